"""What the controller's thread alone touches: the open library, how it is opened, and all that ends with it."""

import logging
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from pathlib import Path
from threading import Lock
from uuid import UUID

from app.storage.bringing_home import bring_home
from app.storage.clinic.away import bring_away_home, has_been_away, open_away, remember_operators
from app.storage.clinic.handing_over import begin_station
from app.storage.clinic.joining import is_station, join, new_station
from app.storage.clinic.journal_store import PlaceMissingError, PlaceUnconfirmedError
from app.storage.clinic.moving import Moved, bring_back_here, give_up_early, move_to_server
from app.storage.clinic.station import server_name, station_of, with_password
from app.storage.data_key import DataKey, LibraryLockedError
from app.storage.error_figures import figures_of
from app.storage.key_change import ChangedKey, change_data_key, refuse_change
from app.storage.keyring_slot import is_there_a_keyring, open_remembered
from app.storage.keys import KeyRefusedError
from app.storage.layout import MOVING
from app.storage.login_delay import LoginDelay
from app.storage.opened import OpenedLibrary, create_library, held_alone, logged_in, open_library, slots_of
from app.storage.recovery import find_interrupted
from app.storage.rollback import Rollback, SeenLibraries
from app.storage.root import GONE
from app.storage.stored import LibraryError, Operator, Role, ServerSilentError
from app.system.progress import Report
from app.wording.translation import later, tr
from app.workers.library_opening import demonstration, let_keyring_remember, tidy
from app.workers.library_state import (
    Closed,
    Joined,
    KeptLogIn,
    LibraryPlace,
    NotOpened,
    OpenedState,
    Reopened,
    Unlocked,
)
from app.workers.refusals import NothingOpenError, Refusal, nothing_open, refusal_of
from core.verdicts.sigmas import PUBLISHED, use

Opening = tuple[OpenedLibrary, str]  # and its recovery key, where it was just made

_log = logging.getLogger(__name__)


class LibraryHolder:
    """What the thread of the calls alone touches: the library, and all that ends with it."""

    def __init__(self, seen: Path | None) -> None:
        self.long_work, self._seen_folder = Lock(), seen
        self.seen: SeenLibraries | None = None
        self.kept: KeptLogIn | None = None
        self._library: OpenedLibrary | None = None
        self._ends = ExitStack()
        self._is_to_be_tidied = False
        self.unlocks = 0  # that succeeded

    @property
    def library(self) -> OpenedLibrary:
        if self._library is None:
            raise NothingOpenError
        return self._library

    def _open(self, opening: Callable[[], Opening], station: Path | None = None) -> OpenedState | NotOpened:
        """Open a library; `station`: the folder in which one may be, to work in without its server."""
        self.close()
        self.forget()
        try:
            with ExitStack() as ends:
                library, recovery_key = opening()
                ends.enter_context(library)
                state = replace(_look_through(library, ends), rollback=self._look_back(library))
                _judge_by_its_figures(library, ends)
                self._library, self._ends = library, ends.pop_all()
        except Exception as error:  # reported where the library was to be opened
            is_away = station is not None and isinstance(error, ServerSilentError) and is_station(station)
            return NotOpened(*refusal_of(error), isinstance(error, KeyRefusedError), is_away)
        self._is_to_be_tidied = True
        return replace(state, recovery_key=recovery_key)

    def open(
        self,
        folder: Path,
        passphrase: str,
        code: str = "",
        must_remember: bool = False,
        delay: LoginDelay | None = None,
    ) -> OpenedState | NotOpened:
        """Open with an operator's passphrase; `must_remember`: from now on the keyring may do so, too.

        `delay` counts the wrong ones.
        """

        def opening() -> Opening:
            with delay.trying(code) if delay is not None else nullcontext():
                library = open_library(folder, passphrase, code)
            if must_remember:
                let_keyring_remember(library)
            return library, ""

        return self._open(opening, folder)

    def open_away(
        self, folder: Path, passphrase: str, code: str, delay: LoginDelay | None = None
    ) -> OpenedState | NotOpened:
        """Open what the station in `folder` works with while the clinic's server does not answer."""

        def opening() -> Opening:
            with delay.trying(code) if delay is not None else nullcontext():
                slots = slots_of(folder)
                data_key = slots.open(code, passphrase)
            if slots.is_given(code):  # keys are changed on the server
                raise KeyRefusedError(
                    tr("Another person chose this passphrase"), tr("Choose your own when the clinic's server responds")
                )
            return open_away(folder, data_key, code), ""

        return self._open(opening)

    def open_remembered(self, folder: Path, code: str) -> OpenedState | NotOpened:
        def opening() -> Opening:
            data_key = open_remembered(slots_of(folder), code)
            if data_key is None:
                raise KeyRefusedError(
                    tr("The passphrase is no longer stored on this computer"), tr("Enter the passphrase")
                )
            return logged_in(folder, data_key, code), ""

        return self._open(opening)

    def open_kept(self, kept: KeptLogIn | None = None) -> OpenedState | NotOpened:
        """Open the library that was closed for a moment; `kept`: by the window before this one."""
        kept, self.kept = kept or self.kept, None

        def opening() -> Opening:
            if kept is None:
                raise LibraryLockedError(later("The library is locked"), later("Type the passphrase, then try again"))
            again = open_away if kept.is_away else logged_in
            return again(kept.folder, kept.data_key, kept.code), ""

        state = self._open(opening)
        return replace(state, is_continued=True) if isinstance(state, OpenedState) else state

    def open_recovered(self, folder: Path, recovery_key: str, code: str, passphrase: str) -> OpenedState | NotOpened:
        """Open with the recovery key, and give the operator a new passphrase."""

        def opening() -> Opening:
            slots = slots_of(folder)
            data_key = slots.open_with_recovery_key(recovery_key)
            slots.confirm_recovery_key(recovery_key)  # it was typed from its sheet
            slots.set_passphrase(data_key, code, passphrase)
            return logged_in(folder, data_key, code), ""

        return self._open(opening)

    def create(self, folder: Path, code: str, name: str, passphrase: str) -> OpenedState | NotOpened:
        """Make a library whose administrator is the operator, and open it."""
        return self._open(lambda: create_library(folder, Operator(code, name, Role.ADMINISTRATOR), passphrase))

    def lock(self, unlocks: int) -> None:
        """Wipe the data key; not after a further unlock than `unlocks`, which came while the lock waited."""
        library = self._library
        if library is None or library.data_key is None or self.unlocks != unlocks:
            return
        if not self.long_work.acquire(blocking=False):
            return
        try:
            library.library.suspend()
            library.data_key.wipe()
        finally:
            self.long_work.release()

    def unlock(self, code: str, passphrase: str, delay: LoginDelay | None) -> Unlocked:
        """Bring the data key back with the operator's passphrase; `delay` counts the wrong ones."""
        library = self.library
        library.refuse_gone()  # else the slots only miss their file, which would count as a wrong passphrase
        with delay.trying(code) if delay is not None else nullcontext():
            data_key = slots_of(library.keys_folder).open(code, passphrase)
        if library.data_key is not None:
            library.data_key.refill(data_key)
        self.unlocks += 1
        return Unlocked()

    def accept_rollback(self, rollback: Rollback) -> None:
        """Go on from the library's older state; an administrator's decision, which its audit keeps."""
        if self.seen is not None:
            self.seen.accept(self.library.library, rollback)

    def change_key(self, leaving: str, report: Report) -> Reopened:
        """Give the library a new data key, without the operator `leaving` if one is named."""
        library = self.library
        if leaving and library.shared is not None:
            with self.long_work:
                return _end_access(library, _operator_of(library), leaving)

        def change() -> ChangedKey:
            refuse_change(library)  # before anybody is entered as no longer working here
            return change_data_key(library, _staying(library, leaving), report)

        return self._reopened_after(change)

    def move_to_server(self, address: str, password: str, place: str, report: Report) -> Reopened:
        library = self.library

        def move() -> Moved:
            station = new_station(with_password(address, password), place)
            try:
                return move_to_server(library, station, report)
            except Exception:
                give_up_early(library.folder)
                raise

        return self._reopened_after(move)

    def bring_back(self, report: Report) -> Reopened:
        library = self.library
        return self._reopened_after(lambda: bring_back_here(library, report))

    def join(self, folder: Path, address: str, password: str, place: str) -> Joined:
        """Make a folder a station of a clinic server's library; `place`: the shared place's name here."""
        try:
            join(folder, with_password(address, password), place)
        except Exception as error:  # reported where the server was named
            place = error.place if isinstance(error, PlaceUnconfirmedError) else ""
            return Joined(refusal_of(error), isinstance(error, PlaceMissingError), place)
        return Joined(None)

    def _reopened_after(self, work: Callable[[], object]) -> Reopened:
        """Do what closes the library, and open it again for whoever worked with it."""
        library, result, refusal = self.library, None, nothing_open()
        operator, key = _operator_of(library), library.data_key
        with self.long_work:
            try:
                result = work()
            except Exception as error:  # reported where it was asked for
                refusal = refusal_of(error)
            is_open = library.library.operator is not None
            if result is None and is_open and not (library.folder / MOVING).exists():
                return Reopened(OpenedState(library, operator), None, refusal)
            if isinstance(result, ChangedKey):
                key = result.data_key
            try:
                assert key is not None  # hidden in the demonstration
                again = self._open_again(library, key, operator.code)
            except Exception as error:  # what was interrupted is finished when somebody logs in
                return Reopened(None, None, refusal if result is None else refusal_of(error))
        return Reopened(OpenedState(again, operator), result, refusal)

    def _open_again(self, before: OpenedLibrary, key: DataKey, code: str) -> OpenedLibrary:
        """The library under `key`; the one before is closed, and its key wiped where it is another."""
        self._library = None
        self._ends.close()
        with ExitStack() as ends:
            library = ends.enter_context(logged_in(before.folder, key, code))
            # held again: where the disk was mounted again meanwhile, the watch held it, which has ended
            ends.enter_context(held_alone(library.folder))
            begin_station(library)
            _judge_by_its_figures(library, ends)
            self._library, self._ends = library, ends.pop_all()
        if before.data_key is not None and before.data_key is not key:
            before.data_key.wipe()
        return library

    def open_demonstration(self, must_keep: bool) -> OpenedState | NotOpened:
        """Open the demonstration; `must_keep`: and keep who is logged in, for the time after it."""
        if must_keep:
            self.keep()
        else:
            self.end()
        try:
            with ExitStack() as ends:
                folder = Path(ends.enter_context(tempfile.TemporaryDirectory(prefix="gaitwright-demo-")))
                library = ends.enter_context(demonstration(folder))
                state = _look_through(library, ends)
                self._library, self._ends = library, ends.pop_all()
        except Exception as error:
            return NotOpened(*refusal_of(error), False)
        return state

    def close(self) -> Closed:
        with self.long_work:
            self._library, self._is_to_be_tidied = None, False
            self._ends.close()
        return Closed()

    def keep(self) -> None:
        """Close the library, and move its key to what opens it again; of a demonstration, what was kept stays."""
        library = self._library
        operator = library.library.operator if library is not None else None
        self.close()
        if library is not None and operator is not None and library.data_key:
            data_key = DataKey()
            data_key.refill(library.data_key)
            self.kept = KeptLogIn(library.keys_folder, operator.code, data_key, library.away_from is not None)

    def forget(self) -> None:
        """Wipe the key of whoever is logged in behind the demonstration."""
        kept, self.kept = self.kept, None
        if kept is not None:
            kept.data_key.wipe()

    def end(self) -> Closed:
        """Close the library, and keep nothing that opens it."""
        self.forget()
        return self.close()

    def _look_back(self, library: OpenedLibrary) -> Rollback | None:
        if self._seen_folder is None:
            return None
        self.seen = SeenLibraries(self._seen_folder)
        return self.seen.look(library.library)

    def do_left_over(self) -> None:
        """What can wait until the library is on the screen: destroy what is overdue, remove old backups."""
        library = self._library
        if library is not None and library.data_key and self.seen is not None:
            self.seen.remember(library.library)
        if library is None or not self._is_to_be_tidied:
            return
        self._is_to_be_tidied = False
        try:
            tidy(library)
        except Exception as error:  # it is tried again at the next start
            _log.warning("what is overdue was not removed", exc_info=error)

    @staticmethod
    def gone_words(library: OpenedLibrary) -> Refusal:
        """The message about a library whose folder is gone, whether something is being recorded or not."""
        if library.shared is not None and library.is_there:
            return Refusal(
                tr("The clinic's server does not respond."),
                tr(
                    "New recordings stay on this computer, encrypted as always. They are added to the library "
                    "automatically once the server responds. Nothing else can be saved until then."
                ),
            )
        what = tr(GONE).format(folder=library.folder) + "."
        if library.shelter is None:
            return Refusal(what, tr("The demonstration ends here. Open the demonstration again."))
        then = tr(
            "Put the library's folder back, or connect its disk. Until then recordings stay on this "
            "computer in {shelter}, encrypted as always. They are added to the library automatically once "
            "it is available again."
        )
        return Refusal(what, then.format(shelter=library.shelter.folder))

    @staticmethod
    def look(folder: Path) -> LibraryPlace:
        slots = slots_of(folder)
        codes = slots.codes if slots.exists else ()
        remembered = tuple(code for code in codes if slots.keyring_slot(code) is not None)
        delay = LoginDelay(folder, time.monotonic)
        if slots.exists:
            delay.read()
        station = station_of(folder)
        server = server_name(station.database) if station is not None else None
        return LibraryPlace(folder, slots.exists, codes, remembered, is_there_a_keyring(), delay, server)


def _judge_by_its_figures(library: OpenedLibrary, ends: ExitStack) -> None:
    """Judge differences by the library's error figures until it is closed."""
    ends.callback(use, PUBLISHED)
    use(figures_of(library.library))


def _look_through(library: OpenedLibrary, ends: ExitStack) -> OpenedState:
    ends.enter_context(held_alone(library.folder))
    from_away, still_away = _begin_station(library)
    operator = _operator_of(library)
    brought: frozenset[UUID] = frozenset()
    try:
        brought = bring_home(library)
    except OSError as error:  # the watch tries again, and reports it
        _log.warning("what is in the shelter cannot be brought home", exc_info=error)
    return OpenedState(
        library,
        operator,
        find_interrupted(library),
        library.library.is_end_lost,
        brought,
        is_recovery_key_confirmed=_is_recovery_key_confirmed(library),
        is_away=library.away_from is not None,
        brought_from_away=from_away,
        still_away=still_away,
        is_passphrase_given=_is_passphrase_given(library, operator),
    )


def _is_recovery_key_confirmed(library: OpenedLibrary) -> bool:
    if library.data_key is None or library.away_from is not None:
        return True
    return slots_of(library.folder).is_recovery_key_confirmed


def _is_passphrase_given(library: OpenedLibrary, operator: Operator) -> bool:
    if library.data_key is None or library.away_from is not None:  # then it was refused before
        return False
    return slots_of(library.folder).is_given(operator.code)


def _begin_station(library: OpenedLibrary) -> tuple[int, Refusal | None]:
    """Start up a clinic's station; give how many away sessions reached the server, and why others did not."""
    if library.shared is None:
        return 0, None
    brought, refusal = 0, None
    try:
        remember_operators(library)
        brought = bring_away_home(library)
    except (LibraryError, OSError) as error:  # it stays here, for the next time
        _log.warning("what was recorded without the server is still here", exc_info=error)
        refusal = refusal_of(error) if has_been_away(library) else None
    begin_station(library)
    return brought, refusal


def _operator_of(library: OpenedLibrary) -> Operator:
    operator = library.library.operator
    assert operator is not None  # whoever opens a library is logged in
    return operator


def _end_access(library: OpenedLibrary, operator: Operator, leaving: str) -> Reopened:
    """Take the operator `leaving` the way into a clinic's library, whose stations go on with its key."""
    state = OpenedState(library, operator)
    try:
        _staying(library, leaving)
        slots_of(library.folder).remove(leaving)
    except Exception as error:  # reported where it was asked for
        return Reopened(state, None, refusal_of(error))
    what = tr("{code} no longer has access.").format(code=leaving)
    then = tr(
        "The library keeps its key, which all workstations share. Set new passwords for the server's "
        "logins, so that nobody who knew the key reaches the server."
    )
    return Reopened(state, None, Refusal(what, then))


def _staying(library: OpenedLibrary, leaving: str) -> list[str]:
    """Who keeps a key, once the operator `leaving` works here no longer."""
    operators = library.library.operators
    for operator in operators.list():
        if operator.code == leaving and operator.is_active:
            operators.change(replace(operator, is_active=False))
    return [operator.code for operator in operators.list() if operator.is_active]

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
from app.storage.data_key import DataKey
from app.storage.key_change import change_data_key, refuse_change
from app.storage.keyring_slot import is_there_a_keyring, open_remembered
from app.storage.keys import KeyRefusedError
from app.storage.login_delay import LoginDelay
from app.storage.opened import OpenedLibrary, create_library, held_alone, logged_in, open_library, slots_of
from app.storage.recovery import find_interrupted
from app.storage.rollback import Rollback, SeenLibraries
from app.storage.root import GONE
from app.storage.stored import Operator, Role
from app.wording import tr
from app.workers.background import Report
from app.workers.library_opening import demonstration, let_keyring_remember, tidy
from app.workers.library_state import Closed, KeyChanged, LibraryPlace, NotOpened, OpenedState, Unlocked
from app.workers.refusals import NothingOpenError, Refusal, nothing_open, refusal_of

Opening = tuple[OpenedLibrary, str]  # and its recovery key, where it was just made

_log = logging.getLogger(__name__)


class LibraryHolder:
    """What the thread of the calls alone touches: the library, and all that ends with it."""

    def __init__(self, seen: Path | None) -> None:
        self.long_work, self._seen_folder = Lock(), seen
        self.seen: SeenLibraries | None = None
        self._library: OpenedLibrary | None = None
        self._ends = ExitStack()
        self._is_to_be_tidied = False

    @property
    def library(self) -> OpenedLibrary:
        if self._library is None:
            raise NothingOpenError
        return self._library

    def _open(self, opening: Callable[[], Opening]) -> OpenedState | NotOpened:
        self.close()
        try:
            with ExitStack() as ends:
                library, recovery_key = opening()
                ends.enter_context(library)
                state = replace(_look_through(library, ends), rollback=self._look_back(library))
                self._library, self._ends = library, ends.pop_all()
        except Exception as error:  # told where the library was to be opened
            return NotOpened(*refusal_of(error), isinstance(error, KeyRefusedError))
        self._is_to_be_tidied = True
        return replace(state, recovery_key=recovery_key)

    def open(
        self, folder: Path, passphrase: str, code: str, must_remember: bool, delay: LoginDelay | None
    ) -> OpenedState | NotOpened:
        def opening() -> Opening:
            with delay.trying(code) if delay is not None else nullcontext():
                library = open_library(folder, passphrase, code)
            if must_remember:
                let_keyring_remember(library)
            return library, ""

        return self._open(opening)

    def open_remembered(self, folder: Path, code: str) -> OpenedState | NotOpened:
        def opening() -> Opening:
            data_key = open_remembered(slots_of(folder), code)
            if data_key is None:
                raise KeyRefusedError(tr("This computer does not remember the passphrase any more"), tr("Type it"))
            return logged_in(folder, data_key, code), ""

        return self._open(opening)

    def open_recovered(self, folder: Path, recovery_key: str, code: str, passphrase: str) -> OpenedState | NotOpened:
        def opening() -> Opening:
            slots = slots_of(folder)
            data_key = slots.open_with_recovery_key(recovery_key)
            slots.confirm_recovery_key(recovery_key)  # it was typed from its sheet
            slots.set_passphrase(data_key, code, passphrase)
            return logged_in(folder, data_key, code), ""

        return self._open(opening)

    def create(self, folder: Path, code: str, name: str, passphrase: str) -> OpenedState | NotOpened:
        return self._open(lambda: create_library(folder, Operator(code, name, Role.ADMINISTRATOR), passphrase))

    def lock(self) -> None:
        library = self._library
        if library is None or library.data_key is None or not self.long_work.acquire(blocking=False):
            return
        try:
            library.library.suspend()
            library.data_key.wipe()
        finally:
            self.long_work.release()

    def unlock(self, code: str, passphrase: str, delay: LoginDelay | None) -> Unlocked:
        library = self.library
        library.refuse_gone()  # else the slots only miss their file, which would count as a wrong passphrase
        with delay.trying(code) if delay is not None else nullcontext():
            data_key = slots_of(library.folder).open(code, passphrase)
        if library.data_key is not None:
            library.data_key.refill(data_key)
        return Unlocked()

    def change_key(self, leaving: str, report: Report) -> KeyChanged:
        library, changed, refusal = self.library, None, nothing_open()
        operator = library.library.operator
        assert operator is not None  # whoever opens a library is logged in
        key = library.data_key
        with self.long_work:
            try:
                refuse_change(library)  # before anybody is said to work here no longer
            except Exception as error:  # told where the key was to be changed
                return KeyChanged(OpenedState(library, operator), None, refusal_of(error))
            try:
                changed = change_data_key(library, _staying(library, leaving), report)
                key = changed.data_key
            except Exception as error:
                refusal = refusal_of(error)
            try:
                assert key is not None  # hidden in the demonstration
                again = self._open_again(library, key, operator.code)
            except Exception as error:  # what was interrupted is finished when somebody logs in
                return KeyChanged(None, None, refusal if changed is None else refusal_of(error))
        return KeyChanged(OpenedState(again, operator), changed, refusal)

    def _open_again(self, before: OpenedLibrary, key: DataKey, code: str) -> OpenedLibrary:
        """The library under `key`; the one before is closed, and its key wiped where it is another."""
        self._library = None
        self._ends.close()
        with ExitStack() as ends:
            library = ends.enter_context(logged_in(before.folder, key, code))
            # held anew: where the disk was mounted anew meanwhile, the watch held it, which has ended
            ends.enter_context(held_alone(library.folder))
            self._library, self._ends = library, ends.pop_all()
        if before.data_key is not None and before.data_key is not key:
            before.data_key.wipe()
        return library

    def open_demonstration(self) -> OpenedState | NotOpened:
        self.close()
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
        """What is said of a library whose folder is gone, whether something is being recorded or not."""
        what = tr(GONE).format(folder=library.folder) + "."
        if library.shelter is None:
            return Refusal(what, tr("The demonstration ends here. Open it again."))
        then = tr(
            "Put its folder back, or connect its disk. Until then recordings are kept on this computer in {shelter}, "
            "encrypted as always, and added to the library by themselves once it is back."
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
        return LibraryPlace(folder, slots.exists, codes, remembered, is_there_a_keyring(), delay)


def _look_through(library: OpenedLibrary, ends: ExitStack) -> OpenedState:
    ends.enter_context(held_alone(library.folder))
    operator = library.library.operator
    assert operator is not None  # whoever opens a library is logged in
    brought: frozenset[UUID] = frozenset()
    try:
        brought = bring_home(library)
    except OSError as error:  # the watch tries again, and says so
        _log.warning("what is in the shelter cannot be brought home", exc_info=error)
    return OpenedState(
        library,
        operator,
        find_interrupted(library),
        library.library.is_end_lost,
        brought,
        is_recovery_key_confirmed=library.data_key is None or slots_of(library.folder).is_recovery_key_confirmed,
    )


def _staying(library: OpenedLibrary, leaving: str) -> list[str]:
    """Who keeps a key, once the operator `leaving` works here no longer."""
    operators = library.library.operators
    for operator in operators.list():
        if operator.code == leaving and operator.is_active:
            operators.change(replace(operator, is_active=False))
    return [operator.code for operator in operators.list() if operator.is_active]

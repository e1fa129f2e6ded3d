"""Who asks the library while the screen goes on? One thread, in the order of asking; answers come to the screen's.

A call is given as a function of the open library and as bound methods of whoever asked. Those are called on the
screen's thread, and not at all once their owner is gone. Refusals arrive as two sentences, what and remedy, ready to
be shown. Storage is imported by the thread, for its imports take longer than the window may.
"""

import logging
import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from queue import SimpleQueue
from threading import Lock
from typing import TYPE_CHECKING, NamedTuple, ParamSpec, TypeVar
from weakref import WeakMethod, ref

from PySide6.QtCore import QObject, QThread, Signal
from shiboken6 import isValid

from app.wording import tr
from app.workers.background import Background, Report

if TYPE_CHECKING:
    from app.storage.keys import KeySlots
    from app.storage.opened import OpenedLibrary
    from app.storage.recovery import Interrupted
    from app.storage.stored import Operator

BACKUP_FOLDER = "backup_folder"  # the library's setting that names where its backups are
DEMONSTRATION_CODE = "DEMO-1"

_log = logging.getLogger(__name__)

P = ParamSpec("P")
T = TypeVar("T")
Failed = Callable[[str, str], object]
if TYPE_CHECKING:
    Opening = tuple[OpenedLibrary, str]  # and its recovery key, where it was just made


@dataclass(frozen=True, slots=True)
class OpenedState:
    """What was found on opening.

    Attributes
    ----------
    interrupted
        Recordings that nobody stopped, to be looked at.
    is_end_lost
        The library was not closed well, and what was saved last is damaged.
    recovery_key
        Of a library that was just made, to be shown once; else empty.
    """

    library: "OpenedLibrary"
    operator: "Operator"
    interrupted: tuple["Interrupted", ...] = ()
    is_end_lost: bool = False
    recovery_key: str = field(default="", repr=False)

    @property
    def is_demonstration(self) -> bool:
        return self.library.data_key is None


@dataclass(frozen=True, slots=True)
class LibraryPlace:
    """What a folder says before its library is opened. `remembered`: operators whom the keyring may let in."""

    folder: Path
    exists: bool
    codes: tuple[str, ...]
    remembered: tuple[str, ...]
    has_keyring: bool


class LibraryDesk(QObject):
    """One library at a time; opening another closes the one before. `finish` belongs to the program's end."""

    opened = Signal(object)  # OpenedState
    not_opened = Signal(str, str, bool)  # what, remedy, whether it was the key that did not open
    closed = Signal()
    refused = Signal(str, str)  # of a call whose asker does not listen to refusals

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._worker = _Worker(self)
        self._worker.told.connect(self._on_told)
        self._state: OpenedState | None = None
        self._long = Background(self)
        self._long.progressed.connect(self._on_long_progressed)
        self._long.done.connect(self._on_long_done)
        self._long.failed.connect(self._on_long_failed)
        self._long_job: _Job | None = None
        self._long_progressed: WeakMethod[Callable[[float, str], object]] | None = None

    @property
    def state(self) -> OpenedState | None:
        """The library that is open, as it was when it was opened; None while there is none."""
        return self._state

    def run(
        self,
        call: Callable[["OpenedLibrary"], T],
        done: Callable[[T], object] | None,
        failed: Failed | None,
        owner: QObject,
    ) -> None:
        """Let the thread make `call`, then call `done(result)` or `failed(what, remedy)`, bound methods of `owner`'s.

        Without `failed` a refusal is told by the signal `refused`.
        """
        self._worker.ask(_Job(lambda thread: call(thread.library), _weak(done), _weak(failed), ref(owner)))

    def run_long(
        self,
        work: Callable[["OpenedLibrary", Report], T],
        done: Callable[[T], object] | None,
        failed: Failed | None,
        progressed: Callable[[float, str], object] | None,
        owner: QObject,
    ) -> None:
        """Do what takes long, an import or a backup, beside the calls; one at a time, and `stop_long` ends it.

        Nothing more is heard of what was stopped.
        """
        job = _Job(_Thread.nothing, _weak(done), _weak(failed), ref(owner))
        if self._state is None:
            self._tell_refusal(job, *_nothing_open())
            return
        if self._long.is_busy:  # what was stopped is waited for by the next
            self._tell_refusal(job, tr("Something else is still being done."), tr("Wait for it, or stop it."))
            return
        self._long_job, self._long_progressed = job, _weak(progressed)
        library, lock = self._state.library, self._worker.long_work

        def locked(report: Report) -> T:
            with lock:  # the library is not closed under it
                return work(library, report)

        self._long.start(locked)

    def stop_long(self) -> None:
        self._long.stop()
        self._long_job = None

    def look(self, folder: Path, done: Callable[[LibraryPlace], object], failed: Failed, owner: QObject) -> None:
        """Find out who may open the library in `folder`."""
        self._worker.ask(_Job(lambda _thread: _look(folder), _weak(done), _weak(failed), ref(owner)))

    def open(self, folder: Path, passphrase: str, code: str = "", must_remember: bool = False) -> None:
        """Open a library with an operator's passphrase; `must_remember`: from now on the keyring may do so, too."""

        def opening() -> "Opening":
            from app.storage.opened import open_library

            library = open_library(folder, passphrase, code)
            if must_remember:
                _remember(library)
            return library, ""

        self._open(opening)

    def open_remembered(self, folder: Path, code: str) -> None:
        """Open a library as this machine's keyring allows."""

        def opening() -> "Opening":
            from app.storage.keyring_slot import open_remembered
            from app.storage.keys import KeyRefusedError

            data_key = open_remembered(_slots(folder), code)
            if data_key is None:
                raise KeyRefusedError(tr("This computer does not remember the passphrase any more"), tr("Type it"))
            return _logged_in(folder, data_key, code), ""

        self._open(opening)

    def open_recovered(self, folder: Path, recovery_key: str, code: str, passphrase: str) -> None:
        """Open a library with its recovery key, and give the operator a new passphrase."""

        def opening() -> "Opening":
            slots = _slots(folder)
            data_key = slots.open_with_recovery_key(recovery_key)
            slots.set_passphrase(data_key, code, passphrase)
            return _logged_in(folder, data_key, code), ""

        self._open(opening)

    def create(self, folder: Path, code: str, name: str, passphrase: str) -> None:
        """Make a library whose administrator is the operator, and open it; its recovery key comes with `opened`."""

        def making() -> "Opening":
            from app.storage.opened import create_library
            from app.storage.stored import Operator, Role

            return create_library(folder, Operator(code, name, Role.ADMINISTRATOR), passphrase)

        self._open(making)

    def open_demonstration(self) -> None:
        """Open a library of its own, gone when it is closed, with one simulated patient and a session."""
        self._end_library()
        self._worker.ask(_Job(_Thread.open_demonstration, None, None, ref(self)))

    def close(self) -> None:
        """Close the library that is open; what is asked later is refused until another is."""
        self._end_library()
        self._worker.ask(_Job(_Thread.close, None, None, ref(self)))

    def finish(self) -> None:
        """Close, and wait for all threads: for the end of the program."""
        self._end_library()
        self._long.finish()
        self._worker.finish()

    def _open(self, opening: "Callable[[], Opening]") -> None:
        self._end_library()
        self._worker.ask(_Job(lambda thread: thread.open(opening), None, None, ref(self)))

    def _end_library(self) -> None:
        self.stop_long()
        self._state = None

    def _on_told(self, job: "_Job", outcome: object) -> None:
        if isinstance(outcome, _Refusal):
            self._tell_refusal(job, outcome.what, outcome.remedy)
        elif isinstance(outcome, OpenedState):
            self._state = outcome
            self.opened.emit(outcome)
        elif isinstance(outcome, _NotOpened):
            self.not_opened.emit(outcome.what, outcome.remedy, outcome.is_key)
        elif isinstance(outcome, _Closed):
            self.closed.emit()
        elif done := job.listening(job.done):
            done(outcome)

    def _tell_refusal(self, job: "_Job", what: str, remedy: str) -> None:
        if job.failed is None:
            self.refused.emit(what, remedy)
        elif failed := job.listening(job.failed):
            failed(what, remedy)

    def _on_long_progressed(self, share: float, what: str) -> None:
        job = self._long_job
        if job is not None and (progressed := job.listening(self._long_progressed)):
            progressed(share, what)

    def _on_long_done(self, result: object) -> None:
        job, self._long_job = self._long_job, None
        if job is not None and (done := job.listening(job.done)):
            done(result)

    def _on_long_failed(self, error: Exception) -> None:
        job, self._long_job = self._long_job, None
        if job is not None:
            refusal = _refusal(error)
            self._tell_refusal(job, refusal.what, refusal.remedy)


class _Refusal(NamedTuple):
    what: str
    remedy: str


class _NotOpened(NamedTuple):
    what: str
    remedy: str
    is_key: bool


class _Closed(NamedTuple):
    pass


class _NothingOpenError(Exception):
    """A call came while no library was open."""


@dataclass(frozen=True, slots=True, eq=False)
class _Job:
    call: "Callable[[_Thread], object]"
    done: "WeakMethod[Callable[..., object]] | None"
    failed: "WeakMethod[Failed] | None"
    owner: "ref[QObject]"

    def listening(self, method: "WeakMethod[Callable[P, object]] | None") -> Callable[P, object] | None:
        """The method, where it and its owner are still there."""
        owner = self.owner()
        return method() if method is not None and owner is not None and isValid(owner) else None


class _Worker(QThread):
    """Runs until `finish`; begins with the first job."""

    told = Signal(object, object)  # the job, and what came of it

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._jobs: SimpleQueue[_Job | None] = SimpleQueue()
        self.long_work = Lock()

    def ask(self, job: _Job) -> None:
        self._jobs.put(job)
        if not self.isRunning():
            self.start()

    def finish(self) -> None:
        if self.isRunning():
            self._jobs.put(None)
            self.wait()

    def run(self) -> None:
        thread = _Thread(self.long_work)
        while (job := self._jobs.get()) is not None:
            try:
                outcome = job.call(thread)
            except Exception as error:  # the edge of the thread: beyond it nobody could catch it
                outcome = _refusal(error)
            self.told.emit(job, outcome)
            del job, outcome  # not held until the next one comes
            thread.do_left_over()
        thread.close()


class _Thread:
    """What the thread alone touches: the library, and all that ends with it."""

    def __init__(self, long_work: Lock) -> None:
        self._long_work = long_work
        self._library: OpenedLibrary | None = None
        self._ends = ExitStack()
        self._is_to_be_tidied = False

    @property
    def library(self) -> "OpenedLibrary":
        if self._library is None:
            raise _NothingOpenError
        return self._library

    def nothing(self) -> None:
        """What runs elsewhere."""

    def open(self, opening: "Callable[[], Opening]") -> OpenedState | _NotOpened:
        from app.storage.keys import KeyRefusedError

        self.close()
        try:
            with ExitStack() as ends:
                library, recovery_key = opening()
                ends.enter_context(library)
                state = _look_through(library, ends)
                self._library, self._ends = library, ends.pop_all()
        except Exception as error:  # told where the library was to be opened
            return _NotOpened(*_refusal(error), isinstance(error, KeyRefusedError))
        self._is_to_be_tidied = True
        return replace(state, recovery_key=recovery_key)

    def open_demonstration(self) -> OpenedState | _NotOpened:
        self.close()
        try:
            with ExitStack() as ends:
                folder = Path(ends.enter_context(tempfile.TemporaryDirectory(prefix="gaitwright-demo-")))
                library = ends.enter_context(_demonstration(folder))
                state = _look_through(library, ends)
                self._library, self._ends = library, ends.pop_all()
        except Exception as error:
            return _NotOpened(*_refusal(error), False)
        return state

    def close(self) -> _Closed:
        with self._long_work:
            self._library, self._is_to_be_tidied = None, False
            self._ends.close()
        return _Closed()

    def do_left_over(self) -> None:
        """What can wait until the library is on the screen: destroy what is overdue, remove old backups."""
        library = self._library
        if library is None or not self._is_to_be_tidied:
            return
        self._is_to_be_tidied = False
        try:
            _tidy(library)
        except Exception as error:  # it is tried again at the next start
            _log.warning("what is overdue was not removed", exc_info=error)


def _look_through(library: "OpenedLibrary", ends: ExitStack) -> OpenedState:
    from app.storage.opened import held_alone
    from app.storage.recovery import find_interrupted

    ends.enter_context(held_alone(library.folder))
    operator = library.library.operator
    assert operator is not None  # whoever opens a library is logged in
    return OpenedState(library, operator, find_interrupted(library), library.library.is_end_lost)


def _tidy(library: "OpenedLibrary") -> None:
    from app.storage.backup import remove_old_backups
    from app.storage.retention import destroy_overdue
    from app.storage.stored import Role

    operator = library.library.operator
    if operator is None or operator.role is Role.VIEWER:
        return
    destroyed = destroy_overdue(library)
    folder = library.library.settings.get(BACKUP_FOLDER, "")
    removed = remove_old_backups(Path(folder)) if folder and Path(folder).is_dir() else ()
    _log.info("sessions destroyed: %d, old backups removed: %d", destroyed, len(removed))


def _demonstration(folder: Path) -> "OpenedLibrary":
    from app.storage.exchange import import_session
    from app.storage.library import DEMONSTRATOR, Library
    from app.storage.opened import OpenedLibrary
    from devices.walker import DEMONSTRATION, simulate

    library = OpenedLibrary(Library.create(folder, None, DEMONSTRATOR), folder, None)
    try:
        session = replace(simulate(DEMONSTRATION).session, started=datetime.now().isoformat(timespec="seconds"))
        import_session(library, session, _silent, DEMONSTRATION_CODE)
    except BaseException:
        library.library.close()
        raise
    return library


def _silent(_share: float, _what: str) -> None:
    """For whom progress is nothing."""


def _slots(folder: Path) -> "KeySlots":
    from app.storage.keys import KeySlots
    from app.storage.opened import KEYS

    return KeySlots(folder / KEYS)


def _look(folder: Path) -> LibraryPlace:
    from app.storage.keyring_slot import is_there_a_keyring

    slots = _slots(folder)
    codes = slots.codes if slots.exists else ()
    remembered = tuple(code for code in codes if slots.keyring_slot(code) is not None)
    return LibraryPlace(folder, slots.exists, codes, remembered, is_there_a_keyring())


def _logged_in(folder: Path, data_key: bytes, code: str) -> "OpenedLibrary":
    from app.storage.library import Library
    from app.storage.opened import OpenedLibrary

    library = Library.open(folder, data_key)
    try:
        library.log_in(code)
    except BaseException:
        library.close()
        raise
    return OpenedLibrary(library, folder, data_key)


def _remember(library: "OpenedLibrary") -> None:
    """Let the keyring open the library next time; where it does not take the key, the passphrase goes on doing so."""
    from app.storage.keyring_slot import remember
    from app.storage.keys import KeyRefusedError

    operator = library.library.operator
    if library.data_key is None or operator is None:
        return
    try:
        remember(_slots(library.folder), library.data_key, operator.code)
    except KeyRefusedError as refusal:
        _log.warning("the keyring takes no key", exc_info=refusal)


def _weak(method: Callable[P, T] | None) -> "WeakMethod[Callable[P, T]] | None":
    return None if method is None else WeakMethod(method)


def _nothing_open() -> tuple[str, str]:
    return tr("No library is open."), tr("Log in, then try again.")


def _refusal(error: Exception) -> _Refusal:
    """Put what was raised into two sentences; what nobody foresaw is logged."""
    from app.storage.journal.header import JournalRefusedError
    from app.storage.keys import KeyRefusedError
    from app.storage.stored import LibraryError
    from devices.files.refusal import FileRefusedError

    if isinstance(error, LibraryError | KeyRefusedError):
        return _Refusal(f"{tr(error.what)}.", f"{tr(error.remedy)}.")
    if isinstance(error, JournalRefusedError | FileRefusedError):
        return _Refusal(f"{error.where}: {error.what}.", f"{error.remedy}.")
    if isinstance(error, _NothingOpenError):
        return _Refusal(*_nothing_open())
    _log.error("a call of the library ended early", exc_info=error)
    if isinstance(error, OSError):
        what = tr("A file could not be read or written ({why}).").format(why=error.strerror or type(error).__name__)
        return _Refusal(what, tr("See to the disk and to the rights of its folder, then try again."))
    return _Refusal(tr("This ended before it was done."), tr("Try again; the log holds the details."))

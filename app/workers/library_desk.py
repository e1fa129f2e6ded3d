"""Who asks the library while the screen goes on? One thread, in the order of asking; answers come to the screen's.

A recording begins and ends in a thread of its own: neither waits for what the library is being asked meanwhile.

A call is given as a function of the open library and as bound methods of whoever asked. Those are called on the
screen's thread, and not at all once their owner is gone. Refusals arrive as two sentences, what and remedy, ready to
be shown. Storage is imported by the thread, for its imports take longer than the window may.
"""

import logging
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from queue import SimpleQueue
from threading import Event, Lock
from typing import TYPE_CHECKING, NamedTuple, ParamSpec, TypeVar
from uuid import UUID
from weakref import WeakMethod, ref

from PySide6.QtCore import QObject, QThread, Signal
from shiboken6 import isValid

from app.wording import tr, tr_n
from app.workers.background import Background, Report
from app.workers.library_opening import demonstration, let_keyring_remember, logged_in, slots_of, tidy
from app.workers.library_watch import LibraryWatch
from app.workers.refusals import NothingOpenError, Refusal, nothing_open, refusal_of

if TYPE_CHECKING:
    from app.storage.data_key import DataKey
    from app.storage.key_change import ChangedKey
    from app.storage.login_delay import LoginDelay
    from app.storage.opened import OpenedLibrary
    from app.storage.recovery import Interrupted
    from app.storage.rollback import Rollback, SeenLibraries
    from app.storage.stored import Operator

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
    brought_home
        Recordings that were made while the library was gone, and are in it again.
    recovery_key
        Of a library that was just made, to be shown once; else empty.
    rollback
        What this computer has seen of the library and it does not hold any more.
    is_recovery_key_confirmed
        Whether somebody typed the recovery key back from its sheet since it was made.
    """

    library: "OpenedLibrary"
    operator: "Operator"
    interrupted: tuple["Interrupted", ...] = ()
    is_end_lost: bool = False
    brought_home: frozenset[UUID] = frozenset()
    recovery_key: str = field(default="", repr=False)
    rollback: "Rollback | None" = None
    is_recovery_key_confirmed: bool = True

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
    delay: "LoginDelay"


class LibraryDesk(QObject):
    """One library at a time; opening another closes the one before. `finish` belongs to the program's end.

    `seen`: the folder where this computer remembers how far a library had come; without it nothing is remembered.
    """

    opened = Signal(object)  # OpenedState
    not_opened = Signal(str, str, bool)  # what, remedy, whether it was the key that did not open
    closed = Signal()
    refused = Signal(str, str)  # of a call whose asker does not listen to refusals
    gone = Signal(str, str)  # the library's folder, while it is open: what happened, and what to do
    back = Signal(str, str)  # it is there again: and what was recorded meanwhile

    def __init__(self, parent: QObject | None = None, seen: Path | None = None) -> None:
        super().__init__(parent)
        self._holder = _Holder(seen)
        self._calls = _Lane(self, self._holder.do_left_over, self._holder.close)
        self._recordings = _Lane(self)
        for lane in (self._calls, self._recordings):
            lane.told.connect(self._on_told)
        self._state: OpenedState | None = None
        self._watch: LibraryWatch | None = None
        self.gone_words: Refusal | None = None  # for whoever comes later; None: the library is where it was opened
        self._is_locked = self._is_to_be_locked = False
        self._held: list[Callable[[], object]] = []  # what was asked under the lock
        self._key_change: _Job | None = None  # that goes on
        self._long = Background(self)
        self._long.progressed.connect(self._on_long_progressed)
        self._long.done.connect(self._on_long_done)
        self._long.failed.connect(self._on_long_failed)
        self._long_job: _Job | None = None
        self._long.stopped.connect(self._on_long_stopped)
        self._long_ended: WeakMethod[Callable[[bool], object]] | None = None
        self._long_progressed: WeakMethod[Callable[[float, str], object]] | None = None

    @property
    def state(self) -> OpenedState | None:
        """The library that is open, as it was when it was opened; None while there is none."""
        return self._state

    @property
    def is_gone(self) -> bool:
        """Whether the folder of the library that is open is gone from its place."""
        return self.gone_words is not None

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
        self._ask(self._calls, _Job(lambda: call(self._holder.library), _weak(done), _weak(failed), ref(owner)))

    def record(
        self,
        call: "Callable[[OpenedLibrary, Future[None]], T]",
        done: Callable[[T], object] | None,
        failed: Failed | None,
        owner: QObject,
    ) -> None:
        """As `run`, for beginning and ending recordings: whatever else the library is asked is not waited for.

        The `Future` that `call` is given is done when all that was asked before has been.
        """
        if self._state is None:
            self._tell_refusal(_Job(_nothing, None, _weak(failed), ref(owner)), *nothing_open())
            return
        library, turn = self._state.library, Future[None]()
        self._ask(self._calls, _Job(lambda: turn.set_result(None), None, None, ref(self)))
        self._ask(self._recordings, _Job(lambda: call(library, turn), _weak(done), _weak(failed), ref(owner)))

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
        job = _Job(_nothing, _weak(done), _weak(failed), ref(owner))
        begin = partial(self._begin_long, work, job, _weak(progressed))
        if self._is_locked:
            self._held.append(begin)
        else:
            begin()

    def stop_long(self, ended: Callable[[bool], object] | None = None) -> None:
        """End what takes long; `ended` is told, once it has ended, whether it was done before it could be stopped."""
        if self._long.is_busy:
            self._long_ended = _weak(ended)
        self._long.stop()
        self._long_job = None

    def lock(self) -> None:
        """Take the data key out of memory until `unlock`; what is asked meanwhile is done after it.

        A recording goes on: its journal has a key of its own. Long work is waited for.
        """
        if self._state is None or self._state.is_demonstration:
            return
        self._is_to_be_locked = self._is_locked = True
        if not self._long.is_busy:
            self._calls.ask(_Job(self._recordings.passed().wait, None, None, ref(self)))
            self._calls.ask(_Job(self._holder.lock, None, None, ref(self)))

    def unlock(
        self,
        code: str,
        passphrase: str,
        delay: "LoginDelay | None",
        done: Callable[[None], object],
        failed: Failed,
        owner: QObject,
    ) -> None:
        """Bring the data key back with the operator's passphrase; `delay` counts the wrong ones."""
        job = _Job(lambda: self._holder.unlock(code, passphrase, delay), _weak(done), _weak(failed), ref(owner))
        self._calls.ask(job)

    def change_key(
        self,
        leaving: str,
        done: Callable[["ChangedKey"], object],
        failed: Failed,
        progressed: Callable[[float, str], object],
        owner: QObject,
    ) -> None:
        """Give the library a new data key, without the operator `leaving` if one is named; nothing else meanwhile.

        Nor is the folder watched: its database is replaced, and nothing must come home that has the old key.
        """
        job = _Job(lambda: self._holder.change_key(leaving, report), _weak(done), _weak(failed), ref(owner))
        if self._state is None:
            self._tell_refusal(job, *nothing_open())
            return
        if self._long.is_busy:
            self._tell_refusal(job, tr("Something else is still being done."), tr("Wait for it, or stop it."))
            return
        if self.gone_words is not None:
            self._tell_refusal(job, *self.gone_words)
            return
        heard = _weak(progressed)

        def report(share: float, _what: str) -> None:
            self._calls.told.emit(job, _Progress(share, heard))

        self._end_watch()
        self._calls.ask(_Job(self._recordings.passed().wait, None, None, ref(self)))
        self._state, self._key_change = None, job
        self._calls.ask(job)

    def accept_rollback(
        self, rollback: "Rollback", done: Callable[[None], object], failed: Failed, owner: QObject
    ) -> None:
        """Go on from the library's older state; an administrator's decision, which its audit keeps."""

        def accept(opened: "OpenedLibrary") -> None:
            if self._holder.seen is not None:
                self._holder.seen.accept(opened.library, rollback)

        self.run(accept, done, failed, owner)

    def look(self, folder: Path, done: Callable[[LibraryPlace], object], failed: Failed, owner: QObject) -> None:
        """Find out who may open the library in `folder`."""
        self._calls.ask(_Job(lambda: _look(folder), _weak(done), _weak(failed), ref(owner)))

    def open(
        self,
        folder: Path,
        passphrase: str,
        code: str = "",
        must_remember: bool = False,
        delay: "LoginDelay | None" = None,
    ) -> None:
        """Open a library with an operator's passphrase; `must_remember`: from now on the keyring may do so, too.

        `delay` counts the wrong ones.
        """

        def opening() -> "Opening":
            from app.storage.opened import open_library

            with delay.trying(code) if delay is not None else nullcontext():
                library = open_library(folder, passphrase, code)
            if must_remember:
                let_keyring_remember(library)
            return library, ""

        self._open(opening)

    def open_remembered(self, folder: Path, code: str) -> None:
        """Open a library as this machine's keyring allows."""

        def opening() -> "Opening":
            from app.storage.keyring_slot import open_remembered
            from app.storage.keys import KeyRefusedError

            data_key = open_remembered(slots_of(folder), code)
            if data_key is None:
                raise KeyRefusedError(tr("This computer does not remember the passphrase any more"), tr("Type it"))
            return logged_in(folder, data_key, code), ""

        self._open(opening)

    def open_recovered(self, folder: Path, recovery_key: str, code: str, passphrase: str) -> None:
        """Open a library with its recovery key, and give the operator a new passphrase."""

        def opening() -> "Opening":
            slots = slots_of(folder)
            data_key = slots.open_with_recovery_key(recovery_key)
            slots.confirm_recovery_key(recovery_key)  # it was typed from its sheet
            slots.set_passphrase(data_key, code, passphrase)
            return logged_in(folder, data_key, code), ""

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
        self._calls.ask(_Job(self._holder.open_demonstration, None, None, ref(self)))

    def close(self) -> None:
        """Close the library that is open; what is asked later is refused until another is."""
        self._end_library()
        self._calls.ask(_Job(self._holder.close, None, None, ref(self)))

    def finish(self) -> None:
        """Close, and wait for all threads: for the end of the program."""
        self._ask_held()  # a recording is ended under a lock too; its row follows at the next start
        self._end_library()
        self._long.finish()
        self._calls.finish()
        self._recordings.finish()

    def _open(self, opening: "Callable[[], Opening]") -> None:
        self._end_library()
        self._calls.ask(_Job(lambda: self._holder.open(opening), None, None, ref(self)))

    def _begin_long(
        self,
        work: Callable[["OpenedLibrary", Report], object],
        job: "_Job",
        progressed: "WeakMethod[Callable[[float, str], object]] | None",
    ) -> None:
        if self._state is None:
            self._tell_refusal(job, *nothing_open())
            return
        if self._long.is_busy:  # what was stopped is waited for by the next
            self._tell_refusal(job, tr("Something else is still being done."), tr("Wait for it, or stop it."))
            return
        self._long_job, self._long_progressed = job, progressed
        library, lock = self._state.library, self._holder.long_work

        def locked(report: Report) -> object:
            with lock:  # the library is not closed under it
                return work(library, report)

        self._long.start(locked)

    def _ask(self, lane: "_Lane", job: "_Job") -> None:
        if self._is_locked:
            self._held.append(partial(lane.ask, job))
        else:
            lane.ask(job)

    def _ask_held(self) -> None:
        self._is_to_be_locked = self._is_locked = False
        held, self._held = self._held, []
        for ask in held:
            ask()

    def _lock_now(self) -> None:
        if self._is_to_be_locked:
            self.lock()

    def _end_library(self) -> None:
        """What is asked next closes the library: not before the last recording has ended."""
        self._ask_held()
        self.stop_long()
        self._end_watch()
        if self._state is not None:
            self._calls.ask(_Job(self._recordings.passed().wait, None, None, ref(self)))
        self._state = self._key_change = None

    def _on_told(self, job: "_Job", outcome: object) -> None:
        if isinstance(outcome, Refusal):
            self._tell_refusal(job, outcome.what, outcome.remedy)
        elif isinstance(outcome, OpenedState):
            self._state = outcome
            self._begin_watch(outcome)
            self.opened.emit(outcome)
        elif isinstance(outcome, _Progress):
            if progressed := job.listening(outcome.heard):
                progressed(outcome.share, "")
        elif isinstance(outcome, _Unlocked):
            self._ask_held()
            if done := job.listening(job.done):
                done(None)
        elif isinstance(outcome, _KeyChanged):
            self._on_key_changed(job, outcome)
        elif isinstance(outcome, _NotOpened):
            self.not_opened.emit(outcome.what, outcome.remedy, outcome.is_key)
        elif isinstance(outcome, _Closed):
            self.closed.emit()
        elif done := job.listening(job.done):
            done(outcome)

    def _begin_watch(self, state: OpenedState) -> None:
        self._end_watch()
        self._watch = LibraryWatch(state.library, self)
        self._watch.went.connect(self._on_gone)
        self._watch.came_back.connect(self._on_back)
        self._watch.left_away.connect(self._on_left_away)
        self._watch.start()

    def _end_watch(self) -> None:
        watch, self._watch, self.gone_words = self._watch, None, None
        if watch is not None:
            watch.finish()
            watch.deleteLater()

    def _on_gone(self) -> None:
        if self._state is None or self.sender() is not self._watch:
            return
        self.gone_words = _gone_words(self._state.library)
        self.gone.emit(*self.gone_words)

    def _on_back(self, brought: int) -> None:
        if self._state is None or self.sender() is not self._watch:
            return
        self.gone_words = None
        then = tr("Nothing had to be added to it.")
        if brought:
            then = tr_n(
                "{count} recording that was made meanwhile is in it now.",
                "{count} recordings that were made meanwhile are in it now.",
                brought,
            )
        self.back.emit(tr("The library is back."), then.format(count=brought))

    def _on_left_away(self, why: str) -> None:
        shelter = self._state.library.shelter if self._state is not None else None
        if shelter is None or self.sender() is not self._watch:
            return
        what = tr("What was recorded while the library was gone could not be added to it yet ({why}).")
        then = tr("It is kept in {shelter}, and is tried again by itself. See to the library's disk.")
        self.refused.emit(what.format(why=why), then.format(shelter=shelter.folder))

    def _on_key_changed(self, job: "_Job", outcome: "_KeyChanged") -> None:
        if job is not self._key_change:
            return  # the library was closed meanwhile
        self._state, self._key_change = outcome.state, None
        if outcome.state is None:  # it does not open again: from the log in, what was interrupted is finished
            self.not_opened.emit(*outcome.refusal, False)
            return
        self._begin_watch(outcome.state)
        if outcome.changed is None:
            self._tell_refusal(job, *outcome.refusal)
        elif done := job.listening(job.done):
            done(outcome.changed)

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
        self._lock_now()
        if job is not None and (done := job.listening(job.done)):
            done(result)

    def _on_long_stopped(self, is_done: bool) -> None:
        ended, self._long_ended = self._long_ended, None
        if ended is not None and (call := ended()) is not None:
            call(is_done)

    def _on_long_failed(self, error: Exception) -> None:
        job, self._long_job = self._long_job, None
        self._lock_now()
        if job is not None:
            refusal = refusal_of(error)
            self._tell_refusal(job, refusal.what, refusal.remedy)


class _NotOpened(NamedTuple):
    what: str
    remedy: str
    is_key: bool


class _Closed(NamedTuple):
    pass


class _Unlocked(NamedTuple):
    pass


class _Progress(NamedTuple):
    share: float
    heard: "WeakMethod[Callable[[float, str], object]] | None"


class _KeyChanged(NamedTuple):
    """What came of a change of the key; `changed` None: nothing but `refusal`. `state` None: nothing is open now."""

    state: OpenedState | None
    changed: "ChangedKey | None"
    refusal: Refusal


@dataclass(frozen=True, slots=True, eq=False)
class _Job:
    call: Callable[[], object]
    done: "WeakMethod[Callable[..., object]] | None"
    failed: "WeakMethod[Failed] | None"
    owner: "ref[QObject]"

    def listening(self, method: "WeakMethod[Callable[P, object]] | None") -> Callable[P, object] | None:
        """The method, where it and its owner are still there."""
        owner = self.owner()
        return method() if method is not None and owner is not None and isValid(owner) else None


def _nothing() -> None:
    """What runs elsewhere."""


class _Lane(QThread):
    """Does one job after the other until `finish`, and nothing after it; begins with the first."""

    told = Signal(object, object)  # the job, and what came of it

    def __init__(
        self, parent: QObject, after_each: Callable[[], object] = _nothing, at_end: Callable[[], object] = _nothing
    ) -> None:
        super().__init__(parent)
        self._jobs: SimpleQueue[_Job | None] = SimpleQueue()
        self._after_each, self._at_end = after_each, at_end
        self._is_over = False

    def ask(self, job: _Job) -> None:
        if self._is_over:
            return
        self._jobs.put(job)
        if not self.isRunning():
            self.start()

    def passed(self) -> Event:
        """Set once all that was asked until now is done."""
        passed = Event()
        if self.isRunning():
            self.ask(_Job(passed.set, None, None, ref(self)))
        else:
            passed.set()
        return passed

    def finish(self) -> None:
        self._is_over = True
        if self.isRunning():
            self._jobs.put(None)
            self.wait()

    def run(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                outcome = job.call()
            except Exception as error:  # the edge of the thread: beyond it nobody could catch it
                outcome = refusal_of(error)
            self.told.emit(job, outcome)
            del job, outcome  # not held until the next one comes
            self._after_each()
        self._at_end()


class _Holder:
    """What the thread of the calls alone touches: the library, and all that ends with it."""

    def __init__(self, seen: Path | None) -> None:
        self.long_work, self._seen_folder = Lock(), seen
        self.seen: SeenLibraries | None = None
        self._library: OpenedLibrary | None = None
        self._ends = ExitStack()
        self._is_to_be_tidied = False

    @property
    def library(self) -> "OpenedLibrary":
        if self._library is None:
            raise NothingOpenError
        return self._library

    def open(self, opening: "Callable[[], Opening]") -> OpenedState | _NotOpened:
        from app.storage.keys import KeyRefusedError

        self.close()
        try:
            with ExitStack() as ends:
                library, recovery_key = opening()
                ends.enter_context(library)
                state = replace(_look_through(library, ends), rollback=self._look_back(library))
                self._library, self._ends = library, ends.pop_all()
        except Exception as error:  # told where the library was to be opened
            return _NotOpened(*refusal_of(error), isinstance(error, KeyRefusedError))
        self._is_to_be_tidied = True
        return replace(state, recovery_key=recovery_key)

    def lock(self) -> None:
        library = self._library
        if library is None or library.data_key is None or not self.long_work.acquire(blocking=False):
            return
        try:
            library.library.suspend()
            library.data_key.wipe()
        finally:
            self.long_work.release()

    def unlock(self, code: str, passphrase: str, delay: "LoginDelay | None") -> _Unlocked:
        library = self.library
        library.refuse_gone()  # else the slots only miss their file, which would count as a wrong passphrase
        with delay.trying(code) if delay is not None else nullcontext():
            data_key = slots_of(library.folder).open(code, passphrase)
        if library.data_key is not None:
            library.data_key.refill(data_key)
        return _Unlocked()

    def change_key(self, leaving: str, report: Report) -> _KeyChanged:
        from app.storage.key_change import change_data_key, refuse_change

        library, changed, refusal = self.library, None, nothing_open()
        operator = library.library.operator
        assert operator is not None  # whoever opens a library is logged in
        key = library.data_key
        with self.long_work:
            try:
                refuse_change(library)  # before anybody is said to work here no longer
            except Exception as error:  # told where the key was to be changed
                return _KeyChanged(OpenedState(library, operator), None, refusal_of(error))
            try:
                changed = change_data_key(library, _staying(library, leaving), report)
                key = changed.data_key
            except Exception as error:
                refusal = refusal_of(error)
            try:
                assert key is not None  # hidden in the demonstration
                again = self._open_again(library, key, operator.code)
            except Exception as error:  # what was interrupted is finished when somebody logs in
                return _KeyChanged(None, None, refusal if changed is None else refusal_of(error))
        return _KeyChanged(OpenedState(again, operator), changed, refusal)

    def _open_again(self, before: "OpenedLibrary", key: "DataKey", code: str) -> "OpenedLibrary":
        """The library under `key`; the one before is closed, and its key wiped where it is another."""
        from app.storage.opened import held_alone

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

    def open_demonstration(self) -> OpenedState | _NotOpened:
        self.close()
        try:
            with ExitStack() as ends:
                folder = Path(ends.enter_context(tempfile.TemporaryDirectory(prefix="gaitwright-demo-")))
                library = ends.enter_context(demonstration(folder))
                state = _look_through(library, ends)
                self._library, self._ends = library, ends.pop_all()
        except Exception as error:
            return _NotOpened(*refusal_of(error), False)
        return state

    def close(self) -> _Closed:
        with self.long_work:
            self._library, self._is_to_be_tidied = None, False
            self._ends.close()
        return _Closed()

    def _look_back(self, library: "OpenedLibrary") -> "Rollback | None":
        if self._seen_folder is None:
            return None
        from app.storage.rollback import SeenLibraries

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


def _gone_words(library: "OpenedLibrary") -> Refusal:
    """What is said of a library whose folder is gone, whether something is being recorded or not."""
    from app.storage.root import GONE

    what = tr(GONE).format(folder=library.folder) + "."
    if library.shelter is None:
        return Refusal(what, tr("The demonstration ends here. Open it again."))
    then = tr(
        "Put its folder back, or connect its disk. Until then recordings are kept on this computer in {shelter}, "
        "encrypted as always, and added to the library by themselves once it is back."
    )
    return Refusal(what, then.format(shelter=library.shelter.folder))


def _look_through(library: "OpenedLibrary", ends: ExitStack) -> OpenedState:
    from app.storage.bringing_home import bring_home
    from app.storage.opened import held_alone
    from app.storage.recovery import find_interrupted

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


def _staying(library: "OpenedLibrary", leaving: str) -> list[str]:
    """Who keeps a key, once the operator `leaving` works here no longer."""
    operators = library.library.operators
    for operator in operators.list():
        if operator.code == leaving and operator.is_active:
            operators.change(replace(operator, is_active=False))
    return [operator.code for operator in operators.list() if operator.is_active]


def _look(folder: Path) -> LibraryPlace:
    from app.storage.keyring_slot import is_there_a_keyring
    from app.storage.login_delay import LoginDelay

    slots = slots_of(folder)
    codes = slots.codes if slots.exists else ()
    remembered = tuple(code for code in codes if slots.keyring_slot(code) is not None)
    delay = LoginDelay(folder, time.monotonic)
    if slots.exists:
        delay.read()
    return LibraryPlace(folder, slots.exists, codes, remembered, is_there_a_keyring(), delay)


def _weak(method: Callable[P, T] | None) -> "WeakMethod[Callable[P, T]] | None":
    return None if method is None else WeakMethod(method)

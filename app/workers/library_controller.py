"""Thread that asks the library while the screen goes on.

It works in the order of asking; answers come to the screen's thread.

A recording begins and ends in a thread of its own: neither waits for what the library is being asked meanwhile.

A call is given as a function of the open library and as bound methods of whoever asked. Those are called on the
screen's thread, and not at all once their owner is gone. Refusals arrive as two sentences, what and remedy, ready to
be shown. Storage is imported by the thread, for its imports take longer than the window may.
"""

from collections.abc import Callable
from concurrent.futures import Future
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, ParamSpec, TypeVar
from weakref import WeakMethod, ref

from PySide6.QtCore import QObject, Signal

from app.system.progress import Report
from app.wording.translation import tr, tr_n
from app.workers.background import Background
from app.workers.jobs import Failed, Job, JobThread, nothing, weak
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
from app.workers.refusals import Refusal, nothing_open, refusal_of

if TYPE_CHECKING:
    from app.storage.clinic.moving import Moved
    from app.storage.key_change import ChangedKey
    from app.storage.login_delay import LoginDelay
    from app.storage.opened import OpenedLibrary
    from app.storage.rollback import Rollback
    from app.workers.library_holder import LibraryHolder
    from app.workers.library_watch import LibraryWatch

P = ParamSpec("P")
T = TypeVar("T")


class LibraryController(QObject):
    """One library at a time; opening another closes the one before. `finish` belongs to the program's end.

    `seen`: the folder where this computer remembers how far a library had come; without it nothing is remembered.
    """

    opened = Signal(object)  # OpenedState
    not_opened = Signal(str, str, bool)  # what, remedy, whether it was the key that did not open
    can_work_away = Signal()  # after `not_opened`: the clinic's server does not answer, and this is a station
    server_back = Signal()  # the clinic's server, whose station works without it
    closed = Signal()
    refused = Signal(str, str)  # of a call whose asker does not listen to refusals
    gone = Signal(str, str)  # the library's folder, while it is open: what happened, and what to do
    back = Signal(str, str)  # it is there again: and what was recorded meanwhile
    changed_elsewhere = Signal()  # another station of the clinic did something

    def __init__(self, parent: QObject | None = None, seen: Path | None = None) -> None:
        super().__init__(parent)
        self._seen = seen
        self._calls = JobThread(self, lambda: self._holder.do_left_over(), self._end_holder)
        self._recordings = JobThread(self)
        for lane in (self._calls, self._recordings):
            lane.reported.connect(self._on_reported)
        self._must_keep = False  # who is logged in, for the next window
        self._state: OpenedState | None = None
        self._watch: LibraryWatch | None = None
        self.gone_words: Refusal | None = None  # for whoever comes later; None: the library is where it was opened
        self._is_locked = self._is_to_be_locked = False
        self._held: list[Callable[[], object]] = []  # what was asked under the lock
        self._reopening: Job | None = None  # that goes on
        self._opening: Job | None = None  # asked for last
        self._long = Background(self)
        self._long.progressed.connect(self._on_long_progressed)
        self._long.done.connect(self._on_long_done)
        self._long.failed.connect(self._on_long_failed)
        self._long.stopped.connect(self._on_long_stopped)
        self._long.idle.connect(self._on_long_idle)
        self._long_job: Job | None = None
        self._quiet: Callable[[], object] | None = None  # begins the long work again, where nobody waits for it
        self._waiting: list[Callable[[], object]] = []  # quiet work that began too early, or was interrupted
        self._long_ended: WeakMethod[Callable[[bool], object]] | None = None
        self._long_progressed: WeakMethod[Callable[[float, str], object]] | None = None

    @cached_property
    def _holder(self) -> "LibraryHolder":
        """Made by the first call: storage is imported by the thread, for that takes longer than the window may."""
        from app.workers.library_holder import LibraryHolder  # the thread waits, not the window

        return LibraryHolder(self._seen)

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
        """Let the thread make `call`, then call `done(result)` or `failed(what, remedy)` as long as `owner` is there.

        Both are bound methods. Without `failed` a refusal is reported by the signal `refused`.
        """
        self._ask(self._calls, Job(lambda: call(self._holder.library), weak(done), weak(failed), ref(owner)))

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
            self._show_refusal(Job(nothing, None, weak(failed), ref(owner)), *nothing_open())
            return
        library, turn = self._state.library, Future[None]()
        self._ask(self._calls, Job(lambda: turn.set_result(None), None, None, ref(self)))
        self._ask(self._recordings, Job(lambda: call(library, turn), weak(done), weak(failed), ref(owner)))

    def run_long(
        self,
        work: Callable[["OpenedLibrary", Report], T],
        done: Callable[[T], object] | None,
        failed: Failed | None,
        progressed: Callable[[float, str], object] | None,
        owner: QObject,
        *,
        is_quiet: bool = False,
    ) -> None:
        """Do what takes long, an import or a backup, beside the calls; one at a time, and `stop_long` ends it.

        Nothing more is received from what was stopped. Quiet work, which nobody asked for, waits for the other, and
        gives way to it: it begins again afterwards.
        """
        job = Job(nothing, weak(done), weak(failed), ref(owner))
        begin = partial(self._begin_long, work, job, weak(progressed), is_quiet=is_quiet)
        if self._is_locked:
            self._held.append(begin)
        else:
            begin()

    def stop_long(self, ended: Callable[[bool], object] | None = None) -> None:
        """End what takes long; `ended` is called, once it has ended, with whether it was done before it was stopped."""
        if self._long.is_busy:
            self._long_ended = weak(ended)
        self._long.stop()
        self._long_job = None

    def lock(self) -> None:
        """Take the data key out of memory until `unlock`; what is asked meanwhile is done after it.

        A recording goes on: its journal has a key of its own. Long work is waited for.
        """
        if self._state is None or self._state.is_demonstration:
            return
        self._is_to_be_locked = self._is_locked = True
        if self._long.is_idle:  # what was stopped and has not ended yet still works with the key
            self._calls.ask(Job(self._recordings.passed().wait, None, None, ref(self)))
            self._calls.ask(Job(self._holder.lock, None, None, ref(self)))

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
        job = Job(lambda: self._holder.unlock(code, passphrase, delay), weak(done), weak(failed), ref(owner))
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
        self._reopen(
            lambda report: self._holder.change_key(leaving, report), weak(done), weak(failed), weak(progressed), owner
        )

    def move_to_server(
        self,
        address: str,
        password: str,
        place: str,
        done: Callable[["Moved"], object],
        failed: Failed,
        progressed: Callable[[float, str], object],
        owner: QObject,
    ) -> None:
        """Take the library from its folder to a clinic's server, and go on with it there; as `change_key`."""
        self._reopen(
            lambda report: self._holder.move_to_server(address, password, place, report),
            weak(done),
            weak(failed),
            weak(progressed),
            owner,
        )

    def bring_back(
        self,
        done: Callable[["Moved"], object],
        failed: Failed,
        progressed: Callable[[float, str], object],
        owner: QObject,
    ) -> None:
        """Take the library from the clinic's server into this station's folder, and go on there; as `change_key`."""
        self._reopen(lambda report: self._holder.bring_back(report), weak(done), weak(failed), weak(progressed), owner)

    def join(
        self,
        folder: Path,
        address: str,
        password: str,
        place: str,
        done: Callable[[Joined], object],
        failed: Failed,
        owner: QObject,
    ) -> None:
        """Make a new folder that of a station of the library at a clinic's server; nothing is opened.

        `password` goes into the address; `place` names the shared place of recordings, where it has another name here.
        """
        job = Job(lambda: self._holder.join(folder, address, password, place), weak(done), weak(failed), ref(owner))
        self._calls.ask(job)

    def _reopen(
        self,
        work: Callable[[Report], Reopened],
        done: "WeakMethod[Callable[..., object]] | None",
        failed: "WeakMethod[Failed] | None",
        progressed: "WeakMethod[Callable[[float, str], object]] | None",
        owner: QObject,
    ) -> None:
        """Let the thread do what closes the library, and opens it again."""
        job = Job(lambda: work(report), done, failed, ref(owner))
        if self._state is None:
            self._show_refusal(job, *nothing_open())
            return
        if self._long.is_busy:
            self._show_refusal(job, tr("Another task is still running."), tr("Wait until it has finished, or stop it."))
            return
        if self.gone_words is not None:
            self._show_refusal(job, *self.gone_words)
            return

        def report(share: float, _what: str) -> None:
            self._calls.reported.emit(job, _Progress(share, progressed))

        self._end_watch()
        self._calls.ask(Job(self._recordings.passed().wait, None, None, ref(self)))
        self._state, self._reopening = None, job
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
        self._calls.ask(Job(lambda: self._holder.look(folder), weak(done), weak(failed), ref(owner)))

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

        self._open(lambda: self._holder.open(folder, passphrase, code, must_remember, delay))

    def open_away(self, folder: Path, passphrase: str, code: str, delay: "LoginDelay | None" = None) -> None:
        """Open what a clinic's station works with while the server does not answer."""
        self._open(lambda: self._holder.open_away(folder, passphrase, code, delay))

    def open_remembered(self, folder: Path, code: str) -> None:
        """Open a library as this machine's keyring allows."""

        self._open(lambda: self._holder.open_remembered(folder, code))

    def open_recovered(self, folder: Path, recovery_key: str, code: str, passphrase: str) -> None:
        """Open a library with its recovery key, and give the operator a new passphrase."""

        self._open(lambda: self._holder.open_recovered(folder, recovery_key, code, passphrase))

    def create(self, folder: Path, code: str, name: str, passphrase: str) -> None:
        """Make a library whose administrator is the operator, and open it; its recovery key comes with `opened`."""

        self._open(lambda: self._holder.create(folder, code, name, passphrase))

    def open_demonstration(self) -> None:
        """Open a library of its own, gone when it is closed, with simulated patients who have no visits yet.

        Whoever is logged in to another library stays so until `forget`: `open_kept` leads back.
        """
        must_keep = not self._is_locked
        self._open(lambda: self._holder.open_demonstration(must_keep))

    def open_kept(self, kept: KeptLogIn | None = None) -> None:
        """Open the library again that the demonstration closed, or the window before this one, which `kept` it."""
        self._open(lambda: self._holder.open_kept(kept))

    @property
    def kept(self) -> KeptLogIn | None:
        """Who is still logged in to the library that was open before the demonstration."""
        return self._holder.kept

    def forget(self) -> None:
        """Log out who is logged in behind the demonstration."""
        self._calls.ask(Job(self._holder.forget, None, None, ref(self)))

    def close(self) -> None:
        """Close the library that is open; what is asked later is refused until another is."""
        self._end_library()
        self._calls.ask(Job(lambda: self._holder.end(), None, None, ref(self)))

    def finish(self, *, must_keep: bool = False) -> KeptLogIn | None:
        """Close, and wait for all threads: for the end of the program.

        `must_keep`: or of a window that another one follows. Gives what opens the library again there, unless it is
        locked.
        """
        self._must_keep = must_keep and not self._is_locked
        self._ask_held()  # a recording is ended under a lock too; its row follows at the next start
        self._end_library()
        self._long.finish()
        self._calls.finish()
        self._recordings.finish()
        return self._holder.kept if self._must_keep else None

    def _end_holder(self) -> None:
        """Close at the end of the thread."""
        if self._must_keep:
            self._holder.keep()
        else:
            self._holder.end()

    def _open(self, opening: Callable[[], OpenedState | NotOpened]) -> None:
        self._end_library()
        self._opening = Job(opening, None, None, ref(self))
        self._calls.ask(self._opening)

    def _begin_long(
        self,
        work: Callable[["OpenedLibrary", Report], object],
        job: Job,
        progressed: "WeakMethod[Callable[[float, str], object]] | None",
        *,
        is_quiet: bool,
    ) -> None:
        if self._state is None:
            self._show_refusal(job, *nothing_open())
            return
        begin = partial(self._begin_long, work, job, progressed, is_quiet=is_quiet)
        if self._long.is_busy:  # what was stopped is waited for by the next
            if is_quiet:
                self._waiting.append(begin)
                return
            if self._quiet is None:
                what, remedy = tr("Another task is still running."), tr("Wait until it has finished, or stop it.")
                self._show_refusal(job, what, remedy)
                return
            self._waiting.append(self._quiet)
        self._quiet = begin if is_quiet else None
        self._long_job, self._long_progressed = job, progressed
        library, lock = self._state.library, self._holder.long_work

        def locked(report: Report) -> object:
            with lock:  # the library is not closed under it
                return work(library, report)

        self._long.start(locked)

    def _ask(self, lane: JobThread, job: Job) -> None:
        if self._is_locked:
            self._held.append(partial(lane.ask, job))
        else:
            lane.ask(job)

    def _ask_held(self) -> None:
        self._is_to_be_locked = self._is_locked = False
        held, self._held = self._held, []
        for ask in held:
            ask()

    def _on_long_idle(self) -> None:
        waiting, self._waiting = self._waiting, []
        if self._is_locked:
            self._held += waiting
        else:
            for begin in waiting:
                begin()
        if self._is_to_be_locked:
            self.lock()

    def _end_library(self) -> None:
        """What is asked next closes the library: not before the last recording has ended."""
        self._ask_held()
        self._waiting.clear()
        self.stop_long()
        self._end_watch()
        if self._state is not None:
            self._calls.ask(Job(self._recordings.passed().wait, None, None, ref(self)))
        self._state = self._reopening = self._opening = None

    def _on_reported(self, job: Job, outcome: object) -> None:
        if isinstance(outcome, Refusal):
            self._show_refusal(job, outcome.what, outcome.remedy)
        elif isinstance(outcome, OpenedState | NotOpened) and job is not self._opening:
            pass  # another was asked for meanwhile, or none: it is closed again, or will be at once
        elif isinstance(outcome, OpenedState):
            self._state, self._opening = outcome, None  # which held the passphrase
            self._begin_watch(outcome)
            self.opened.emit(outcome)
        elif isinstance(outcome, _Progress):
            if progressed := job.listening(outcome.received):
                progressed(outcome.share, "")
        elif isinstance(outcome, Unlocked):
            self._ask_held()
            if done := job.listening(job.done):
                done(None)
        elif isinstance(outcome, Reopened):
            self._on_reopened(job, outcome)
        elif isinstance(outcome, NotOpened):
            self._opening = None
            self.not_opened.emit(outcome.what, outcome.remedy, outcome.is_key)
            if outcome.can_work_away:
                self.can_work_away.emit()
        elif isinstance(outcome, Closed):
            self.closed.emit()
        elif done := job.listening(job.done):
            done(outcome)

    def _begin_watch(self, state: OpenedState) -> None:
        from app.workers.library_watch import LibraryWatch  # storage, as above

        self._end_watch()
        self._watch = LibraryWatch(state.library, self)
        self._watch.went.connect(self._on_gone)
        self._watch.came_back.connect(self._on_back)
        self._watch.left_away.connect(self._on_left_away)
        self._watch.left_here.connect(self._on_left_here)
        self._watch.changed_elsewhere.connect(self._on_changed_elsewhere)
        self._watch.server_back.connect(self.server_back)
        self._watch.start()

    def _end_watch(self) -> None:
        """It may still wait for a server: what is asked next waits for it, the screen does not."""
        watch, self._watch, self.gone_words = self._watch, None, None
        if watch is not None:
            watch.end()
            self._calls.ask(Job(watch.ended, weak(self._on_watch_ended), None, ref(self)))

    def _on_watch_ended(self, watch: "LibraryWatch") -> None:
        watch.deleteLater()

    def _on_gone(self) -> None:
        if self._state is None or self.sender() is not self._watch:
            return
        self.gone_words = self._holder.gone_words(self._state.library)
        self.gone.emit(*self.gone_words)

    def _on_back(self, brought: int) -> None:
        if self._state is None or self.sender() is not self._watch:
            return
        self.gone_words = None
        if self._state.library.shared is not None and not brought:
            self.back.emit(
                tr("The clinic's server responds again."),
                tr("Recordings made meanwhile are now being added to the library."),
            )
            return
        then = tr("There were no recordings to add.")
        if brought:
            then = tr_n(
                "{count} recording made meanwhile was added.",
                "{count} recordings made meanwhile were added.",
                brought,
            )
        self.back.emit(tr("The library is available again."), then.format(count=brought))

    def _on_left_away(self, why: str) -> None:
        shelter = self._state.library.shelter if self._state is not None else None
        if shelter is None or self.sender() is not self._watch:
            return
        what = tr("Recordings made while the library was unavailable could not be added yet ({why}).")
        then = tr("They are stored in {shelter}, and adding them is retried automatically. Check the library's disk.")
        self.refused.emit(what.format(why=why), then.format(shelter=shelter.folder))

    def _on_left_here(self, why: str, remedy: str) -> None:
        if self._state is None or self.sender() is not self._watch:
            return
        kept = tr("Recordings made here stay on this computer and are transferred automatically as soon as possible.")
        self.refused.emit(why, f"{remedy} {kept}")

    def _on_changed_elsewhere(self) -> None:
        if self._state is not None and self.sender() is self._watch:
            self.changed_elsewhere.emit()

    def _on_reopened(self, job: Job, outcome: Reopened) -> None:
        if job is not self._reopening:
            return  # the library was closed meanwhile
        self._state, self._reopening = outcome.state, None
        if outcome.state is None:  # it does not open again: from the log in, what was interrupted is finished
            self.not_opened.emit(*outcome.refusal, False)
            return
        self._begin_watch(outcome.state)
        if outcome.result is None:
            self._show_refusal(job, *outcome.refusal)
        elif done := job.listening(job.done):
            done(outcome.result)

    def _show_refusal(self, job: Job, what: str, remedy: str) -> None:
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

    def _on_long_stopped(self, is_done: bool) -> None:
        ended, self._long_ended = self._long_ended, None
        if ended is not None and (call := ended()) is not None:
            call(is_done)

    def _on_long_failed(self, error: Exception) -> None:
        job, self._long_job = self._long_job, None
        if job is not None:
            refusal = refusal_of(error)
            self._show_refusal(job, refusal.what, refusal.remedy)


class _Progress(NamedTuple):
    share: float
    received: "WeakMethod[Callable[[float, str], object]] | None"

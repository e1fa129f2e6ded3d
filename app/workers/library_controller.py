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
from typing import TYPE_CHECKING, NamedTuple, TypeVar
from weakref import WeakMethod

from PySide6.QtCore import QObject, Signal

from app.system.progress import Report
from app.wording.translation import tr, tr_n
from app.workers.background import Background
from app.workers.jobs import Failed, Job, JobThread, Progressed, nothing, weak
from app.workers.library_state import Closed, KeptLogIn, NotOpened, OpenedState, Reopened, Unlocked
from app.workers.refusals import Refusal, nothing_open, refusal_of

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.workers.library_holder import LibraryHolder
    from app.workers.library_watch import LibraryWatch

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
    locking = Signal()  # what the library shows is to be let go

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
        self._unlocks = 0  # before the lock that is asked for
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
        """Run `call` on the thread, then `done(result)` or `failed(what, remedy)`, bound methods, while `owner` lives.

        Without `failed` a refusal is reported by the signal `refused`.
        """
        self._ask(self._calls, Job.of(lambda: call(self._holder.library), done, failed, owner))

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
            self._show_refusal(Job.of(nothing, None, failed, owner), *nothing_open())
            return
        library, turn = self._state.library, Future[None]()
        self._ask(self._calls, Job(lambda: turn.set_result(None)))
        self._ask(self._recordings, Job.of(lambda: call(library, turn), done, failed, owner))

    def run_long(
        self,
        work: Callable[["OpenedLibrary", Report], T],
        done: Callable[[T], object] | None,
        failed: Failed | None,
        progressed: Progressed | None,
        owner: QObject,
        *,
        is_quiet: bool = False,
    ) -> None:
        """Run long work beside the calls, one at a time; `stop_long` ends it, quiet work yields and restarts."""
        job = Job.of(nothing, done, failed, owner, progressed)
        begin = partial(self._begin_long, work, job, is_quiet=is_quiet)
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
        """Drop the data key until `unlock`; calls wait, long work ends first, recordings have their own key."""
        if self._state is None or self._state.is_demonstration:
            return
        was_locked, self._is_to_be_locked, self._is_locked = self._is_locked, True, True
        if not was_locked:
            self._unlocks = self._holder.unlocks
            self.locking.emit()  # what is asked now waits for the unlock
        if self._long.is_idle:  # what was stopped and has not ended yet still works with the key
            self._wait_for_recordings()
            self._calls.ask(Job(partial(self._holder.lock, self._unlocks)))

    def call(
        self,
        function: Callable[["LibraryHolder"], T],
        done: Callable[[T], object] | None,
        failed: Failed | None,
        owner: QObject,
    ) -> None:
        """As `run`, for what is done under the lock too, or where no library is open."""
        self._calls.ask(Job.of(lambda: function(self._holder), done, failed, owner))

    def reopen(
        self,
        work: Callable[["LibraryHolder", Report], Reopened],
        done: Callable[..., object],
        failed: Failed,
        progressed: Progressed,
        owner: QObject,
    ) -> None:
        """Let the thread do what closes the library and opens it again, as a change of its key; nothing else meanwhile.

        Nor is the folder watched: its database is replaced, and nothing must come home that has the old key.
        """
        job = Job.of(lambda: work(self._holder, report), done, failed, owner, progressed)
        if self._state is None:
            self._show_refusal(job, *nothing_open())
            return
        if self._long.is_busy:
            self._show_refusal(job, *_still_running())
            return
        if self.gone_words is not None:
            self._show_refusal(job, *self.gone_words)
            return

        def report(share: float, _what: str) -> None:
            self._calls.reported.emit(job, _Progress(share))

        self._end_watch()
        self._wait_for_recordings()
        self._state, self._reopening = None, job
        self._calls.ask(job)

    def open(self, opening: Callable[["LibraryHolder"], OpenedState | NotOpened]) -> None:
        """Let the thread open a library: `opened` or `not_opened` comes of it."""
        self._end_library()
        self._opening = Job(lambda: opening(self._holder))
        self._calls.ask(self._opening)

    def open_demonstration(self) -> None:
        """Open a library of its own, gone when it is closed, with simulated patients who have no visits yet.

        Whoever is logged in to another library stays so until they are forgotten: `open_kept` leads back.
        """
        must_keep = not self._is_locked
        self.open(lambda holder: holder.open_demonstration(must_keep))

    @property
    def kept(self) -> KeptLogIn | None:
        """Who is still logged in to the library that was open before the demonstration."""
        return self._holder.kept

    def close(self) -> None:
        """Close the library that is open; what is asked later is refused until another is."""
        self._end_library()
        self._calls.ask(Job(lambda: self._holder.end()))

    def finish(self, *, must_keep: bool = False) -> KeptLogIn | None:
        """Close and await all threads at the end; `must_keep`: give what reopens it, None while locked."""
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

    def _begin_long(self, work: Callable[["OpenedLibrary", Report], object], job: Job, *, is_quiet: bool) -> None:
        if self._state is None:
            self._show_refusal(job, *nothing_open())
            return
        begin = partial(self._begin_long, work, job, is_quiet=is_quiet)
        if self._long.is_busy:  # what was stopped is waited for by the next
            if is_quiet:
                self._waiting.append(begin)
                return
            if self._quiet is None:
                self._show_refusal(job, *_still_running())
                return
            self._waiting.append(self._quiet)
        self._quiet = begin if is_quiet else None
        self._long_job = job
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

    def _wait_for_recordings(self) -> None:
        """What is asked next is done once all recordings asked for have begun or ended."""
        self._calls.ask(Job(self._recordings.passed().wait))

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
            self._wait_for_recordings()
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
            if progressed := job.listening(job.progressed):
                progressed(outcome.share, "")
        elif isinstance(outcome, Reopened):
            self._on_reopened(job, outcome)
        elif isinstance(outcome, NotOpened):
            self._opening = None
            self.not_opened.emit(outcome.what, outcome.remedy, outcome.is_key)
            if outcome.can_work_away:
                self.can_work_away.emit()
        elif isinstance(outcome, Closed):
            self.closed.emit()
        else:
            if isinstance(outcome, Unlocked):
                self._ask_held()
            if done := job.listening(job.done):
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
            self._calls.ask(Job.of(watch.ended, self._on_watch_ended, None, self))

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
        if job is not None and (progressed := job.listening(job.progressed)):
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


def _still_running() -> Refusal:
    return Refusal(tr("Another task is still running."), tr("Wait until it has finished, or stop it."))

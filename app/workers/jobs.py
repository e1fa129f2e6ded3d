"""Threads that do one job after the other and report to whoever asked, as long as they are still there.

What a job holds of Qt, as a page that is closed meanwhile, must end on the screen's thread (`garbage.py`). So that
thread keeps every job until the one that did it has let it go.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from queue import SimpleQueue
from threading import Event
from typing import ParamSpec, TypeVar
from weakref import WeakMethod, ref

from PySide6.QtCore import QObject, QThread, Signal
from shiboken6 import isValid

from app.workers.refusals import refusal_of

P = ParamSpec("P")
T = TypeVar("T")
Failed = Callable[[str, str], object]
Progressed = Callable[[float, str], object]


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    call: Callable[[], object]
    done: "WeakMethod[Callable[..., object]] | None" = None
    failed: "WeakMethod[Failed] | None" = None
    owner: "ref[QObject] | None" = None
    progressed: "WeakMethod[Progressed] | None" = None

    @classmethod
    def of(
        cls,
        call: Callable[[], object],
        done: Callable[..., object] | None,
        failed: Failed | None,
        owner: QObject,
        progressed: "Progressed | None" = None,
    ) -> "Job":
        """A job whose asker may be gone before it is done."""
        return cls(call, weak(done), weak(failed), ref(owner), weak(progressed))

    def listening(self, method: "WeakMethod[Callable[P, object]] | None") -> Callable[P, object] | None:
        """The method, where it and its owner are still there."""
        owner = self.owner() if self.owner is not None else None
        return method() if method is not None and owner is not None and isValid(owner) else None


def nothing() -> None:
    """What runs elsewhere."""


class JobThread(QThread):
    """Does one job after the other until `finish`, and nothing after it; begins with the first."""

    reported = Signal(object, object)  # the job, and what came of it
    _let_go = Signal()  # the eldest job that is kept

    def __init__(
        self, parent: QObject, after_each: Callable[[], object] = nothing, at_end: Callable[[], object] = nothing
    ) -> None:
        super().__init__(parent)
        self._jobs: SimpleQueue[Job | None] = SimpleQueue()
        self._kept: deque[Job] = deque()
        self._after_each, self._at_end = after_each, at_end
        self._is_over = False
        self._let_go.connect(self._on_let_go)

    def ask(self, job: Job) -> None:
        if self._is_over:
            return
        self._kept.append(job)
        self._jobs.put(job)
        if not self.isRunning():
            self.start()

    def passed(self) -> Event:
        """Set once all that was asked until now is done."""
        passed = Event()
        if self.isRunning():
            self.ask(Job(passed.set))
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
            self.reported.emit(job, outcome)
            del job, outcome  # not held until the next one comes
            self._let_go.emit()
            self._after_each()
        self._at_end()

    def _on_let_go(self) -> None:
        self._kept.popleft()


def weak(method: Callable[P, T] | None) -> "WeakMethod[Callable[P, T]] | None":
    return None if method is None else WeakMethod(method)

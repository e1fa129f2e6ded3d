"""Run slow work without holding up the screen: one piece at a time, with progress, and a stop that stops."""

import logging
from collections.abc import Callable
from time import monotonic

from PySide6.QtCore import QObject, QThread, Signal

from app.system.progress import Report

PROGRESS_EVERY_S = 0.05  # faster than anybody reads; more would keep the screen from anything else

_log = logging.getLogger(__name__)

Work = Callable[[Report], object]
"""Its `Report` raises `Stopped` once nobody waits for the work."""


class Stopped(Exception):  # noqa: N818  being stopped is no error
    """Raised inside the work by its report when it was asked to stop."""


class Background(QObject):
    """Runs one piece of work at a time; a newer one takes the older one's place.

    Signals of a piece that was stopped or replaced never arrive, but for `stopped`, once it has ended: whether it came
    to its end all the same, before its next report could stop it. `idle` is emitted when the last thread has ended.
    """

    progressed = Signal(float, str)
    done = Signal(object)
    failed = Signal(object)
    stopped = Signal(bool)
    idle = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._threads: set[_WorkThread] = set()
        self._current: _WorkThread | None = None
        self._is_finished = False

    @property
    def is_busy(self) -> bool:
        """Whether somebody waits for a result."""
        return self._current is not None

    @property
    def is_idle(self) -> bool:
        """Whether no thread is left, not even one that is being stopped."""
        return not self._threads

    def start(self, work: Work) -> None:
        """Begin `work` in a thread of its own, and stop whatever ran before; after `finish` nothing begins any more."""
        self.stop()
        if self._is_finished:  # what the library answers late asks for more
            return
        thread = _WorkThread(work, self)
        thread.progressed.connect(self._on_progressed)
        thread.done.connect(self._on_done)
        thread.failed.connect(self._on_failed)
        thread.ended.connect(self._on_ended)
        self._threads.add(thread)
        self._current = thread
        thread.start()

    def stop(self) -> None:
        """Let the running work end at its next report. Nothing more is received from it."""
        if self._current is not None:
            self._current.requestInterruption()
            self._current.is_stopped = True
            self._current = None

    def finish(self) -> None:
        """Stop, and wait until no thread is left: for the end of the program, when there is no screen to hold up."""
        self._is_finished = True
        self.stop()
        for thread in self._threads:
            thread.wait()
        self._threads.clear()

    def _on_progressed(self, thread: "_WorkThread", share: float, what: str) -> None:
        if thread is self._current:
            self.progressed.emit(share, what)

    def _on_done(self, thread: "_WorkThread", result: object) -> None:
        if thread is self._current:
            self._current = None
            self.done.emit(result)

    def _on_failed(self, thread: "_WorkThread", error: Exception) -> None:
        if thread is self._current:
            self._current = None
            self.failed.emit(error)

    def _on_ended(self, thread: "_WorkThread") -> None:
        thread.wait()  # it has left run(); only its last few instructions are awaited
        self._threads.discard(thread)
        thread.deleteLater()
        if thread.is_stopped:
            self.stopped.emit(thread.is_done)
        if self.is_idle:
            self.idle.emit()


class _WorkThread(QThread):
    progressed = Signal(object, float, str)
    done = Signal(object, object)
    failed = Signal(object, object)
    ended = Signal(object)

    def __init__(self, work: Work, parent: QObject) -> None:
        super().__init__(parent)
        self._work = work
        self._reported_s, self._reported = 0.0, ""
        self.is_stopped = self.is_done = False

    def run(self) -> None:
        try:
            result = self._work(self._report)
        except Stopped:
            pass
        except Exception as error:  # the edge of the thread: beyond it nobody could catch it
            _log.info("work in the background ended early", exc_info=error)
            self.failed.emit(self, error)
        else:
            self.is_done = True
            self.done.emit(self, result)
        self.ended.emit(self)

    def _report(self, share: float, what: str) -> None:
        if self.isInterruptionRequested():
            raise Stopped
        if what != self._reported or monotonic() - self._reported_s >= PROGRESS_EVERY_S:
            self._reported_s, self._reported = monotonic(), what
            self.progressed.emit(self, share, what)

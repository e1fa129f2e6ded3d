"""Watchdog that detects whether the screen's thread was ever held up.

A timer beats in its event loop, and a thread beside it counts late beats.

What counts is what the screen's thread itself did between two beats: processor time it used, and time it waited for
something, as for a lock, a file or `sleep`. Time in which it was ready and another process had the processor is left
out, so that a busy machine fails no test; systems that do not report that time are asked for processor time only. What
the test process holds beside the application is kept from the garbage collector meanwhile: clinics do not run pytest.
"""

import faulthandler
import gc
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import Qt, QTimer

BEAT_MS = 5
LOOK_EVERY_S = 0.01
BUSY_LIMIT_S = 0.2  # the house allows 0.1 on the screen's thread; half as fast a computer fails no test
WAIT_LIMIT_S = 0.3  # more: waiting for a thread of ours that another process keeps from running is no fault


@dataclass(frozen=True, slots=True)
class Spent:
    """How the screen's thread spent its time so far: at work, waiting, and kept from running by others."""

    wall_s: float
    busy_s: float
    kept_s: float | None  # None where the system does not report

    def since(self, before: "Spent") -> tuple[float, float]:
        """Give the time at work and the time waiting, between `before` and this."""
        busy_s = self.busy_s - before.busy_s
        if self.kept_s is None or before.kept_s is None:
            return busy_s, 0.0
        return busy_s, max(0.0, self.wall_s - before.wall_s - busy_s - (self.kept_s - before.kept_s))


@dataclass(frozen=True, slots=True)
class LateBeat:
    busy_s: float
    waited_s: float
    stack: str

    def __str__(self) -> str:
        held = f"{1000 * self.busy_s:.0f} ms at work and {1000 * self.waited_s:.0f} ms waiting"
        return f"The screen's thread was held up: {held}.\n{self.stack}"


class Watchdog:
    """Made, started and stopped on the screen's thread."""

    def __init__(self) -> None:
        self.late: list[LateBeat] = []
        self._thread_id = threading.get_ident()
        self._kept_file = Path(f"/proc/self/task/{threading.get_native_id()}/schedstat")
        self._has_kept = self._kept_file.exists()
        self._clock = time.pthread_getcpuclockid(self._thread_id) if hasattr(time, "pthread_getcpuclockid") else None
        self._lock = threading.Lock()
        self._stack = ""
        self._beat = self._spent()
        self._is_watching = False
        self._is_over = threading.Event()
        self._looker = threading.Thread(target=self._look, name="watchdog", daemon=True)
        self._timer = QTimer()
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._on_beat)

    def start(self) -> None:
        gc.collect()
        gc.freeze()
        self._resume()
        self._timer.start(BEAT_MS)
        self._looker.start()

    def stop(self) -> None:
        self._pause()
        self._timer.stop()
        self._is_over.set()
        self._looker.join()
        gc.unfreeze()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Leave out what the test does itself, as simulating a patient."""
        self._pause()
        try:
            yield
        finally:
            self._resume()

    def _pause(self) -> None:
        with self._lock:
            self._note()
            self._is_watching = False

    def _resume(self) -> None:
        with self._lock:
            self._beat, self._stack, self._is_watching = self._spent(), "", True

    def _on_beat(self) -> None:
        with self._lock:
            self._note()
            self._beat, self._stack = self._spent(), ""

    def _note(self) -> None:
        """Write the time since the last beat down, if it was too long."""
        busy_s, waited_s = self._spent().since(self._beat)
        if self._is_watching and _is_late(busy_s, waited_s):
            where = self._stack or "Nobody saw where: it never let another thread run.\n"
            self.late.append(LateBeat(busy_s, waited_s, where))

    def _look(self) -> None:
        """Keep the stack of the screen's thread as it is when its beat becomes late."""
        while not self._is_over.wait(LOOK_EVERY_S):
            with self._lock:
                if self._is_watching and not self._stack and _is_late(*self._spent().since(self._beat)):
                    self._stack = _stack_of(self._thread_id)

    def _spent(self) -> Spent:
        wall_s = time.monotonic()
        if self._clock is not None:
            busy_s = time.clock_gettime(self._clock)
        else:  # Windows reports a thread's time only to itself: then late beats are seen, but not where
            busy_s = time.thread_time() if threading.get_ident() == self._thread_id else self._beat.busy_s
        kept_s = int(self._kept_file.read_text().split()[1]) / 1e9 if self._has_kept else None
        return Spent(wall_s, busy_s, kept_s)


def _stack_of(thread_id: int) -> str:
    """Where a thread is. No frame of it is held: with its frame a painter outlives its `paintEvent`, is ended by
    whoever lets the frame go, and the next painter of that window draws without a state, which ends the process.
    """
    with tempfile.TemporaryFile("w+") as file:
        faulthandler.dump_traceback(file, all_threads=True)
        file.seek(0)
        stacks = file.read().split("\n\n")
    own = (one for one in stacks if f"0x{thread_id:016x}" in one.split("\n", 1)[0])
    return next(own, "")


def _is_late(busy_s: float, waited_s: float) -> bool:
    return busy_s > BUSY_LIMIT_S or busy_s + waited_s > WAIT_LIMIT_S

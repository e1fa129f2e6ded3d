"""Watchdog that detects whether the screen's thread was ever held up.

A timer beats in its event loop, and a thread beside it counts late beats.

What counts is what the screen's thread itself did between two beats: processor time it used, and time it waited for
something, as for a lock, a file or `sleep`. Time in which it was ready and another process had the processor is left
out, so that a busy machine fails no test; systems that do not report that time are asked for processor time only. A
processor that is slow, or that shares its core and caches with another's work, needs more of it for the same work: what
is late is compared with a fixed piece of work, done at once after it. What the test process holds beside the
application is kept from the garbage collector meanwhile: clinics do not run pytest.
"""

import faulthandler
import gc
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from PySide6.QtCore import Qt, QTimer

BEAT_MS = 5
LOOK_EVERY_S = 0.01
BUSY_LIMIT_S = 0.15  # the house allows 0.1; what tests watch of every object, and a slower computer, come on top
WAIT_LIMIT_S = 0.2  # more: waiting for a thread of ours that another process keeps from running is no fault
PIECE_S = 0.0025  # what `_piece_of_work` takes on the computer on which these limits were set
PIECES = 5


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


def slowness() -> float:
    """How many times as long as on the computer of the limits a piece of work takes this thread now; at least 1."""
    return max(1.0, *(_piece_of_work() / PIECE_S for _ in range(PIECES)))


def _piece_of_work() -> float:
    begin_s = time.thread_time()
    counts: dict[int, int] = {}
    for k in range(20_000):
        counts[k % 97] = counts.get(k % 97, 0) + k * k % 7
    return time.thread_time() - begin_s


class Watchdog:
    """Made, started and stopped on the screen's thread. `slowness` is asked where a beat is late, on that thread.

    What is waited for until the next beat counts as held up: beats further apart find more late, never less.
    """

    def __init__(self, slowness: Callable[[], float] = slowness, beat_ms: int = BEAT_MS) -> None:
        self.late: list[LateBeat] = []
        self._slowness, self._beat_ms = slowness, beat_ms
        self._thread_id = threading.get_ident()
        self._kept_file: BinaryIO | None = None
        with suppress(OSError):  # systems that do not report it
            self._kept_file = open_schedstat(threading.get_native_id())
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
        self._timer.start(self._beat_ms)
        self._looker.start()

    def stop(self) -> None:
        self._pause()
        self._timer.stop()
        self._is_over.set()
        self._looker.join()
        if self._kept_file is not None:
            self._kept_file.close()
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
            self._note(self._spent())
            self._is_watching = False

    def _resume(self) -> None:
        with self._lock:
            self._beat, self._stack, self._is_watching = self._spent(), "", True

    def _on_beat(self) -> None:
        with self._lock:
            now = self._spent()
            self._beat, self._stack = self._spent() if self._note(now) else now, ""

    def _note(self, now: Spent) -> bool:
        """Write the time since the last beat down, if it was too long; return whether that took time to find out."""
        busy_s, waited_s = now.since(self._beat)
        if not self._is_watching or not _is_late(busy_s, waited_s):
            return False
        if _is_late(busy_s, waited_s, self._slowness()):
            where = self._stack or "Nobody saw where: it never let another thread run.\n"
            self.late.append(LateBeat(busy_s, waited_s, where))
        return True

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
        kept_s = schedstat_s(self._kept_file)[1] if self._kept_file is not None else None
        return Spent(wall_s, busy_s, kept_s)


def open_schedstat(native_id: int) -> BinaryIO:
    """Open what Linux reports of one of this process' threads; to be read again and again without opening it."""
    return Path(f"/proc/self/task/{native_id}/schedstat").open("rb", buffering=0)


def schedstat_s(file: BinaryIO) -> tuple[float, float]:
    """Read how long a thread was at work so far, and how long it was ready and others were on the processor."""
    busy_ns, kept_ns, _ = os.pread(file.fileno(), 100, 0).split()
    return int(busy_ns) / 1e9, int(kept_ns) / 1e9


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


def _is_late(busy_s: float, waited_s: float, slowness: float = 1.0) -> bool:
    return busy_s > slowness * BUSY_LIMIT_S or busy_s + waited_s > slowness * WAIT_LIMIT_S

"""A metronome that does not drift: each tick is due at its own instant, counted from the start."""

import math
import time
from collections.abc import Callable

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.system import sounds
from app.system.sounds import Sound

LEAST, MOST = 30, 200  # steps per minute
LATE_S = 0.12  # a tick that comes later than this would sound like one of another rate


class Metronome(QObject):
    """`beats_per_min` is 0 while it is silent.

    A timer that waits for a period after each tick adds up its delays; this one waits for instants. Ticks that the
    program was too busy for are left out, and the next one is in time again.
    """

    changed = Signal()

    def __init__(
        self,
        parent: QObject | None = None,
        now_s: Callable[[], float] = time.monotonic,
        tick: Callable[[], None] = lambda: sounds.play(Sound.TICK),
    ) -> None:
        super().__init__(parent)
        self._now_s, self._tick = now_s, tick
        self.beats_per_min = 0
        self._begin_s, self._next = 0.0, 0
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.look)

    def start(self, beats_per_min: int) -> None:
        """Tick now and at this rate; raises ValueError outside LEAST to MOST."""
        if not LEAST <= beats_per_min <= MOST:
            raise ValueError(f"beats_per_min is {beats_per_min}, expected {LEAST} to {MOST}")
        self.beats_per_min, self._begin_s, self._next = beats_per_min, self._now_s(), 0
        self.look()
        self.changed.emit()

    def stop(self) -> None:
        self._timer.stop()
        if self.beats_per_min:
            self.beats_per_min = 0
            self.changed.emit()

    def look(self) -> None:
        """Tick if a tick is due, and wait for the next."""
        if not self.beats_per_min:
            return
        late_s = self._now_s() - self._due_s
        if late_s >= 0.0:
            if late_s <= LATE_S:
                self._tick()
            self._next = math.floor((self._now_s() - self._begin_s) * self.beats_per_min / 60.0 + 1e-9) + 1
        self._timer.start(max(math.ceil(1000.0 * (self._due_s - self._now_s())), 0))

    @property
    def _due_s(self) -> float:
        return self._begin_s + self._next * 60.0 / self.beats_per_min

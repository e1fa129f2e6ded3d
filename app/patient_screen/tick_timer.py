"""Ticks by a timer, where no stream of clicks can be played: each is due at its own instant, counted from the first."""

import math
import time
from collections.abc import Callable

from PySide6.QtCore import QObject, Qt, QTimer

from app.system import sounds
from app.system.sounds import Sound

LATE_S = 0.12  # a tick that comes later than this would sound like one of another rate


class TickTimer(QObject):
    """A timer that waits for a period after each tick adds up its delays; this one waits for instants.

    Ticks that the program was too busy for are left out, and the next one is in time again.
    """

    def __init__(
        self,
        parent: QObject | None = None,
        now_s: Callable[[], float] = time.monotonic,
        tick: Callable[[], None] = lambda: sounds.play(Sound.TICK),
    ) -> None:
        super().__init__(parent)
        self._now_s, self._tick = now_s, tick
        self._period_s, self._first_s, self._next = math.inf, 0.0, 0
        self._latest_s = -math.inf
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.look)

    def start(self, beats_per_min: float) -> None:
        """Tick at this rate: a whole new period after the latest tick, or at once where that is over."""
        self._period_s = 60.0 / beats_per_min
        self._first_s, self._next = max(self._now_s(), self._latest_s + self._period_s), 0
        self.look()

    def stop(self) -> None:
        self._timer.stop()
        self._period_s = math.inf

    def look(self) -> None:
        """Tick if a tick is due, and wait for the next."""
        if math.isinf(self._period_s):
            return
        now_s = self._now_s()
        if now_s >= self._due_s:
            if now_s - self._due_s <= LATE_S:
                self._latest_s = now_s
                self._tick()
            self._next = math.floor((now_s - self._first_s) / self._period_s + 1e-9) + 1
        self._timer.start(max(math.ceil(1000.0 * (self._due_s - self._now_s())), 0))

    @property
    def _due_s(self) -> float:
        return self._first_s + self._next * self._period_s

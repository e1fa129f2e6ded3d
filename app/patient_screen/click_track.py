"""Samples of a metronome: one stream without an end, in which every click has its own instant."""

import math
from threading import Lock

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.int16]


class ClickTrack:
    """Clicks are counted from the first of their rate, so that rounding to a sample does not add up.

    `set_rate` and `read` may be called by different threads.

    Parameters
    ----------
    click : (k,)
        One click, shorter than the shortest period.
    """

    def __init__(self, click: Samples, rate_hz: int) -> None:
        self._click, self._rate_hz = click, rate_hz
        self._lock = Lock()
        self._at = 0  # the sample that is read next
        self._latest = -math.inf  # where the latest click began
        self._first, self._passed, self._period = 0.0, 0, math.inf  # in samples, but `_passed` in clicks

    def set_rate(self, beats_per_min: float) -> None:
        """Click at this rate: a whole new period after the latest click, or at once where that is over."""
        with self._lock:
            self._period = 60.0 * self._rate_hz / beats_per_min
            self._first, self._passed = max(self._latest + self._period, float(self._at)), 0

    def read(self, count: int) -> Samples:
        """Give the next `count` samples, (count,)."""
        samples = np.zeros(count, dtype=np.int16)
        with self._lock:
            end = self._at + count
            self._lay(samples, self._latest)  # what is left of it
            while (begin := self._next) < end:
                self._latest, self._passed = begin, self._passed + 1
                self._lay(samples, begin)
            self._at = end
        return samples

    @property
    def _next(self) -> float:
        """Where the next click begins; infinite before a rate is set."""
        if math.isinf(self._period):
            return math.inf
        return float(round(self._first + self._passed * self._period))

    def _lay(self, samples: Samples, begin: float) -> None:
        """Put the click that begins there into the samples that are read now, as far as it lies in them."""
        if math.isinf(begin):
            return
        offset = int(begin) - self._at
        part = self._click[max(-offset, 0) : max(len(samples) - offset, 0)]
        samples[max(offset, 0) : max(offset, 0) + len(part)] = part

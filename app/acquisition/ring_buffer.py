"""Samples that a sensor sent in the last seconds.

For the screen and the live estimate, which may skip but never wait.
"""

from bisect import bisect_left

import numpy as np

from core.samples import FloatArray, ImuBlock

COLUMNS = 7  # time, rate, force


class RingBuffer:
    """The last `capacity` samples of one sensor, in order of time. Not for two threads at once.

    Twice the room is held, so that what is there lies in one piece.
    """

    def __init__(self, sensor: str, capacity: int) -> None:
        self._sensor, self._capacity = sensor, capacity
        self._rows: FloatArray = np.empty((2 * capacity, COLUMNS))
        self._end = 0
        self.total = 0

    def add(self, time_s: FloatArray, gyr_rad_s: FloatArray, acc_m_s2: FloatArray) -> None:
        """Take samples (n,), (n, 3), (n, 3), each later than those before."""
        self.total += len(time_s)
        if len(time_s) > self._capacity:
            time_s, gyr_rad_s, acc_m_s2 = (part[-self._capacity :] for part in (time_s, gyr_rad_s, acc_m_s2))
        if self._end + len(time_s) > len(self._rows):
            kept = self._rows[max(self._end - self._capacity, 0) : self._end].copy()
            self._rows[: len(kept)], self._end = kept, len(kept)
        rows = self._rows[self._end : self._end + len(time_s)]
        rows[:, 0], rows[:, 1:4], rows[:, 4:] = time_s, gyr_rad_s, acc_m_s2
        self._end += len(time_s)

    def __len__(self) -> int:
        return min(self._end, self._capacity)

    @property
    def last_s(self) -> float:
        """Stamp of the newest sample; long ago where there is none."""
        return float(self._rows[self._end - 1, 0]) if self._end else -np.inf

    def since(self, time_s: float) -> ImuBlock:
        """A copy of the samples that are not older than `time_s`."""
        return self._block(self._since(time_s))

    def count_since(self, time_s: float) -> int:
        """How many samples are not older than `time_s`."""
        return len(self._since(time_s))

    def rates_since(self, time_s: float) -> FloatArray:
        """The angular rates (n, 3) of the samples that are not older than `time_s`, to be read at once: no copy."""
        return self._since(time_s)[:, 1:4]

    def newest(self, count: int) -> ImuBlock:
        """A copy of the last `count` samples, or of fewer where so many are not there."""
        return self._block(self._held()[max(len(self) - count, 0) :])

    def _since(self, time_s: float) -> FloatArray:
        rows = self._held()
        return rows[bisect_left(rows[:, 0], time_s) :]  # `searchsorted` would copy all times first

    def _held(self) -> FloatArray:
        return self._rows[self._end - len(self) : self._end]

    def _block(self, rows: FloatArray) -> ImuBlock:
        rows = rows.copy()
        return ImuBlock(self._sensor, rows[:, 0], rows[:, 1:4], rows[:, 4:])

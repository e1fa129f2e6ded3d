"""Stamps while samples come: what is known of a sensor's clock improves, and the stamps follow it gently."""

import threading

import numpy as np

from core.samples import BoolArray, FloatArray
from devices.clocks.clock import BIN_S, EARLY_S, REMEMBERED, ClockFit, ClockRuns, fit_clock


class LiveLine:
    """The line from one clock to the host's, learnt from what arrives by it; of several sensors where these share it.

    A correction changes an interval by a twentieth at most, so that none looks like a lost sample. Of several threads
    at once.
    """

    KEPT_S = 600.0
    FOLLOWS = 0.05
    JUMPS_S = 0.5  # what is this wrong was no clock

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._bins: dict[int, tuple[float, float]] = {}
        self.fit: ClockFit | None = None
        """As it is known now; None before anything was learnt."""
        self._fitted_at_s = self._shift_s = self._stamped_s = 0.0

    def stamp(self, device_s: FloatArray, host_s: float) -> FloatArray:
        """Learn from samples (n,) that arrived together, and stamp them in seconds of the host."""
        with self._lock:
            self._learn(device_s, host_s)
            return self._followed(device_s)

    def _learn(self, device_s: FloatArray, host_s: float) -> None:
        # of samples that arrive together the last is the most informative: it waited least
        newest_s = float(device_s.max())
        number, late_s = int(newest_s // BIN_S), host_s - newest_s
        if number not in self._bins or late_s < self._bins[number][1]:
            self._bins[number] = newest_s, late_s
        fit = self.fit
        is_early = fit is None or host_s < fit.host_s(np.array([newest_s]))[0]
        if is_early or newest_s - self._fitted_at_s > 1.0:
            while len(self._bins) > self.KEPT_S / BIN_S:
                del self._bins[min(self._bins)]
            at_s, behind_s = np.array(list(self._bins.values())).T
            self.fit, self._fitted_at_s = fit_clock(at_s, at_s + behind_s), newest_s
            if fit is None:
                self._shift_s, self._stamped_s = 0.0, newest_s
            else:  # go on from what was stamped last
                moved_s = (fit.host_s(at_s[-1:]) - self.fit.host_s(at_s[-1:]))[0]
                self._shift_s += float(moved_s)
                if abs(self._shift_s) > self.JUMPS_S:
                    self._shift_s = 0.0

    def _followed(self, device_s: FloatArray) -> FloatArray:
        assert self.fit is not None
        passed_s = np.maximum(device_s - self._stamped_s, 0.0)
        shift_s = np.sign(self._shift_s) * np.maximum(abs(self._shift_s) - self.FOLLOWS * passed_s, 0.0)
        self._shift_s, self._stamped_s = float(shift_s[-1]), max(self._stamped_s, float(device_s.max()))
        return self.fit.host_s(device_s) + shift_s


class LiveClock:
    """One sensor's stamps, from its own clock.

    Parameters
    ----------
    line
        Of a clock that several sensors share; None: it has one of its own. Once its clock has begun again it has one
        of its own in any case.
    """

    def __init__(self, line: LiveLine | None = None) -> None:
        self._runs = ClockRuns()
        self._line = LiveLine() if line is None else line
        self._run, self._early = -1, 0

    def begin(self) -> None:
        """What follows was sent after a loss, and the sensor's clock may have begun again."""
        self._runs.begin()

    @property
    def fit(self) -> ClockFit | None:
        """As `LiveLine.fit`."""
        return self._line.fit

    def stamp(self, device_s: FloatArray, host_s: float) -> FloatArray:
        """Stamps (n,) of samples that arrived together, in seconds of the host; NaN for what cannot be."""
        run = self._runs.take(device_s, np.full(len(device_s), host_s))
        stamps_s = np.full(len(device_s), np.nan)
        if self._runs.run != self._run:
            if self._run >= 0:
                self._line = LiveLine()
            self._run = self._runs.run
        rows = run == self._run
        rows[rows] = self._is_meant(device_s[rows], host_s)
        if rows.any():
            stamps_s[rows] = self._line.stamp(device_s[rows], host_s)
        return stamps_s

    def _is_meant(self, device_s: FloatArray, host_s: float) -> BoolArray:
        """Which samples (n,) came no sooner than can be; if the next ones do, too, the line was wrong, not they."""
        if (fit := self._line.fit) is None:
            return np.ones(len(device_s), dtype=bool)
        is_early: BoolArray = fit.host_s(device_s) > host_s + EARLY_S
        self._early = self._early + 1 if is_early.any() else 0
        return ~is_early if self._early < REMEMBERED else np.ones(len(device_s), dtype=bool)

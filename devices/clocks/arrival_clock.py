"""Seconds of a sensor that gives none and counts nothing: from how many samples came, and when.

What arrives was taken before: so each sample is later than the one before by a little more than the usual step, but
never later than it arrived. The usual step is what the last seconds have shown. A single sample that is lost cannot be
distinguished from one that came late; what is reported about such a sensor mentions that.
"""

from collections import deque

MORE = 1.02  # of the usual step: an arrival that was not held up is met again within a second or so
SPAN_S = 10.0  # from which the usual step is found
SURE_S = 1.0  # before that, the rate that was asked for gives it
PAUSE_S = 0.35  # a link holds nothing up for longer: it was away


class ArrivalClock:
    """Not for two threads at once.

    Parameters
    ----------
    rate_hz
        What the sensor was set to.
    """

    def __init__(self, rate_hz: float) -> None:
        self._step_s = 1.0 / rate_hz
        self._arrived: deque[float] = deque()
        self._last_s: float | None = None

    def take(self, host_s: float) -> float:
        """When the next sample was taken, in seconds of the host's clock; it arrived at `host_s`."""
        if self._last_s is None or host_s - self._last_s > PAUSE_S:
            self._arrived.clear()
            time_s = host_s
        else:
            time_s = min(self._last_s + MORE * self._usual_s(), host_s)
            time_s = max(time_s, self._last_s + 1e-6)  # of several that arrive together, each is later
        self._arrived.append(host_s)
        while host_s - self._arrived[0] > SPAN_S:
            self._arrived.popleft()
        self._last_s = time_s
        return time_s

    def _usual_s(self) -> float:
        passed_s = self._arrived[-1] - self._arrived[0]
        return passed_s / (len(self._arrived) - 1) if passed_s > SURE_S else self._step_s

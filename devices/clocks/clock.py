"""Samples stamped by the host's clock, from the sensor's own clock and the arrivals.

What arrives was sent before it arrived: latency only ever delays. So the line from the device's clock to the host's
lies below the arrivals (Zhang, Liu & Xia 2002, Clock synchronization algorithms for network measurements, IEEE INFOCOM,
doi:10.1109/INFCOM.2002.1019257): a little, and the less the more of them are near, as the mean of all lines that may be
(Pitman 1939, The estimation of the location and scale parameters of a continuous population of any given form,
Biometrika 30:391-421, doi:10.1093/biomet/30.3-4.391). The least latency cannot be seen from here and remains: a
millisecond by cable.
"""

from collections import deque
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.samples import BoolArray, FloatArray, IntArray
from devices.source import SensorCounts

MOST_SKEW = 500e-6  # the worst quartz; what looks like more is latency that changed
BIN_S = 0.5  # of which the earliest arrival counts; within it the clocks part by less than a quarter millisecond
NEAR = 6  # arrivals next to the line, which show how dense they are there; no more than each third of all
ALIKE_S = 1e-6  # latencies so near to one another differ by rounding only
SLOPES = 201  # tried at a time, in ever narrower ranges
UNLIKELY = -20.0  # logarithm of what is no part of a mean any more
SPREAD_S = 10.0  # pieces whose earliest arrivals show how straight the clocks run
BACK_S = 1.0  # so far back a sample may have been overtaken on its way
AHEAD_S = 5.0  # so much further than the host's a sensor's clock may step: the sample before had been held up
AGREEING = 5  # samples that make a new clock of what looked damaged
REMEMBERED = 3  # samples, of which the next has to follow one
EARLY_S = 0.25  # so much sooner than all around it no sample comes: its stamp is wrong
MOST_CLOCK_S = 1e12  # no clock shows more, and beyond it a double resolves no milliseconds any more

Arrival = tuple[float, float]
"""A sample's time by the sensor's clock, and when it arrived."""
Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class ClockFit:
    """`host_s = device_s + offset_s + skew (device_s - origin_s)`."""

    origin_s: float
    offset_s: float
    skew: float
    residual_s: float = 0.0  # how far from the line the earliest arrivals of ten seconds each lie: root mean square

    def host_s(self, device_s: FloatArray) -> FloatArray:
        """The host's seconds (n,) at the sensor's."""
        return device_s + (self.offset_s + self.skew * (device_s - self.origin_s))


def fit_clock(device_s: FloatArray, host_s: FloatArray) -> ClockFit:
    """Find the line below all arrivals (n,), n > 0, in any order, from the sensor's seconds to the host's."""
    order = np.argsort(device_s, kind="stable")
    x_s, late_s = device_s[order], (host_s - device_s)[order]
    origin_s, least_s = float(x_s[0]), float(late_s.min())
    at_s, earliest_s = _earliest(x_s, late_s, BIN_S)
    skew, below_s = _line_below(at_s - at_s.mean(), earliest_s - least_s)
    offset_s = float((late_s - skew * (x_s - origin_s)).min()) - below_s
    at_s, earliest_s = _earliest(x_s, late_s - skew * (x_s - origin_s) - offset_s, SPREAD_S)
    return ClockFit(origin_s, offset_s, skew, float(np.sqrt(np.mean(earliest_s**2))))


def _earliest(x_s: FloatArray, late_s: FloatArray, bin_s: float) -> tuple[FloatArray, FloatArray]:
    """The least late (m,) of each bin, and where it is; `x_s` (n,) ascends."""
    starts = np.flatnonzero(np.diff(np.floor(x_s / bin_s), prepend=-np.inf) > 0)
    least_s = np.minimum.reduceat(late_s, starts)
    is_least = late_s == np.repeat(least_s, np.diff(starts, append=len(x_s)))
    rows = np.flatnonzero(is_least)
    first = rows[np.searchsorted(rows, starts)]
    return x_s[first], least_s


def _line_below(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Slope of the line below all points (n,), and how far below the lowest it lies; the mean of x is 0."""
    # were points as dense everywhere above the true line as next to it, any line below them all would be as likely as
    # exp(density height), its height taken at x = 0; this is the mean of these lines
    hull_x, hull_y = np.array(_hull_below(x, y)).T
    if len(hull_x) < 2:
        return 0.0, 0.0
    k = min(max(int(np.searchsorted(hull_x, 0.0)), 1), len(hull_x) - 1)
    nearest = (hull_y[k] - hull_y[k - 1]) / (hull_x[k] - hull_x[k - 1])  # of all lines below, that which lies highest
    slope = float(np.clip(nearest, -MOST_SKEW, MOST_SKEW))
    above = np.sort(y - slope * x)
    count = min(NEAR, len(above) // 3)
    if count < 3 or above[count] - above[0] < ALIKE_S:
        return slope, 0.0
    density = (count - 1) / (above[count] - above[0])  # two of them lie on the line
    low, high = -MOST_SKEW, MOST_SKEW
    for _ in range(4):
        slopes = np.linspace(low, high, SLOPES)
        heights = (hull_y[:, None] - slopes * hull_x[:, None]).min(axis=0)
        likely = density * (heights - heights.max())
        first, last = np.flatnonzero(likely > UNLIKELY)[[0, -1]].tolist()
        low, high = slopes[max(first - 1, 0)], slopes[min(last + 1, SLOPES - 1)]
    weights = np.exp(likely) / np.exp(likely).sum()
    slope, height = float(weights @ slopes), float(weights @ heights) - 1.0 / density
    return slope, float((hull_y - slope * hull_x).min()) - height


def _hull_below(x: FloatArray, y: FloatArray) -> list[Point]:
    """The corners that a thread touches that is drawn tight below all points, x ascending."""
    hull: list[Point] = []
    for point in zip(x.tolist(), y.tolist(), strict=True):
        while len(hull) > 1 and _turn(hull[-2], hull[-1], point) <= 0:
            hull.pop()
        hull.append(point)
    return hull


def _turn(a: Point, b: Point, c: Point) -> float:
    """Positive where a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


class ClockRuns:
    """Finds which samples share one run of the sensor's clock, and which carry a time that cannot be.

    A sensor that was switched off begins again. A single wild stamp, of a message without a checksum, is damage; five
    that agree are a new run, whose first four are given up: but for one that begins after a loss that is known.
    """

    def __init__(self) -> None:
        self.run = -1
        self._last: deque[Arrival] = deque(maxlen=REMEMBERED)
        self._doubtful: list[Arrival] = []
        self._may_begin = True

    def begin(self, *, is_again: bool = False) -> None:
        """Mark a loss or start: a time that does not follow is a new run at once, with `is_again` any time."""
        self._may_begin = True
        if is_again:
            self._last.clear()
            self._doubtful.clear()

    def take(self, device_s: FloatArray, host_s: FloatArray) -> IntArray:
        """Number the run of each arrival (n,), in the order in which they arrived; -1 for what cannot be."""
        can_be = np.abs(device_s) < MOST_CLOCK_S
        if not can_be.all():
            run = np.full(len(device_s), -1, dtype=np.int64)
            run[can_be] = self.take(device_s[can_be], host_s[can_be])
            return run
        if self._last and len(device_s) and not self._doubtful:
            last_device_s, last_host_s = self._last[-1]
            step_s = np.diff(device_s, prepend=last_device_s)
            is_meant = (step_s > -BACK_S) & (step_s < np.diff(host_s, prepend=last_host_s) + AHEAD_S)
            if is_meant.all():
                newest = zip(device_s[-REMEMBERED:].tolist(), host_s[-REMEMBERED:].tolist(), strict=True)
                self._last.extend(newest)
                self._may_begin = False
                return np.full(len(device_s), self.run, dtype=np.int64)
        arrivals = zip(device_s.tolist(), host_s.tolist(), strict=True)
        return np.fromiter((self._one(arrival) for arrival in arrivals), np.int64, len(device_s))

    def _one(self, arrival: Arrival) -> int:
        if not self._last:
            self.run += 1
        elif not any(_follows(before, arrival) for before in self._last):  # of which one may have been wrong itself
            if self._doubtful and not _follows(self._doubtful[-1], arrival):
                self._doubtful.clear()
            self._doubtful.append(arrival)
            if len(self._doubtful) < AGREEING and not self._may_begin:
                return -1
            self.run += 1
            self._last.clear()
        self._may_begin = False
        self._doubtful.clear()
        self._last.append(arrival)
        return self.run


def _follows(before: Arrival, arrival: Arrival) -> bool:
    step_s = arrival[0] - before[0]
    return -BACK_S < step_s < arrival[1] - before[1] + AHEAD_S


class Unwrapping:
    """A counter of so many bits, made to go on where it begins again, however long it was not received."""

    def __init__(self, bits: int, tick_hz: float) -> None:
        self._span, self._tick_hz = 1 << bits, tick_hz
        self._last: tuple[int, float] | None = None

    def ticks(self, counter: int, host_s: float) -> int:
        """Ticks since the counter was 0 before it was first received; less than the one before where overtaken."""
        if self._last is None:
            self._last = counter, host_s
            return counter
        ticks, received_s = self._last
        expected = ticks + round((host_s - received_s) * self._tick_hz)
        half = self._span // 2
        near = expected + (counter - expected + half) % self._span - half
        self._last = near, host_s
        return near


@dataclass(frozen=True, slots=True)
class Ordered:
    """Rows of a stream by when they were taken: `rows` indexes what arrived, `time_s` on the host's clock."""

    rows: IntArray
    time_s: FloatArray
    device_s: FloatArray
    counts: SensorCounts
    residual_s: float


def put_in_order(
    device_s: FloatArray,
    host_s: FloatArray,
    step_s: float | None,
    begins: Sequence[int] = (),
    again: Collection[int] = (),
) -> Ordered:
    """Order arrivals (n,) by the sensor's clock, each once, and stamp them by the host's.
    `begins`: arrivals, ascending, before which something was lost; `again`: where the clock is a new one.
    """
    runs, pieces = ClockRuns(), []
    for begin, end in pairwise([0, *begins, len(device_s)]):
        pieces.append(runs.take(device_s[begin:end], host_s[begin:end]))
        runs.begin(is_again=end in again)
    run = np.concatenate(pieces)
    rows: list[IntArray] = []
    times: list[FloatArray] = []
    residuals: list[float] = []
    doubled = late = lost = timeless = 0
    for number in range(int(run.max(initial=-1)) + 1):
        arrived = np.flatnonzero(run == number)
        order = arrived[np.argsort(device_s[arrived], kind="stable")]
        is_wild = _is_too_early(host_s[order] - device_s[order])
        if is_wild.any():
            timeless += int(np.count_nonzero(is_wild))
            order = order[~is_wild]
            arrived = np.sort(order)
        is_new = np.diff(device_s[order], prepend=-np.inf) > 0
        fit = fit_clock(device_s[arrived], host_s[arrived])
        kept = order[is_new]
        first = device_s[np.sort(kept)]
        late += int(np.count_nonzero(first[1:] < np.maximum.accumulate(first)[:-1]))
        doubled += int(np.count_nonzero(~is_new))
        usual_s = step_s or _usual_step_s(device_s[kept])
        lost += _missing(device_s[kept], usual_s)
        stamps_s = fit.host_s(device_s[kept])
        if len(times) == 1 and len(times[0]) < AGREEING and stamps_s[0] <= times[0][-1]:
            # what was received first was wild, and held up: it must not take the instants of what follows
            timeless += len(rows.pop())
            times.pop()
        if times:  # the sensor began again
            is_later: BoolArray = stamps_s > times[-1][-1]
            timeless += int(np.count_nonzero(~is_later))  # the run before had been held up: theirs are taken already
            if not is_later.any():
                continue
            kept, stamps_s = kept[is_later], stamps_s[is_later]
            lost += _missing(np.concatenate([times[-1][-1:], stamps_s[:1]]), usual_s)
        rows.append(kept)
        times.append(stamps_s)
        residuals.append(fit.residual_s)
    chosen = np.concatenate([*rows, np.empty(0, np.int64)]).astype(np.int64)
    time_s = np.concatenate([*times, np.empty(0)])
    damaged = int(np.count_nonzero(run < 0)) + timeless
    counts = SensorCounts(received=len(chosen), lost=lost, damaged=damaged, doubled=doubled, late=late)
    return Ordered(chosen, time_s, device_s[chosen], counts, max(residuals, default=0.0))


def _is_too_early(late_s: FloatArray) -> BoolArray:
    """Which samples (n,), by the sensor's clock, came sooner than all of the five before and after."""
    # one such stamp, of a message without a checksum, would draw the line below it
    around_s = np.full(len(late_s), np.inf)
    for k in range(1, AGREEING + 1):
        around_s[k:] = np.minimum(around_s[k:], late_s[:-k])
        around_s[:-k] = np.minimum(around_s[:-k], late_s[k:])
    too_early: BoolArray = late_s < around_s - EARLY_S
    too_early[:1] = False  # those after it may all have been held up
    return too_early & (len(late_s) > AGREEING)


def _usual_step_s(device_s: FloatArray) -> float:
    return float(np.median(np.diff(device_s))) if len(device_s) > 2 else np.inf


def _missing(time_s: FloatArray, step_s: float) -> int:
    return int(np.maximum(np.round(np.diff(time_s) / step_s) - 1, 0).sum())

"""The samples that identify a joint while it moves: a set S(i) of both sensors every tenth of a second (eq 2)."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from core.live.orientation import NOTHING, OrientedSamples, joined
from core.samples import FloatArray
from core.signal.pair import FAST_RAD_S, MOVING_RAD_S, MOVING_WINDOW_S, lever_matrix
from core.signal.rotations import cross_matrix

SPACING_S = 0.1
# Rates are read this far apart: 30 ms damp their noise in angular accelerations tenfold against adjacent samples
# and still follow what a leg does. The same span carries the distal sensor's lag.
NODE_S = 0.03
NODES = NODE_S * np.arange(-3, 4)
MAX_SETS = 400  # forty seconds of movement
DROPPED_AT_ONCE = 100
MAX_GAP_S = 0.05  # between two samples that are read between; after more, the orientation may have restarted
KEPT_S = 10.0  # so long samples of one sensor wait for the other's


@dataclass(slots=True)
class Sets:
    """Sample sets of the proximal (1) and the distal (2) sensor, in sensor axes.

    Angular rates `g` and accelerations `dg`, specific forces `a` (n, 3), lever matrices `k` (eq 7) and rotations
    `earth_from` (n, 3, 3). The distal forces (n, 3, 3) and levers (n, 3, 3, 3) stand for three instants `NODE_S` apart,
    the set's own in the middle. `effort` (n, 2): the squared angular accelerations of both.
    """

    g1: FloatArray
    g2: FloatArray
    dg2: FloatArray
    effort: FloatArray
    a1: FloatArray
    k1: FloatArray
    a2: FloatArray
    k2: FloatArray
    earth_from_1: FloatArray
    earth_from_2: FloatArray

    def __len__(self) -> int:
        return len(self.g1)

    def part(self, chosen: slice) -> "Sets":
        return Sets(*(getattr(self, name)[chosen] for name in Sets.__slots__))

    def rates_in_earth(self, lag_s: float) -> tuple[FloatArray, FloatArray]:
        """Both rates (n, 3), each in its own earth axes, the distal one `lag_s` earlier."""
        rate_2 = self.g2 - lag_s * self.dg2
        return (self.earth_from_1 @ self.g1[:, :, None])[:, :, 0], (self.earth_from_2 @ rate_2[:, :, None])[:, :, 0]


_SHAPES = ((3,), (3,), (3,), (2,), (3,), (3, 3), (3, 3), (3, 3, 3), (3, 3), (3, 3))


def parabola(lag_s: float) -> tuple[FloatArray, FloatArray]:
    """Give shares (3,) of the three instants `lag_s` earlier, and their slopes (3,), 1/s."""
    at = -lag_s / NODE_S
    return (
        np.array([0.5 * at * (at - 1), 1 - at**2, 0.5 * at * (at + 1)]),
        np.array([0.5 - at, 2 * at, -0.5 - at]) / NODE_S,
    )


def _products_to_matrix() -> FloatArray:
    """The (16, 9) by which the products of a unit quaternion's components, scalar first, give its rotation matrix."""
    linear = np.zeros((4, 4, 3, 3))
    linear[0, 0] = np.eye(3)
    for i in range(3):
        for k in range(3):
            linear[1 + i, 1 + k, i, k] += 2.0  # 2 v v'
            linear[1 + i, 1 + i, k, k] -= 1.0  # -|v|^2
    linear[0, 1:] = 2.0 * cross_matrix(np.eye(3))  # 2 w [v]x
    return linear.reshape(16, 9)


_PRODUCTS_TO_MATRIX = _products_to_matrix()


def matrices_of(q: FloatArray) -> FloatArray:
    """Give rotation matrices (n, 3, 3) of near-unit quaternions (n, 4), scalar first; for one, fast."""
    products = q[:, :, None] * (q / np.sum(q**2, axis=1, keepdims=True))[:, None, :]
    return (products.reshape(-1, 16) @ _PRODUCTS_TO_MATRIX).reshape(-1, 3, 3)


class SetCollector:
    """Takes samples of both sensors as they come and keeps the sets of the last forty seconds of movement.

    Sensors may have rates and grids of their own. Sets stand at whole tenths of a second of the session's clock, so
    that they do not depend on how the samples were cut into blocks.
    """

    def __init__(self) -> None:
        self._ends = (_Recent(), _Recent())
        self._next: int | None = None
        self._speeds: deque[float] = deque(maxlen=round(MOVING_WINDOW_S / SPACING_S))
        self._kept = Sets(*(np.empty((MAX_SETS, *shape)) for shape in _SHAPES))
        self._count = 0
        self._same_heading = 0  # the first set since both orientations began
        self._stretches = 0, 0
        self.headings = 0  # counts up where an orientation restarts

    @property
    def sets(self) -> Sets:
        return self._kept.part(slice(0, self._count))

    @property
    def of_one_heading(self) -> Sets:
        """The last sets between which neither orientation restarted."""
        return self._kept.part(slice(self._same_heading, self._count))

    @property
    def newest(self) -> Sets:
        return self._kept.part(slice(self._count - 1, self._count))

    def feed(self, proximal: OrientedSamples, distal: OrientedSamples) -> Iterator[bool]:
        """Take samples; yields once per tenth of a second they complete: did the joint move, is there a new set?"""
        for end, samples in zip(self._ends, (proximal, distal), strict=True):
            end.add(samples)
        last_s = self._ends[0].last_s, self._ends[1].last_s
        is_complete = self._next is None or min(last_s) >= self._next * SPACING_S + NODES[-1]
        if not is_complete and max(last_s) - min(last_s) < KEPT_S:
            return  # as most blocks: quicker
        for end in self._ends:
            end.settle()
        first_s, shared_s = max(end.first_s for end in self._ends), min(last_s)
        if shared_s < first_s:  # one is silent
            for end in self._ends:
                end.forget_before(end.last_s - KEPT_S)
            return
        earliest = int(np.ceil((first_s - NODES[0]) / SPACING_S))
        self._next = earliest if self._next is None else max(self._next, earliest)
        while self._next * SPACING_S + NODES[-1] <= shared_s:
            yield self._take(self._next * SPACING_S)
            self._next += 1
        for end in self._ends:
            end.forget_before(max(self._next * SPACING_S + NODES[0], end.last_s - KEPT_S))

    def _take(self, at_s: float) -> bool:
        one, two = (end.read(at_s) for end in self._ends)
        stretches = self._ends[0].stretch, self._ends[1].stretch
        if stretches != self._stretches:  # an orientation has restarted
            self._stretches, self._same_heading = stretches, self._count
            self.headings += 1
        g1, g2 = one.gyr_rad_s, two.gyr_rad_s
        squares = np.einsum("ni,ni->n", g1, g1), np.einsum("ni,ni->n", g2, g2)
        self._speeds.append(float(np.sqrt(squares[0] + squares[1]).sum()) / len(NODES))
        is_moving = sum(self._speeds) > MOVING_RAD_S * len(self._speeds)
        is_fast = max(squares[0].max(), squares[1].max()) > FAST_RAD_S**2
        if not is_moving or is_fast or not (one.is_usable and two.is_usable):
            return False
        if self._count == MAX_SETS:
            self._drop_oldest()
        kept, n = self._kept, self._count
        rates = np.concatenate([g1, g2], axis=1)
        # at the three middle nodes; Seel et al. 2014, doi 10.3390/s140406891, eq 1
        accelerations = (rates[0:3] - 8 * rates[1:4] + 8 * rates[3:6] - rates[4:7]) / (12 * NODE_S)
        dg1, dg2 = accelerations[:, :3], accelerations[:, 3:]
        kept.g1[n], kept.g2[n], kept.dg2[n] = g1[3], g2[3], dg2[1]
        kept.effort[n] = dg1[1] @ dg1[1], dg2[1] @ dg2[1]
        kept.a1[n], kept.a2[n] = one.acc_m_s2[1], two.acc_m_s2
        levers = lever_matrix(np.concatenate([g1[3:4], g2[2:5]]), np.concatenate([dg1[1:2], dg2]))
        kept.k1[n], kept.k2[n] = levers[0], levers[1:]
        turned = matrices_of(np.stack([one.q_earth_from_sensor, two.q_earth_from_sensor]))
        kept.earth_from_1[n], kept.earth_from_2[n] = turned
        self._count += 1
        return True

    def _drop_oldest(self) -> None:
        left = MAX_SETS - DROPPED_AT_ONCE
        for name in Sets.__slots__:
            values = getattr(self._kept, name)
            values[:left] = values[DROPPED_AT_ONCE:].copy()
        self._count = left
        self._same_heading = max(self._same_heading - DROPPED_AT_ONCE, 0)


@dataclass(frozen=True, slots=True)
class _Reading:
    """One sensor's signals at the nodes (7, 10); not `is_usable` where a sample near them is missing."""

    signals: FloatArray
    is_usable: bool

    @property
    def q_earth_from_sensor(self) -> FloatArray:
        return self.signals[3, 0:4]

    @property
    def gyr_rad_s(self) -> FloatArray:
        return self.signals[:, 4:7]

    @property
    def acc_m_s2(self) -> FloatArray:
        return self.signals[2:5, 7:10]


class _Recent:
    """The last samples of one sensor, to be read at any instant between."""

    def __init__(self) -> None:
        self._samples = NOTHING
        self._new: list[OrientedSamples] = []
        self.last_s = -np.inf
        self._starts: deque[float] = deque()  # of stretches that have not been read yet
        self.stretch = 0

    @property
    def first_s(self) -> float:
        return float(self._samples.time_s[0]) if len(self._samples) else np.inf

    def add(self, samples: OrientedSamples) -> None:
        if len(samples):
            self._new.append(samples)
            self.last_s = float(samples.time_s[-1])

    def settle(self) -> None:
        """Put what was added to what is there."""
        known = max(len(self._samples) - 1, 0)
        self._samples = joined([self._samples, *self._new])
        self._new = []
        new_s = self._samples.time_s[known:]
        self._starts.extend(new_s[1:][np.diff(new_s) > MAX_GAP_S].tolist())

    def forget_before(self, time_s: float) -> None:
        first = int(np.searchsorted(self._samples.time_s, time_s)) - 1
        self._samples = self._samples.part(slice(max(first, 0), None))

    def read(self, at_s: float) -> _Reading:
        while self._starts and self._starts[0] <= at_s:
            self._starts.popleft()
            self.stretch += 1
        required_s, time_s = at_s + NODES, self._samples.time_s
        right = np.minimum(np.maximum(np.searchsorted(time_s, required_s), 1), len(time_s) - 1)
        left_s = time_s[right - 1]
        apart_s = time_s[right] - left_s
        before, after = self._samples.signals[right - 1], self._samples.signals[right]
        share = (required_s - left_s) / apart_s
        is_measured = self._samples.is_measured[right[0] - 1 : right[-1] + 1].all()
        return _Reading(before + share[:, None] * (after - before), bool(is_measured and apart_s.max() < MAX_GAP_S))

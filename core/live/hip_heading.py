"""Relative heading of pelvis and thigh while they move: the causal form of `core.hip.heading`.

Both sides of the coincidence are linear in what is unknown but the heading, so that three matrices of moments hold what
all headings say; they forget. Each sample counts as much as the solution before it finds it credible.
"""

from collections import deque
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from core.calibration.coincidence import BIAS_PRIOR_M_S2, CENTRE_PRIOR_M, SCALE_M_S2
from core.hip.heading import MIN_MOVING_S, RIVAL_RAD, SCAN_RAD, SD_FACTOR
from core.hip.measure import MAX_3D_SD_RAD, MAX_DISAGREEMENT, MIN_MARGIN
from core.live.joint_force import NO_FORCES, SPACING_S, FeltForces, joined_forces
from core.samples import GRAVITY_M_S2, FloatArray
from core.signal.pair import MOVING_RAD_S, MOVING_WINDOW_S
from core.signal.rotations import wrap

PER_BATCH = 20  # instants: the heading is looked at once a second
MEMORY_S = 30.0  # of movement: two orientation filters part by a degree or two in it
WAITS_S = 10.0  # of one sensor's instants for the other's
LOST_SD_RAD = np.deg2rad(8.0)  # beyond, a heading that was sure is so no longer: not to and fro at the limit
SCANS_ALL = 3  # batches: all around the circle only in so many, once the heading is known
HEADINGS = np.arange(0.0, 2 * np.pi, SCAN_RAD)
NEAR = np.linspace(-0.5, 0.5, 11) * SCAN_RAD
PRIOR = np.repeat([CENTRE_PRIOR_M, BIAS_PRIOR_M_S2] * 2, 3) ** -2.0 * SCALE_M_S2**2
GRAVITY_M_S2_UP = np.array([[0.0], [0.0], [GRAVITY_M_S2]])


@dataclass(frozen=True, slots=True)
class HipHeadingState:
    """What the movement so far shows of the heading of the thigh's earth in the pelvis's."""

    until_s: float = -np.inf  # of the last sample that counts
    heading_rad: float = 0.0
    sd_rad: float = np.inf
    margin: float = 1.0  # cost of the best heading more than 45 deg away over that of this one
    disagreement: float = 1.0  # what the best coincidence leaves, against all that both sensors feel
    moved_s: float = 0.0  # of movement, since the orientations began
    is_sure: bool = False  # whether it is sure enough for Cardan angles

    @property
    def is_trusted(self) -> bool:
        """Whether both move as adjacent segments of one hip do, beyond doubt about the heading."""
        is_long = self.moved_s >= MIN_MOVING_S
        return is_long and self.margin >= MIN_MARGIN and self.disagreement < MAX_DISAGREEMENT


UNKNOWN_HEADING = HipHeadingState()


class HipHeading:
    """One hip's heading, from the forces that both sensors feel, each instant once and in order."""

    def __init__(self) -> None:
        self._ends = [NO_FORCES, NO_FORCES]
        self._next: int | None = None  # batch
        self._moments = _Moments()
        self._stretch = (-1, -1)
        self._speeds: deque[float] = deque(maxlen=round(MOVING_WINDOW_S / SPACING_S))
        self._moved_s, self._batches = 0.0, 0
        self.state = UNKNOWN_HEADING

    def update(self, pelvis: FeltForces, thigh: FeltForces) -> list[HipHeadingState]:
        """Take what is new of both; returns the states that it makes, one for each batch in which they moved."""
        if not len(pelvis) and not len(thigh):
            return []
        ends = self._ends = [joined_forces([end, new]) for end, new in zip(self._ends, (pelvis, thigh), strict=True)]
        if not all(map(len, ends)):
            self._ends = [_latest(end) for end in ends]
            return []
        shared = min(int(end.instant[-1]) for end in ends)
        first = max(int(end.instant[0]) for end in ends) // PER_BATCH
        self._next = first if self._next is None else max(self._next, first)
        reported = []
        while (self._next + 1) * PER_BATCH - 1 <= shared:
            reported += self._take(self._next)
            self._next += 1
        self._ends = [_latest(_since(end, self._next * PER_BATCH)) for end in ends]
        return reported

    def _take(self, batch: int) -> list[HipHeadingState]:
        one, two = (_between(end, batch * PER_BATCH, (batch + 1) * PER_BATCH) for end in self._ends)
        if len(one) != PER_BATCH or len(two) != PER_BATCH:
            _, at_1, at_2 = np.intersect1d(one.instant, two.instant, assume_unique=True, return_indices=True)
            one, two = one.part(at_1), two.part(at_2)
        reported = []
        edges = np.flatnonzero(np.diff(one.stretch) | np.diff(two.stretch)) + 1
        for a, b in pairwise([0, *edges.tolist(), len(one)]):
            if b > a:
                reported += self._add(one.part(slice(a, b)), two.part(slice(a, b)))
        return reported

    def _add(self, one: FeltForces, two: FeltForces) -> list[HipHeadingState]:
        """Instants between which no orientation restarted."""
        reported = []
        if (stretch := (int(one.stretch[0]), int(two.stretch[0]))) != self._stretch:
            if self._moved_s:
                reported.append(UNKNOWN_HEADING)
            self._stretch, self._moments, self._moved_s, self._batches = stretch, _Moments(), 0.0, 0
            self.state = UNKNOWN_HEADING
        moving = []
        for speed in np.hypot(one.rate_rad_s, two.rate_rad_s).tolist():
            self._speeds.append(speed)
            moving.append(sum(self._speeds) > MOVING_RAD_S * len(self._speeds))
        is_used = np.array(moving) & one.is_clear & two.is_clear
        if not is_used.any():
            return reported
        self._moments.add(one.terms[is_used], two.terms[is_used])
        self._moved_s += SPACING_S * np.count_nonzero(is_used)
        self._batches += 1
        if self._moved_s >= MIN_MOVING_S:
            is_whole_circle = self._batches % SCANS_ALL == 0 or not self.state.is_trusted
            self._moments.solve(is_whole_circle)
            found = self._moments.state(SPACING_S * float(one.instant[-1]), self._moved_s)
            limit_rad = LOST_SD_RAD if self.state.is_sure else MAX_3D_SD_RAD
            self.state = replace(found, is_sure=found.is_trusted and found.sd_rad <= limit_rad)
            reported.append(self.state)
        return reported


class _Moments:
    """Weighted sums over rows (n, 14) of both sensors, forgotten over MEMORY_S: x'x + y'y, z'z, x'y, totals (3, 14)."""

    def __init__(self) -> None:
        self._flat, self._upright, self._turned = np.zeros((3, 14, 14))
        self._sums = np.zeros((3, 14))
        self._weight = self._count = 0.0
        self._felt = 0.0  # robust loss of what both feel beside gravity
        self._heading: float | None = None
        self._x = np.zeros(12)
        self._square = np.inf  # mean square that the best heading leaves
        self._margin = 1.0

    def add(self, one: FloatArray, two: FloatArray) -> None:
        """Take the terms (n, 3, 7) of both sensors."""
        rows = np.concatenate([one, two], axis=2)
        weight = np.ones(len(rows))
        kept = np.exp(-SPACING_S * len(rows) / MEMORY_S)
        felt = rows[..., [6, 13]] - GRAVITY_M_S2_UP
        self._felt = kept * self._felt + float(np.sum(_loss(np.einsum("nij,nij->nj", felt, felt))))
        self._count = kept * self._count + len(rows)
        if self._heading is not None:
            weight = 1 / np.sqrt(1 + np.sum(self._errors(rows) ** 2, axis=1) / SCALE_M_S2**2)
        x, y, z = rows.transpose(1, 0, 2)
        weighted = weight[:, None]
        self._flat = kept * self._flat + (weighted * x).T @ x + (weighted * y).T @ y
        self._upright = kept * self._upright + (weighted * z).T @ z
        self._turned = kept * self._turned + (weighted * x).T @ y
        self._sums = kept * self._sums + np.einsum("n,nij->ij", weight, rows)
        self._weight = kept * self._weight + float(weight.sum())

    def solve(self, is_whole_circle: bool) -> None:
        """Find the heading, all around the circle or near the one before."""
        if is_whole_circle or self._heading is None:
            cost = _loss(self._squares(HEADINGS)[1])
            best = int(np.argmin(cost))
            is_rival = np.abs(wrap(HEADINGS - HEADINGS[best])) > RIVAL_RAD
            around, rival = float(HEADINGS[best]), float(cost[is_rival].min())
        else:
            around, rival = self._heading, None
        trial = around + NEAR
        unknowns, squares = self._squares(trial)
        at = min(max(int(np.argmin(squares)), 1), len(trial) - 2)
        before, here, after = squares[at - 1 : at + 2]
        bend = before - 2 * here + after
        step = 0.5 * (before - after) / bend if bend > 0 else 0.0
        self._heading = float(trial[at] + np.clip(step, -1.0, 1.0) * (NEAR[1] - NEAR[0]))
        self._x, self._square = unknowns[at], float(squares[at])
        if rival is not None:
            self._margin = rival / max(float(_loss(self._square)), 1e-9)

    def state(self, until_s: float, moved_s: float) -> HipHeadingState:
        """What the solution gives."""
        assert self._heading is not None
        return HipHeadingState(
            until_s=until_s,
            heading_rad=self._heading,
            sd_rad=self._sd_rad(),
            margin=self._margin,
            disagreement=float(_loss(self._square)) * self._count / max(self._felt, 1e-12),
            moved_s=moved_s,
        )

    def _sd_rad(self) -> float:
        """3 s_r/(a_h sqrt(4 T)), as `core.hip.heading` has it."""
        v = np.concatenate([-self._x[:6], [1.0]])
        mean = self._sums[:2, :7] @ v / self._weight
        felt = float(v @ self._flat[:7, :7] @ v) / self._weight - float(mean @ mean)
        felt_m_s2 = np.sqrt(max(felt, (1e-6 * GRAVITY_M_S2) ** 2))
        return float(SD_FACTOR * np.sqrt(self._square) / (felt_m_s2 * np.sqrt(4.0 * SPACING_S * self._count)))

    def _errors(self, rows: FloatArray) -> FloatArray:
        """What the solution leaves (n, 3) of rows (n, 3, 14)."""
        assert self._heading is not None
        one = rows[..., 6] - rows[..., :6] @ self._x[:6]
        two = rows[..., 13] - rows[..., 7:13] @ self._x[6:]
        c, s = np.cos(self._heading), np.sin(self._heading)
        return one - two @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])

    def _squares(self, headings: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Centres and biases (h, 12) that leave least at each heading, and the mean square (h,) that they leave."""
        turns = np.stack([np.cos(headings), np.sin(headings), np.ones_like(headings)], axis=1)
        flat, upright, turned = self._flat, self._upright, self._turned
        mixed = np.tensordot(
            turns, np.stack([flat[:7, 7:], turned[7:, :7].T - turned[:7, 7:], upright[:7, 7:]]), axes=1
        )
        own_1, own_2 = ((flat + upright)[part, part] for part in (slice(0, 7), slice(7, 14)))
        matrix = np.empty((len(headings), 12, 12))
        matrix[:, :6, :6], matrix[:, 6:, 6:] = own_1[:6, :6], own_2[:6, :6]
        matrix[:, :6, 6:], matrix[:, 6:, :6] = -mixed[:, :6, :6], -np.swapaxes(mixed[:, :6, :6], 1, 2)
        slope = np.concatenate([own_1[:6, 6] - mixed[:, :6, 6], own_2[:6, 6] - mixed[:, 6, :6]], axis=1)
        x = np.linalg.solve(matrix + np.diag(PRIOR), slope[..., None])[..., 0]
        left = own_1[6, 6] + own_2[6, 6] - 2 * mixed[:, 6, 6] - np.sum(x * slope, axis=1) - x**2 @ PRIOR
        return x, np.maximum(left, 0.0) / self._weight


def _loss(square: FloatArray | float) -> FloatArray:
    """The robust loss of the offline cost, of squares (n,) in (m/s2)^2."""
    return np.asarray(2 * (np.sqrt(1 + np.asarray(square) / SCALE_M_S2**2) - 1))


def _between(forces: FeltForces, first: int, end: int) -> FeltForces:
    return forces.part(slice(*np.searchsorted(forces.instant, [first, end]).tolist()))


def _since(forces: FeltForces, first: int) -> FeltForces:
    return forces.part(slice(int(np.searchsorted(forces.instant, first)), None))


def _latest(forces: FeltForces) -> FeltForces:
    if not len(forces):
        return forces
    return _since(forces, int(forces.instant[-1]) - round(WAITS_S / SPACING_S))

"""Joint axes in both sensors' axes, and the relative heading of their orientation filters.

The relative rate of the two segments points along the joint axis in both sensors, and the axis itself is the same
line seen from both: j1 = R12 j2. The unknowns are the two axes and the relative heading; the heading enters the
relative rate so simply that all headings can be tried at once. Seel et al. 2014 identify the axes from the rates'
lengths alone (eq 6), which needs no heading; on human joints, where the rest of the motion is as large as the
sensors' noise is small, the direction contains more.
"""

from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray, IntArray
from core.signal.datasets import HEADING_WALK_RAD, Datasets
from core.signal.pair import FAST_RAD_S
from core.signal.rotations import joint_frame, turn_about_vertical

SCAN_STEP_RAD = np.deg2rad(5.0)
SCAN_S = 60.0  # over longer stretches one constant heading blurs the minima
MAX_SCAN_SAMPLES = 800
KEPT_MINIMA = 3
RATE_SCALE_RAD_S = 0.3  # off-axis rate of a human joint
NEUTRAL_SCALE_RAD = np.deg2rad(5.0)  # how far the two axes part in a human joint
CORRELATION_S = 0.5  # residuals nearer in time show nothing new
MAX_AXIS_STEP_RAD = 0.4
MIN_STEP_RAD = 1e-5  # nothing is known so finely


@dataclass(frozen=True, slots=True)
class Candidates:
    """Hypotheses: axes (c, 3) in each sensor, heading knots (c, k), mean robust cost (c,)."""

    axis_1: FloatArray
    axis_2: FloatArray
    knots_rad: FloatArray
    cost: FloatArray

    def __len__(self) -> int:
        return len(self.cost)

    def pick(self, index: int) -> "Candidates":
        return Candidates(*(getattr(self, name)[index : index + 1] for name in self.__slots__))


def joined(many: list[Candidates]) -> Candidates:
    """Candidates of several searches in one table, in their order."""
    return Candidates(*(np.concatenate([getattr(one, name) for one in many]) for name in Candidates.__slots__))


def candidates(data: Datasets, few: Datasets, stretch: int) -> Candidates:
    """Find axes and headings with little off-axis rate in one stretch, and their mirror pairings.
    The relative rate is w(d) = cos d A + sin d B + C, so six 3x3 moments give its scatter at all headings
    d; axes are its principal directions. `few` gives the headings of all stretches.
    """
    axes_1, axes_2 = _scan(data, stretch)
    pairs_1, pairs_2 = np.concatenate([axes_1, axes_1]), np.concatenate([axes_2, -axes_2])
    knots = heading_from_axes(few, pairs_1, pairs_2)
    return Candidates(pairs_1, pairs_2, knots, np.full(len(pairs_1), np.inf))


def _scan(data: Datasets, stretch: int) -> tuple[FloatArray, FloatArray]:
    chosen = np.flatnonzero(data.stretch == stretch)
    chosen = _liveliest(data, chosen)
    chosen = chosen[:: max(1, len(chosen) // MAX_SCAN_SAMPLES)]
    to_1, to_2 = data.earth_from_1[chosen], data.earth_from_2[chosen]
    rate_1 = np.einsum("nij,nj->ni", to_1, data.g1[chosen])
    rate_2 = np.einsum("nij,nj->ni", to_2, data.g2[chosen])
    heading = np.arange(0.0, 2 * np.pi, SCAN_STEP_RAD)
    scatter_1 = _scatter(np.swapaxes(to_1, 1, 2), rate_2, -rate_1, heading)
    scatter_2 = _scatter(np.swapaxes(to_2, 1, 2), -rate_1, rate_2, -heading)
    spread_1, direction_1 = np.linalg.eigh(scatter_1)
    spread_2, direction_2 = np.linalg.eigh(scatter_2)
    cost = spread_1[:, :2].sum(axis=1) + spread_2[:, :2].sum(axis=1)
    is_minimum = (cost <= np.roll(cost, 1)) & (cost < np.roll(cost, -1))
    minima = np.flatnonzero(is_minimum)
    best = minima[np.argsort(cost[minima])][:KEPT_MINIMA]
    axis_1, axis_2 = direction_1[best, :, 2], direction_2[best, :, 2]
    for k, d in enumerate(heading[best]):  # principal directions have no sign: pair them by the relative rate
        relative = turn_about_vertical(np.full(len(chosen), d), rate_2) - rate_1
        along_1 = np.einsum("ni,nij,j->n", relative, to_1, axis_1[k])
        back = turn_about_vertical(np.full(len(chosen), -d), relative)
        along_2 = np.einsum("ni,nij,j->n", back, to_2, axis_2[k])
        if along_1 @ along_2 < 0:
            axis_2[k] = -axis_2[k]
    return axis_1, axis_2


def _liveliest(data: Datasets, chosen: IntArray) -> IntArray:
    """Of the samples of one stretch, in order of time, those of the minute with the most movement."""
    time_s = data.time_s[chosen]
    if time_s[-1] - time_s[0] <= SCAN_S:
        return chosen
    energy = np.sum(data.g1[chosen] ** 2, axis=1) + np.sum(data.g2[chosen] ** 2, axis=1)
    total = np.concatenate([[0.0], np.cumsum(np.minimum(energy, FAST_RAD_S**2))])  # a jump is not a minute's worth
    end = np.searchsorted(time_s, time_s + SCAN_S, side="right")
    first = int(np.argmax(total[end] - total[: len(chosen)]))
    return chosen[first : end[first]]


def _scatter(sensor_from: FloatArray, turned: FloatArray, fixed: FloatArray, heading: FloatArray) -> FloatArray:
    """Second moments (h, 3, 3) in a sensor's axes of Rz(heading) turned + fixed, vectors given in earth axes."""
    flat = turned * [1.0, 1.0, 0.0]
    across = np.stack([-turned[:, 1], turned[:, 0], np.zeros(len(turned))], axis=1)
    rest = fixed + turned * [0.0, 0.0, 1.0]
    parts = np.einsum("nij,pnj->pni", sensor_from, np.stack([flat, across, rest]))
    moments = np.einsum("pni,qnj->pqij", parts, parts) / len(turned)
    weights = np.stack([np.cos(heading), np.sin(heading), np.ones_like(heading)])
    return np.einsum("ph,qh,pqij->hij", weights, weights, moments)


def heading_from_axes(data: Datasets, axis_1: FloatArray, axis_2: FloatArray) -> FloatArray:
    """Give heading knots (c, k), rad, under which both axes (c, 3) point the same way, in closed form."""
    e1 = np.einsum("nij,cj->cni", data.earth_from_1, axis_1)
    e2 = np.einsum("nij,cj->cni", data.earth_from_2, axis_2)
    product = (e1[..., 0] + 1j * e1[..., 1]) * (e2[..., 0] - 1j * e2[..., 1])
    weights = knot_weights(data)
    knots = product.real @ weights + 1j * (product.imag @ weights)
    heading = np.empty(knots.shape)
    for first, last in _stretch_knots(data):
        mine = knots[:, first : last + 1]
        # a knot without samples near it takes the stretch's mean
        heading[:, first : last + 1] = np.unwrap(np.angle(mine + 1e-3 * mine.sum(axis=1, keepdims=True)), axis=1)
    return heading


def _stretch_knots(data: Datasets) -> list[tuple[int, int]]:
    ends = [*np.flatnonzero(np.isnan(data.knot_spacing_s)).tolist(), data.knots - 1]
    starts = [0, *[end + 1 for end in ends[:-1]]]
    return list(zip(starts, ends, strict=True))


def knot_weights(data: Datasets) -> FloatArray:
    """Give the share (n, k) of each heading knot in each sample; rows sum to 1."""
    weights = np.zeros((len(data), data.knots))
    row = np.arange(len(data))
    weights[row, data.knot_left] = 1 - data.knot_share
    weights[row, np.minimum(data.knot_left + 1, data.knots - 1)] += data.knot_share
    return weights


@dataclass(frozen=True, slots=True)
class InEarth:
    """Both sensors' rotations (3, 3, n) and rates (3, n), each in its own earth: what no hypothesis changes."""

    turn_1: FloatArray
    turn_2: FloatArray
    rate_1: FloatArray
    rate_2: FloatArray


def in_earth(data: Datasets) -> InEarth:
    """Rotations and rates of both sensors, turned to their own earths once for all hypotheses."""
    turns = [np.ascontiguousarray(turn.transpose(1, 2, 0)) for turn in (data.earth_from_1, data.earth_from_2)]
    rates = [np.sum(turn * rate.T, axis=1) for turn, rate in zip(turns, (data.g1, data.g2), strict=True)]
    return InEarth(*turns, *rates)


@dataclass(frozen=True, slots=True)
class Residuals:
    """Three groups of residuals per candidate and sample and their slopes.

    `value` (c, n, 7): off-axis relative rate seen from sensor 1 (2) and from sensor 2 (2), parting of the axes (3),
    each over its scale. `by_heading` (c, n, 7): slopes by the heading. Of the slopes by the two tangent coordinates of
    each axis few are not zero: `along_1`, `along_2` (c, n), the relative rate along the axes, and `across_1`,
    `across_2` (3, 2, c, n), the tangents in the earth of sensor 1, over their scales.
    """

    value: FloatArray
    by_heading: FloatArray
    along_1: FloatArray
    along_2: FloatArray
    across_1: FloatArray
    across_2: FloatArray

    @property
    def by_axes(self) -> FloatArray:
        """All slopes (c, n, 7, 4) by the tangent coordinates."""
        slopes = np.zeros((*self.value.shape, 4))
        for k in range(2):
            slopes[..., k, k] = -self.along_1
            slopes[..., 2 + k, 2 + k] = -self.along_2
            slopes[..., 4:7, k] = np.moveaxis(self.across_1[:, k], 0, -1)
            slopes[..., 4:7, 2 + k] = -np.moveaxis(self.across_2[:, k], 0, -1)
        return slopes


GROUPS = (slice(0, 2), slice(2, 4), slice(4, 7))


def residuals(
    data: Datasets,
    axis_1: FloatArray,
    axis_2: FloatArray,
    heading: FloatArray,
    rate_scale: float,
    neutral_scale: float,
    known: InEarth | None = None,
) -> Residuals:
    """Compute residuals at axes (c, 3) and headings (c, n), rad; scales in rad/s and rad."""
    earth = known or in_earth(data)
    axes = np.stack([axis_1, axis_2])
    x, y = joint_frame(axes)
    frames = np.stack([x, y, axes], axis=1)  # (2, 3, c, 3)
    cosine, sine = np.cos(heading), np.sin(heading)
    rate_weight = 1 / (np.sqrt(2) * rate_scale)
    # component, which of the frame, candidate, sample; all in the earth of sensor 1
    seen_1 = _seen(earth.turn_1, frames[0])
    seen_2 = _turned(cosine, sine, _seen(earth.turn_2, frames[1]))
    rate_1, rate_2 = earth.rate_1 * rate_weight, _turned(cosine, sine, earth.rate_2[:, None] * rate_weight)
    relative = rate_2 - rate_1[:, None]
    from_1, from_2 = (np.sum(relative[:, None] * seen, axis=0) for seen in (seen_1, seen_2))
    value = np.empty((7, *heading.shape))
    by_heading = np.empty((7, *heading.shape))
    value[0:2], value[2:4] = from_1[:2], from_2[:2]
    by_heading[0:2] = rate_2[0] * seen_1[1, :2] - rate_2[1] * seen_1[0, :2]
    by_heading[2:4] = seen_2[1, :2] * rate_1[0] - seen_2[0, :2] * rate_1[1]
    seen_1 /= neutral_scale
    seen_2 /= neutral_scale
    value[4:7] = seen_1[:, 2] - seen_2[:, 2]
    by_heading[4], by_heading[5], by_heading[6] = seen_2[1, 2], -seen_2[0, 2], 0.0
    return Residuals(
        np.moveaxis(value, 0, -1), np.moveaxis(by_heading, 0, -1), from_1[2], from_2[2], seen_1[:, :2], seen_2[:, :2]
    )


def _seen(turn: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors (k, c, 3) of a sensor as its earth sees them at each of n instants, (3, k, c, n)."""
    k, c = vectors.shape[:2]
    return np.asarray(vectors.reshape(-1, 3) @ turn).reshape(3, k, c, -1)


def _turned(cosine: FloatArray, sine: FloatArray, v: FloatArray) -> FloatArray:
    """Vectors (3, ..., n) turned about the vertical by headings (c, n)."""
    turned = np.empty((3, *np.broadcast_shapes(v.shape[1:], cosine.shape)))
    turned[0] = cosine * v[0] - sine * v[1]
    turned[1] = sine * v[0] + cosine * v[1]
    turned[2] = v[2]
    return turned


def loss_and_weights(value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute robust loss 2 (sqrt(1 + r^2) - 1) per sample (c, n) and weights (c, n, 7) of `value` (c, n, 7)."""
    roots = _roots(value)
    weights = np.empty_like(value)
    for group, root in zip(GROUPS, roots, strict=True):
        weights[..., group] = (1 / root)[..., None]
    return _loss(roots), weights


def _roots(value: FloatArray) -> FloatArray:
    """sqrt(1 + r^2) of each group of residuals (c, n, 7), (3, c, n)."""
    square = np.moveaxis(value, -1, 0) ** 2
    return np.sqrt([1 + square[0] + square[1], 1 + square[2] + square[3], 1 + square[4] + square[5] + square[6]])


def _loss(roots: FloatArray) -> FloatArray:
    return np.asarray(2 * (np.sum(roots, axis=0) - 3))


def polish(
    data: Datasets,
    start: Candidates,
    steps: int,
    rate_scale: float = RATE_SCALE_RAD_S,
    neutral_scale: float = NEUTRAL_SCALE_RAD,
    is_axis_fixed: bool = False,
) -> Candidates:
    """Refine axes and heading knots of all candidates by Gauss-Newton; `is_axis_fixed`: knots only."""
    axis_1, axis_2, knots = start.axis_1, start.axis_2, start.knots_rad
    shares, information, prior = knot_weights(data), sample_information(data), heading_prior(data)
    known = in_earth(data)
    for _ in range(steps):
        r = residuals(data, axis_1, axis_2, data.heading(knots), rate_scale, neutral_scale, known)
        step = _step(r, information / _roots(r.value), shares, prior, knots, is_axis_fixed)
        axis_1, axis_2 = moved(np.stack([axis_1, axis_2]), np.stack([step[:, :2], step[:, 2:4]]))
        knots = knots + step[:, 4:]
        if np.max(np.abs(step)) < MIN_STEP_RAD:
            break
    r = residuals(data, axis_1, axis_2, data.heading(knots), rate_scale, neutral_scale, known)
    return Candidates(axis_1, axis_2, knots, _loss(_roots(r.value)).mean(axis=1))


def _step(
    r: Residuals, weight: FloatArray, knot_shares: FloatArray, prior: FloatArray, knots: FloatArray, is_axis_fixed: bool
) -> FloatArray:
    """Changes (c, 4 + k) of the tangent coordinates and the knots; `weight` (3, c, n) is that of each group."""
    c, k = knots.shape
    v, h = np.moveaxis(r.value, -1, 0), np.moveaxis(r.by_heading, -1, 0)
    groups = np.repeat(weight, [2, 2, 3], axis=0)
    weighted, weighted_heading = groups * v, groups * h
    matrix, slope = np.zeros((c, 4 + k, 4 + k)), np.zeros((c, 4 + k))
    bend, push = np.sum(weighted_heading * h, axis=0), np.sum(weighted_heading * v, axis=0)
    matrix[:, 4:, 4:] = (knot_shares.T[None] * bend[:, None, :]) @ knot_shares + prior
    slope[:, 4:] = push @ knot_shares + knots @ prior
    if is_axis_fixed:
        matrix[:, range(4), range(4)] = 1.0
    else:
        mixed = np.empty((4, *weight.shape[1:]))  # products of an axis's slope and the heading's
        neutral = np.sum(weight[2], axis=1) * float(np.sum(r.across_1[:, 0, 0, 0] ** 2))  # tangents are of one length
        sides = ((0, r.along_1, r.across_1, 1.0), (2, r.along_2, r.across_2, -1.0))
        for first, along, across, sign in sides:
            own = slice(first, first + 2)
            mixed[own] = sign * np.sum(weighted_heading[4:, None] * across, axis=0) - weighted_heading[own] * along
            force = sign * np.sum(weighted[4:, None] * across, axis=0) - weighted[own] * along
            slope[:, own] = np.sum(force, axis=-1).T
            matrix[:, (first, first + 1), (first, first + 1)] = (
                np.sum(weight[first // 2] * along**2, axis=1) + neutral
            )[:, None]
        for i in range(2):
            both = -np.sum(weight[2] * np.sum(r.across_1[:, i, None] * r.across_2, axis=0), axis=-1).T
            matrix[:, i, 2:4] = matrix[:, 2:4, i] = both
        share = np.moveaxis(mixed, 0, 1) @ knot_shares
        matrix[:, :4, 4:], matrix[:, 4:, :4] = share, np.swapaxes(share, 1, 2)
    diagonal = np.arange(4 + k)
    matrix[:, diagonal, diagonal] += 1e-6 * (1 + matrix[:, diagonal, diagonal])
    step: FloatArray = -np.linalg.solve(matrix, slope[..., None])[..., 0]
    length = np.linalg.norm(step[:, :4], axis=1, keepdims=True)
    return step * np.minimum(1.0, MAX_AXIS_STEP_RAD / np.maximum(length, 1e-12))


def sample_information(data: Datasets) -> float:
    """Give what one sample adds, 0 to 1, as samples within the correlation time show the same."""
    if len(data) < 2:
        return 1.0
    same = data.stretch[1:] == data.stretch[:-1]
    spacing_s = float(np.median(np.diff(data.time_s)[same])) if same.any() else CORRELATION_S
    return min(1.0, spacing_s / CORRELATION_S)


def heading_prior(data: Datasets) -> FloatArray:
    """Give the information matrix (k, k) of the headings' random walk between adjacent knots, 1/rad2."""
    prior = np.zeros((data.knots, data.knots))
    for k, spacing_s in enumerate(data.knot_spacing_s):
        if np.isfinite(spacing_s):
            information = 1 / (HEADING_WALK_RAD**2 * spacing_s)
            prior[k : k + 2, k : k + 2] += information * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return prior


def moved(axis: FloatArray, tangent: FloatArray) -> FloatArray:
    """Move unit axes (..., 3) along their tangents (..., 2), rad in `joint_frame`, and renormalise them."""
    x, y = joint_frame(axis)
    there = axis + tangent[..., :1] * x + tangent[..., 1:] * y
    moved_there: FloatArray = there / np.linalg.norm(there, axis=-1, keepdims=True)
    return moved_there

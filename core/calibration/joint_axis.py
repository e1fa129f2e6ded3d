"""Along which direction of each sensor does the joint bend, and how do the two headings compare?

The relative rate of the two segments points along the joint axis in both sensors, and the axis itself is the same
line seen from both: j1 = R12 j2. The unknowns are the two axes and the relative heading; the heading enters the
relative rate so simply that all headings can be tried at once. Seel et al. 2014 identify the axes from the rates'
lengths alone (eq 6), which needs no heading; on human joints, where the rest of the motion is as large as the
sensors' noise is small, the direction tells more.
"""

from dataclasses import dataclass

import numpy as np

from core.datasets import HEADING_WALK_RAD, Datasets
from core.pair import FAST_RAD_S
from core.rotations import joint_frame, turn_about_vertical
from core.samples import FloatArray, IntArray

SCAN_STEP_RAD = np.deg2rad(5.0)
SCAN_S = 60.0  # over longer stretches one constant heading blurs the minima
MAX_SCAN_SAMPLES = 800
KEPT_MINIMA = 3
RATE_SCALE_RAD_S = 0.3  # off-axis rate of a human joint
NEUTRAL_SCALE_RAD = np.deg2rad(5.0)  # how far the two axes part in a human joint
CORRELATION_S = 0.5  # residuals nearer in time tell nothing new
MAX_AXIS_STEP_RAD = 0.4
MIN_STEP_RAD = 1e-5  # nothing is told so finely


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
    return Candidates(*(np.concatenate([getattr(one, name) for one in many]) for name in Candidates.__slots__))


def candidates(data: Datasets, few: Datasets, stretch: int) -> Candidates:
    """Axes and headings under which little of the relative rate is off axis, and their mirror pairings.

    The relative rate is w(d) = cos d A + sin d B + C, so six 3x3 moments give its scatter at every heading d. At each
    of the best minima the axes are the principal directions; the opposite pairing of the two axes is a candidate as
    well.

    Parameters
    ----------
    few
        Some of the same samples, enough to tell the headings of all stretches from the axes.
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
    """Heading knots (c, k) under which the axes (c, 3) of both sensors point the same way, in closed form."""
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
    """Share (n, k) that each knot has in the heading of each sample."""
    weights = np.zeros((len(data), data.knots))
    row = np.arange(len(data))
    weights[row, data.knot_left] = 1 - data.knot_share
    weights[row, np.minimum(data.knot_left + 1, data.knots - 1)] += data.knot_share
    return weights


@dataclass(frozen=True, slots=True)
class Residuals:
    """Three groups of residuals per candidate and sample and their slopes.

    `value` (c, n, 7): off-axis relative rate seen from sensor 1 (2) and from sensor 2 (2), parting of the axes (3),
    each over its scale. `by_axes` (c, n, 7, 4): slopes by the two tangent coordinates of each axis; `by_heading` (c,
    n, 7).
    """

    value: FloatArray
    by_axes: FloatArray
    by_heading: FloatArray


GROUPS = (slice(0, 2), slice(2, 4), slice(4, 7))


def residuals(
    data: Datasets, axis_1: FloatArray, axis_2: FloatArray, heading: FloatArray, rate_scale: float, neutral_scale: float
) -> Residuals:
    """Residuals at axes (c, 3) and headings (c, n)."""
    x1, y1 = joint_frame(axis_1)
    x2, y2 = joint_frame(axis_2)
    seen_1 = _in_earth(data.earth_from_1, np.stack([x1, y1, axis_1]))
    seen_2 = _in_earth(data.earth_from_2, np.stack([x2, y2, axis_2]))
    seen_2 = turn_about_vertical(heading, seen_2)  # now in the earth of sensor 1
    rate_1 = (data.earth_from_1 @ data.g1[..., None])[..., 0]
    rate_2 = turn_about_vertical(heading, (data.earth_from_2 @ data.g2[..., None])[..., 0][None])
    relative = rate_2 - rate_1
    value = np.empty((*heading.shape, 7))
    by_axes = np.zeros((*heading.shape, 7, 4))
    by_heading = np.empty((*heading.shape, 7))
    rate_weight = 1 / (np.sqrt(2) * rate_scale)
    along_1 = np.sum(relative * seen_1[2], axis=-1)
    along_2 = np.sum(relative * seen_2[2], axis=-1)
    for k in range(2):
        value[..., k] = np.sum(relative * seen_1[k], axis=-1) * rate_weight
        by_axes[..., k, k] = -along_1 * rate_weight
        by_heading[..., k] = _turned_component(rate_2, seen_1[k]) * rate_weight
        value[..., 2 + k] = np.sum(relative * seen_2[k], axis=-1) * rate_weight
        by_axes[..., 2 + k, 2 + k] = -along_2 * rate_weight
        by_heading[..., 2 + k] = -_turned_component(seen_2[k], rate_1) * rate_weight
        by_axes[..., 4:7, k] = seen_1[k] / neutral_scale
        by_axes[..., 4:7, 2 + k] = -seen_2[k] / neutral_scale
    value[..., 4:7] = (seen_1[2] - seen_2[2]) / neutral_scale
    by_heading[..., 4] = seen_2[2][..., 1] / neutral_scale
    by_heading[..., 5] = -seen_2[2][..., 0] / neutral_scale
    by_heading[..., 6] = 0.0
    return Residuals(value, by_axes, by_heading)


def _in_earth(earth_from: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors (k, c, 3) of a sensor as its earth sees them at each of n instants, (k, c, n, 3)."""
    k, c = vectors.shape[:2]
    seen = earth_from.reshape(-1, 3) @ vectors.reshape(-1, 3).T
    return np.ascontiguousarray(seen.T).reshape(k, c, -1, 3)


def _turned_component(turning: FloatArray, fixed: FloatArray) -> FloatArray:
    """Derivative of (Rz v) . fixed by the heading, where `turning` = Rz v."""
    slope: FloatArray = turning[..., 0] * fixed[..., 1] - turning[..., 1] * fixed[..., 0]
    return slope


def loss_and_weights(value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Robust loss 2 (sqrt(1 + r^2) - 1) per sample (c, n), and the weight (c, n, 7) each residual has in it."""
    weights = np.empty_like(value)
    loss = np.zeros(value.shape[:-1])
    for group in GROUPS:
        root = np.sqrt(1 + np.sum(value[..., group] ** 2, axis=-1))
        loss += 2 * (root - 1)
        weights[..., group] = (1 / root)[..., None]
    return loss, weights


def polish(
    data: Datasets,
    start: Candidates,
    steps: int,
    rate_scale: float = RATE_SCALE_RAD_S,
    neutral_scale: float = NEUTRAL_SCALE_RAD,
    is_axis_fixed: bool = False,
) -> Candidates:
    """Gauss-Newton on axes and heading knots of every candidate at once."""
    axis_1, axis_2, knots = start.axis_1, start.axis_2, start.knots_rad
    weights_of_knots = knot_weights(data)
    information = sample_information(data)
    prior = heading_prior(data)
    for _ in range(steps):
        r = residuals(data, axis_1, axis_2, data.heading(knots), rate_scale, neutral_scale)
        _, weight = loss_and_weights(r.value)
        step = _step(r, weight * information, weights_of_knots, prior, knots, is_axis_fixed)
        axis_1, axis_2 = moved(axis_1, step[:, :2]), moved(axis_2, step[:, 2:4])
        knots = knots + step[:, 4:]
        if np.max(np.abs(step)) < MIN_STEP_RAD:
            break
    r = residuals(data, axis_1, axis_2, data.heading(knots), rate_scale, neutral_scale)
    cost = loss_and_weights(r.value)[0].mean(axis=1)
    return Candidates(axis_1, axis_2, knots, cost)


def _step(
    r: Residuals, weight: FloatArray, knot_shares: FloatArray, prior: FloatArray, knots: FloatArray, is_axis_fixed: bool
) -> FloatArray:
    c, k = len(knots), knots.shape[1]
    weighted_heading = weight * r.by_heading
    matrix = np.zeros((c, 4 + k, 4 + k))
    matrix[:, :4, :4] = np.einsum("cnr,cnri,cnrj->cij", weight, r.by_axes, r.by_axes, optimize=True)
    mixed = np.einsum("cnr,cnri->cin", weighted_heading, r.by_axes) @ knot_shares
    matrix[:, :4, 4:] = mixed
    matrix[:, 4:, :4] = np.swapaxes(mixed, 1, 2)
    bend = np.sum(weighted_heading * r.by_heading, axis=-1)
    matrix[:, 4:, 4:] = (knot_shares.T[None] * bend[:, None, :]) @ knot_shares + prior
    slope = np.zeros((c, 4 + k))
    slope[:, :4] = np.einsum("cnr,cnri->ci", weight * r.value, r.by_axes)
    slope[:, 4:] = np.sum(weighted_heading * r.value, axis=-1) @ knot_shares + knots @ prior
    if is_axis_fixed:
        matrix[:, :4, :] = matrix[:, :, :4] = 0.0
        slope[:, :4] = 0.0
    diagonal = np.arange(4 + k)
    matrix[:, diagonal, diagonal] += 1e-6 * (1 + matrix[:, diagonal, diagonal])
    step: FloatArray = -np.linalg.solve(matrix, slope[..., None])[..., 0]
    length = np.linalg.norm(step[:, :4], axis=1, keepdims=True)
    return step * np.minimum(1.0, MAX_AXIS_STEP_RAD / np.maximum(length, 1e-12))


def sample_information(data: Datasets) -> float:
    """What one sample tells, where neighbours within the correlation time tell the same."""
    if len(data) < 2:
        return 1.0
    same = data.stretch[1:] == data.stretch[:-1]
    spacing_s = float(np.median(np.diff(data.time_s)[same])) if same.any() else CORRELATION_S
    return min(1.0, spacing_s / CORRELATION_S)


def heading_prior(data: Datasets) -> FloatArray:
    """Information matrix (k, k) of the headings' random walk between neighbouring knots."""
    prior = np.zeros((data.knots, data.knots))
    for k, spacing_s in enumerate(data.knot_spacing_s):
        if np.isfinite(spacing_s):
            information = 1 / (HEADING_WALK_RAD**2 * spacing_s)
            prior[k : k + 2, k : k + 2] += information * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return prior


def moved(axis: FloatArray, tangent: FloatArray) -> FloatArray:
    """Axes (c, 3) moved along their own tangent coordinates (c, 2) and back to unit length."""
    x, y = joint_frame(axis)
    there = axis + tangent[:, :1] * x + tangent[:, 1:] * y
    return there / np.linalg.norm(there, axis=1, keepdims=True)

"""Axes of a joint for every relative heading there could be, and which headings fit.

The relative rate of two segments and the accelerations of their joint depend on the relative heading d only through
cos d, sin d and a constant, so a few sums over the samples hold what all headings say. The offline identification
decides among a few candidates by the same two costs, robustly and over each sample.
"""

from dataclasses import dataclass

import numpy as np

from core.calibration.coincidence import BIAS_PRIOR_M_S2, CENTRE_PRIOR_M, SCALE_M_S2
from core.calibration.identify import ACCELERATION_COST_FLOOR, RIVAL_HEADING_RAD
from core.calibration.joint_axis import NEUTRAL_SCALE_RAD, RATE_SCALE_RAD_S
from core.live.sample_sets import Sets, parabola
from core.samples import FloatArray
from core.signal.rotations import cross_matrix, wrap

STEP_RAD = np.deg2rad(7.5)
HEADINGS = np.arange(0.0, 2 * np.pi, STEP_RAD)
# A heading r times as costly as the best counts r^-2.7: at the offline margin of doubt, 1.3, half as much as the best.
COST_EXPONENT = 2.7
NEAR_RAD = np.deg2rad(30.0)  # within, headings are distinguished by the information about the axes, not by their costs


@dataclass(frozen=True, slots=True)
class HeadingProfile:
    """The best hypothesis, and how far it is in doubt.

    `axis_1`, `axis_2`: (3,): in sensor axes.
    `spread_1_rad`, `spread_2_rad`: root mean square of the angles to the axes that other headings give, each weighted
    by how well it fits.
    `bending_rad_s`: root mean square of the relative rate at the heading that leaves least of it: nothing in a joint
    held stiff.
    """

    heading_rad: float  # of the distal earth in the proximal one
    axis_1: FloatArray
    axis_2: FloatArray
    across: FloatArray  # (6, 6): takes from two vectors, one in each sensor, what lies along the axes
    spread_1_rad: float
    spread_2_rad: float
    margin: float  # cost of the best rival, a heading elsewhere or the opposite pairing, over the cost of the best
    bending_rad_s: float


def profile_headings(sets: Sets, lag_s: float) -> HeadingProfile:
    """Try all headings on all sets, the distal lag corrected."""
    rate_1, rate_2 = sets.rates_in_earth(lag_s)
    to_1, to_2 = sets.earth_from_1, sets.earth_from_2 @ (np.eye(3) - lag_s * cross_matrix(sets.g2))
    scatter_1 = _scatter(to_1, rate_2, -rate_1, 1.0)
    scatter_2 = _scatter(to_2, -rate_1, rate_2, -1.0)
    spread_1, directions_1 = np.linalg.eigh(scatter_1)
    spread_2, directions_2 = np.linalg.eigh(scatter_2)
    axes_1, axes_2 = directions_1[:, :, 2], directions_2[:, :, 2]
    rotations = _mean_rotations(to_1, to_2)
    alike = np.sum((axes_1[:, None, :] @ rotations)[:, 0] * axes_2, axis=1)
    axes_2 = axes_2 * np.where(alike < 0, -1.0, 1.0)[:, None]
    off_axis = spread_1[:, :2].sum(axis=1) + spread_2[:, :2].sum(axis=1)
    rates = _rate_cost(off_axis, np.abs(alike))
    share, _ = parabola(lag_s)
    one = _equations(to_1, sets.k1, sets.a1)
    two = _equations(to_2, np.tensordot(sets.k2, share, (1, 0)), np.tensordot(sets.a2, share, (1, 0)))
    forces = np.log(_force_cost(one, two) + ACCELERATION_COST_FLOOR)
    cost = np.log(rates) + forces
    best = int(np.argmin(cost))
    axis_1, axis_2 = axes_1[best], axes_2[best]

    apart = np.abs(wrap(HEADINGS - HEADINGS[best]))
    weight = np.exp(-COST_EXPONENT * (cost - cost[best]))
    is_far = apart > NEAR_RAD
    spreads = [_spread(axes, best, weight, is_far) for axes in (axes_1, axes_2)]

    is_minimum = (rates <= np.roll(rates, 1)) & (rates < np.roll(rates, -1))
    rivals = cost[is_minimum & (apart > RIVAL_HEADING_RAD)].tolist()
    aligned = axis_1 @ rotations @ -axis_2
    across = int(np.argmax(aligned))
    along = axis_1 @ scatter_1[across] @ axis_1 + axis_2 @ scatter_2[across] @ axis_2
    total = np.trace(scatter_1[across]) + np.trace(scatter_2[across])
    opposite = np.log(_rate_cost(total - along, aligned[across])) + forces[across]
    margin = float(np.exp(min([*rivals, float(opposite)]) - cost[best]))
    bending = float(np.sqrt(spread_1.sum(axis=1).min()))
    keep = np.eye(6)
    keep[:3, :3] -= np.outer(axis_1, axis_1)
    keep[3:, 3:] -= np.outer(axis_2, axis_2)
    return HeadingProfile(float(HEADINGS[best]), axis_1, axis_2, keep, spreads[0], spreads[1], margin, bending)


def _spread(axes: FloatArray, best: int, weight: FloatArray, is_far: FloatArray) -> float:
    angle = np.arccos(np.clip(np.abs(axes @ axes[best]), 0.0, 1.0))
    return float(np.sqrt(np.sum((weight * angle**2)[is_far]) / np.sum(weight)))


def _rate_cost(off_axis: FloatArray | float, alike: FloatArray | float) -> FloatArray:
    """Cost of the mean square rate across both axes, and of the axes' mean parting 2 - 2 j1.R12 j2."""
    return _loss(0.5 * off_axis / RATE_SCALE_RAD_S**2) + _loss((2 - 2 * alike) / NEUTRAL_SCALE_RAD**2) + 1e-9


def _loss(mean_square: FloatArray | float) -> FloatArray:
    """The robust loss of the offline cost, of the mean square instead of each sample."""
    return 2 * (np.sqrt(1 + np.maximum(mean_square, 0.0)) - 1)


def _scatter(earth_from: FloatArray, turned: FloatArray, fixed: FloatArray, sense: float) -> FloatArray:
    """Second moments (h, 3, 3) in sensor axes of Rz(sense d) turned + fixed, vectors (n, 3) given in earth axes."""
    flat, across = turned * [1.0, 1.0, 0.0], np.zeros_like(turned)
    across[:, 0], across[:, 1] = -turned[:, 1], turned[:, 0]
    rest = fixed + turned * [0.0, 0.0, 1.0]
    parts = np.stack([flat, across, rest], axis=1) @ earth_from  # rows turned into the sensor
    parts = parts.reshape(len(turned), 9)
    moments = (parts.T @ parts / len(turned)).reshape(3, 3, 3, 3)
    weights = np.stack([np.cos(HEADINGS), sense * np.sin(HEADINGS), np.ones_like(HEADINGS)])
    pairs = (weights[:, None] * weights).reshape(9, -1)
    scatter: FloatArray = (pairs.T @ moments.transpose(0, 2, 1, 3).reshape(9, 9)).reshape(-1, 3, 3)
    return scatter


def _mean_rotations(to_1: FloatArray, to_2: FloatArray) -> FloatArray:
    """Mean relative rotation R1' Rz(d) R2 at each heading, (h, 3, 3)."""
    moments = (to_1.reshape(-1, 9).T @ to_2.reshape(-1, 9)) / len(to_1)
    moments = moments.reshape(3, 3, 3, 3)  # [earth 1, sensor 1, earth 2, sensor 2]
    even = moments[0, :, 0] + moments[1, :, 1]
    odd = moments[1, :, 0] - moments[0, :, 1]
    turned: FloatArray = np.cos(HEADINGS)[:, None, None] * even + np.sin(HEADINGS)[:, None, None] * odd
    return turned + moments[2, :, 2]


def _force_cost(one: FloatArray, two: FloatArray) -> FloatArray:
    """How badly the accelerations of the joint coincide (h,), centres and biases fitted to each heading."""
    # with E = R [K, 1, a] (n, 3, 7) of each sensor, a1 - b1 - K1 o1 = Rz(d) (a2 - b2 - K2 o2) in earth axes is linear
    # in the unknowns, and its normal equations are sums of products of the two E
    flat_1, flat_2 = one[:, 0] + 1j * one[:, 1], two[:, 0] + 1j * two[:, 1]
    turned = np.real(np.exp(1j * HEADINGS)[:, None, None] * (np.conj(flat_1).T @ flat_2))
    mixed = turned + one[:, 2].T @ two[:, 2]
    own_1, own_2 = (rows.T @ rows for rows in (one.reshape(-1, 7), two.reshape(-1, 7)))
    matrix = np.empty((len(HEADINGS), 12, 12))
    matrix[:, :6, :6], matrix[:, 6:, 6:] = own_1[:6, :6], own_2[:6, :6]
    matrix[:, :6, 6:], matrix[:, 6:, :6] = -mixed[:, :6, :6], -np.swapaxes(mixed[:, :6, :6], 1, 2)
    right = np.concatenate([own_1[:6, 6] - mixed[:, :6, 6], own_2[:6, 6] - mixed[:, 6, :6]], axis=1)
    prior = np.repeat([CENTRE_PRIOR_M, BIAS_PRIOR_M_S2, CENTRE_PRIOR_M, BIAS_PRIOR_M_S2], 3) ** -2.0 * SCALE_M_S2**2
    x = np.linalg.solve(matrix + np.diag(prior), right[:, :, None])[:, :, 0]
    left = own_1[6, 6] + own_2[6, 6] - 2 * mixed[:, 6, 6] - np.sum(x * right, axis=1) - (x**2) @ prior
    return _loss(left / len(one) / SCALE_M_S2**2)


def _equations(earth_from: FloatArray, k: FloatArray, a: FloatArray) -> FloatArray:
    """R [K, 1, a], (n, 3, 7)."""
    inner = np.empty((len(k), 3, 7))
    inner[:, :, 0:3], inner[:, :, 3:6], inner[:, :, 6] = k, np.eye(3), a
    return earth_from @ inner

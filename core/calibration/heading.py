"""Relative heading of the two orientation filters over a recording, once the axes are known."""

import numpy as np

from core.calibration.joint_axis import (
    MIN_STEP_RAD,
    NEUTRAL_SCALE_RAD,
    RATE_SCALE_RAD_S,
    SCAN_STEP_RAD,
    Candidates,
    heading_from_axes,
    heading_prior,
    in_earth,
    loss_and_weights,
    residuals,
    sample_information,
)
from core.samples import BoolArray, FloatArray, IntArray
from core.signal.datasets import Datasets, gather, knot_positions, knot_products, knot_sums
from core.signal.pair import Pair, lever_acceleration
from core.signal.robust import robust_sd

SAMPLES_PER_S = 10.0  # residuals are correlated over half a second
STEPS = 6
MIN_RATE_SCALE_RAD_S = 0.01
MIN_NEUTRAL_SCALE_RAD = np.deg2rad(0.3)

# An axis that is upright (lying on the side, seated sideways) shows no heading; then the accelerations of the joint
# have to. On horizontal axes they do slightly more harm than good.
STEEP_RAD = np.deg2rad(58.0)
MIN_FORCE_SCALE_M_S2 = 0.15
FORCE_CORRELATION_S = 0.1


def heading_over(pair: Pair, axis_1: FloatArray, axis_2: FloatArray, unknowns: FloatArray) -> FloatArray:
    """Give the heading (n,) of the distal earth in the proximal one, rad; `unknowns` (12,) in m and m/s2."""
    data = _spread(pair, pair.is_known)
    if len(data) < 10:
        data = _spread(pair, np.ones(len(pair), dtype=bool))
    knots = heading_from_axes(data, axis_1[None], axis_2[None])[0]
    elevation = np.arcsin(np.clip(np.abs((data.earth_from_1 @ axis_1)[:, 2]), 0.0, 1.0))
    forces = None
    if np.median(elevation) > STEEP_RAD and np.isfinite(data.dg1).all() and np.isfinite(data.dg2).all():
        forces = _horizontal_forces(data, unknowns)
        knots = _scanned(forces, data.knots)
    knots = _fitted(data, axis_1, axis_2, forces, knots)
    intervals, position = knot_positions(pair)
    return np.interp(position, np.arange(intervals + 1), knots)


def _spread(pair: Pair, is_used: BoolArray) -> Datasets:
    index: IntArray = np.flatnonzero(is_used)
    stride = max(1, round(1 / (SAMPLES_PER_S * pair.step_s)))
    return gather((pair,), [index[::stride]])


Forces = tuple[FloatArray, FloatArray]
"""Specific force of the joint as both sensors feel it, horizontal part in their own earths, as (n,) complex numbers."""


def _horizontal_forces(data: Datasets, x: FloatArray) -> Forces:
    one = data.a1 - x[6:9] - lever_acceleration(data.g1, data.dg1, x[0:3])
    two = data.a2 - x[9:12] - lever_acceleration(data.g2, data.dg2, x[3:6])
    earth = [np.einsum("nij,nj->ni", r, v) for r, v in ((data.earth_from_1, one), (data.earth_from_2, two))]
    return earth[0][:, 0] + 1j * earth[0][:, 1], earth[1][:, 0] + 1j * earth[1][:, 1]


def _scanned(forces: Forces, knots: int) -> FloatArray:
    """The constant heading under which the two forces differ least."""
    trial = np.arange(0.0, 2 * np.pi, SCAN_STEP_RAD)
    difference = np.abs(forces[0] - np.exp(1j * trial)[:, None] * forces[1])
    cost = np.sqrt(1 + (difference / MIN_FORCE_SCALE_M_S2) ** 2).mean(axis=1)
    return np.full(knots, trial[np.argmin(cost)])


def _fitted(
    data: Datasets, axis_1: FloatArray, axis_2: FloatArray, forces: Forces | None, knots: FloatArray
) -> FloatArray:
    prior, information = heading_prior(data), sample_information(data)
    knots_of = data.knot_left, data.knot_share
    known = in_earth(data)
    rate_scale, neutral_scale = RATE_SCALE_RAD_S, NEUTRAL_SCALE_RAD
    for step in range(STEPS):
        heading = data.heading(knots)
        r = residuals(data, axis_1[None], axis_2[None], heading[None], rate_scale, neutral_scale, known)
        weight = loss_and_weights(r.value)[1][0] * information
        slope = np.sum(weight * r.by_heading[0] * r.value[0], axis=1)
        bend = np.sum(weight * r.by_heading[0] ** 2, axis=1)
        if forces is not None:
            by_force = _force_terms(data, forces, heading)
            slope, bend = slope + by_force[0], bend + by_force[1]
        matrix = knot_products(*knots_of, bend, data.knots) + prior
        matrix += 1e-6 * (1 + np.trace(matrix) / len(matrix)) * np.eye(len(matrix))
        change = np.linalg.solve(matrix, knot_sums(*knots_of, slope, data.knots) + prior @ knots)
        knots = knots - change
        if step >= STEPS // 2 and np.max(np.abs(change)) < MIN_STEP_RAD:
            break
        if step == STEPS // 2 - 1:
            fit = Candidates(axis_1[None], axis_2[None], knots[None], np.zeros(1))
            rate_scale, neutral_scale = residual_scales(data, fit)
    return knots


def _force_terms(data: Datasets, forces: Forces, heading: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Slope and bend (n,) of the robust cost of |f1 - Rz f2| by the heading."""
    turned = np.exp(1j * heading) * forces[1]
    error = forces[0] - turned
    scale = max(robust_sd(np.concatenate([error.real, error.imag])), MIN_FORCE_SCALE_M_S2)
    spacing_s = float(np.median(np.diff(data.time_s)))
    weight = min(1.0, spacing_s / FORCE_CORRELATION_S) / (scale**2 * np.sqrt(1 + np.abs(error) ** 2 / scale**2))
    return weight * np.real(np.conj(error) * (-1j * turned)), weight * np.abs(turned) ** 2


def residual_scales(data: Datasets, fit: Candidates) -> tuple[float, float]:
    """Give robust spreads of the off-axis rate, rad/s, and of the axes' parting, rad, for candidate 0."""
    r = residuals(data, fit.axis_1, fit.axis_2, data.heading(fit.knots_rad), RATE_SCALE_RAD_S, NEUTRAL_SCALE_RAD)
    rate = robust_sd(r.value[0, :, :4]) * np.sqrt(2) * RATE_SCALE_RAD_S
    neutral = robust_sd(r.value[0, :, 4:]) * NEUTRAL_SCALE_RAD
    return max(rate, MIN_RATE_SCALE_RAD_S), max(neutral, MIN_NEUTRAL_SCALE_RAD)

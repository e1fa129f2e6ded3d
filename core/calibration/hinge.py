"""Test for a true hinge, whose axis the published constraint finds best from a good start.

On a hinge the rates of both sensors have the same length across the axis (Seel et al. 2014, doi 10.3390/s140406891,
eqs 3 and 6), whatever the headings. On a human joint that length is biased by everything else that moves, so it is
never used there.
"""

import numpy as np

from core.calibration.coincidence import BIAS_PRIOR_M_S2
from core.calibration.joint_axis import moved
from core.samples import FloatArray
from core.signal.datasets import Datasets
from core.signal.pair import is_turning, lever_acceleration
from core.signal.robust import robust_sd
from core.signal.rotations import angle_between, joint_frame

# Both of the samples at which the segments turn (`turning`), of which there have to be some
MAX_HINGE_RESIDUAL_RAD_S = 0.06  # mechanical hinges 0.02, human joints 0.07 to 1.0
MAX_OFF_AXIS_RAD_S = 0.05  # mechanical hinges 0.025, simulated 0.01 to 0.02; people 0.07 and more in walking
MIN_TURNING_SAMPLES = 50
ACCELERATION_WEIGHT_S_M = 0.15  # rad/s per m/s2
MIN_SCALE_RAD_S = 0.002
MAX_MOVE_RAD = np.deg2rad(11.0)  # farther from the start it is another minimum
STEPS = 8
MIN_STEP = 1e-5


def turning(data: Datasets, count: int) -> Datasets:
    """About `count` of the samples at which the segments turn."""
    fast = np.flatnonzero(is_turning(data.g1, data.g2))
    few = np.linspace(0, len(fast) - 1, min(count, len(fast))).astype(np.int64)
    return data.only(fast[few])


def in_plane_difference(data: Datasets, axis_1: FloatArray, axis_2: FloatArray) -> FloatArray:
    """Compute |g1 x j1| - |g2 x j2| (n,), 0 on a hinge (Seel et al. 2014, doi 10.3390/s140406891, eq 3)."""
    return _in_plane_length(data.g1, axis_1) - _in_plane_length(data.g2, axis_2)


def _in_plane_length(rate: FloatArray, axis: FloatArray) -> FloatArray:
    """|g x j| (n,)."""
    in_plane = rate @ np.stack(joint_frame(axis), axis=1)
    return np.asarray(np.sqrt(in_plane[:, 0] ** 2 + in_plane[:, 1] ** 2))


def hinge_residual(data: Datasets, axis_1: FloatArray, axis_2: FloatArray) -> float:
    """Give the spread of `in_plane_difference`, rad/s, by which a joint is called a hinge."""
    return robust_sd(in_plane_difference(data, axis_1, axis_2))


def hinge_axes(
    data: Datasets, axis_1: FloatArray, axis_2: FloatArray, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Fit both axes (3,) by eq 6 and equal acceleration along the axis; None where they move too far.
    Also gives (n, 2, 5): slopes of both residuals by the four tangent coordinates and, last, the residuals,
    all scaled.
    """
    shifted_1 = data.a1 - unknowns[6:9] - lever_acceleration(data.g1, data.dg1, unknowns[0:3])
    shifted_2 = data.a2 - unknowns[9:12] - lever_acceleration(data.g2, data.dg2, unknowns[3:6])
    j1, j2 = axis_1, axis_2
    bias = 0.0
    for _ in range(STEPS):
        value, slope = _residuals(data, shifted_1, shifted_2, j1, j2)
        value[:, 1] -= bias
        scale = np.array([max(robust_sd(value[:, k]), MIN_SCALE_RAD_S) for k in range(2)])
        value, slope = value / scale, slope / scale[:, None]
        weight = 1 / np.sqrt(1 + value**2)
        weighted = (slope * weight[..., None]).reshape(-1, 5)
        information = weighted.T @ slope.reshape(-1, 5) + 1e-9 * np.eye(5)
        information[4, 4] += (ACCELERATION_WEIGHT_S_M * BIAS_PRIOR_M_S2) ** -2
        score = value.ravel() @ weighted
        score[4] += bias * (ACCELERATION_WEIGHT_S_M * BIAS_PRIOR_M_S2) ** -2
        step = -np.linalg.solve(information, score)
        j1, j2 = moved(j1[None], step[None, :2])[0], moved(j2[None], step[None, 2:4])[0]
        bias += step[4]
        if np.max(np.abs(step)) < MIN_STEP:
            break
    if max(angle_between(j1, axis_1), angle_between(j2, axis_2)) > MAX_MOVE_RAD:
        return None
    return j1, j2, np.concatenate([slope[..., :4], value[..., None]], axis=2)


def _residuals(
    data: Datasets, shifted_1: FloatArray, shifted_2: FloatArray, j1: FloatArray, j2: FloatArray
) -> tuple[FloatArray, FloatArray]:
    value = np.empty((len(data), 2))
    slope = np.zeros((len(data), 2, 5))
    value[:, 1] = ACCELERATION_WEIGHT_S_M * (shifted_1 @ j1 - shifted_2 @ j2)
    slope[:, 1, 4] = -1.0
    value[:, 0] = 0.0
    for sign, rate, shifted, axis, at in ((1, data.g1, shifted_1, j1, 0), (-1, data.g2, shifted_2, j2, 2)):
        tangents = np.stack(joint_frame(axis), axis=1)
        in_plane = rate @ tangents
        length = np.sqrt(in_plane[:, 0] ** 2 + in_plane[:, 1] ** 2)
        value[:, 0] += sign * length
        slope[:, 0, at : at + 2] = (-sign * (rate @ axis) / np.maximum(length, 1e-6))[:, None] * in_plane
        slope[:, 1, at : at + 2] = sign * ACCELERATION_WEIGHT_S_M * (shifted @ tangents)
    return value, slope

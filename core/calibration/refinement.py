"""One fit over everything that holds on a rigid limb: angle, centres and accelerometer biases together.

The orientation filter leans on the accelerometers, so a bias tilts it, and the centre found under a tilted
orientation is off in turn. On a true hinge the relative rotation is one angle, and that angle is the rates' integral
but for a slow drift: with the drift among the unknowns nothing leans on the filter any more.
"""

import numpy as np

from core.angles.hinge_angle import DRIFT_WALK_RAD, hinge_angle
from core.calibration.coincidence import CENTRE_PRIOR_M, force_design
from core.calibration.joint_axis import knot_weights
from core.calibration.joint_centre import MIN_SCALE_M_S2, JointCentre
from core.samples import FloatArray
from core.signal.datasets import Datasets
from core.signal.pair import lever_matrix
from core.signal.robust import robust_sd
from core.signal.rotations import joint_frame

BIAS_PRIOR_M_S2 = 0.1
STEPS = 6
MIN_STEP = 1e-5
_OF_SENSOR_2 = [3, 4, 5, 9, 10, 11]  # which of the unknowns are
MAX_CENTRE_STEP_M = 0.05  # a larger move means that the start was wrong, and the fit is not believed


def refine_on_hinge(data: Datasets, j1: FloatArray, j2: FloatArray, start: JointCentre) -> JointCentre | None:
    """Refine a hinge's centres and biases (m, m/s2) from `start`; None where the fit diverges.
    Residual a1 - b1 - K1 o1 - R12(theta) (a2 - b2 - K2 o2): vector form of Seel et al. 2014, eq 7, theta
    from eq 11 plus a line between knots.
    """
    theta = np.concatenate(
        [hinge_angle(pair, j1, j2, start.unknowns)[data.index[data.stretch == s]] for s, pair in enumerate(data.pairs)]
    )
    # in the axes of the hinge, where the turn is one about z
    terms_1, terms_2 = _terms(data.g1, data.dg1, data.a1, j1), _terms(data.g2, data.dg2, data.a2, j2)
    shares, n = knot_weights(data), len(data)
    x, knots = start.unknowns.copy(), np.zeros(data.knots)
    prior = _prior(data)
    information = np.empty((12 + data.knots, 12 + data.knots))
    for _ in range(STEPS):
        design = force_design(terms_1, terms_2, (theta + shares @ knots)[None])[0]
        error = design[12] - np.tensordot(x, design[:12], 1)
        scale = max(robust_sd(error), MIN_SCALE_M_S2)
        weight = 1 / (scale**2 * np.sqrt(1 + np.sum(error**2, axis=0) / scale**2))
        force_2 = np.tensordot(x[_OF_SENSOR_2], design[_OF_SENSOR_2], 1) + terms_1[6] - design[12]
        by_angle = np.stack([-force_2[1], force_2[0]])
        weighted = (design[:12] * weight).reshape(12, 3 * n)
        weighted_angle = by_angle * weight
        mixed = np.sum(weighted_angle * design[:12, :2], axis=1) @ shares
        information[:12, :12] = weighted @ design[:12].reshape(12, 3 * n).T
        information[:12, 12:], information[12:, :12] = mixed, mixed.T
        information[12:, 12:] = shares.T @ (shares * np.sum(weighted_angle * by_angle, axis=0)[:, None])
        information += prior
        push = [weighted @ error.ravel(), np.sum(weighted_angle * error[:2], axis=0) @ shares]
        step = np.linalg.solve(information, np.concatenate(push) - prior @ np.concatenate([x, knots]))
        x, knots = x + step[:12], knots + step[12:]
        if np.max(np.abs(step)) < MIN_STEP:
            break
    if np.max(np.abs(x[:6] - start.unknowns[:6])) > MAX_CENTRE_STEP_M:
        return None
    return JointCentre(x, np.linalg.inv(information)[:12, :12])


def _terms(rate: FloatArray, angular_acceleration: FloatArray, force: FloatArray, axis: FloatArray) -> FloatArray:
    """K, unity and the specific force (7, 3, n) of a sensor, in the axes of the hinge."""
    frame = np.stack([*joint_frame(axis), axis])
    terms = np.empty((7, 3, len(rate)))
    terms[0:3] = (frame @ lever_matrix(rate, angular_acceleration)).T
    terms[3:6] = frame.T[..., None]
    terms[6] = frame @ force.T
    return terms


def _prior(data: Datasets) -> FloatArray:
    prior = np.zeros((12 + data.knots, 12 + data.knots))
    prior[np.arange(12), np.arange(12)] = [CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6
    for k, spacing_s in enumerate(data.knot_spacing_s):
        if np.isfinite(spacing_s):
            information = 1 / (DRIFT_WALK_RAD**2 * spacing_s)
            prior[12 + k : 14 + k, 12 + k : 14 + k] += information * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return prior

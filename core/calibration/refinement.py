"""One fit over everything that holds on a rigid limb: angle, centres and accelerometer biases together.

The orientation filter leans on the accelerometers, so a bias tilts it, and the centre found under a tilted
orientation is off in turn. On a true hinge the relative rotation is one angle, and that angle is the rates' integral
but for a slow drift: with the drift among the unknowns nothing leans on the filter any more.
"""

import numpy as np

from core.angles.hinge_angle import DRIFT_WALK_RAD, hinge_angle
from core.calibration.coincidence import CENTRE_PRIOR_M, turned_about_vertical
from core.calibration.joint_axis import knot_weights
from core.calibration.joint_centre import MIN_SCALE_M_S2, JointCentre
from core.datasets import Datasets
from core.pair import lever_matrix
from core.robust import robust_sd
from core.rotations import joint_frame
from core.samples import FloatArray

BIAS_PRIOR_M_S2 = 0.1
STEPS = 6
MIN_STEP = 1e-5
MAX_CENTRE_STEP_M = 0.05  # a larger move means that the start was wrong, and the fit is not believed


def refine_on_hinge(data: Datasets, j1: FloatArray, j2: FloatArray, start: JointCentre) -> JointCentre | None:
    """Centres and biases of a hinge with axes (3,), from the first guess `start`; None where the fit runs away.

    The residual is a1 - b1 - K1 o1 - R12(theta) (a2 - b2 - K2 o2), the vector form of Seel et al. 2014, eq 7, with
    theta from eq 11 plus a line between knots.
    """
    theta = np.concatenate(
        [hinge_angle(pair, j1, j2, start.unknowns)[data.index[data.stretch == s]] for s, pair in enumerate(data.pairs)]
    )
    # in the axes of the hinge, where the turn is one about z
    terms_1, terms_2 = _terms(data.g1, data.dg1, data.a1, j1), _terms(data.g2, data.dg2, data.a2, j2)
    shares = knot_weights(data)
    x, knots = start.unknowns.copy(), np.zeros(data.knots)
    prior = _prior(data)
    information = np.empty((12 + data.knots, 12 + data.knots))
    design = np.empty((len(data), 3, 12))
    design[..., 0:3], design[..., 6:9] = terms_1[..., 0:3], terms_1[..., 3:6]
    for _ in range(STEPS):
        turned = turned_about_vertical((theta + shares @ knots)[None], terms_2)[0]
        design[..., 3:6], design[..., 9:12] = -turned[..., 0:3], -turned[..., 3:6]
        force_2 = turned[..., 6] - turned[..., 0:3] @ x[3:6] - turned[..., 3:6] @ x[9:12]
        error = terms_1[..., 6] - terms_1[..., 0:3] @ x[0:3] - terms_1[..., 3:6] @ x[6:9] - force_2
        scale = max(robust_sd(error), MIN_SCALE_M_S2)
        weight = 1 / (scale**2 * np.sqrt(1 + np.sum(error**2, axis=1) / scale**2))
        by_angle = np.stack([-force_2[:, 1], force_2[:, 0]], axis=1)
        weighted = (design * weight[:, None, None]).reshape(-1, 12)
        weighted_angle = by_angle * weight[:, None]
        mixed = (weighted_angle[:, None] @ design[:, :2])[:, 0].T @ shares
        information[:12, :12] = weighted.T @ design.reshape(-1, 12)
        information[:12, 12:], information[12:, :12] = mixed, mixed.T
        information[12:, 12:] = shares.T @ (shares * np.sum(weighted_angle * by_angle, axis=1)[:, None])
        information += prior
        push = [error.ravel() @ weighted, np.sum(weighted_angle * error[:, :2], axis=1) @ shares]
        step = np.linalg.solve(information, np.concatenate(push) - prior @ np.concatenate([x, knots]))
        x, knots = x + step[:12], knots + step[12:]
        if np.max(np.abs(step)) < MIN_STEP:
            break
    if np.max(np.abs(x[:6] - start.unknowns[:6])) > MAX_CENTRE_STEP_M:
        return None
    return JointCentre(x, np.linalg.inv(information)[:12, :12])


def _terms(rate: FloatArray, angular_acceleration: FloatArray, force: FloatArray, axis: FloatArray) -> FloatArray:
    """K, unity and the specific force (n, 3, 7) of a sensor, in the axes of the hinge."""
    frame = np.stack([*joint_frame(axis), axis])
    terms = np.empty((len(rate), 3, 7))
    terms[..., 0:3], terms[..., 3:6] = frame @ lever_matrix(rate, angular_acceleration), frame
    terms[..., 6] = force @ frame.T
    return terms


def _prior(data: Datasets) -> FloatArray:
    prior = np.zeros((12 + data.knots, 12 + data.knots))
    prior[np.arange(12), np.arange(12)] = [CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6
    for k, spacing_s in enumerate(data.knot_spacing_s):
        if np.isfinite(spacing_s):
            information = 1 / (DRIFT_WALK_RAD**2 * spacing_s)
            prior[12 + k : 14 + k, 12 + k : 14 + k] += information * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return prior

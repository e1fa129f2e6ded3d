"""One fit over everything that holds on a rigid limb: angle, centres and accelerometer biases together.

The orientation filter leans on the accelerometers, so a bias tilts it, and the centre found under a tilted
orientation is off in turn. On a true hinge the relative rotation is one angle, and that angle is the rates' integral
but for a slow drift: with the drift among the unknowns nothing leans on the filter any more.
"""

import numpy as np

from core.angles.hinge_angle import DRIFT_WALK_RAD, hinge_angle
from core.calibration.coincidence import CENTRE_PRIOR_M
from core.calibration.joint_axis import knot_weights
from core.calibration.joint_centre import MIN_SCALE_M_S2, JointCentre
from core.datasets import Datasets
from core.pair import lever_matrix
from core.robust import robust_sd
from core.rotations import cross_matrix, joint_frame
from core.samples import FloatArray

BIAS_PRIOR_M_S2 = 0.1
STEPS = 6
MIN_STEP = 1e-6
MAX_CENTRE_STEP_M = 0.05  # a larger move means that the start was wrong, and the fit is not believed


def refine_on_hinge(data: Datasets, j1: FloatArray, j2: FloatArray, start: JointCentre) -> JointCentre | None:
    """Centres and biases of a hinge with axes (3,), from the first guess `start`; None where the fit runs away.

    The residual is a1 - b1 - K1 o1 - R12(theta) (a2 - b2 - K2 o2), the vector form of Seel et al. 2014, eq 7, with
    theta from eq 11 plus a line between knots.
    """
    theta = np.concatenate(
        [hinge_angle(pair, j1, j2, start.unknowns)[data.index[data.stretch == s]] for s, pair in enumerate(data.pairs)]
    )
    lever_1, lever_2 = lever_matrix(data.g1, data.dg1), lever_matrix(data.g2, data.dg2)
    frame_1, frame_2 = (np.stack([*joint_frame(j), j], axis=1) for j in (j1, j2))
    shares = knot_weights(data)
    x, knots = start.unknowns.copy(), np.zeros(data.knots)
    prior = _prior(data)
    design = np.empty((len(data), 3, 12))
    design[..., 0:3], design[..., 6:9] = lever_1, np.eye(3)
    for _ in range(STEPS):
        rotation = _rotation_about(frame_1, frame_2, theta + shares @ knots)
        force_2 = data.a2 - x[9:12] - lever_2 @ x[3:6]
        turned_2 = np.einsum("nij,nj->ni", rotation, force_2)
        error = data.a1 - x[6:9] - lever_1 @ x[0:3] - turned_2
        scale = max(robust_sd(error), MIN_SCALE_M_S2)
        weight = 1 / (scale**2 * np.sqrt(1 + np.sum(error**2, axis=1) / scale**2))
        design[..., 3:6], design[..., 9:12] = -rotation @ lever_2, -rotation
        by_angle = turned_2 @ cross_matrix(j1).T
        slope = np.concatenate([design, by_angle[..., None] * shares[:, None, :]], axis=2).reshape(-1, 12 + data.knots)
        weighted = slope * np.repeat(weight, 3)[:, None]
        information = slope.T @ weighted + prior
        step = np.linalg.solve(information, weighted.T @ error.ravel() - prior @ np.concatenate([x, knots]))
        x, knots = x + step[:12], knots + step[12:]
        if np.max(np.abs(step)) < MIN_STEP:
            break
    if np.max(np.abs(x[:6] - start.unknowns[:6])) > MAX_CENTRE_STEP_M:
        return None
    return JointCentre(x, np.linalg.inv(information)[:12, :12])


def _rotation_about(frame_1: FloatArray, frame_2: FloatArray, theta: FloatArray) -> FloatArray:
    """R12 (n, 3, 3) of a hinge bent by theta (n,)."""
    turn = np.zeros((len(theta), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(theta)
    turn[:, 1, 0] = np.sin(theta)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1.0
    return frame_1 @ turn @ frame_2.T


def _prior(data: Datasets) -> FloatArray:
    prior = np.zeros((12 + data.knots, 12 + data.knots))
    prior[np.arange(12), np.arange(12)] = [CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6
    for k, spacing_s in enumerate(data.knot_spacing_s):
        if np.isfinite(spacing_s):
            information = 1 / (DRIFT_WALK_RAD**2 * spacing_s)
            prior[12 + k : 14 + k, 12 + k : 14 + k] += information * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return prior

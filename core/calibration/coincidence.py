"""Do both sensors feel the same acceleration at the joint? The test that tells true candidates from mirror images.

With the centres o and the accelerometer biases b, a1 - b1 - K1 o1 = R12 (a2 - b2 - K2 o2), K(g) = [g]x[g]x + [g']x: the
vector form of Seel et al. 2014, eq 7, linear in all unknowns once the relative orientation R12 is known.
"""

from dataclasses import dataclass

import numpy as np

from core.datasets import Datasets
from core.pair import lever_matrix
from core.samples import FloatArray

CENTRE_PRIOR_M = 0.3  # a sensor sits within a segment's length of the joint
BIAS_PRIOR_M_S2 = 0.05
SCALE_M_S2 = 0.5
STEPS = 3
GRAVITY_M_S2 = 9.81


@dataclass(frozen=True, slots=True)
class Coincidence:
    """Solutions per candidate: `unknowns` (c, 12) = o1, o2 (m), b1, b2 (m/s2); `cost` (c,) mean robust loss."""

    unknowns: FloatArray
    cost: FloatArray
    covariance: FloatArray


def relative_rotation(data: Datasets, heading: FloatArray) -> FloatArray:
    """R12 (c, n, 3, 3), turning vectors of sensor 2 into sensor 1, for headings (c, n)."""
    c, s = np.cos(heading), np.sin(heading)
    turn = np.zeros((*heading.shape, 3, 3))
    turn[..., 0, 0] = turn[..., 1, 1] = c
    turn[..., 1, 0], turn[..., 0, 1], turn[..., 2, 2] = s, -s, 1.0
    return np.swapaxes(data.earth_from_1, 1, 2) @ (turn @ data.earth_from_2)


def fit_coincidence(data: Datasets, rotation_12: FloatArray, scale_m_s2: float = SCALE_M_S2) -> Coincidence:
    """Robust linear least squares for centres and biases under rotations (c, n, 3, 3)."""
    c, n = rotation_12.shape[:2]
    design = np.empty((c, n, 3, 12))
    design[..., 0:3] = lever_matrix(data.g1, data.dg1)
    design[..., 3:6] = -rotation_12 @ lever_matrix(data.g2, data.dg2)
    design[..., 6:9] = np.eye(3)
    design[..., 9:12] = -rotation_12
    target = data.a1 - np.einsum("cnij,nj->cni", rotation_12, data.a2)
    return solve_robustly(design, target, scale_m_s2)


def disagreement(data: Datasets, rotation_12: FloatArray, unknowns: FloatArray) -> float:
    """What the best coincidence leaves, against all that both sensors feel beside gravity: 0 one joint, 1 none.

    Parameters
    ----------
    rotation_12 : (n, 3, 3)
    unknowns : (12,)
    """
    one = data.a1 - unknowns[6:9] - lever_matrix(data.g1, data.dg1) @ unknowns[0:3]
    two = data.a2 - unknowns[9:12] - lever_matrix(data.g2, data.dg2) @ unknowns[3:6]
    left = _loss(one - np.einsum("nij,nj->ni", rotation_12, two))
    felt = 0.0
    for earth_from, force in ((data.earth_from_1, data.a1), (data.earth_from_2, data.a2)):
        felt += _loss(np.einsum("nij,nj->ni", earth_from, force) - [0.0, 0.0, GRAVITY_M_S2])
    return left / max(felt, 1e-12)


def _loss(error: FloatArray) -> float:
    return float(2 * np.mean(np.sqrt(1 + np.sum(error**2, axis=1) / SCALE_M_S2**2) - 1))


def solve_robustly(design: FloatArray, target: FloatArray, scale_m_s2: float) -> Coincidence:
    c, n = target.shape[:2]
    prior = np.diag([CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6) * scale_m_s2**2
    flat = design.reshape(c, 3 * n, 12)
    weight = np.ones((c, n))
    for _ in range(STEPS):
        weighted = (design * weight[..., None, None]).reshape(c, 3 * n, 12)
        information = np.swapaxes(weighted, 1, 2) @ flat + prior
        unknowns = np.linalg.solve(information, np.swapaxes(weighted, 1, 2) @ target.reshape(c, 3 * n, 1))
        error = (target.reshape(c, 3 * n, 1) - flat @ unknowns).reshape(c, n, 3)
        root = np.sqrt(1 + np.sum(error**2, axis=-1) / scale_m_s2**2)
        weight = 1 / root
    cost = 2 * np.mean(root - 1, axis=1)
    return Coincidence(unknowns[..., 0], cost, np.linalg.inv(information) * scale_m_s2**2)

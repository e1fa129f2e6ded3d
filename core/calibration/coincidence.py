"""The coincidence of both sensors' accelerations at the joint, which sorts true candidates from mirror images.

With the centres o and the accelerometer biases b, a1 - b1 - K1 o1 = R12 (a2 - b2 - K2 o2), K(g) = [g]x[g]x + [g']x: the
vector form of Seel et al. 2014, eq 7, linear in all unknowns once the relative orientation R12 is known. What decides
between hypotheses is low-passed first, for tissue rings above; what a hinge's centre is found from is not.
"""

from dataclasses import dataclass

import numpy as np

from core.samples import GRAVITY_M_S2, FloatArray, IntArray
from core.signal.datasets import Datasets
from core.signal.pair import lever_matrix

CENTRE_PRIOR_M = 0.3  # a sensor sits within a segment's length of the joint
BIAS_PRIOR_M_S2 = 0.05
SCALE_M_S2 = 0.5
STEPS = 3
MIN_CLEAR = 50  # samples


@dataclass(frozen=True, slots=True)
class Coincidence:
    """Solutions per candidate: `unknowns` (c, 12) = o1, o2 (m), b1, b2 (m/s2); `cost` (c,) mean robust loss."""

    unknowns: FloatArray
    cost: FloatArray
    covariance: FloatArray


def relative_rotation(data: Datasets, heading: FloatArray) -> FloatArray:
    """Give R12 (c, n, 3, 3), from distal to proximal sensor axes, for headings (c, n) of the distal earth."""
    c, s = np.cos(heading), np.sin(heading)
    turn = np.zeros((*heading.shape, 3, 3))
    turn[..., 0, 0] = turn[..., 1, 1] = c
    turn[..., 1, 0], turn[..., 0, 1], turn[..., 2, 2] = s, -s, 1.0
    return np.swapaxes(data.earth_from_1, 1, 2) @ (turn @ data.earth_from_2)


def fit_coincidence(data: Datasets, rotation_12: FloatArray, scale_m_s2: float = SCALE_M_S2) -> Coincidence:
    """Fit centres and biases per candidate rotation (c, n, 3, 3) by robust linear least squares."""
    return solve_robustly(coincidence_design(data, rotation_12), scale_m_s2)


def coincidence_design(data: Datasets, rotation_12: FloatArray) -> FloatArray:
    """Build the design (c, 13, 3, n) for `solve_robustly`: slopes by o1, o2, b1, b2, then targets, m/s2."""
    c, n = rotation_12.shape[:2]
    design = np.empty((c, 13, 3, n))
    rows = np.moveaxis(design, (3, 2, 1), (1, 2, 3))  # the same, sample by sample
    rows[..., 0:3] = lever_matrix(data.g1, data.dg1)
    rows[..., 3:6] = -rotation_12 @ lever_matrix(data.g2, data.dg2)
    rows[..., 6:9] = np.eye(3)
    rows[..., 9:12] = -rotation_12
    rows[..., 12] = data.a1 - (rotation_12 @ data.a2[..., None])[..., 0]
    return design


@dataclass(frozen=True, slots=True)
class JointForces:
    """What both sensors of a joint feel of it, low-passed, at those samples of a data set where both were received.

    `chosen` (n,) are the samples' numbers, `terms_1` and `terms_2` (7, 3, n) as in `JointForce`.
    """

    chosen: IntArray
    terms_1: FloatArray
    terms_2: FloatArray

    def __len__(self) -> int:
        return len(self.chosen)


def joint_forces(data: Datasets, room_s: float = 0.0) -> JointForces:
    """Give forces at samples clear of gaps, else at all; `room_s`: margin of distal samples before and after."""
    is_clear = np.zeros(len(data), dtype=bool)
    for s, pair in enumerate(data.pairs):
        mine = data.stretch == s
        one, two = (track.joint_force for track in pair.tracks)
        own_s = data.time_s[mine]
        is_clear[mine] = one.is_received_at(own_s)
        for shift_s in (-room_s, 0.0, room_s) if room_s else (0.0,):
            is_clear[mine] &= two.is_received_at(own_s - pair.lag_s - shift_s)
    if np.count_nonzero(is_clear) < MIN_CLEAR:
        is_clear[:] = True
    chosen = np.flatnonzero(is_clear)
    terms_1 = np.empty((7, 3, len(chosen)))
    for s, pair in enumerate(data.pairs):
        mine = data.stretch[chosen] == s
        terms_1[..., mine] = pair.tracks[0].joint_force.at(data.time_s[chosen[mine]]).T
    return JointForces(chosen, terms_1, distal_terms(data, chosen, np.zeros(1))[0])


def distal_terms(data: Datasets, chosen: IntArray, shifts_s: FloatArray) -> FloatArray:
    """Give the distal sensor's terms (c, 7, 3, n) in its earth axes, stamps moved by `shifts_s` (c,)."""
    terms = np.empty((len(shifts_s), 7, 3, len(chosen)))
    for s, pair in enumerate(data.pairs):
        mine = data.stretch[chosen] == s
        time_s = data.time_s[chosen[mine]] - pair.lag_s - shifts_s[:, None]
        found = pair.tracks[1].joint_force.at(time_s.ravel())
        terms[..., mine] = found.reshape(*time_s.shape, 3, 7).transpose(0, 3, 2, 1)
    return terms


def fit_forces(forces: JointForces, heading: FloatArray) -> Coincidence:
    """Fit as `fit_coincidence`, but low-passed forces under headings (c, n), rad, at their samples."""
    return solve_robustly(force_design(forces.terms_1, forces.terms_2, heading), SCALE_M_S2)


def force_design(terms_1: FloatArray, terms_2: FloatArray, heading: FloatArray) -> FloatArray:
    """Build the design (c, 13, 3, n) from terms (7, 3, n) or (c, 7, 3, n) and headings (c, n), rad."""
    turned = turned_about_vertical(heading, terms_2)
    design = np.empty((len(turned), 13, *turned.shape[2:]))
    design[:, 0:3], design[:, 6:9] = terms_1[0:3], terms_1[3:6]
    np.negative(turned[:, 0:3], out=design[:, 3:6])
    np.negative(turned[:, 3:6], out=design[:, 9:12])
    np.subtract(terms_1[6], turned[:, 6], out=design[:, 12])
    return design


def turned_about_vertical(heading: FloatArray, terms: FloatArray) -> FloatArray:
    """Compute Rz(heading) terms, (c, t, 3, n), for headings (c, n), rad, and terms ([c,] t, 3, n), z up."""
    c, s = np.cos(heading)[:, None], np.sin(heading)[:, None]
    turned = np.empty((*np.broadcast_shapes(terms.shape[:-2], (len(heading), 1)), 3, heading.shape[1]))
    turned[..., 0, :] = c * terms[..., 0, :] - s * terms[..., 1, :]
    turned[..., 1, :] = s * terms[..., 0, :] + c * terms[..., 1, :]
    turned[..., 2, :] = terms[..., 2, :]
    return turned


def disagreement(forces: JointForces, heading: FloatArray, unknowns: FloatArray) -> float:
    """Give the best coincidence's residual by all force beside gravity: 0 one joint, 1 none; heading (n,)."""
    turned = turned_about_vertical(heading[None], forces.terms_2)[0]
    one = forces.terms_1[6] - np.tensordot(unknowns[[0, 1, 2, 6, 7, 8]], forces.terms_1[:6], 1)
    two = turned[6] - np.tensordot(unknowns[[3, 4, 5, 9, 10, 11]], turned[:6], 1)
    gravity = np.array([[0.0], [0.0], [GRAVITY_M_S2]])
    felt = sum(mean_cost(terms[6] - gravity) for terms in (forces.terms_1, forces.terms_2))
    return mean_cost(one - two) / max(felt, 1e-12)


def mean_cost(error: FloatArray) -> float:
    """Mean robust loss of vectors (3, n)."""
    return float(2 * np.mean(np.sqrt(1 + np.sum(error**2, axis=0) / SCALE_M_S2**2) - 1))


def solve_robustly(design: FloatArray, scale_m_s2: float) -> Coincidence:
    """Solve each candidate's design (c, 13, 3, n) robustly; samples come last, which is several times as fast."""
    c, n = len(design), design.shape[3]
    prior = np.diag([CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6) * scale_m_s2**2
    flat, root = design.reshape(c, 13, 3 * n), np.ones((c, n))
    for step in range(STEPS):
        weighted = (design * (1 / root)[:, None, None]).reshape(c, 13, 3 * n) if step else flat
        products = weighted @ np.swapaxes(flat, 1, 2)
        information = products[:, :12, :12] + prior
        unknowns = np.linalg.solve(information, products[:, :12, 12:])
        error = (flat[:, 12:] - np.swapaxes(unknowns, 1, 2) @ flat[:, :12]).reshape(c, 3, n)
        root = np.sqrt(1 + np.sum(error**2, axis=1) / scale_m_s2**2)
    cost = 2 * np.mean(root - 1, axis=1)
    return Coincidence(unknowns[..., 0], cost, np.linalg.inv(information) * scale_m_s2**2)

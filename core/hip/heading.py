"""Relative heading of pelvis and thigh, from the accelerations that both feel of the hip's centre.

A hip is a ball joint: what ties both sensors is its centre alone. Low-passed at 4 Hz (tissue rings above), with
Y = R a, A = R K, B = R in each sensor's own earth, Y1 - A1 o1 - B1 b1 = Rz(d) (Y2 - A2 o2 - B2 b2) holds exactly
for a rigid joint (Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, eq 7 with an unknown heading).
"""

from dataclasses import dataclass

import numpy as np

from core.calibration.coincidence import (
    BIAS_PRIOR_M_S2,
    CENTRE_PRIOR_M,
    SCALE_M_S2,
    JointForces,
    disagreement,
    force_design,
    joint_forces,
    solve_robustly,
    turned_about_vertical,
)
from core.calibration.joint_axis import heading_prior
from core.samples import GRAVITY_M_S2, FloatArray
from core.signal.datasets import Datasets, gather, knot_positions, moving_indices
from core.signal.pair import Pair
from core.signal.rotations import wrap

SAMPLES_PER_S = 20.0  # of motion below 4 Hz
MOST_SAMPLES, SCANNED_SAMPLES = 1500, 240
SCANNED_S = 60.0  # over which two headings hardly drift apart
SCAN_RAD = np.deg2rad(10.0)
RIVAL_RAD = np.deg2rad(45.0)
MIN_MOVING_S = 3.0
STEPS, MIN_STEP_RAD = 8, 1e-4
SD_FACTOR = 3.0  # of residuals as if white below 4 Hz: 2 sd then hold 0.98 of windows
ROOM_S = 0.02


@dataclass(frozen=True, slots=True)
class HipFit:
    """Pelvis and one thigh over one stretch.

    `centre_proximal_m`, `centre_distal_m`: (3,): from the joint to the sensors, in sensor axes.
    """

    knots_rad: FloatArray  # (k,): heading of the thigh's earth in the pelvis's, at knots evenly spread over the stretch
    centre_proximal_m: FloatArray
    centre_distal_m: FloatArray
    margin: float  # cost of the best heading more than 45 deg away over that of this one
    disagreement: float  # what the best coincidence leaves, against all that both sensors feel: 0 one joint, 1 none
    sd_rad: float  # of the heading
    moving_s: float  # how long they moved

    def heading(self, pair: Pair) -> FloatArray:
        """The heading (n,) at every sample of the pair that was fitted, rad."""
        intervals, position = knot_positions(pair)
        return np.interp(position, np.arange(intervals + 1), self.knots_rad)


@dataclass(frozen=True, slots=True)
class Forces:
    """What both sensors feel of the joint at chosen samples: data of n samples, terms (7, 3, n)."""

    data: Datasets
    terms_1: FloatArray
    terms_2: FloatArray


def forces_of(pair: Pair, room_s: float = ROOM_S) -> Forces | None:
    """Give a stretch's forces while it moves, None if hardly; `room_s`: margin of thigh samples."""
    index = moving_indices(pair)
    step = max(1, round(1 / (SAMPLES_PER_S * pair.step_s)), -(-len(index) // MOST_SAMPLES))
    index = index[::step]
    if len(index) * step * pair.step_s < MIN_MOVING_S:
        return None
    data = gather((pair,), [index])
    found = joint_forces(data, room_s)
    return Forces(data.only(found.chosen), found.terms_1, found.terms_2)


def fit_hip(pair: Pair) -> HipFit | None:
    """Fit the heading over one stretch; None where it hardly moves."""
    forces = forces_of(pair)
    if forces is None:
        return None
    start_rad, margin = scan_heading(forces)
    knots, unknowns, error = fit_knots(forces, np.full(forces.data.knots, start_rad))
    heading = forces.data.heading(knots)
    whole = JointForces(np.arange(len(heading)), forces.terms_1, forces.terms_2)
    moving_s = float(np.count_nonzero(pair.is_moving & pair.is_known) * pair.step_s)
    return HipFit(
        knots_rad=knots,
        centre_proximal_m=unknowns[0:3],
        centre_distal_m=unknowns[3:6],
        margin=margin,
        disagreement=disagreement(whole, heading, unknowns),
        sd_rad=_heading_sd_rad(forces, unknowns, error, moving_s),
        moving_s=moving_s,
    )


def scan_heading(forces: Forces) -> tuple[float, float]:
    """Scan constant headings over the first minute; give the best, rad, and the rival's cost over its cost."""
    time_s = forces.data.time_s
    first = np.flatnonzero(time_s <= time_s[0] + SCANNED_S)
    some = first[:: max(1, len(first) // SCANNED_SAMPLES)]
    trial = np.arange(0.0, 2 * np.pi, SCAN_RAD)

    def costs(headings: FloatArray) -> FloatArray:
        spread = np.repeat(headings[:, None], len(some), axis=1)
        return solve_robustly(
            force_design(forces.terms_1[..., some], forces.terms_2[..., some], spread), SCALE_M_S2
        ).cost

    cost = costs(trial)
    best = float(trial[np.argmin(cost)])
    near = best + np.linspace(-0.5, 0.5, 11) * SCAN_RAD
    fine = costs(near)
    best, least = float(near[np.argmin(fine)]), float(fine.min())
    is_rival = np.abs(wrap(trial - best)) > RIVAL_RAD
    return best, float(cost[is_rival].min()) / max(least, 1e-9)


def fit_knots(forces: Forces, knots_rad: FloatArray, steps: int = STEPS) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Fit heading knots (k,), centres and biases (12,) by robust Gauss-Newton; residuals (3, n), m/s2."""
    data, n = forces.data, len(forces.data)
    share = _shares(data)
    prior_x = np.diag([CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6) * SCALE_M_S2**2
    prior_k = heading_prior(data) * SCALE_M_S2**2
    k = data.knots
    unknowns, weight = np.zeros(12), np.ones(n)
    for step in range(steps):
        heading = data.heading(knots_rad)
        design = force_design(forces.terms_1, forces.terms_2, heading[None])[0]
        felt = turned_about_vertical(heading[None], forces.terms_2)[0]
        two = felt[6] - np.tensordot(unknowns[[3, 4, 5, 9, 10, 11]], felt[:6], 1)
        by_heading = np.stack([two[1], -two[0], np.zeros(n)])  # of what is left, by the heading
        if step:
            left = design[12] - np.tensordot(unknowns, design[:12], 1)
            weight = 1 / np.sqrt(1 + np.sum(left**2, axis=0) / SCALE_M_S2**2)
        slopes = design[:12] * weight
        information = np.zeros((12 + k, 12 + k))
        information[:12, :12] = np.tensordot(slopes, design[:12], ([1, 2], [1, 2])) + prior_x
        mixed = np.einsum("icn,cn->in", slopes, by_heading) @ share
        information[:12, 12:], information[12:, :12] = -mixed, -mixed.T
        bend = weight * np.sum(by_heading**2, axis=0)
        information[12:, 12:] = (share.T * bend) @ share + prior_k
        information[12:, 12:] += 1e-9 * (1 + np.trace(information)) * np.eye(k)
        aim = np.concatenate(
            [
                np.tensordot(slopes, design[12], ([1, 2], [0, 1])),
                -share.T @ (weight * np.sum(by_heading * design[12], axis=0)) - prior_k @ knots_rad,
            ]
        )
        found = np.linalg.solve(information, aim)
        unknowns, change = found[:12], found[12:]
        knots_rad = knots_rad + np.clip(change, -0.5, 0.5)
        if step > 1 and np.max(np.abs(change)) < MIN_STEP_RAD:
            break
    design = force_design(forces.terms_1, forces.terms_2, data.heading(knots_rad)[None])[0]
    return knots_rad, unknowns, design[12] - np.tensordot(unknowns, design[:12], 1)


def _shares(data: Datasets) -> FloatArray:
    """How much each knot counts in each sample's heading (n, k)."""
    share = np.zeros((len(data), data.knots))
    row = np.arange(len(data))
    share[row, data.knot_left] = 1 - data.knot_share
    share[row, np.minimum(data.knot_left + 1, data.knots - 1)] += data.knot_share
    return share


def _heading_sd_rad(forces: Forces, unknowns: FloatArray, error: FloatArray, moving_s: float) -> float:
    """3 s_r/(a_h sqrt(4 T)): residual against the horizontal force at the centre, over the seconds that moved."""
    one = forces.terms_1[6] - np.tensordot(unknowns[[0, 1, 2, 6, 7, 8]], forces.terms_1[:6], 1)
    horizontal = one[:2] - one[:2].mean(axis=1, keepdims=True)
    felt = float(np.sqrt(np.mean(np.sum(horizontal**2, axis=0))))
    square = np.sum(error**2, axis=0)
    weight = 1 / np.sqrt(1 + square / SCALE_M_S2**2)
    residual = float(np.sqrt(np.sum(weight * square) / np.sum(weight)))
    return SD_FACTOR * residual / max(felt * np.sqrt(4.0 * max(moving_s, 0.25)), 1e-6 * GRAVITY_M_S2)

"""Joint centres seen from each sensor: vectors o from the joint to the sensor, in sensor axes."""

import math
from dataclasses import dataclass

import numpy as np

from core.calibration.certainty import sandwich_covariance, time_blocks
from core.calibration.coincidence import (
    BIAS_PRIOR_M_S2,
    CENTRE_PRIOR_M,
    SCALE_M_S2,
    coincidence_design,
    relative_rotation,
    solve_robustly,
)
from core.samples import FloatArray
from core.signal.datasets import Datasets
from core.signal.robust import robust_sd
from core.signal.rotations import cross, cross_matrix, joint_frame

MIN_SCALE_M_S2 = 0.02
NORM_STEPS = 10
# A sensor's shift in step with the limb looks the same in every sample: its energy, counted in residuals, divides the
# information, however long the motion lasts. With the factor below 9 of 10 reported centres lie within twice
# the standard deviation (240 simulated joints, stopped at random times as in tests/benchmarks/excitation.py).
IN_STEP_M = 0.0004
SD_FACTOR_HUMAN = 2.5
# What the residuals themselves show, hanging together over a second, counts beside it: four times their standard
# deviation, with which nine of ten centres of 190 simulated sessions with walks lie within twice what is reported.
SEEN_SHARE = (4.0 / 2.5) ** 2
SD_FACTOR_HINGE = 8.0  # scale errors, and what noise in the angular accelerations pretends to know of a still segment
MIN_SD_HINGE_M = 0.002
MIN_SD_HUMAN_M = 0.010
MAX_SD_M = 0.050  # less certain than this is unknown; nearly all that the live gauge closes is better


@dataclass(frozen=True, slots=True)
class JointCentre:
    """`unknowns` (12,) = o1, o2 (m), b1, b2 (m/s2): centres and accelerometer biases; covariance (12, 12)."""

    unknowns: FloatArray
    covariance: FloatArray

    @property
    def proximal_m(self) -> FloatArray:
        """From the joint to the proximal sensor (3,), in its axes."""
        return self.unknowns[0:3]

    @property
    def distal_m(self) -> FloatArray:
        """From the joint to the distal sensor (3,), in its axes."""
        return self.unknowns[3:6]


def centre_by_vectors(data: Datasets, knots_rad: FloatArray) -> JointCentre:
    """Find the centre by eq 7's vector form (Seel et al. 2014, doi 10.3390/s140406891); knots (k,), rad."""
    design = coincidence_design(data, relative_rotation(data, data.heading(knots_rad)[None]))
    first = solve_robustly(design, SCALE_M_S2).unknowns[0]
    left = design[0, 12] - np.tensordot(first, design[0, :12], 1)
    fit = solve_robustly(design, max(MIN_SCALE_M_S2, robust_sd(left)))
    return JointCentre(fit.unknowns[0], fit.covariance[0])


def centre_by_lengths(data: Datasets, start: FloatArray) -> JointCentre:
    """Find the centre by eq 8 (Seel et al. 2014, doi 10.3390/s140406891) with biases, robustly; `start` (12,)."""
    g1, dg1, a1 = (np.ascontiguousarray(v.T) for v in (data.g1, data.dg1, data.a1))
    g2, dg2, a2 = (np.ascontiguousarray(v.T) for v in (data.g2, data.dg2, data.a2))
    prior = np.diag([CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6)
    x = start.copy()
    slope = np.empty((12, len(data)))
    for _ in range(NORM_STEPS):
        length_1, slope[0:3], slope[6:9] = _length(g1, dg1, a1, x[0:3], x[6:9])
        length_2, slope[3:6], slope[9:12] = _length(g2, dg2, a2, x[3:6], x[9:12])
        slope[3:6] *= -1.0
        slope[9:12] *= -1.0
        error = length_1 - length_2
        scale = max(MIN_SCALE_M_S2, robust_sd(error))
        weight = 1 / np.sqrt(1 + (error / scale) ** 2) / scale**2
        information = (slope * weight) @ slope.T + prior
        step = -np.linalg.solve(information, slope @ (weight * error) + prior @ x)
        x = x + step
        if np.max(np.abs(step[:6])) < 1e-6:
            break
    effort = float(weight @ (np.sum(data.dg1**2, axis=1) + np.sum(data.dg2**2, axis=1)))
    shared = 1 + IN_STEP_M**2 * effort
    unseen = np.linalg.inv((information - prior) / shared + prior)
    seen = sandwich_covariance(slope.T[:, None, :], error[:, None], weight[:, None], time_blocks(data))
    return JointCentre(x, unseen + SEEN_SHARE * seen)


def _length(
    rate: FloatArray, change: FloatArray, force: FloatArray, centre_m: FloatArray, bias: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """|a - b - K o| (n,) of signals (3, n), and its slopes (3, n) by o and by b."""
    square = np.sum(rate**2, axis=0)
    lever = (centre_m @ rate) * rate - square * centre_m[:, None] - cross_matrix(centre_m) @ change
    shifted = force - bias[:, None] - lever
    length = np.sqrt(np.sum(shifted**2, axis=0))
    unit = shifted / length
    by_centre = square * unit - np.sum(unit * rate, axis=0) * rate - cross(unit.T, change.T).T
    return length, by_centre, -unit


def centre_sd_m(
    centre: JointCentre,
    axis_1: FloatArray,
    axis_2: FloatArray,
    is_hinge: bool,
    is_knee: bool,
    looseness: float = 0.0,
) -> float:
    """Give the centre's larger sd, m, in the weakest observable direction (knee, hinge: across the axis)."""
    worst = 0.0
    for axis, part in ((axis_1, slice(0, 3)), (axis_2, slice(3, 6))):
        covariance = centre.covariance[part, part]
        if is_knee or is_hinge:
            plane = np.stack(joint_frame(axis), axis=1)
            covariance = plane.T @ covariance @ plane
        worst = max(worst, float(np.linalg.eigvalsh(covariance)[-1]))
    if is_hinge:
        return math.hypot(SD_FACTOR_HINGE * math.sqrt(worst), MIN_SD_HINGE_M, CENTRE_PRIOR_M * looseness)
    return math.hypot(SD_FACTOR_HUMAN * math.sqrt(worst), MIN_SD_HUMAN_M)


def nearest_to_sensors(centre: JointCentre, axis_1: FloatArray, axis_2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give vectors (3,), m, from the axis point nearest to both sensors to each (Seel et al. 2014, eq 9)."""
    along = 0.5 * float(centre.proximal_m @ axis_1 + centre.distal_m @ axis_2)
    return centre.proximal_m - axis_1 * along, centre.distal_m - axis_2 * along

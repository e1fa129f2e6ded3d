"""Standard deviations of axes and angles, from residuals correlated in time plus a measured floor."""

import numpy as np

from core.prosthesis import JointNature
from core.samples import FloatArray, IntArray
from core.signal.datasets import Datasets
from core.signal.rotations import turn_about_vertical

BLOCK_S = 1.0  # residuals nearer in time than this are not independent
# What no recording shows of itself: scale and misalignment of the sensors on a hinge; functional against anatomical
# axis on a human; and walking, whose segments all turn about parallel axes.
AXIS_FLOOR_HINGE_RAD = np.deg2rad(0.3)
AXIS_FLOOR_HUMAN_RAD = np.deg2rad(4.0)
AXIS_FLOOR_WALKING_RAD = np.deg2rad(6.0)

# Of an angle. Tissue that turns about the flexion axis in step with the gait leaves no trace in the data, and turns a
# simulated ankle as easily by 2 deg as by none. So there is no seeing that there is none: of a person's joint it is
# taken for granted, and only a joint that is declared as a prosthesis, or that is a hinge in every sample, is without.
# Measured on simulated sessions of all tissues, and prostheses (tests/benchmarks/certainty.py).
ANGLE_FLOOR_KNEE_RAD, KNEE_PER_RATE_S = np.deg2rad(1.1), np.deg2rad(3.0)
ANGLE_FLOOR_ANKLE_RAD, ANKLE_PER_RATE_S = np.deg2rad(0.3), np.deg2rad(4.0)
ANKLE_PER_DISTANCE = 0.13
ANGLE_FLOOR_PROSTHESIS_RAD, PROSTHESIS_PER_RATE_S = np.deg2rad(0.2), np.deg2rad(1.1)
# On a hinge what the sensors' scales are off by grows with the range: simulated legs, of 60 to 76 deg, are off by 0.05
# to 0.1 deg, two mechanical hinges, of 160 deg and against optics, by 0.5.
ANGLE_FLOOR_HINGE_RAD, MIN_HINGE_RAD = np.deg2rad(0.05), np.deg2rad(0.10)
HINGE_PER_SQUARE_RANGE = 0.001  # per radian
# A joint that passes for a hinge, and that nobody has declared to be one, is one where it turns across its axis and
# rings no more than this; else it may be a person's
BARE_OFF_AXIS_RAD_S, BARE_RINGING_RAD_S = 0.03, 0.02
MIN_DOUBTED_HINGE_RAD = np.deg2rad(0.9)


def sandwich_covariance(slope: FloatArray, value: FloatArray, weight: FloatArray, block: IntArray) -> FloatArray:
    """Compute the covariance (p, p) of a robust fit whose residuals are correlated within blocks.
    H^-1 (sum_b s_b s_b') H^-1 with s_b the sum of the score over block b; `slope` (n, r, p), `value`,
    `weight` (n, r), `block` (n,).
    """
    weighted = slope * weight[..., None]
    information = np.tensordot(weighted, slope, axes=([0, 1], [0, 1]))
    information += 1e-9 * np.trace(information) / len(information) * np.eye(len(information))
    score = (value[:, None, :] @ weighted)[:, 0]
    sums = np.zeros((int(block.max()) + 1, score.shape[1]))
    np.add.at(sums, block, score)
    inverse = np.linalg.inv(information)
    covariance: FloatArray = inverse @ (sums.T @ sums) @ inverse
    return covariance


def time_blocks(data: Datasets) -> IntArray:
    """Number the one-second block of each sample, (n,), counted over all stretches."""
    block = np.zeros(len(data), dtype=np.int64)
    first = 0
    for s in range(len(data.pairs)):
        mine = data.stretch == s
        if mine.any():
            seconds = ((data.time_s[mine] - data.time_s[mine][0]) / BLOCK_S).astype(np.int64)
            block[mine] = first + seconds
            first += int(seconds.max()) + 1
    return block


def axis_sd_rad(covariance: FloatArray, floor_rad: float) -> float:
    """Give the larger axis sd along its weakest direction, rad, with the floor; covariance (4, 4) of tangents."""
    worst = max(float(np.linalg.eigvalsh(covariance[part, part])[-1]) for part in (slice(0, 2), slice(2, 4)))
    return float(np.sqrt(max(worst, 0.0) + floor_rad**2))


def looseness(data: Datasets, axis_1: FloatArray, heading_rad: FloatArray) -> float:
    """Give RMS rate across over along the axis: 0 true hinge (mechanical 0.015, knee to 0.06), 1 no axis."""
    rate_1 = np.einsum("nij,nj->ni", data.earth_from_1, data.g1)
    rate_2 = turn_about_vertical(heading_rad, np.einsum("nij,nj->ni", data.earth_from_2, data.g2))
    relative = rate_2 - rate_1
    along = float(np.sum((relative * (data.earth_from_1 @ axis_1)).sum(axis=1) ** 2))
    across = 0.5 * max(float(np.sum(relative**2)) - along, 0.0)  # in each of two directions
    return float(np.sqrt(across / max(along, 1e-12)))


def hinge_floor_rad(loose: float) -> float:
    """Give the least standard deviation of a hinge's axis, rad, from its `looseness`."""
    return float(np.hypot(AXIS_FLOOR_HINGE_RAD, loose))


def angle_sd_rad(
    distance_rad: FloatArray,
    off_axis_rate_rad_s: float,
    range_rad: float,
    is_knee: bool,
    is_hinge: bool,
    nature: JointNature = JointNature.NOT_STATED,
    ringing_rad_s: float | None = None,
) -> FloatArray:
    """Give the standard deviation (n,) of a joint's angle, rad; `distance_rad` (n,) from the middle posture.
    `range_rad` counts on hinges only; `ringing_rad_s`: RMS off-axis rate above 3 Hz, None: unknown. What is declared to
    be the patient's, or a foot without a joint, is no hinge, however it looks.
    """
    is_prosthetic = nature in (JointNature.PROSTHETIC, JointNature.RIGID)
    rate = off_axis_rate_rad_s
    if is_knee:
        human = np.full(np.shape(distance_rad), ANGLE_FLOOR_KNEE_RAD + KNEE_PER_RATE_S * rate)
    else:
        human = np.hypot(ANGLE_FLOOR_ANKLE_RAD + ANKLE_PER_RATE_S * rate, ANKLE_PER_DISTANCE * distance_rad)
    if is_hinge and nature is not JointNature.RIGID:
        is_bare = rate <= BARE_OFF_AXIS_RAD_S and (ringing_rad_s or 0.0) <= BARE_RINGING_RAD_S
        if not is_prosthetic and (not is_bare or nature is JointNature.OWN):
            return np.maximum(MIN_DOUBTED_HINGE_RAD, human)
        hinge = max(MIN_HINGE_RAD, ANGLE_FLOOR_HINGE_RAD + HINGE_PER_SQUARE_RANGE * range_rad**2)
        return np.full(np.shape(distance_rad), hinge)
    if is_prosthetic and not is_knee:
        return np.full(np.shape(distance_rad), ANGLE_FLOOR_PROSTHESIS_RAD + PROSTHESIS_PER_RATE_S * rate)
    return human

"""Standard deviations of axes and angles, from residuals correlated in time plus a measured floor."""

import numpy as np

from core.datasets import Datasets
from core.rotations import turn_about_vertical
from core.samples import FloatArray, IntArray

BLOCK_S = 1.0  # residuals nearer in time than this are not independent
# What no recording shows of itself: scale and misalignment of the sensors on a hinge; functional against anatomical
# axis on a human; and walking, whose segments all turn about parallel axes.
AXIS_FLOOR_HINGE_RAD = np.deg2rad(0.3)
AXIS_FLOOR_HUMAN_RAD = np.deg2rad(4.0)
AXIS_FLOOR_WALKING_RAD = np.deg2rad(6.0)

# Of an angle, measured on 66 simulated sessions of all tissues (tests/benchmarks/certainty.py): what it is off by grows
# with the off-axis rate, and with the distance from the middle posture, for tissue acts as a gain.
ANGLE_FLOOR_KNEE_RAD, KNEE_PER_RATE_S = np.deg2rad(0.8), np.deg2rad(2.0)
KNEE_PER_DISTANCE = 0.12  # times the root of the rate
ANGLE_FLOOR_ANKLE_RAD, ANKLE_PER_RATE_S = np.deg2rad(-0.1), np.deg2rad(3.0)
ANKLE_PER_DISTANCE = 0.09
MIN_ANKLE_RAD = np.deg2rad(0.2)
# An ankle turns off its axis by itself. That tissue does shows above 3 Hz: 0.15 rad/s in walking without any tissue,
# 0.2 to 0.4 under tight, 0.35 to 0.7 under loose tissue.
LOOSE_RINGING_RAD_S, MIN_TISSUE = 0.3, 0.4
# On a hinge what the sensors' scales are off by grows with the range: simulated legs, of 60 to 76 deg, are off by 0.05
# to 0.1 deg, two mechanical hinges, of 160 deg and against optics, by 0.5.
ANGLE_FLOOR_HINGE_RAD = np.deg2rad(0.05)
HINGE_PER_SQUARE_RANGE = 0.001  # per radian


def sandwich_covariance(slope: FloatArray, value: FloatArray, weight: FloatArray, block: IntArray) -> FloatArray:
    """Covariance (p, p) of a robust fit whose residuals are correlated within blocks.

    H^-1 (sum_b s_b s_b') H^-1 with s_b the sum of the score over block b.

    Parameters
    ----------
    slope : (n, r, p)
    value, weight : (n, r)
    block : (n,)
        Which block each sample belongs to.

    Returns
    -------
    (p, p)
        In the unknowns' units squared.
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
    """Number (n,) of the one-second block that each sample lies in, counted over all stretches.

    Returns
    -------
    (n,)
        Ascending within each stretch.
    """
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
    """The larger of both axes' standard deviations along their weakest direction, with the floor.

    Parameters
    ----------
    covariance : (4, 4)
        Of the tangent coordinates of both axes.
    floor_rad
        What no fit on such a joint is better than.

    Returns
    -------
    float
        rad.
    """
    worst = max(float(np.linalg.eigvalsh(covariance[part, part])[-1]) for part in (slice(0, 2), slice(2, 4)))
    return float(np.sqrt(max(worst, 0.0) + floor_rad**2))


def looseness(data: Datasets, axis_1: FloatArray, heading_rad: FloatArray) -> float:
    """Rate across the axis over the rate along it, root mean squares: 0 a true hinge, 1 no axis at all.

    A mechanical hinge has 0.015, a person's knee that passes for one 0.02 to 0.06, and its axis is off by as much.

    Parameters
    ----------
    axis_1 : (3,)
        Unit axis of the proximal sensor, in its axes.
    heading_rad : (n,)
        Of the distal earth in the proximal one.

    Returns
    -------
    float
        A ratio without unit.
    """
    rate_1 = np.einsum("nij,nj->ni", data.earth_from_1, data.g1)
    rate_2 = turn_about_vertical(heading_rad, np.einsum("nij,nj->ni", data.earth_from_2, data.g2))
    relative = rate_2 - rate_1
    along = float(np.sum((relative * (data.earth_from_1 @ axis_1)).sum(axis=1) ** 2))
    across = 0.5 * max(float(np.sum(relative**2)) - along, 0.0)  # in each of two directions
    return float(np.sqrt(across / max(along, 1e-12)))


def hinge_floor_rad(loose: float) -> float:
    """Least standard deviation of a hinge's axis.

    Parameters
    ----------
    loose
        As `looseness` gives it.

    Returns
    -------
    float
        rad.
    """
    return float(np.hypot(AXIS_FLOOR_HINGE_RAD, loose))


def angle_sd_rad(
    distance_rad: FloatArray,
    off_axis_rate_rad_s: float,
    range_rad: float,
    is_knee: bool,
    is_hinge: bool,
    ringing_rad_s: float | None = None,
) -> FloatArray:
    """Standard deviation (n,) of a joint's angle in one recording.

    Parameters
    ----------
    distance_rad : (n,)
        Of the angle from the middle posture.
    off_axis_rate_rad_s
        Its spread per axis in that recording, while moving.
    range_rad
        Of the angle; counts on a hinge only.
    ringing_rad_s
        Of an ankle, the part of the off-axis rate above 3 Hz in walking, root mean square; None where not known.

    Returns
    -------
    (n,)
        rad.
    """
    if is_hinge:
        return np.full(np.shape(distance_rad), ANGLE_FLOOR_HINGE_RAD + HINGE_PER_SQUARE_RANGE * range_rad**2)
    rate = off_axis_rate_rad_s
    if is_knee:
        by_distance = KNEE_PER_DISTANCE * np.sqrt(rate) * distance_rad
        return np.hypot(ANGLE_FLOOR_KNEE_RAD + KNEE_PER_RATE_S * rate, by_distance)
    tissue = 1.0 if ringing_rad_s is None else float(np.clip(ringing_rad_s / LOOSE_RINGING_RAD_S, MIN_TISSUE, 1.0))
    base = max(ANGLE_FLOOR_ANKLE_RAD + ANKLE_PER_RATE_S * rate, MIN_ANKLE_RAD)
    return tissue * np.hypot(base, ANKLE_PER_DISTANCE * distance_rad)

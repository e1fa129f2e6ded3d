"""How sure are axes and angles? Honest figures, from how the residuals hang together in time plus a measured floor."""

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

ANGLE_PER_RATE_S = np.deg2rad(3.3)  # as if tissue wobbled at 2.8 Hz: 1 / (2 pi 2.8 Hz)
ANGLE_FLOOR_KNEE_RAD = np.deg2rad(1.5)
ANGLE_FLOOR_ANKLE_RAD = np.deg2rad(0.3)
ANGLE_FLOOR_HINGE_RAD = np.deg2rad(0.3)
ANGLE_PER_RANGE_HINGE = 0.004


def sandwich_covariance(slope: FloatArray, value: FloatArray, weight: FloatArray, block: IntArray) -> FloatArray:
    """Covariance (p, p) of a robust fit whose residuals are correlated within blocks.

    H^-1 (sum_b s_b s_b') H^-1 with s_b the sum of the score over block b.

    Parameters
    ----------
    slope : (n, r, p)
    value, weight : (n, r)
    block : (n,)
        Which block each sample belongs to.
    """
    information = np.einsum("nr,nri,nrj->ij", weight, slope, slope)
    information += 1e-9 * np.trace(information) / len(information) * np.eye(len(information))
    score = np.einsum("nr,nri->ni", weight * value, slope)
    sums = np.zeros((int(block.max()) + 1, score.shape[1]))
    np.add.at(sums, block, score)
    inverse = np.linalg.inv(information)
    covariance: FloatArray = inverse @ (sums.T @ sums) @ inverse
    return covariance


def time_blocks(data: Datasets) -> IntArray:
    """Number (n,) of the one-second block that each sample lies in, counted over all stretches."""
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
    """
    worst = max(float(np.linalg.eigvalsh(covariance[part, part])[-1]) for part in (slice(0, 2), slice(2, 4)))
    return float(np.sqrt(max(worst, 0.0) + floor_rad**2))


def looseness(data: Datasets, axis_1: FloatArray, heading_rad: FloatArray) -> float:
    """Rate across the axis over the rate along it, root mean squares: 0 a true hinge, 1 no axis at all.

    A mechanical hinge has 0.015, a person's knee that passes for one 0.02 to 0.06, and its axis is off by as much.

    Parameters
    ----------
    heading_rad : (n,)
        Of the distal earth in the proximal one.
    """
    rate_1 = np.einsum("nij,nj->ni", data.earth_from_1, data.g1)
    rate_2 = turn_about_vertical(heading_rad, np.einsum("nij,nj->ni", data.earth_from_2, data.g2))
    relative = rate_2 - rate_1
    along = float(np.sum((relative * (data.earth_from_1 @ axis_1)).sum(axis=1) ** 2))
    across = 0.5 * max(float(np.sum(relative**2)) - along, 0.0)  # in each of two directions
    return float(np.sqrt(across / max(along, 1e-12)))


def hinge_floor_rad(loose: float) -> float:
    """Floor of a hinge's axis."""
    return float(np.hypot(AXIS_FLOOR_HINGE_RAD, loose))


def angle_sd_rad(off_axis_rate_sd_rad_s: float, range_rad: float, is_knee: bool, is_hinge: bool) -> float:
    """Standard deviation of a joint's angle over one recording, from the off-axis rate in that recording."""
    if is_hinge:
        floor = ANGLE_FLOOR_HINGE_RAD + ANGLE_PER_RANGE_HINGE * range_rad
    else:
        floor = ANGLE_FLOOR_KNEE_RAD if is_knee else ANGLE_FLOOR_ANKLE_RAD
    return float(floor + ANGLE_PER_RATE_S * off_axis_rate_sd_rad_s)

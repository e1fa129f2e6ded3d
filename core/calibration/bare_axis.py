"""Axes of a joint that no tissue hides, straight from the relative rate of a walk.

Under tissue the axis is where the joint's own rate rises out of what rings, and where both sensors agree on it. On a
prosthetic foot, or a shoe, nothing rings: the relative rate is the joint's own, and its principal direction, slow and
fast parts alike, is the axis about which its angle is least off.
"""

import numpy as np

from core.angles.twist import ringing
from core.calibration.joint_axis import Candidates, heading_from_axes, polish
from core.samples import FloatArray
from core.signal.datasets import Datasets
from core.signal.pair import MOVING_RAD_S
from core.signal.rotations import joint_frame, turn_about_vertical

MAX_RINGING_RAD_S = 0.21  # above 3 Hz, root mean square; simulated rigid feet have 0.17 to 0.20, people 0.5 to 0.7
FAST_SHARE_S2 = 0.1  # fast parts count less, by 1 / (1 + 0.1 |w|^2)
ROUNDS, HEADING_STEPS = 4, 2
SAMPLES = 800
Axes = tuple[FloatArray, FloatArray]


def bare_axes(data: Datasets, axes: Axes) -> Axes | None:
    """Find both axes (3,) from a walk's moving samples, starting at `axes`; None where tissue rings."""
    if _ringing_rad_s(data, axes) > MAX_RINGING_RAD_S:
        return None
    some = data.thinned(SAMPLES)
    one, two = axes
    knots = heading_from_axes(some, one[None], two[None])
    for _ in range(ROUNDS):
        fit = polish(some, Candidates(one[None], two[None], knots, np.zeros(1)), HEADING_STEPS, is_axis_fixed=True)
        knots = fit.knots_rad
        heading = some.heading(knots[0])
        relative = _relative_rate(some, heading)
        weight = 1 / (1 + FAST_SHARE_S2 * np.sum(relative**2, axis=1))
        seen_1 = np.einsum("nij,ni->nj", some.earth_from_1, relative)
        seen_2 = np.einsum("nij,ni->nj", some.earth_from_2, turn_about_vertical(-heading, relative))
        one, two = _principal(seen_1, weight, one), _principal(seen_2, weight, two)
    return one, two


def _relative_rate(data: Datasets, heading: FloatArray) -> FloatArray:
    """Of the distal segment against the proximal one, (n, 3) in the proximal sensor's earth."""
    rate_1 = np.einsum("nij,nj->ni", data.earth_from_1, data.g1)
    rate_2 = np.einsum("nij,nj->ni", data.earth_from_2, data.g2)
    return turn_about_vertical(heading, rate_2) - rate_1


def _ringing_rad_s(data: Datasets, axes: Axes) -> float:
    """Root mean square of the off-axis rate above 3 Hz while something moves."""
    knots = heading_from_axes(data, axes[0][None], axes[1][None])
    relative = _relative_rate(data, data.heading(knots[0]))
    across = np.stack([np.sum(relative * (data.earth_from_1 @ v), axis=1) for v in joint_frame(axes[0])], axis=1)
    is_moving = np.sum(data.g1**2 + data.g2**2, axis=1) > MOVING_RAD_S**2
    above = [ringing(across[data.stretch == s], pair.step_s) for s, pair in enumerate(data.pairs)]
    rung = np.concatenate(above)[is_moving]
    return float(np.sqrt(np.mean(np.sum(rung**2, axis=1)))) if len(rung) else 0.0


def _principal(seen: FloatArray, weight: FloatArray, like: FloatArray) -> FloatArray:
    """First eigenvector (3,) of the weighted scatter of vectors (n, 3), on the side of `like`."""
    axis = np.linalg.eigh(seen.T @ (seen * weight[:, None]))[1][:, 2]
    return axis * np.sign(axis @ like)

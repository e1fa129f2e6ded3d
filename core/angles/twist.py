"""The joint angle: the twist of the relative orientation about the joint axis.

On a human joint the integral of g1.j1 - g2.j2 (eq 11) collects what moves beside the axis; the twist does not.
"""

from functools import lru_cache

import numpy as np
from scipy.signal import butter, sosfiltfilt

from core.samples import FloatArray
from core.signal.pair import Pair
from core.signal.rotations import joint_frame, turn_about_vertical

RINGING_HZ = 3.0
MIN_FILTERED = 10  # samples; the filter wants more than nine at either end


def twist(pair: Pair, axis_1: FloatArray, axis_2: FloatArray, heading_rad: FloatArray) -> FloatArray:
    """Give the rotation (n,) of distal against proximal segment about the joint axis (3,), rad, unwrapped.
    theta = arg(u - i v), u = z(R12 x2), v = z(R12 y2) in sensor 1's joint plane; sign and zero of -alpha in
    Seel et al. 2014, eqs 10 to 14. `heading_rad` (n,): distal earth in the proximal one's.
    """
    x1, y1 = _in_earth(pair.earth_from_1, axis_1)
    x2, y2 = (turn_about_vertical(heading_rad, v) for v in _in_earth(pair.earth_from_2, axis_2))
    cosine = _dot(x2, x1) + _dot(y2, y1)
    sine = _dot(x2, y1) - _dot(y2, x1)
    return np.unwrap(np.arctan2(sine, cosine))


def off_axis_rate(pair: Pair, axis_1: FloatArray, heading_rad: FloatArray) -> FloatArray:
    """Give the relative rate across the joint axis (n, 2), rad/s, in the proximal joint plane; 0 on a hinge."""
    rate_1 = np.einsum("nij,nj->ni", pair.earth_from_1, pair.g1)
    rate_2 = turn_about_vertical(heading_rad, np.einsum("nij,nj->ni", pair.earth_from_2, pair.g2))
    relative = rate_2 - rate_1
    return np.stack([_dot(relative, v) for v in _in_earth(pair.earth_from_1, axis_1)], axis=1)


def _in_earth(earth_from: FloatArray, axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The x and y (n, 3) of a sensor's joint frame as its earth sees them, for rotations (n, 3, 3)."""
    seen = (earth_from.reshape(-1, 3) @ np.stack(joint_frame(axis), axis=1)).reshape(-1, 3, 2)
    return seen[..., 0], seen[..., 1]


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ni,ni->n", a, b))


def ringing(off_axis: FloatArray, step_s: float) -> FloatArray:
    """Give the part of an off-axis rate (n, 2) above 3 Hz; all of it at low sampling rates or short stretches."""
    if 1 / step_s < 4 * RINGING_HZ or len(off_axis) < MIN_FILTERED:
        return off_axis
    return np.asarray(sosfiltfilt(_above_ringing(step_s), off_axis, axis=0))


@lru_cache(maxsize=64)
def _above_ringing(step_s: float) -> FloatArray:
    return np.asarray(butter(2, RINGING_HZ, "highpass", fs=1 / step_s, output="sos"))

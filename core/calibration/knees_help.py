"""Axis of a person's ankle that is known from walking alone, with the help of the knee above.

What tissue and the joint's second axis do in walking bends the axis that an ankle shows by itself. The knee's axis in
the shank comes from another pair of sensors and lies nearly parallel to it, so that the middle of both is a better one.
"""

import numpy as np

from core.samples import FloatArray

SHARE = 0.5  # of the knee in the ankle's axis
MIN_ALIGNMENT = 0.5  # farther apart, one of both is not what it is taken for
Axes = tuple[FloatArray, FloatArray]


def helped_by_knee(axes: Axes, knee_axis: FloatArray, downs: Axes) -> Axes | None:
    """Move an ankle's axes (3,) towards its knee's (shank's sensor); None where they are not of one direction."""
    one, two = axes
    along = float(one @ knee_axis)
    if abs(along) < MIN_ALIGNMENT:
        return None
    middle = (1 - SHARE) * one + SHARE * np.sign(along) * knee_axis
    middle /= np.linalg.norm(middle)
    return middle, _triad(two, downs[1]) @ _triad(one, downs[0]).T @ middle


def _triad(axis: FloatArray, down: FloatArray) -> FloatArray:
    """Right-handed columns (3, 3): the axis, what of `down` is across it, and the third."""
    across = down - axis * (axis @ down)
    across /= np.linalg.norm(across)
    return np.stack([axis, across, np.cross(axis, across)], axis=1)

"""Anatomical frames of pelvis and thigh, and the angles between them and against the vertical."""

import numpy as np

from core.samples import FloatArray
from core.signal.rotations import cross, turn_about_vertical


def segment_frame(up: FloatArray, left: FloatArray) -> FloatArray:
    """Give the rows x forward, y left, z up (3, 3) of a segment, in sensor axes; `left` (3,) is made level."""
    z = up / np.linalg.norm(up)
    y = left - (left @ z) * z
    y = y / np.linalg.norm(y)
    return np.stack([cross(y, z), y, z])


def seen_from_pelvis(
    earth_from_pelvis: FloatArray, earth_from_thigh: FloatArray, heading: FloatArray, direction: FloatArray
) -> FloatArray:
    """Average a thigh direction (3,) in pelvis sensor axes; shorter than 1 by its swing. Heading (n,), rad."""
    in_earth = turn_about_vertical(heading, earth_from_thigh @ direction)
    return np.asarray(np.einsum("nij,ni->j", earth_from_pelvis, in_earth) / len(heading))


def pitch_and_roll(frame: FloatArray, earth_from_sensor: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give pitch (upper end forward) and roll (left side up) of a segment, (n,) rad, without heading."""
    v = earth_from_sensor[:, 2, :] @ frame.T
    return np.unwrap(np.arctan2(-v[:, 0], v[:, 2])), np.arcsin(np.clip(v[:, 1], -1.0, 1.0))


def heading_of(frame: FloatArray, earth_from_sensor: FloatArray) -> FloatArray:
    """Give a segment's heading (n,) in its sensor's earth, rad, positive to the left, without jumps."""
    forward = earth_from_sensor @ frame[0]
    return np.asarray(np.unwrap(np.arctan2(forward[:, 1], forward[:, 0])))


def hip_cardan(
    pelvis_frame: FloatArray,
    thigh_frame: FloatArray,
    earth_from_pelvis: FloatArray,
    earth_from_thigh: FloatArray,
    heading: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Give thigh turns (n,) in the pelvis about y, then x', rad: Cardan angles y-x'-z''.
    Flexion is the negated first; the second is abduction of the left hip, adduction of the right one.
    """
    in_earth = turn_about_vertical(heading, earth_from_thigh @ thigh_frame[2])  # the thigh's z is all that it takes
    z = np.einsum("nij,ni->nj", earth_from_pelvis, in_earth) @ pelvis_frame.T
    return np.unwrap(np.arctan2(z[:, 0], z[:, 2])), np.arcsin(np.clip(-z[:, 1], -1.0, 1.0))

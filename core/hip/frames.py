"""Anatomical frames of pelvis and thigh, and the angles between them and against the vertical."""

import numpy as np

from core.samples import FloatArray
from core.signal.rotations import cross, turn_about_vertical


def segment_frame(up: FloatArray, left: FloatArray) -> FloatArray:
    """Rows x forward, y left, z up (3, 3) of a segment, in sensor axes: what turns sensor axes into the segment's.

    Parameters
    ----------
    up : (3,)
        The vertical in standing, in sensor axes, of any length.
    left : (3,)
        Roughly to the left of the patient, in sensor axes; made level.

    Returns
    -------
    (3, 3)
        Unit vectors.
    """
    z = up / np.linalg.norm(up)
    y = left - (left @ z) * z
    y = y / np.linalg.norm(y)
    return np.stack([cross(y, z), y, z])


def seen_from_pelvis(
    earth_from_pelvis: FloatArray, earth_from_thigh: FloatArray, heading: FloatArray, direction: FloatArray
) -> FloatArray:
    """Mean over the samples of a direction of the thigh, in the axes of the pelvis's sensor; no unit vector.

    Parameters
    ----------
    earth_from_pelvis, earth_from_thigh : (n, 3, 3)
    heading : (n,)
        Of the thigh's earth in the pelvis's, rad.
    direction : (3,)
        In the thigh's sensor's axes.

    Returns
    -------
    (3,)
        Shorter than 1 by how much the direction swings.
    """
    in_earth = turn_about_vertical(heading, earth_from_thigh @ direction)
    return np.asarray(np.einsum("nij,ni->j", earth_from_pelvis, in_earth) / len(heading))


def pitch_and_roll(frame: FloatArray, earth_from_sensor: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Pitch (upper end forward) and roll (left side up) of a segment against the vertical (n,), rad; without heading.

    Parameters
    ----------
    frame : (3, 3)
        Of the segment, as `segment_frame` gives it.
    earth_from_sensor : (n, 3, 3)

    Returns
    -------
    (n,) and (n,)
        rad; the pitch without jumps.
    """
    v = earth_from_sensor[:, 2, :] @ frame.T
    return np.unwrap(np.arctan2(-v[:, 0], v[:, 2])), np.arcsin(np.clip(v[:, 1], -1.0, 1.0))


def heading_of(frame: FloatArray, earth_from_sensor: FloatArray) -> FloatArray:
    """Heading of a segment in its sensor's own earth, positive to the left, without jumps.

    Parameters
    ----------
    frame : (3, 3)
        Of the segment, as `segment_frame` gives it.
    earth_from_sensor : (n, 3, 3)

    Returns
    -------
    (n,)
        rad.
    """
    forward = earth_from_sensor @ frame[0]
    return np.asarray(np.unwrap(np.arctan2(forward[:, 1], forward[:, 0])))


def hip_cardan(
    pelvis_frame: FloatArray,
    thigh_frame: FloatArray,
    earth_from_pelvis: FloatArray,
    earth_from_thigh: FloatArray,
    heading: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Turns (n,) of the thigh in the pelvis about y, then x', rad: Cardan angles y-x'-z''.

    Flexion is the first, turned round. The second is abduction of the left hip, adduction of the right one.

    Parameters
    ----------
    pelvis_frame, thigh_frame : (3, 3)
    earth_from_pelvis, earth_from_thigh : (n, 3, 3)
    heading : (n,)
        Of the thigh's earth in the pelvis's, rad.

    Returns
    -------
    (n,) and (n,)
        rad; the first without jumps.
    """
    in_earth = turn_about_vertical(heading, earth_from_thigh @ thigh_frame[2])  # the thigh's z is all that it takes
    z = np.einsum("nij,ni->nj", earth_from_pelvis, in_earth) @ pelvis_frame.T
    return np.unwrap(np.arctan2(z[:, 0], z[:, 2])), np.arcsin(np.clip(-z[:, 1], -1.0, 1.0))

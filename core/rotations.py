"""The few things about directions and rotations that SciPy's Rotation lacks."""

import numpy as np
from scipy.spatial.transform import Rotation

from core.samples import ComplexArray, FloatArray


def cross_matrix(v: FloatArray) -> FloatArray:
    """[v]x of vectors (..., 3), so that cross_matrix(v) @ w is v x w; (..., 3, 3)."""
    matrix = np.zeros((*v.shape[:-1], 3, 3))
    matrix[..., 0, 1], matrix[..., 0, 2] = -v[..., 2], v[..., 1]
    matrix[..., 1, 0], matrix[..., 1, 2] = v[..., 2], -v[..., 0]
    matrix[..., 2, 0], matrix[..., 2, 1] = -v[..., 1], v[..., 0]
    return matrix


def joint_frame(axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors x, y spanning the plane normal to `axis`, with (x, y, axis) right-handed.

    x = (j x c)/|j x c| with c the unit vector least parallel to j, y = j x x (Seel et al. 2014, eq 13).

    Parameters
    ----------
    axis : (..., 3)
        Unit vectors.
    """
    c = np.eye(3)[np.argmin(np.abs(axis), axis=-1)]
    x = np.cross(axis, c)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    return x, np.cross(axis, x)


def turn_about_vertical(heading_rad: FloatArray, v: FloatArray) -> FloatArray:
    """Rz(heading) v for headings (...,) and vectors (..., 3)."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    x = c * v[..., 0] - s * v[..., 1]
    return np.stack([x, s * v[..., 0] + c * v[..., 1], np.broadcast_to(v[..., 2], x.shape)], axis=-1)


def matrix_from_quaternion(q: FloatArray) -> FloatArray:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4), scalar first."""
    return Rotation.from_quat(q, scalar_first=True).as_matrix()


def angle_between(a: FloatArray, b: FloatArray) -> float:
    """Angle between two vectors (3,), radians; exact for small angles too."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), np.dot(a, b)))


def wrap(angle_rad: FloatArray) -> FloatArray:
    """Angles brought to -pi..pi."""
    return (angle_rad + np.pi) % (2 * np.pi) - np.pi


def in_plane(v: FloatArray, axis: FloatArray) -> ComplexArray:
    """Vectors (n, 3) seen in the plane normal to `axis`, as complex numbers v.x + i v.y (eq 13)."""
    x, y = joint_frame(axis)
    return np.asarray(v @ x + 1j * (v @ y))

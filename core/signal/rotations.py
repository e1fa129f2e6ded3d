"""The few things about directions and rotations that SciPy's Rotation lacks."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from core.samples import ComplexArray, FloatArray


def cross_matrix(v: FloatArray) -> FloatArray:
    """Give [v]x (..., 3, 3) of vectors (..., 3), so that cross_matrix(v) @ w is v x w."""
    matrix = np.zeros((*v.shape[:-1], 3, 3))
    matrix[..., 0, 1], matrix[..., 0, 2] = -v[..., 2], v[..., 1]
    matrix[..., 1, 0], matrix[..., 1, 2] = v[..., 2], -v[..., 0]
    matrix[..., 2, 0], matrix[..., 2, 1] = -v[..., 1], v[..., 0]
    return matrix


def joint_frame(axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give unit vectors x, y normal to unit `axis` (..., 3), with (x, y, axis) right-handed.
    x = (j x c)/|j x c| with c the unit vector least parallel to j, y = j x x (Seel et al. 2014, eq 13).
    """
    if axis.ndim == 1:
        return _frame_of_one(*axis.tolist())
    c = np.eye(3)[np.argmin(np.abs(axis), axis=-1)]
    x = cross(axis, c)
    x /= np.sqrt(np.sum(x**2, axis=-1, keepdims=True))
    return x, cross(axis, x)


def _frame_of_one(a: float, b: float, c: float) -> tuple[FloatArray, FloatArray]:
    """As `joint_frame`, of one axis, for which arrays are slow."""
    least = min(abs(a), abs(b), abs(c))
    if abs(a) == least:
        x = 0.0, c, -b
    elif abs(b) == least:
        x = -c, 0.0, a
    else:
        x = b, -a, 0.0
    length = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2)
    p, q, r = x[0] / length, x[1] / length, x[2] / length
    return np.array([p, q, r]), np.array([b * r - c * q, c * p - a * r, a * q - b * p])


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Compute a x b of vectors (..., 3); several times faster than NumPy's on a few of them."""
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        product[..., k] = a[..., i] * b[..., j] - a[..., j] * b[..., i]
    return product


def turn_about_vertical(heading_rad: FloatArray, v: FloatArray) -> FloatArray:
    """Give Rz(heading) v of vectors (..., 3) in earth axes, z up; headings (...,) are positive to the left."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    turned = np.empty((*np.broadcast_shapes(c.shape, v.shape[:-1]), 3))
    turned[..., 0] = c * v[..., 0] - s * v[..., 1]
    turned[..., 1] = s * v[..., 0] + c * v[..., 1]
    turned[..., 2] = v[..., 2]
    return turned


def quaternions_about_vertical(heading_rad: FloatArray, q: FloatArray) -> FloatArray:
    """Give Rz(heading) q of quaternions (n, 4), earth from sensor, scalar first, earth z up; headings (n,)."""
    c, s = np.cos(0.5 * heading_rad), np.sin(0.5 * heading_rad)
    w, x, y, z = q.T
    return np.stack([c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w], axis=1)


def matrix_from_quaternion(q: FloatArray) -> FloatArray:
    """Give the rotation matrices (n, 3, 3) of unit quaternions (n, 4), scalar first."""
    return Rotation.from_quat(q, scalar_first=True).as_matrix()


def angle_between(a: FloatArray, b: FloatArray) -> float:
    """Give the angle between two vectors (3,) in rad, 0 to pi; exact for small angles too."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), np.dot(a, b)))


def wrap(angle_rad: FloatArray) -> FloatArray:
    """Wrap angles to -pi..pi."""
    return (angle_rad + np.pi) % (2 * np.pi) - np.pi


def in_plane(v: FloatArray, axis: FloatArray) -> ComplexArray:
    """Project (n, 3) to the plane normal to unit `axis` as v.x + i v.y.
    Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, eq 13.
    """
    x, y = joint_frame(axis)
    return np.asarray(v @ x + 1j * (v @ y))

"""Tests that the few helpers about directions match their names."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from core.samples import FloatArray
from core.signal.rotations import (
    angle_between,
    cross_matrix,
    joint_frame,
    matrix_from_quaternion,
    quaternions_about_vertical,
    turn_about_vertical,
    wrap,
)

vectors = arrays(np.float64, 3, elements=st.floats(-10, 10, allow_subnormal=False))
directions = vectors.filter(lambda v: np.linalg.norm(v) > 1e-3).map(lambda v: v / np.linalg.norm(v))


@given(vectors, vectors)
def test_the_cross_matrix_is_the_cross_product(v: FloatArray, w: FloatArray) -> None:
    np.testing.assert_allclose(cross_matrix(v) @ w, np.cross(v, w), atol=1e-12)


@given(directions)
def test_a_joint_frame_is_right_handed_and_as_in_eq_13(axis: FloatArray) -> None:
    x, y = joint_frame(axis)
    np.testing.assert_allclose(np.stack([x, y, axis]) @ np.stack([x, y, axis]).T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(np.cross(x, y), axis, atol=1e-12)
    c = np.eye(3)[np.argmin(np.abs(axis))]
    np.testing.assert_allclose(x, np.cross(axis, c) / np.linalg.norm(np.cross(axis, c)), atol=1e-12)


def test_joint_frames_of_many_axes_are_those_of_each() -> None:
    axes = np.random.default_rng(0).normal(size=(5, 4, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    x, y = joint_frame(axes)
    for index in np.ndindex(5, 4):
        one_x, one_y = joint_frame(axes[index])
        np.testing.assert_allclose(x[index], one_x)
        np.testing.assert_allclose(y[index], one_y)


@given(st.floats(-7, 7), vectors)
def test_turning_about_the_vertical_is_a_rotation_about_z(heading: float, v: FloatArray) -> None:
    expected = Rotation.from_rotvec([0.0, 0.0, heading]).apply(v)
    np.testing.assert_allclose(turn_about_vertical(np.array(heading), v), expected, atol=1e-12)


@given(st.floats(-7, 7), directions)
def test_quaternions_turned_about_the_vertical_turn_vectors_so(heading: float, axis: FloatArray) -> None:
    before = Rotation.from_rotvec(axis)
    turned = quaternions_about_vertical(np.array([heading]), before.as_quat(scalar_first=True)[None])
    expected = (Rotation.from_rotvec([0.0, 0.0, heading]) * before).as_matrix()
    np.testing.assert_allclose(matrix_from_quaternion(turned)[0], expected, atol=1e-12)


def test_matrices_of_quaternions_are_scalar_first() -> None:
    turn = matrix_from_quaternion(np.array([[np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]]))
    np.testing.assert_allclose(turn[0] @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 1.0, np.pi - 1e-9, np.pi])
def test_angles_between_directions_are_exact_also_when_tiny(angle: float) -> None:
    a, b = np.array([2.0, 0.0, 0.0]), 5 * np.array([np.cos(angle), np.sin(angle), 0.0])
    assert angle_between(a, b) == pytest.approx(angle, abs=1e-15, rel=1e-6)


@given(st.floats(-50, 50))
def test_wrapping_keeps_the_direction(angle: float) -> None:
    found = float(wrap(np.array(angle)))
    assert -np.pi <= found <= np.pi
    assert np.exp(1j * found) == pytest.approx(np.exp(1j * angle), abs=1e-12)

"""Tests that the paper's own identification of axes follows its slopes to the axes of a hinge."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.body import Joint
from core.published import joint_axis
from core.published.joint_axis import axis_from_angles, constraint, identify_axes
from core.published.signs import signs_match
from core.samples import FloatArray
from core.signal.rotations import angle_between
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE
STEP = 1e-6
angles = st.tuples(*[st.floats(-1.4, 1.4)] * 4)


@given(st.floats(-4, 4), st.floats(-4, 4))
def test_tangents_are_central_differences_of_unit_vectors(phi: float, theta: float) -> None:
    assert np.linalg.norm(axis_from_angles(phi, theta)) == pytest.approx(1.0)
    by_phi = (axis_from_angles(phi + STEP, theta) - axis_from_angles(phi - STEP, theta)) / (2 * STEP)
    by_theta = (axis_from_angles(phi, theta + STEP) - axis_from_angles(phi, theta - STEP)) / (2 * STEP)
    np.testing.assert_allclose(joint_axis._tangents(phi, theta), np.stack([by_phi, by_theta], axis=1), atol=1e-8)


@settings(max_examples=25)
@given(x=angles, seed=st.integers(0, 2**31))
def test_the_first_step_uses_slopes_that_are_central_differences(
    x: tuple[float, float, float, float], seed: int
) -> None:
    g1, g2 = np.random.default_rng(seed).normal(size=(2, 7, 3))
    at = np.array(x)
    seen: list[tuple[FloatArray, FloatArray]] = []
    solve = np.linalg.solve

    def watched(a: Any, b: Any) -> Any:
        seen.append((a.copy(), b.copy()))
        return solve(a, b)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(np.linalg, "solve", watched)
        joint_axis._gauss_newton(g1, g2, at)

    def error(y: FloatArray) -> FloatArray:
        return constraint(g1, g2, axis_from_angles(y[0], y[1]), axis_from_angles(y[2], y[3]))

    slope = np.stack([(error(at + STEP * e) - error(at - STEP * e)) / (2 * STEP) for e in np.eye(4)], axis=1)
    information = slope.T @ slope
    np.testing.assert_allclose(seen[0][1], slope.T @ error(at), atol=1e-4)
    np.testing.assert_allclose(seen[0][0], information, atol=1e-2 * np.abs(information).max())


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.LEFT_ANKLE])
def test_the_axes_of_a_hinge_are_found_however_the_sensors_are_turned(seed: int, joint: Joint) -> None:
    person = Person(seed=seed)
    pair = person.exact_pair(joint)
    j1, j2 = identify_axes(pair.g1[::10], pair.g2[::10])
    for site, axis in ((joint.proximal, j1), (joint.distal, j2)):
        truth = person.axis(site, joint)
        assert angle_between(axis * np.sign(axis @ truth), truth) < 1e-4


@pytest.mark.parametrize("seed", range(3))
def test_congruence_shows_whether_the_axes_point_the_same_way(seed: int) -> None:
    person = Person(seed=seed)
    pair = person.exact_pair(KNEE, duration_s=10.0)
    j1, j2 = (person.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal))
    for turn in (1.0, -1.0):
        same, clarity = signs_match(pair.g1, pair.g2, turn * j1, turn * j2, pair.step_s)
        mirrored, other = signs_match(pair.g1, pair.g2, turn * j1, -turn * j2, pair.step_s)
        assert same
        assert not mirrored
        assert clarity == pytest.approx(other)
        assert clarity > 0.01


def test_too_short_a_curve_shows_nothing() -> None:
    z = np.array([0.0, 0.0, 1.0])
    assert signs_match(np.ones((10, 3)), np.ones((10, 3)), z, z, 0.01)[1] == 0.0

"""Tests that the slopes of the centre's residual are right and the centre lies where it was put."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.body import Joint
from core.calibration import joint_centre
from core.calibration.coincidence import BIAS_PRIOR_M_S2, CENTRE_PRIOR_M
from core.calibration.joint_centre import (
    MIN_SD_HINGE_M,
    MIN_SD_HUMAN_M,
    SD_FACTOR_HINGE,
    SD_FACTOR_HUMAN,
    JointCentre,
    centre_by_lengths,
    centre_by_vectors,
    centre_sd_m,
    nearest_to_sensors,
)
from core.samples import FloatArray
from core.signal.datasets import Datasets, gather
from core.signal.robust import robust_sd
from core.signal.rotations import joint_frame
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE
PERSON = Person(seed=3)
STEP = 1e-5


@pytest.fixture(scope="module")
def data() -> Datasets:
    pair = PERSON.exact_pair(KNEE, heading_rad=0.5)
    return gather((pair,), [np.arange(5, 590, 3)])


def in_plane_error_m(found: FloatArray, truth: FloatArray, axis: FloatArray) -> float:
    return float(np.linalg.norm(np.stack(joint_frame(axis)) @ (found - truth)))


def lengths_apart(data: Datasets, x: FloatArray) -> FloatArray:
    """Eq 8 written out sample by sample, as the paper has it."""
    rows = []
    for k in range(len(data)):
        parts = []
        for a, g, dg, o, b in (
            (data.a1[k], data.g1[k], data.dg1[k], x[0:3], x[6:9]),
            (data.a2[k], data.g2[k], data.dg2[k], x[3:6], x[9:12]),
        ):
            parts.append(np.linalg.norm(a - b - np.cross(g, np.cross(g, o)) - np.cross(dg, o)))
        rows.append(parts[0] - parts[1])
    return np.array(rows)


@pytest.mark.endurance
@settings(max_examples=8)
@given(seed=st.integers(0, 2**31))
def test_the_first_step_uses_slopes_that_are_central_differences(data: Datasets, seed: int) -> None:
    x = np.random.default_rng(seed).normal(scale=0.1, size=12)
    seen: list[tuple[FloatArray, FloatArray]] = []
    solve = np.linalg.solve

    def watched(a: Any, b: Any) -> Any:
        seen.append((a.copy(), b.copy()))
        return solve(a, b)

    few = data.only(np.arange(len(data)) % 20 == 0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(np.linalg, "solve", watched)
        centre_by_lengths(few, x)
    information, gradient = seen[0]
    error = lengths_apart(few, x)
    slope = np.stack(
        [(lengths_apart(few, x + STEP * e) - lengths_apart(few, x - STEP * e)) / (2 * STEP) for e in np.eye(12)], axis=1
    )
    scale = max(joint_centre.MIN_SCALE_M_S2, robust_sd(error))
    weight = 1 / np.sqrt(1 + (error / scale) ** 2) / scale**2
    prior = np.diag([CENTRE_PRIOR_M**-2] * 6 + [BIAS_PRIOR_M_S2**-2] * 6)
    expected = slope.T @ (weight * error) + prior @ x
    np.testing.assert_allclose(gradient, expected, atol=1e-5 * np.abs(expected).max())
    required = (slope * weight[:, None]).T @ slope + prior
    np.testing.assert_allclose(information, required, atol=1e-5 * np.abs(required).max())


def test_both_forms_find_a_hinge_s_centre_in_the_plane_normal_to_its_axis(data: Datasets) -> None:
    by_vectors = centre_by_vectors(data, np.full(data.knots, 0.5))
    for found in (by_vectors, centre_by_lengths(data, by_vectors.unknowns), centre_by_lengths(data, np.zeros(12))):
        for site, o in ((KNEE.proximal, found.proximal_m), (KNEE.distal, found.distal_m)):
            assert in_plane_error_m(o, PERSON.centre_m(site, KNEE), PERSON.axis(site, KNEE)) < 0.001


def test_eq_9_takes_the_point_of_the_axis_nearest_to_both_sensors() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        j1, j2 = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        o1, o2 = rng.normal(size=(2, 3))
        one, two = nearest_to_sensors(JointCentre(np.concatenate([o1, o2, np.zeros(6)]), np.eye(12)), j1, j2)
        assert one @ j1 + two @ j2 == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(np.cross(one - o1, j1), 0.0, atol=1e-12)
        # the same point: both move by the same length along the axis, and any other point is farther
        along = float((o1 - one) @ j1)
        assert float((o2 - two) @ j2) == pytest.approx(along, abs=1e-12)
        least = one @ one + two @ two
        for shift in (-0.01, 0.01):
            assert np.sum((one + shift * j1) ** 2) + np.sum((two + shift * j2) ** 2) > least


def test_the_spread_of_a_centre_is_that_of_its_weakest_observable_direction() -> None:
    z = np.array([0.0, 0.0, 1.0])
    covariance = np.diag([1e-4, 4e-4, 1.0] * 2 + [1.0] * 6)
    centre = JointCentre(np.zeros(12), covariance)
    assert centre_sd_m(centre, z, z, is_hinge=False, is_knee=True) == pytest.approx(SD_FACTOR_HUMAN * 0.02, rel=0.03)
    assert centre_sd_m(centre, z, z, is_hinge=True, is_knee=False) == pytest.approx(SD_FACTOR_HINGE * 0.02, rel=0.03)
    assert centre_sd_m(centre, z, z, is_hinge=False, is_knee=False) == pytest.approx(SD_FACTOR_HUMAN, rel=1e-3)
    sure = JointCentre(np.zeros(12), 1e-12 * np.eye(12))
    assert centre_sd_m(sure, z, z, is_hinge=True, is_knee=True) == pytest.approx(MIN_SD_HINGE_M, rel=1e-3)
    assert centre_sd_m(sure, z, z, is_hinge=False, is_knee=True) == pytest.approx(MIN_SD_HUMAN_M, rel=1e-3)
    loose = centre_sd_m(sure, z, z, is_hinge=True, is_knee=True, looseness=0.03)
    assert loose == pytest.approx(np.hypot(MIN_SD_HINGE_M, 0.03 * CENTRE_PRIOR_M), rel=1e-3)


def test_what_no_motion_shows_of_a_centre_is_as_uncertain_as_before(data: Datasets) -> None:
    still = replace(data, g1=0 * data.g1, dg1=0 * data.dg1)
    found = centre_by_lengths(still, np.zeros(12))
    assert found.covariance[:3, :3] == pytest.approx(CENTRE_PRIOR_M**2 * np.eye(3), rel=1e-6, abs=1e-9)
    assert np.linalg.eigvalsh(centre_by_lengths(data, np.zeros(12)).covariance[:3, :3])[0] < 0.01**2


@pytest.mark.endurance
def test_residuals_count_with_four_times_the_spread_they_show(data: Datasets) -> None:
    """The covariance of eq 8 across the axis: slopes by differences, residuals in blocks of a second."""
    rng = np.random.default_rng(8)
    noisy = replace(data, a1=data.a1 + 0.3 * rng.normal(size=data.a1.shape))
    found = centre_by_lengths(noisy, np.zeros(12))
    x = found.unknowns
    error = lengths_apart(noisy, x)
    slope = np.stack(
        [(lengths_apart(noisy, x + STEP * e) - lengths_apart(noisy, x - STEP * e)) / (2 * STEP) for e in np.eye(12)],
        axis=1,
    )
    scale = 1.4826 * np.median(np.abs(error))
    weight = 1 / np.sqrt(1 + (error / scale) ** 2) / scale**2
    information = (slope * weight[:, None]).T @ slope
    inverse = np.linalg.inv(information)
    second = np.floor(noisy.time_s - noisy.time_s[0]).astype(int)
    pushes = np.array([(slope * (weight * error)[:, None])[second == k].sum(axis=0) for k in range(second.max() + 1)])
    by_residuals = inverse @ pushes.T @ pushes @ inverse
    shift = 0.0004 * np.sqrt(np.sum(noisy.dg1**2 + noisy.dg2**2, axis=1))  # m/s2, of 0.4 mm in step with the limb
    prior = np.diag([0.3**-2] * 6 + [0.05**-2] * 6)
    unseen = np.linalg.inv(information / (1 + np.sum(weight * shift**2)) + prior)
    expected = unseen + (4.0 / 2.5) ** 2 * by_residuals  # a human joint's sd is reported 2.5 times as large
    for site, part in ((KNEE.proximal, slice(0, 3)), (KNEE.distal, slice(3, 6))):
        across = np.stack(joint_frame(PERSON.axis(site, KNEE)))
        reported, required, shown = (
            across @ covariance[part, part] @ across.T for covariance in (found.covariance, expected, by_residuals)
        )
        np.testing.assert_allclose(reported, required, rtol=0.01, atol=0.01 * np.trace(required))
        assert np.trace(shown) > 0.2 * np.trace(required)

"""Tests that the stricter method finds the axis of a true hinge, by slopes that are right."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.body import Joint, Site
from core.calibration import hinge
from core.calibration.hinge import hinge_axes, hinge_residual, in_plane_difference
from core.calibration.joint_axis import moved
from core.signal.datasets import Datasets, gather
from core.signal.robust import robust_sd
from core.signal.rotations import angle_between
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE
PERSON = Person(seed=3)
STEP = 1e-6


@pytest.fixture(scope="module")
def data() -> Datasets:
    pair = PERSON.exact_pair(KNEE)
    return gather((pair,), [np.arange(5, 590, 5)])


@settings(max_examples=20)
@given(seed=st.integers(0, 2**31))
def test_slopes_are_central_differences(data: Datasets, seed: int) -> None:
    rng = np.random.default_rng(seed)
    j1, j2 = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
    shifted = data.a1 + rng.normal(size=3), data.a2 + rng.normal(size=3)
    _, slope = hinge._residuals(data, *shifted, j1, j2)
    for k in range(4):
        step = np.zeros((1, 2))
        step[0, k % 2] = STEP

        def at(sign: float, k: int = k, step: np.ndarray = step) -> np.ndarray:
            one = moved(j1[None], sign * step)[0] if k < 2 else j1
            two = moved(j2[None], sign * step)[0] if k >= 2 else j2
            return hinge._residuals(data, *shifted, one, two)[0]

        expected = (at(1) - at(-1)) / (2 * STEP)
        np.testing.assert_allclose(slope[..., k], expected, atol=1e-5 * np.abs(slope).max())


def test_at_the_true_axes_nothing_is_left_over(data: Datasets) -> None:
    j1, j2 = (PERSON.axis(site, KNEE) for site in (Site.LEFT_THIGH, Site.LEFT_SHANK))
    np.testing.assert_allclose(in_plane_difference(data, j1, j2), 0.0, atol=1e-7)
    assert hinge_residual(data, j1, j2) < 1e-7
    centres = np.concatenate([PERSON.centre_m(s, KNEE) for s in (Site.LEFT_THIGH, Site.LEFT_SHANK)] + [np.zeros(6)])
    found = hinge_axes(data, j1, j2, centres)
    assert found is not None
    assert angle_between(found[0], j1) < 1e-6
    assert angle_between(found[1], j2) < 1e-6


@pytest.mark.parametrize("seed", range(3))
def test_from_a_few_degrees_away_it_comes_back(data: Datasets, seed: int) -> None:
    truth = [PERSON.axis(site, KNEE) for site in (Site.LEFT_THIGH, Site.LEFT_SHANK)]
    centres = np.concatenate([PERSON.centre_m(s, KNEE) for s in (Site.LEFT_THIGH, Site.LEFT_SHANK)] + [np.zeros(6)])
    off = 0.05 * np.random.default_rng(seed).normal(size=(2, 1, 2))
    start = [moved(axis[None], step)[0] for axis, step in zip(truth, off, strict=True)]
    found = hinge_axes(data, start[0], start[1], centres)
    assert found is not None
    assert angle_between(found[0], truth[0]) < 1e-3
    assert angle_between(found[1], truth[1]) < 1e-3


def test_from_far_away_it_states_so_rather_than_lead_elsewhere(data: Datasets) -> None:
    j1 = moved(PERSON.axis(Site.LEFT_THIGH, KNEE)[None], np.array([[0.4, 0.0]]))[0]
    assert hinge_axes(data, j1, PERSON.axis(Site.LEFT_SHANK, KNEE), np.zeros(12)) is None


def test_the_robust_spread_is_the_standard_deviation_of_normal_noise_and_deaf_to_outliers() -> None:
    noise = np.random.default_rng(0).normal(scale=3.0, size=20000)
    assert robust_sd(noise) == pytest.approx(3.0, rel=0.03)
    noise[:1000] = 1e9
    assert robust_sd(noise) == pytest.approx(3.0, rel=0.1)
    assert np.isnan(robust_sd(np.empty(0)))

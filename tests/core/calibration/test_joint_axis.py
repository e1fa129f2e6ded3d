"""Tests that the slopes of the axes' residuals are right and the candidates hold the truth."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.body import Joint, Site
from core.calibration.joint_axis import (
    Candidates,
    candidates,
    heading_from_axes,
    heading_prior,
    knot_weights,
    loss_and_weights,
    moved,
    polish,
    residuals,
)
from core.samples import FloatArray
from core.signal.datasets import Datasets, gather
from core.signal.rotations import angle_between, wrap
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE
STEP = 1e-6


@pytest.fixture(scope="module")
def few() -> Datasets:
    """Samples of a joint that is a perfect hinge, but seen from arbitrary axes the residuals are large."""
    pair = Person(seed=3).exact_pair(KNEE, duration_s=25.0, rate_hz=50.0, heading_rad=1.0)
    return gather((pair,), [np.arange(10, len(pair) - 10, 60)])


def random_axes(seed: int, count: int = 2) -> FloatArray:
    axes = np.random.default_rng(seed).normal(size=(count, 3))
    return axes / np.linalg.norm(axes, axis=1, keepdims=True)


def central(at_plus: FloatArray, at_minus: FloatArray) -> FloatArray:
    return (at_plus - at_minus) / (2 * STEP)


@settings(max_examples=15)
@given(seed=st.integers(0, 2**31), scales=st.tuples(st.floats(0.05, 1.0), st.floats(0.01, 0.5)))
def test_slopes_by_the_axes_are_central_differences(few: Datasets, seed: int, scales: tuple[float, float]) -> None:
    j1, j2 = random_axes(seed), random_axes(seed + 1)
    heading = np.random.default_rng(seed).uniform(-3, 3, (2, len(few)))
    r = residuals(few, j1, j2, heading, *scales)
    for k in range(4):
        tangent = np.zeros((2, 2))
        tangent[:, k % 2] = STEP

        def at(sign: float, k: int = k, tangent: FloatArray = tangent) -> FloatArray:
            one, two = (moved(j1, sign * tangent), j2) if k < 2 else (j1, moved(j2, sign * tangent))
            # seen along the tangents at the point where the slope is taken: project on the frames of j1, j2
            return residuals(few, one, two, heading, *scales).value

        found, expected = r.by_axes[..., k], central(at(1), at(-1))
        scale = np.abs(r.by_axes).max()
        np.testing.assert_allclose(found[..., 4:], expected[..., 4:], atol=1e-5 * scale)
        # the frame's x, y turn about the axis with it (a gauge), which changes components but not their length
        for group in (slice(0, 2), slice(2, 4)):
            by_length = 2 * np.sum(r.value[..., group] * found[..., group], axis=-1)
            plus, minus = (np.sum(at(s)[..., group] ** 2, axis=-1) for s in (1, -1))
            np.testing.assert_allclose(by_length, central(plus, minus), atol=1e-4 * scale**2)


@settings(max_examples=15)
@given(seed=st.integers(0, 2**31), scales=st.tuples(st.floats(0.05, 1.0), st.floats(0.01, 0.5)))
def test_slopes_by_the_heading_are_central_differences(few: Datasets, seed: int, scales: tuple[float, float]) -> None:
    j1, j2 = random_axes(seed), random_axes(seed + 1)
    heading = np.random.default_rng(seed).uniform(-3, 3, (2, len(few)))
    r = residuals(few, j1, j2, heading, *scales)
    plus, minus = (residuals(few, j1, j2, heading + s * STEP, *scales).value for s in (1, -1))
    np.testing.assert_allclose(r.by_heading, central(plus, minus), atol=1e-5 * np.abs(r.by_heading).max())


@settings(max_examples=10)
@given(seed=st.integers(0, 2**31))
def test_slopes_are_exact_where_the_frame_is_still(few: Datasets, seed: int) -> None:
    """Components along fixed x, y: the off-axis rate's own slopes, without the gauge."""
    j1, j2 = random_axes(seed, 1), random_axes(seed + 1, 1)
    heading = np.zeros((1, len(few)))
    r = residuals(few, j1, j2, heading, 1.0, 1.0)
    relative = np.einsum("nij,nj->ni", few.earth_from_2, few.g2) - np.einsum("nij,nj->ni", few.earth_from_1, few.g1)
    in_1 = np.einsum("nij,ni->nj", few.earth_from_1, relative) / np.sqrt(2)
    in_2 = np.einsum("nij,ni->nj", few.earth_from_2, relative) / np.sqrt(2)
    for group, seen, axis in ((0, in_1, j1[0]), (2, in_2, j2[0])):
        for k in range(2):
            np.testing.assert_allclose(r.by_axes[0, :, group + k, group + k], -seen @ axis, atol=1e-10)
            assert not r.by_axes[0, :, group + k, group + 1 - k].any()
            assert not r.by_axes[0, :, group + k, 2 - group : 4 - group].any()


@settings(max_examples=20)
@given(seed=st.integers(0, 2**31), size=st.floats(0.01, 30))
def test_weights_times_residuals_are_half_the_slope_of_the_loss(seed: int, size: float) -> None:
    value = size * np.random.default_rng(seed).normal(size=(1, 5, 7))
    _, weight = loss_and_weights(value)
    for k in range(7):
        step = np.zeros_like(value)
        step[..., k] = 1e-5 * size
        plus, minus = (loss_and_weights(value + s * step)[0] for s in (1, -1))
        np.testing.assert_allclose(
            (plus - minus) / (2e-5 * size), 2 * weight[..., k] * value[..., k], rtol=1e-4, atol=1e-6
        )


def test_at_the_truth_nothing_is_left_over() -> None:
    person = Person(seed=3)
    pair = person.exact_pair(KNEE, heading_rad=0.8)
    data = gather((pair,), [np.arange(5, 500, 7)])
    j1, j2 = (person.axis(site, KNEE)[None] for site in (Site.LEFT_THIGH, Site.LEFT_SHANK))
    r = residuals(data, j1, j2, np.full((1, len(data)), 0.8), 0.3, 0.1)
    assert np.abs(r.value).max() < 1e-6
    knots = heading_from_axes(data, j1, j2)
    np.testing.assert_allclose(wrap(knots - 0.8), 0.0, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("joint", [Joint.LEFT_KNEE, Joint.RIGHT_ANKLE])
def test_the_truth_is_among_the_candidates_up_to_a_common_sign(seed: int, joint: Joint) -> None:
    person = Person(seed=seed)
    pair = person.exact_pair(joint, duration_s=8.0, heading_rad=2.0 * seed)
    data = gather((pair,), [np.arange(5, 790, 4)])
    found = polish(data, candidates(data, data, 0), 5)
    j1, j2 = person.axis(joint.proximal, joint), person.axis(joint.distal, joint)
    best = int(np.argmin(found.cost))
    sign = np.sign(found.axis_1[best] @ j1)
    assert angle_between(sign * found.axis_1[best], j1) < 1e-3
    assert angle_between(sign * found.axis_2[best], j2) < 1e-3
    np.testing.assert_allclose(wrap(found.knots_rad[best] - 2.0 * seed), 0.0, atol=1e-3)


def test_polishing_never_raises_the_cost_and_keeps_axes_of_unit_length(few: Datasets) -> None:
    start = Candidates(
        random_axes(5), random_axes(6), heading_from_axes(few, random_axes(5), random_axes(6)), np.full(2, np.inf)
    )
    before = loss_and_weights(
        residuals(few, start.axis_1, start.axis_2, few.heading(start.knots_rad), 0.3, 0.087).value
    )[0]
    after = polish(few, start, 8, 0.3, 0.087)
    assert np.all(after.cost < before.mean(axis=1))
    np.testing.assert_allclose(np.linalg.norm(after.axis_1, axis=1), 1.0)
    np.testing.assert_allclose(np.linalg.norm(after.axis_2, axis=1), 1.0)


def test_fixed_axes_stay(few: Datasets) -> None:
    j1, j2 = random_axes(7), random_axes(8)
    start = Candidates(j1, j2, heading_from_axes(few, j1, j2), np.full(2, np.inf))
    after = polish(few, start, 3, is_axis_fixed=True)
    np.testing.assert_allclose(after.axis_1, j1, atol=1e-12)
    np.testing.assert_allclose(after.axis_2, j2, atol=1e-12)


def test_shares_of_knots_interpolate_the_heading(few: Datasets) -> None:
    knots = np.random.default_rng(1).normal(size=(3, few.knots))
    np.testing.assert_allclose(knots @ knot_weights(few).T, few.heading(knots), atol=1e-12)
    np.testing.assert_allclose(knot_weights(few).sum(axis=1), 1.0)


def test_the_random_walk_does_not_link_two_stretches() -> None:
    pair = Person().exact_pair(KNEE, duration_s=20.0, rate_hz=50.0)
    data = gather((pair, pair), [np.arange(5, 900, 50), np.arange(5, 900, 50)])
    prior = heading_prior(data)
    assert data.knots == 6
    assert not prior[:3, 3:].any()
    np.testing.assert_allclose(prior @ np.ones(6), 0.0, atol=1e-6 * np.abs(prior).max())
    assert np.linalg.matrix_rank(prior) == 4

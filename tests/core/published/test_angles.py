"""Tests that eqs 10, 11, 14 and the twist share sign and zero on a hinge built from poses. Eq 15 fuses as reported."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.angles.twist import off_axis_rate, twist
from core.body import LEG_JOINTS, Joint
from core.published.angles import (
    angle_from_accelerations,
    angle_from_orientations,
    angle_from_rates,
    fused_angle,
    published_angle,
    unwrapped_about_trend,
)
from core.samples import FloatArray
from core.session import RecordingKind
from core.signal.pair import Pair
from core.signal.rotations import joint_frame, wrap
from tests.core.hinges import Person

Built = tuple[Person, Pair, FloatArray, FloatArray, FloatArray, FloatArray]


@pytest.fixture(scope="module", params=[(3, Joint.LEFT_KNEE), (4, Joint.RIGHT_ANKLE), (6, Joint.RIGHT_KNEE)])
def built(request: pytest.FixtureRequest) -> Built:
    """A person, exact samples of one hinge in one common earth, its axes in clinical sign and its centres."""
    seed, joint = request.param
    person = Person(seed=seed)
    pair = person.exact_pair(joint)
    axes = [person.axis(site, joint) for site in (joint.proximal, joint.distal)]
    centres = [person.centre_m(site, joint) for site in (joint.proximal, joint.distal)]
    return person, pair, axes[0], axes[1], centres[0], centres[1]


@pytest.fixture(scope="module")
def bend(built: Built, request: pytest.FixtureRequest) -> FloatArray:
    """Minus flexion from the x axis of the proximal frame: alpha as the geometry of the poses has it."""
    person, pair, j1, j2, _, _ = built
    joint = next(joint for joint in LEG_JOINTS if np.allclose(person.axis(joint.proximal, joint), j1))
    mounts = [person.mounting(site) for site in (joint.proximal, joint.distal)]
    x1, x2 = mounts[0].apply(joint_frame(j1)[0]), mounts[1].apply(joint_frame(j2)[0])
    axis = mounts[0].apply(j1)
    # in standing the segment frames coincide: there alpha is the angle from x2 to x1 about the axis
    standing = np.arctan2(np.cross(x2, x1) @ axis, x2 @ x1)
    return np.asarray(standing - person.truth(RecordingKind.FREE_MOTION, joint, pair.time_s))


def test_eq_10_is_the_angle_of_the_poses(built: Built, bend: FloatArray) -> None:
    _, pair, j1, j2, _, _ = built
    found = angle_from_orientations(pair.earth_from_1, pair.earth_from_2, j1, j2)
    np.testing.assert_allclose(wrap(found - bend), 0.0, atol=1e-7)


def test_eq_11_changes_as_the_angle_does(built: Built, bend: FloatArray) -> None:
    _, pair, j1, j2, _, _ = built
    found = angle_from_rates(pair.g1, pair.g2, j1, j2, pair.step_s)
    assert found[0] == 0.0
    np.testing.assert_allclose(found, bend - bend[0], atol=2e-3)


def test_eq_14_is_the_angle_of_the_poses_without_drift(built: Built, bend: FloatArray) -> None:
    _, pair, j1, j2, o1, o2 = built
    found = angle_from_accelerations(pair, j1, j2, o1, o2)
    reported = np.isfinite(found)
    assert np.count_nonzero(reported) > 0.8 * len(pair)
    np.testing.assert_allclose(wrap(found - bend)[reported], 0.0, atol=2e-3)


def test_eq_14_is_silent_where_its_accelerations_point_along_the_axis(built: Built) -> None:
    _, pair, j1, j2, o1, o2 = built
    lying = replace(pair, a1=pair.a1 * 0 + 9.81 * j1, g1=pair.g1 * 0, dg1=pair.dg1 * 0)
    assert np.isnan(angle_from_accelerations(lying, j1, j2, o1, o2)).all()


def test_the_twist_is_minus_alpha_with_the_same_zero(built: Built, bend: FloatArray) -> None:
    _, pair, j1, j2, _, _ = built
    found = twist(pair, j1, j2, np.zeros(len(pair)))
    np.testing.assert_allclose(wrap(found + bend), 0.0, atol=1e-7)
    assert np.abs(np.diff(found)).max() < 0.2
    np.testing.assert_allclose(off_axis_rate(pair, j1, np.zeros(len(pair))), 0.0, atol=1e-6)


def test_eq_15_has_the_sign_and_zero_of_all_others(built: Built, bend: FloatArray) -> None:
    _, pair, j1, j2, o1, o2 = built
    found = published_angle(pair, j1, j2, o1, o2)
    np.testing.assert_allclose(wrap(found - bend), 0.0, atol=5e-3)


def test_turning_both_axes_turns_every_angle(built: Built) -> None:
    _, pair, j1, j2, o1, o2 = built
    ways: tuple[Callable[[float], FloatArray], ...] = (
        lambda s: angle_from_orientations(pair.earth_from_1, pair.earth_from_2, s * j1, s * j2),
        lambda s: angle_from_rates(pair.g1, pair.g2, s * j1, s * j2, pair.step_s),
        lambda s: np.nan_to_num(angle_from_accelerations(pair, s * j1, s * j2, o1, o2)),
        lambda s: twist(pair, s * j1, s * j2, np.zeros(len(pair))),
    )
    for at in ways:
        one, other = np.unwrap(at(1)), np.unwrap(at(-1))
        np.testing.assert_allclose(wrap(one - one[9] + other - other[9]), 0.0, atol=1e-6)


@pytest.mark.parametrize("step_s", [0.005, 0.01, 0.02])
@pytest.mark.parametrize("tau_s", [0.5, 2.0, 8.0])
def test_eq_15_forgets_by_its_time_constant(step_s: float, tau_s: float) -> None:
    n = round((10 + 3 * tau_s) / step_s)
    jump_at = round(10 / step_s)
    reported = np.where(np.arange(n) >= jump_at, 0.3, 0.0)
    found = fused_angle(np.zeros(n), reported, step_s, tau_s)
    after = found[jump_at + round(tau_s / step_s)]
    assert after == pytest.approx(0.3 * (1 - np.exp(-1)), rel=0.03)
    np.testing.assert_allclose(found[:jump_at], 0.0, atol=1e-12)


@settings(max_examples=15)
@given(bias=st.floats(-0.05, 0.05), step_s=st.sampled_from([0.005, 0.01, 0.02]), tau_s=st.sampled_from([0.5, 1.0, 2.0]))
def test_a_bias_of_the_rates_leaves_the_documented_steady_offset(bias: float, step_s: float, tau_s: float) -> None:
    n = round(20 * tau_s / step_s)
    drift = bias * step_s * np.arange(n)
    found = fused_angle(drift, np.zeros(n), step_s, tau_s)
    weight = 1 - np.exp(-step_s / tau_s)
    assert found[-1] == pytest.approx(bias * step_s * (1 - weight) / weight, abs=1e-6)


def test_eq_15_holds_its_correction_while_the_accelerations_are_silent() -> None:
    n = 2000
    reported = np.full(n, 0.4)
    reported[1000:1500] = np.nan
    rates = 0.1 * np.sin(np.arange(n) / 50)
    found = fused_angle(rates, reported + rates, 0.01, 2.0)
    np.testing.assert_allclose(found, 0.4 + rates, atol=1e-9)


def test_eq_15_knows_nothing_where_the_accelerations_never_speak() -> None:
    assert np.isnan(fused_angle(np.zeros(50), np.full(50, np.nan), 0.01, 2.0)).all()


def test_a_difference_near_half_a_turn_is_not_pulled_over() -> None:
    noise = np.random.default_rng(0).normal(scale=0.3, size=3000)
    found = fused_angle(np.zeros(3000), wrap(np.pi + noise), 0.01, 2.0)
    np.testing.assert_allclose(wrap(found - np.pi), 0.0, atol=0.15)
    assert np.ptp(found) < 0.3


def test_an_impact_does_not_leave_a_whole_turn_behind() -> None:
    angle = np.zeros(1000)
    angle[500:503] = [2.5, -2.8, 3.0]
    found = unwrapped_about_trend(angle, 0.01)
    np.testing.assert_allclose(found[600:], 0.0, atol=1e-9)

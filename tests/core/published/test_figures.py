"""Tests that the numbers behind Figures 3, 4 and 6 show what is true of a hinge. Its every truth is known."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint
from core.published.angles import DEFAULT_TAU_S, published_angle
from core.published.figures import (
    GRID_STEP_RAD,
    MIN_DRIFT_S,
    cost_over_sphere,
    projected_rates,
    two_ways,
)
from core.samples import FloatArray
from core.session import RecordingKind
from core.signal.pair import Pair
from core.signal.rotations import angle_between
from tests.core.hinges import Person

Hinge = tuple[Pair, FloatArray, FloatArray, FloatArray, FloatArray]
DRIFT_RAD_S = np.deg2rad(1.5)  # that of the paper's own example


@pytest.fixture(scope="module")
def hinge() -> Hinge:
    """Exact samples of some seconds, the true axes and the true centres."""
    person, joint = Person(seed=4), Joint.RIGHT_ANKLE
    pair = person.exact_pair(joint, RecordingKind.FREE_MOTION, duration_s=8.0, rate_hz=50.0)
    j1, j2 = (person.axis(site, joint) for site in (joint.proximal, joint.distal))
    o1, o2 = (person.centre_m(site, joint) for site in (joint.proximal, joint.distal))
    return pair, j1, j2, o1, o2


def test_the_cost_over_the_sphere_is_lowest_at_the_true_axis_and_at_its_opposite(hinge: Hinge) -> None:
    pair, j1, j2, _, _ = hinge
    found = cost_over_sphere(pair.g1, j1, np.linalg.norm(np.cross(pair.g2, j2), axis=1))
    rows, columns = found.rms_rad_s.shape
    equator, east, west = rows // 2, 3 * (columns - 1) // 4, (columns - 1) // 4
    np.testing.assert_allclose(found.direction[equator, east], j1, atol=1e-12)
    np.testing.assert_allclose(found.direction[equator, west], -j1, atol=1e-12)
    lowest = np.argsort(found.rms_rad_s, axis=None)[:2]
    assert {tuple(np.unravel_index(k, found.rms_rad_s.shape)) for k in lowest} == {(equator, east), (equator, west)}
    assert found.rms_rad_s[equator, east] < 1e-3 < 0.1 < np.median(found.rms_rad_s)


def test_an_axis_that_is_off_is_seen_to_be_off_by_as_much(hinge: Hinge) -> None:
    pair, j1, j2, _, _ = hinge
    beside = np.cross(j1, [0.0, 0.0, 1.0])
    off = np.cos(0.2) * j1 + np.sin(0.2) * beside / np.linalg.norm(beside)
    found = cost_over_sphere(pair.g1, off, np.linalg.norm(np.cross(pair.g2, j2), axis=1))
    assert found.apart_rad == pytest.approx(0.2, abs=np.deg2rad(0.05))
    assert angle_between(found.lowest, j1) < np.deg2rad(0.05) < GRID_STEP_RAD


def test_every_cost_is_that_of_eq_3(hinge: Hinge) -> None:
    pair, j1, j2, _, _ = hinge
    length = np.linalg.norm(np.cross(pair.g2, j2), axis=1)
    found = cost_over_sphere(pair.g1, j1, length)
    for row, column in ((4, 9), (20, 50), (33, 1)):
        error = np.linalg.norm(np.cross(pair.g1, found.direction[row, column]), axis=1) - length
        assert found.rms_rad_s[row, column] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-9)


@pytest.mark.parametrize("is_paired", [True, False], ids=["paired", "reversed"])
def test_curves_of_axes_that_pair_lie_on_each_other_and_those_of_reversed_ones_do_not(
    hinge: Hinge, is_paired: bool
) -> None:
    pair, j1, j2, _, _ = hinge
    found = projected_rates((pair,), j1, j2 if is_paired else -j2)
    assert found is not None
    alike, apart = found.congruence, found.reversed_congruence
    if not is_paired:
        alike, apart = apart, alike
    assert alike > 0.9
    assert alike - apart > 0.2
    np.testing.assert_allclose(np.abs(found.distal), np.abs(found.proximal), atol=1e-6)  # eq 3 holds either way
    np.testing.assert_allclose(np.abs(found.reversed_distal), np.abs(found.proximal), atol=1e-6)


def test_without_movement_no_stretch_shows_the_pairing(hinge: Hinge) -> None:
    pair, j1, j2, _, _ = hinge
    still = replace(pair, g1=np.zeros_like(pair.g1), g2=np.zeros_like(pair.g2))
    assert projected_rates((still,), j1, j2) is None


def test_rates_drift_by_the_bias_about_the_axis_and_the_fused_angle_does_not(hinge: Hinge) -> None:
    pair, j1, j2, o1, o2 = hinge
    biased = replace(pair, g1=pair.g1 + DRIFT_RAD_S * j1)
    exact, found = (two_ways((one,), j1, j2, o1, o2, DEFAULT_TAU_S) for one in (pair, biased))
    assert exact.drift_rad_s == pytest.approx(0.0, abs=np.deg2rad(0.02))
    assert found.drift_rad_s == pytest.approx(DRIFT_RAD_S, abs=np.deg2rad(0.02))
    late = slice(int(2 * DEFAULT_TAU_S / pair.step_s), None)
    ran_away = found.from_rates_rad - exact.from_rates_rad
    assert np.ptp(ran_away) > 0.9 * DRIFT_RAD_S * pair.duration_s
    assert np.ptp((found.fused_rad - exact.fused_rad)[late]) < 0.1 * DRIFT_RAD_S * pair.duration_s


def test_the_fused_angle_is_eq_15_and_stretches_are_kept_apart(hinge: Hinge) -> None:
    pair, j1, j2, o1, o2 = hinge
    later = replace(pair, time_s=pair.time_s + pair.duration_s + 1.0)
    found = two_ways((pair, later), j1, j2, o1, o2, DEFAULT_TAU_S)
    expected = published_angle(pair, j1, j2, o1, o2)
    n = len(pair)
    np.testing.assert_allclose(found.fused_rad[:n], expected, atol=1e-12)
    np.testing.assert_allclose(found.fused_rad[n + 1 :], expected, atol=1e-12)
    assert np.isnan(found.time_s[n])
    assert np.isnan(found.fused_rad[n])
    assert found.from_rates_rad[0] == pytest.approx(found.fused_rad[0])


def test_a_second_is_too_short_to_show_a_drift(hinge: Hinge) -> None:
    pair, j1, j2, o1, o2 = hinge
    short = int((MIN_DRIFT_S - 1.0) / pair.step_s)
    names = ("time_s", "g1", "g2", "a1", "a2", "dg1", "dg2", "earth_from_1", "earth_from_2", "is_measured", "is_known")
    cut = replace(pair, **{name: getattr(pair, name)[:short] for name in names})
    assert np.isnan(two_ways((cut,), j1, j2, o1, o2, DEFAULT_TAU_S).drift_rad_s)
    nothing = two_ways((), j1, j2, o1, o2, DEFAULT_TAU_S)
    assert nothing.time_s.size == 0
    assert np.isnan(nothing.drift_rad_s)

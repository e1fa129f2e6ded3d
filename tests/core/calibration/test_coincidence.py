"""Tests that both sensors feel the joint's own acceleration. The fit finds centres, biases and lags from it."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint
from core.calibration.coincidence import fit_coincidence, relative_rotation
from core.calibration.heading import heading_over
from core.calibration.lag import find_lag
from core.signal.datasets import Datasets, gather, moving_indices
from core.signal.pair import OrientedTrack, Pair, lever_matrix, pair_up
from core.signal.rotations import joint_frame, wrap
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE
PERSON = Person(seed=5)


@pytest.fixture(scope="module")
def pair() -> Pair:
    return PERSON.exact_pair(KNEE, heading_rad=-0.7)


@pytest.fixture(scope="module")
def data(pair: Pair) -> Datasets:
    return gather((pair,), [np.arange(5, len(pair) - 5, 2)])


def test_the_lever_s_acceleration_is_that_of_eq_7() -> None:
    rng = np.random.default_rng(0)
    g, dg, o = rng.normal(size=(3, 3))
    expected = np.cross(g, np.cross(g, o)) + np.cross(dg, o)
    np.testing.assert_allclose(lever_matrix(g, dg) @ o, expected, atol=1e-12)


def test_at_the_truth_both_sensors_agree_on_the_joint_s_acceleration(data: Datasets) -> None:
    o1, o2 = (PERSON.centre_m(site, KNEE) for site in (KNEE.proximal, KNEE.distal))
    one = data.a1 - lever_matrix(data.g1, data.dg1) @ o1
    two = data.a2 - lever_matrix(data.g2, data.dg2) @ o2
    rotation = relative_rotation(data, np.full((1, len(data)), -0.7))[0]
    np.testing.assert_allclose(one, np.einsum("nij,nj->ni", rotation, two), atol=2e-3)


def test_the_fit_finds_centres_and_the_relative_bias(data: Datasets) -> None:
    bias = np.array([0.05, -0.03, 0.04])
    biased = replace(data, a1=data.a1 + bias)
    rotation = relative_rotation(biased, np.full((1, len(data)), -0.7))
    found = fit_coincidence(biased, rotation).unknowns[0]
    for site, o in ((KNEE.proximal, found[:3]), (KNEE.distal, found[3:6])):
        plane = np.stack(joint_frame(PERSON.axis(site, KNEE)))
        np.testing.assert_allclose(plane @ (o - PERSON.centre_m(site, KNEE)), 0.0, atol=0.003)


def test_a_false_heading_is_dear(data: Datasets) -> None:
    heading = np.stack([np.full(len(data), -0.7 + off) for off in (0.0, 0.5, np.pi)])
    cost = fit_coincidence(data, relative_rotation(data, heading)).cost
    assert cost[0] < 1e-3 * cost[1]
    assert cost[0] < 1e-3 * cost[2]


def late(pair: Pair, lag_s: float) -> Pair:
    """The pair as it would be if the distal sensor's stamps were late by `lag_s`."""
    one, two = pair.tracks
    shifted = pair_up(one, OrientedTrack(replace(two.track, start_s=lag_s), two.q_earth_from_sensor), 0.0)
    assert shifted is not None
    return shifted


@pytest.mark.parametrize("lag_s", [0.03, -0.05, 0.06])
def test_a_late_clock_is_found_with_the_sign_that_corrects_it(pair: Pair, lag_s: float) -> None:
    shifted = late(pair, lag_s)
    sets = gather((shifted,), [moving_indices(shifted)])
    found = find_lag(sets.thinned(400), np.full(sets.knots, -0.7))
    # what is added to the distal stamps: a late clock needs a negative correction
    assert found.lag_s == pytest.approx(-lag_s, abs=0.001)
    assert not found.is_at_border


def test_no_lag_is_invented(pair: Pair) -> None:
    sets = gather((pair,), [moving_indices(pair)])
    found = find_lag(sets.thinned(400), np.full(sets.knots, -0.7))
    assert found.lag_s == 0.0
    assert not found.is_at_border


def test_a_lag_beyond_the_search_is_not_called_a_lag(pair: Pair) -> None:
    shifted = late(pair, 0.2)
    sets = gather((shifted,), [moving_indices(shifted)])
    found = find_lag(sets.thinned(400), np.full(sets.knots, -0.7))
    assert found.lag_s == 0.0


@pytest.mark.parametrize("heading", [-0.7, 3.1, -3.1])
def test_the_heading_of_a_recording_is_found_from_axes_and_centres(heading: float) -> None:
    pair = PERSON.exact_pair(KNEE, duration_s=21.0, rate_hz=50.0, heading_rad=heading)
    j1, j2 = (PERSON.axis(site, KNEE) for site in (KNEE.proximal, KNEE.distal))
    centres = [PERSON.centre_m(site, KNEE) for site in (KNEE.proximal, KNEE.distal)]
    found = heading_over(pair, j1, j2, np.concatenate([*centres, np.zeros(6)]))
    assert found.shape == (len(pair),)
    np.testing.assert_allclose(wrap(found - heading), 0.0, atol=1e-4)

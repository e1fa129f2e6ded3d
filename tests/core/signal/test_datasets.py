"""Tests that the samples that identify a joint are those that were known, moving and slow enough."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint
from core.signal.datasets import KNOT_SPACING_S, gather, knot_positions, moving_indices
from core.signal.pair import Pair
from tests.core.hinges import Person


@pytest.fixture(scope="module")
def pair() -> Pair:
    return Person(seed=2).exact_pair(Joint.LEFT_KNEE, duration_s=24.0, rate_hz=50.0)


def test_samples_run_from_the_first_to_the_last_movement(pair: Pair) -> None:
    g1, g2 = pair.g1.copy(), pair.g2.copy()
    still = (pair.time_s < 5) | (pair.time_s > 20) | ((pair.time_s > 10) & (pair.time_s < 12))
    g1[still] = g2[still] = 0.0
    found = moving_indices(replace(pair, g1=g1, g2=g2))
    t = pair.time_s[found]
    assert 4.7 < t[0] < 5.1
    assert 19.9 < t[-1] < 20.3
    assert np.any((t > 10.5) & (t < 11.5))


def test_unknown_and_fast_samples_are_left_out(pair: Pair) -> None:
    known = pair.is_known.copy()
    known[300:320] = False
    g2 = pair.g2.copy()
    g2[400:410] = 10.0
    changed = replace(pair, is_known=known, g2=g2)
    assert not np.intersect1d(moving_indices(changed), np.arange(300, 320)).size
    assert np.isin(np.arange(400, 410), moving_indices(changed)).all()
    assert not np.intersect1d(moving_indices(changed, 6.0), np.arange(400, 410)).size


def test_a_sensor_at_rest_gives_no_samples(pair: Pair) -> None:
    assert len(moving_indices(replace(pair, g1=0 * pair.g1, g2=0 * pair.g2))) == 0


def test_every_stretch_has_knots_of_its_own(pair: Pair) -> None:
    intervals, position = knot_positions(pair)
    assert intervals == round(pair.duration_s / KNOT_SPACING_S)
    assert position[0] == 0.0
    assert position[-1] == pytest.approx(intervals)
    both = gather((pair, pair), [np.array([0, 600, len(pair) - 1]), np.array([5])])
    assert both.knots == 2 * (intervals + 1)
    knots = np.arange(both.knots, dtype=float)
    headings = both.heading(knots)
    np.testing.assert_allclose(headings[[0, 2]], [0.0, intervals])
    assert intervals < headings[3] <= intervals + 2


def test_thinning_keeps_rows_together(pair: Pair) -> None:
    data = gather((pair,), [np.arange(3, 900)])
    few = data.thinned(50)
    assert len(few) == 50
    np.testing.assert_array_equal(few.g1, pair.g1[few.index])
    np.testing.assert_array_equal(few.earth_from_2, pair.earth_from_2[few.index])
    assert len(data.thinned(10**6)) == len(data)

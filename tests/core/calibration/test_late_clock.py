"""Tests that a clock is called late only where it always is, and how sure that is."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from core.body import Joint
from core.calibration.lag import Lag, find_lag, sharpest_lag, smoothest_lag
from core.samples import FloatArray
from core.signal.datasets import Datasets, gather, moving_indices
from core.signal.pair import OrientedTrack, Pair, pair_up
from tests.core.hinges import Person

KNEE = Joint.LEFT_KNEE
PERSON = Person(seed=5)


@pytest.fixture(scope="module")
def pair() -> Pair:
    """Twelve seconds of free motion, without any error but a little noise."""
    pair = PERSON.exact_pair(KNEE, duration_s=12.0, heading_rad=0.4)
    one, two = pair.tracks
    rng = np.random.default_rng(6)
    noisy = replace(two.track, acc_m_s2=two.track.acc_m_s2 + 0.05 * rng.normal(size=two.track.acc_m_s2.shape))
    again = pair_up(one, OrientedTrack(noisy, two.q_earth_from_sensor), 0.0)
    assert again is not None
    return again


def late(pair: Pair, samples: int, from_sample: int = 0) -> Pair:
    """What the distal sensor measured is stamped later by so many samples, from one sample on."""
    one, two = pair.tracks
    moved = np.arange(len(two.track))
    moved[from_sample:] = np.clip(moved[from_sample:] - samples, 0, len(moved) - 1)
    track = replace(two.track, gyr_rad_s=two.track.gyr_rad_s[moved], acc_m_s2=two.track.acc_m_s2[moved])
    found = pair_up(one, OrientedTrack(track, two.q_earth_from_sensor[moved]), 0.0)
    assert found is not None
    return found


def data_of(pair: Pair, every: int = 3) -> Datasets:
    return gather((pair,), [moving_indices(pair)[::every]])


def lag_of(pair: Pair, find: Callable[[Datasets, FloatArray], Lag] = find_lag, every: int = 3) -> Lag:
    data = data_of(pair, every)
    return find(data, np.full(data.knots, 0.4))


@pytest.mark.parametrize("find", [find_lag, sharpest_lag, smoothest_lag])
@pytest.mark.parametrize("samples", [-7, -2, 2, 5])
def test_a_clock_that_is_late_all_the_time_is_found(
    pair: Pair, find: Callable[[Datasets, FloatArray], Lag], samples: int
) -> None:
    found = lag_of(late(pair, samples), find)
    assert found.lag_s == pytest.approx(-0.01 * samples, abs=0.001)
    assert found.best_s == found.lag_s
    assert not found.is_at_border
    assert found.sd_s is not None
    assert 0.0 < found.sd_s < 0.001
    assert found.cost_ratio > 1.15


def test_a_clock_that_is_late_in_one_half_only_is_not(pair: Pair) -> None:
    found = lag_of(late(pair, 5, from_sample=len(pair) // 3))
    assert found.lag_s == 0.0
    assert abs(found.best_s) > 0.004


@pytest.mark.parametrize("find", [find_lag, sharpest_lag])
def test_no_lag_is_found_where_there_is_none(pair: Pair, find: Callable[[Datasets, FloatArray], Lag]) -> None:
    found = lag_of(pair, find)
    assert found.lag_s == 0.0
    assert found.best_s == pytest.approx(0.0, abs=0.001)
    assert found.cost_ratio == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("find", [sharpest_lag, smoothest_lag])
def test_a_shift_at_the_border_of_the_search_is_no_lag(pair: Pair, find: Callable[[Datasets, FloatArray], Lag]) -> None:
    """75 ms are the most; beyond, both sensors hardly sit on one joint."""
    found = lag_of(late(pair, 8), find)
    assert (found.lag_s, found.is_at_border, found.sd_s) == (0.0, True, None)


@pytest.mark.parametrize("find", [sharpest_lag, smoothest_lag])
def test_fifty_samples_are_needed(pair: Pair, find: Callable[[Datasets, FloatArray], Lag]) -> None:
    data = data_of(late(pair, 5))
    inner = data.only((data.time_s > 2.0) & (data.time_s < 10.0))
    for count, is_found in ((49, False), (60, True)):
        few = inner.thinned(count)
        found = find(few, np.full(few.knots, 0.4))
        assert (found.lag_s != 0.0) == is_found
        if not is_found:
            assert (found.best_s, found.sd_s, found.cost_ratio, found.is_at_border) == (0.0, None, 1.0, False)


@pytest.mark.parametrize("find", [sharpest_lag, smoothest_lag])
def test_samples_within_a_tenth_of_a_second_make_a_lag_no_surer(
    pair: Pair, find: Callable[[Datasets, FloatArray], Lag]
) -> None:
    dense, thin = (lag_of(late(pair, 5), find, every) for every in (2, 8))
    assert dense.sd_s is not None
    assert thin.sd_s is not None
    assert dense.sd_s == pytest.approx(thin.sd_s, rel=0.3)

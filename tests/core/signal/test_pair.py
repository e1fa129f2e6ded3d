"""Tests that two sensors are brought to the same instants, and that eq 1 is what it states."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from core.samples import BoolArray, FloatArray
from core.signal.pair import OrientedTrack, angular_acceleration, moving_mean, pair_up
from core.signal.tracks import Track


@given(arrays(np.float64, (4, 3), elements=st.floats(-3, 3)), st.sampled_from([50.0, 60.0, 100.0, 200.0]))
def test_eq_1_is_exact_for_cubics(c: FloatArray, rate_hz: float) -> None:
    t = np.arange(12) / rate_hz
    found = angular_acceleration(np.stack([np.polyval(c[:, k], t) for k in range(3)], axis=1), 1 / rate_hz)
    expected = np.stack([np.polyval(np.polyder(c[:, k]), t) for k in range(3)], axis=1)
    np.testing.assert_allclose(found[2:-2], expected[2:-2], atol=1e-9)


@pytest.mark.parametrize("n", [4, 5, 6, 40])
def test_eq_1_leaves_two_samples_at_each_border_unknown(n: int) -> None:
    unknown = np.isnan(angular_acceleration(np.ones((n, 3)), 0.01)).all(axis=1)
    np.testing.assert_array_equal(np.flatnonzero(~unknown), np.arange(2, n - 2))


def test_eq_1_is_wrong_by_the_fourth_power_of_the_step_only() -> None:
    def worst(step_s: float) -> float:
        t = np.arange(0, 1, step_s)
        found = angular_acceleration(np.sin(9 * t)[:, None], step_s)[2:-2, 0]
        return float(np.abs(found - 9 * np.cos(9 * t[2:-2])).max())

    assert worst(0.02) / worst(0.01) == pytest.approx(16, rel=0.1)


@given(arrays(np.float64, st.integers(1, 30), elements=st.floats(-5, 5)), st.integers(1, 12))
def test_a_moving_mean_is_the_mean_of_what_there_is(values: FloatArray, width: int) -> None:
    found = moving_mean(values, width)
    for k in range(len(values)):
        part = values[max(0, k - width // 2) : k + width - width // 2]
        assert found[k] == pytest.approx(np.mean(part), abs=1e-9)


def signal(t: FloatArray) -> FloatArray:
    return np.stack([np.sin(4 * t), np.cos(6 * t), np.sin(2 * t + 1)], axis=1)


def oriented_track(start_s: float, n: int, rate_hz: float, is_measured: BoolArray | None = None) -> OrientedTrack:
    t = start_s + np.arange(n) / rate_hz
    half = 0.5 * t
    q = np.stack([np.cos(half), np.sin(half), 0 * t, 0 * t], axis=1)
    received = np.ones(n, dtype=bool) if is_measured is None else is_measured
    return OrientedTrack(Track(start_s, 1 / rate_hz, signal(t), 9 + signal(t), None, None, received), q)


@pytest.mark.parametrize("lag_s", [0.0, 0.013, -0.04])
@pytest.mark.parametrize("rate_2_hz", [50.0, 100.0, 128.0])
def test_the_distal_sensor_is_read_at_the_proximal_instants(lag_s: float, rate_2_hz: float) -> None:
    pair = pair_up(oriented_track(10.0, 500, 100.0), oriented_track(10.3, round(4 * rate_2_hz), rate_2_hz), lag_s)
    assert pair is not None
    np.testing.assert_allclose(pair.g1, signal(pair.time_s), atol=1e-9)
    np.testing.assert_allclose(pair.g2, signal(pair.time_s - lag_s), atol=2e-4)
    np.testing.assert_allclose(pair.a2, 9 + signal(pair.time_s - lag_s), atol=2e-4)
    turned = pair.earth_from_2[:, 1:, 1:] @ [1.0, 0.0]
    np.testing.assert_allclose(
        np.unwrap(np.arctan2(turned[:, 1], turned[:, 0])) % (2 * np.pi), (pair.time_s - lag_s) % (2 * np.pi), atol=1e-4
    )
    assert pair.time_s[0] >= 10.3 + lag_s - 1e-6
    assert pair.time_s[-1] <= 10.3 + lag_s + 4 + 1e-6


def test_sensors_that_hardly_overlap_are_no_pair() -> None:
    one = oriented_track(0.0, 300, 100.0)
    assert pair_up(one, oriented_track(2.5, 300, 100.0), 0.0) is None
    assert pair_up(one, oriented_track(30.0, 300, 100.0), 0.0) is None
    assert pair_up(one, oriented_track(1.5, 300, 100.0), 0.0) is not None


def test_around_what_was_not_received_the_angular_acceleration_is_unknown() -> None:
    received = np.ones(300, dtype=bool)
    received[100:106] = False
    pair = pair_up(oriented_track(0.0, 300, 100.0), oriented_track(0.0, 300, 100.0, received), 0.0)
    assert pair is not None
    np.testing.assert_array_equal(np.flatnonzero(~pair.is_measured), np.arange(100, 106))
    np.testing.assert_array_equal(np.flatnonzero(~pair.is_known), [0, 1, *range(98, 108), 298, 299])
    assert np.isfinite(pair.dg1[pair.is_known]).all()
    assert np.isfinite(pair.dg2[pair.is_known]).all()


def test_a_pair_on_one_clock_is_not_interpolated() -> None:
    one = oriented_track(1e9, 300, 100.0)
    pair = pair_up(one, replace(one), 0.0)
    assert pair is not None
    np.testing.assert_array_equal(pair.g1, pair.g2)
    np.testing.assert_array_equal(pair.g2, one.track.gyr_rad_s)


def test_standing_is_not_moving() -> None:
    still = oriented_track(0.0, 300, 100.0)
    quiet = replace(still, track=replace(still.track, gyr_rad_s=np.full((300, 3), 0.05)))
    pair = pair_up(quiet, quiet, 0.0)
    assert pair is not None
    assert not pair.is_moving.any()
    both = pair_up(still, still, 0.0)
    assert both is not None
    assert both.is_moving.all()

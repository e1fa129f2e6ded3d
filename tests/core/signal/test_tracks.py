"""Tests that uneven stamps, lost rows and gaps become stretches on an even clock.

Nothing that was not measured becomes one.
"""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.samples import BoolArray, FloatArray, ImuBlock
from core.signal.tracks import (
    BLOCK_S,
    MAX_BRIDGED_GAP_S,
    MAX_REPORTED_GAP_S,
    OVERLAP_S,
    at_positions,
    blocks_of,
    continuous,
    even_tracks,
    is_stuck,
    nominal_step_s,
)

RATES_HZ = (50.0, 60.0, 100.0, 200.0)


def smooth(t: FloatArray) -> FloatArray:
    return np.stack([np.sin(3 * t), np.cos(5 * t + 1), 0.3 * np.sin(11 * t)], axis=1)


def block_at(t: FloatArray) -> ImuBlock:
    return ImuBlock("one", t, smooth(t), 9 + smooth(t + 7))


def stamps(rate_hz: float, duration_s: float = 6.0) -> FloatArray:
    return 3.0 + np.arange(round(duration_s * rate_hz)) / rate_hz


def with_hole(t: FloatArray, at_s: float, gap_s: float) -> FloatArray:
    """Rows taken out so that the gap between two stamps is the widest that does not pass `gap_s`."""
    first = int(np.searchsorted(t, at_s))
    last = int(np.searchsorted(t, t[first] + gap_s + 1e-9, side="right")) - 1
    return np.delete(t, slice(first + 1, last))


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_an_even_clock_is_left_as_it_is(rate_hz: float) -> None:
    t = stamps(rate_hz)
    (track,) = even_tracks(block_at(t))
    assert track.step_s == pytest.approx(1 / rate_hz, rel=1e-9)
    np.testing.assert_array_equal(track.gyr_rad_s, smooth(t))
    assert track.is_measured.all()
    np.testing.assert_allclose(track.time_s, t, atol=1e-9)


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_the_nominal_step_survives_jitter_rounding_and_loss(rate_hz: float) -> None:
    rng = np.random.default_rng(1)
    t = stamps(rate_hz, 30.0)
    t = np.round(t + rng.uniform(-0.15, 0.15, len(t)) / rate_hz, 3)[rng.random(len(t)) > 0.2]
    assert nominal_step_s(t) == pytest.approx(1 / rate_hz, rel=0.01)


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_jittered_samples_are_brought_to_the_even_clock_by_their_own_stamps(rate_hz: float) -> None:
    t = stamps(rate_hz) + np.random.default_rng(2).uniform(-0.3, 0.3, round(6 * rate_hz)) / rate_hz
    (track,) = even_tracks(block_at(t))
    error = np.abs(track.gyr_rad_s - smooth(track.time_s)).max()
    taken_by_row = np.abs(smooth(t) - smooth(stamps(rate_hz))).max()
    assert error < 0.2 * taken_by_row
    assert track.is_measured.all()


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_stamps_rounded_to_milliseconds_neither_lose_nor_invent_samples(rate_hz: float) -> None:
    t = np.round(stamps(rate_hz, 20.0), 3)
    (track,) = even_tracks(block_at(t))
    assert len(track) == len(t)
    assert track.is_measured.all()


def test_a_missing_row_and_a_row_of_nan_are_the_same() -> None:
    t = stamps(100.0)
    lost = [100, 101, 333]
    block = block_at(t)
    block.gyr_rad_s[lost[0]] = np.nan
    block.acc_m_s2[lost[1], 2] = np.nan
    block.gyr_rad_s[lost[2]] = np.inf
    (by_nan,), (by_row,) = even_tracks(block), even_tracks(block_at(np.delete(t, lost)))
    np.testing.assert_array_equal(by_nan.gyr_rad_s, by_row.gyr_rad_s)
    np.testing.assert_array_equal(by_nan.acc_m_s2, by_row.acc_m_s2)
    assert len(by_nan) == len(t)
    assert by_nan.is_measured.all()
    np.testing.assert_allclose(by_nan.gyr_rad_s, smooth(t), atol=2e-3)


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_a_gap_of_up_to_50_ms_is_filled(rate_hz: float) -> None:
    t = with_hole(stamps(rate_hz), 5.0, MAX_REPORTED_GAP_S - 0.001)
    (track,) = even_tracks(block_at(t))
    assert track.is_measured.all()
    assert len(track) == round(6 * rate_hz)


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_a_gap_over_50_ms_is_bridged_but_not_called_measured(rate_hz: float) -> None:
    t = with_hole(stamps(rate_hz), 5.0, 0.09)
    (track,) = even_tracks(block_at(t))
    (here,) = np.flatnonzero(np.diff(t) > MAX_REPORTED_GAP_S)
    inside = (track.time_s > t[here] + 1e-6) & (track.time_s < t[here + 1] - 1e-6)
    np.testing.assert_array_equal(track.is_measured, ~inside)
    assert np.isfinite(track.gyr_rad_s).all()


@pytest.mark.parametrize("rate_hz", RATES_HZ)
@pytest.mark.parametrize(("gap_s", "stretches"), [(MAX_BRIDGED_GAP_S - 0.001, 1), (MAX_BRIDGED_GAP_S + 0.021, 2)])
def test_a_gap_of_a_quarter_of_a_second_begins_a_new_stretch(rate_hz: float, gap_s: float, stretches: int) -> None:
    tracks = even_tracks(block_at(with_hole(stamps(rate_hz), 5.0, gap_s)))
    assert len(tracks) == stretches
    for before, after in pairwise(tracks):
        assert before.end_s < after.start_s


def test_a_stretch_too_short_for_an_orientation_is_dropped() -> None:
    t = stamps(100.0)
    t = t[(t < 5.0) | ((t > 5.5) & (t < 6.3)) | (t > 7.0)]
    starts = [track.start_s for track in even_tracks(block_at(t))]
    np.testing.assert_allclose(starts, [3.0, 7.0], atol=0.011)


@pytest.mark.parametrize("count", [0, 1, 2, 9])
def test_hardly_any_samples_give_no_stretch(count: int) -> None:
    assert even_tracks(block_at(stamps(100.0)[:count])) == []


@settings(max_examples=40)
@given(
    rate_hz=st.sampled_from(RATES_HZ),
    seed=st.integers(0, 2**31),
    loss=st.floats(0.0, 0.6),
    holes=st.lists(st.tuples(st.floats(3.5, 8.0), st.floats(0.02, 1.0)), max_size=4),
)
def test_what_is_called_measured_was_received_nearby(
    rate_hz: float, seed: int, loss: float, holes: list[tuple[float, float]]
) -> None:
    t = stamps(rate_hz)
    t = t[np.random.default_rng(seed).random(len(t)) >= loss]
    for at_s, gap_s in holes:
        t = t[(t <= at_s) | (t >= at_s + gap_s)]
    tracks = even_tracks(block_at(t))
    for track in tracks:
        assert np.isfinite(track.gyr_rad_s).all()
        assert np.isfinite(track.acc_m_s2).all()
        reported = track.time_s[track.is_measured]
        after = np.clip(np.searchsorted(t, reported - 0.501 * track.step_s), 0, len(t) - 1)
        before = np.clip(np.searchsorted(t, reported + 0.501 * track.step_s) - 1, 0, len(t) - 1)
        assert np.all(t[after] - t[before] <= MAX_REPORTED_GAP_S + 1e-9)
        received = t[(t >= track.start_s - 1e-9) & (t <= track.end_s + 1e-9)]
        nearest = np.round((received - track.start_s) / track.step_s).astype(int)
        assert track.is_measured[nearest].all()
    for one, next_one in pairwise(tracks):
        assert one.end_s + MAX_BRIDGED_GAP_S < next_one.start_s + 1e-9


@pytest.mark.parametrize("duration_s", [0.0, 5.0, 599.0, 601.0, 899.0, 901.0, 3600.0, 36000.0])
@pytest.mark.parametrize("first_s", [0.0, -40.0, 1e9])
def test_the_cores_of_blocks_cover_every_instant_once(duration_s: float, first_s: float) -> None:
    blocks = list(blocks_of(first_s, first_s + duration_s))
    edges = [b.core_from_s for b in blocks] + [b.core_to_s for b in blocks]
    instants = np.array([first_s, first_s + duration_s, *(e for e in edges if np.isfinite(e))])
    for t in np.concatenate([instants, np.linspace(first_s, first_s + duration_s, 101)]):
        assert sum(b.core_from_s <= t < b.core_to_s for b in blocks) == 1
    assert [b.number for b in blocks] == list(range(len(blocks)))
    for b in blocks:
        assert b.from_s <= b.core_from_s - OVERLAP_S
        assert b.to_s >= b.core_to_s + OVERLAP_S
        longest = min(b.to_s, first_s + duration_s) - max(b.from_s, first_s)
        assert longest <= 1.5 * BLOCK_S + 2 * OVERLAP_S


def test_a_piece_between_two_instants_holds_the_same_samples_as_the_whole() -> None:
    t = stamps(100.0)
    (piece,) = even_tracks(block_at(t), 4.0, 7.0)
    assert piece.start_s == pytest.approx(4.0, abs=0.011)
    assert piece.end_s == pytest.approx(7.0, abs=0.011)
    np.testing.assert_allclose(piece.gyr_rad_s, smooth(piece.time_s), atol=1e-9)


@settings(max_examples=50)
@given(
    c=st.lists(st.floats(-3, 3), min_size=4, max_size=4),
    n=st.integers(4, 12),
    share=st.lists(st.floats(0, 1), min_size=1, max_size=6),
)
def test_cubics_are_met_exactly_between_samples(c: list[float], n: int, share: list[float]) -> None:
    at = np.array(share) * (n - 1)
    index = np.arange(n, dtype=float)
    found = at_positions(np.polyval(c, index)[:, None], at)[:, 0]
    np.testing.assert_allclose(found, np.polyval(c, at), atol=1e-9 * n**3)


def test_whole_positions_are_the_samples_and_outside_is_the_nearest() -> None:
    values = np.random.default_rng(0).normal(size=(9, 3))
    np.testing.assert_array_equal(at_positions(values, np.array([0.0, 4.0, 8.0])), values[[0, 4, 8]])
    np.testing.assert_array_equal(at_positions(values, np.array([-3.0, 8.6])), values[[0, 8]])
    mixed = at_positions(values, np.array([0.0, 0.5, 8.0]))
    np.testing.assert_allclose(mixed[[0, 2]], values[[0, 8]], atol=1e-12)


def test_quaternions_are_made_continuous_without_turning_anything() -> None:
    half = np.linspace(0, 4 * np.pi, 60)
    q = np.stack([np.cos(half), np.sin(half), 0 * half, 0 * half], axis=1)
    flipped = q * np.random.default_rng(3).choice([-1.0, 1.0], 60)[:, None]
    found = continuous(flipped)
    assert np.all(np.sum(found[1:] * found[:-1], axis=1) > 0)
    np.testing.assert_allclose(np.abs(np.sum(found * q, axis=1)), 1.0)


def test_a_missing_orientation_holds_the_last_one_received() -> None:
    t = stamps(100.0)
    half = 0.3 * (t - t[0])
    q = np.stack([np.cos(half), 0 * half, np.sin(half), 0 * half], axis=1)
    gappy = q.copy()
    gappy[[0, 1, 200]] = np.nan
    (track,) = even_tracks(ImuBlock("one", t, smooth(t), smooth(t), gappy))
    assert track.q_device is not None
    np.testing.assert_allclose(np.delete(track.q_device, [0, 1, 200], axis=0), np.delete(q, [0, 1, 200], axis=0))
    np.testing.assert_allclose(track.q_device[[0, 1, 200]], q[[2, 2, 199]])


def held(for_s: float, rate_rad_s: float, is_left_where_it_was: bool) -> BoolArray:
    """What is stuck of a sensor that repeats itself for a while, at 100 Hz, between other samples."""
    n, count = 600, round(100 * for_s)
    rng = np.random.default_rng(0)
    gyr = rate_rad_s + 0.01 * rng.standard_normal((n, 3))
    acc = np.array([0.0, 0.0, 9.81]) + 0.02 * rng.standard_normal((n, 3))
    gyr[100 : 100 + count], acc[100 : 100 + count] = rate_rad_s, [0.0, 0.0, 9.81]
    if not is_left_where_it_was:
        gyr[100 + count :] += 1.0
    return is_stuck(np.arange(n) / 100.0, gyr, acc)


def test_a_coarse_sensor_that_lies_still_is_not_stuck() -> None:
    assert not held(1.0, 0.0, is_left_where_it_was=True).any()


@pytest.mark.parametrize(("for_s", "rate_rad_s", "is_left"), [(1.0, 0.5, True), (1.0, 0.0, False), (3.0, 0.0, True)])
def test_a_sensor_that_repeats_itself_in_motion_or_for_long_is_stuck(
    for_s: float, rate_rad_s: float, is_left: bool
) -> None:
    assert np.count_nonzero(held(for_s, rate_rad_s, is_left)) == round(100 * for_s) - 1

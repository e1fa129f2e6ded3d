"""One sensor's samples on an even grid, as they come in."""

import pickle
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.live.streams import EvenSamples, EvenStream
from core.samples import FloatArray, ImuBlock, IntArray
from core.signal.tracks import even_tracks

RATE_HZ = 100.0
STEP_S = 1 / RATE_HZ


def signals(time_s: FloatArray) -> FloatArray:
    """Rates (3) and forces (3) of a leg that swings (n, 6)."""
    wave = np.stack([np.sin(2 * np.pi * (1.0 + 0.3 * k) * time_s + k) for k in range(6)], axis=1)
    return wave * [4.0, 2.0, 1.0, 6.0, 3.0, 2.0] + [0.0, 0.0, 0.0, 0.0, 9.81, 0.0]


def block_of(time_s: FloatArray, stamps_s: FloatArray | None = None) -> ImuBlock:
    values = signals(time_s)
    return ImuBlock("sensor", time_s if stamps_s is None else stamps_s, values[:, :3], values[:, 3:])


def taken(block: ImuBlock, edges: list[int] | None = None) -> EvenSamples:
    """What a stream makes of a block, cut at `edges`; every piece is taken at once."""
    stream, pieces = EvenStream(RATE_HZ), []
    for a, b in pairwise([0, *sorted(edges or []), len(block)]):
        stream.feed(block.select(slice(a, b)))
        pieces.append(stream.take())
    return EvenSamples(*(np.concatenate([getattr(piece, name) for piece in pieces]) for name in EvenSamples.__slots__))


def values_of(even: EvenSamples) -> FloatArray:
    return np.concatenate([even.gyr_rad_s, even.acc_m_s2], axis=1)


def hard_recording(seed: int) -> ImuBlock:
    """Twelve seconds with scattered stamps, lost samples, long gaps, a hanging sensor, late and repeated samples."""
    rng = np.random.default_rng(seed)
    time_s = STEP_S * np.arange(1200)
    lost = rng.uniform(size=1200) < 0.05
    for first, count in ((300, 40), (700, 8), (900, 14)):
        lost[first : first + count] = True
    time_s = time_s[~lost]
    block = block_of(time_s, time_s + rng.uniform(-0.002, 0.002, len(time_s)))
    block.gyr_rad_s[500:540], block.acc_m_s2[500:540] = block.gyr_rad_s[500], block.acc_m_s2[500]
    block.gyr_rad_s[620:626], block.acc_m_s2[620:626] = block.gyr_rad_s[620], block.acc_m_s2[620]
    block.gyr_rad_s[100] = np.nan
    order: IntArray = np.arange(len(time_s))
    order[200:204] = [201, 200, 203, 203]
    return block.select(order)


def test_samples_on_the_grid_are_reported_at_once_and_as_they_are() -> None:
    block = block_of(3.7 + STEP_S * np.arange(200))
    even = taken(block)
    np.testing.assert_array_equal(even.tick, np.arange(200))
    np.testing.assert_allclose(even.time_s, block.time_s, atol=1e-12)
    np.testing.assert_array_equal(even.gyr_rad_s, block.gyr_rad_s)
    assert even.is_measured.all()


@pytest.mark.endurance
@given(seed=st.integers(0, 5), edges=st.lists(st.integers(0, 1100), max_size=40))
def test_what_comes_out_does_not_depend_on_the_blocks(seed: int, edges: list[int]) -> None:
    block = hard_recording(seed)
    whole, cut = taken(block), taken(block, edges)
    np.testing.assert_array_equal(cut.tick, whole.tick)
    np.testing.assert_array_equal(cut.is_measured, whole.is_measured)
    np.testing.assert_allclose(values_of(cut), values_of(whole), atol=1e-9)


def test_lost_samples_are_bridged_as_offline() -> None:
    time_s = STEP_S * np.arange(1000)
    lost = np.random.default_rng(1).uniform(size=1000) < 0.05
    lost[400:408] = True  # not reported as measured
    lost[[0, 1, 2, -1, -2, -3]] = False
    block = block_of(time_s[~lost])
    even, (offline,) = taken(block), even_tracks(block)
    n = len(even)
    assert n > 990
    np.testing.assert_allclose(even.gyr_rad_s, offline.gyr_rad_s[:n], atol=1e-9)
    np.testing.assert_allclose(even.acc_m_s2, offline.acc_m_s2[:n], atol=1e-9)
    np.testing.assert_array_equal(even.is_measured, offline.is_measured[:n])
    assert not even.is_measured.all()


def test_a_long_gap_ends_a_stretch_as_offline() -> None:
    time_s = STEP_S * np.arange(1000)
    block = block_of(time_s).select((time_s < 4.0) | (time_s > 4.2))
    even, tracks = taken(block), even_tracks(block)
    (jump,) = np.flatnonzero(np.diff(even.tick) > 1)
    assert len(tracks) == 2
    assert even.time_s[jump] == pytest.approx(tracks[0].end_s)
    assert even.time_s[jump + 1] == pytest.approx(tracks[1].start_s)


def test_a_sensor_that_lies_still_may_be_silent_for_longer() -> None:
    time_s = STEP_S * np.arange(600)
    block = block_of(time_s).select((time_s < 3.0) | (time_s > 3.2))
    noise = 0.001 * np.random.default_rng(0).normal(size=(len(block), 3))
    still = ImuBlock("sensor", block.time_s, noise, block.acc_m_s2)
    assert np.all(np.diff(taken(still).tick) == 1)
    assert np.any(np.diff(taken(block).tick) > 1)


def test_scattered_stamps_do_not_scatter_the_samples() -> None:
    time_s = STEP_S * np.arange(2000)
    stamps_s = time_s + np.random.default_rng(2).normal(0.0, 0.0015, 2000).clip(-0.004, 0.004)
    even = taken(block_of(time_s, stamps_s))
    as_stamped = signals(time_s) - signals(stamps_s)
    later = even.time_s > 3.0  # the line through the stamps is then known
    error = values_of(even)[later] - signals(even.time_s)[later]
    # a clock that is off by half a millisecond remains, which turns nothing
    assert np.std(np.diff(error[:, 0])) < 0.1 * np.std(np.diff(as_stamped[:, 0]))


def test_a_sensor_slower_than_it_states_is_put_on_the_grid_it_states() -> None:
    time_s = np.arange(2000) / 99.6
    even = taken(block_of(time_s))
    np.testing.assert_allclose(np.diff(even.time_s), STEP_S)
    inner = slice(300, -20)  # once its own rate is known
    np.testing.assert_allclose(values_of(even)[inner], signals(even.time_s)[inner], atol=3e-3)


def test_late_and_repeated_samples_are_dropped_and_counted() -> None:
    block = block_of(STEP_S * np.arange(300))
    stream = EvenStream(RATE_HZ)
    stream.feed(block.select(slice(0, 200)))
    stream.feed(block.select(slice(190, 250)))
    stream.feed(block.select(slice(0, 5)))
    stream.feed(block.select(slice(250, 300)))
    assert stream.late == 15
    even = stream.take()
    np.testing.assert_array_equal(even.gyr_rad_s, block.gyr_rad_s)


def test_a_hanging_sensor_makes_a_gap() -> None:
    block = block_of(STEP_S * np.arange(600))
    block.gyr_rad_s[300:340], block.acc_m_s2[300:340] = block.gyr_rad_s[300], block.acc_m_s2[300]
    even = taken(block)
    (jump,) = np.flatnonzero(np.diff(even.tick) > 1)
    assert (even.tick[jump], even.tick[jump + 1]) == (300, 340)


def test_empty_blocks_and_nothing_at_all_are_fine() -> None:
    stream = EvenStream(RATE_HZ)
    stream.feed(block_of(STEP_S * np.arange(5)).select(slice(0, 0)))
    assert len(stream.take()) == 0


def test_memory_does_not_grow_with_time() -> None:
    stream, sizes = EvenStream(RATE_HZ), []
    for k in range(60):
        time_s = STEP_S * np.arange(500 * k, 500 * (k + 1))
        lost = np.random.default_rng(k).uniform(size=500) < 0.02
        stream.feed(block_of(time_s).select(~lost))
        stream.take()
        sizes.append(len(pickle.dumps(stream)))
    assert max(sizes) < 20_000

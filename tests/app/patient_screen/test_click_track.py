"""The samples of the metronome: clicks at the set cadence, without drift, none twice when it is changed."""

import numpy as np
import pytest
from numpy.typing import NDArray

from app.patient_screen.click_track import ClickTrack
from tests.app.patient_screen.sound_detection import onsets_s

RATE_HZ = 48_000
COARSE_HZ = 8_000  # where rounding to a sample costs six times as much
MOST_OFF_S = 0.002


def click(rate_hz: int = RATE_HZ) -> NDArray[np.int16]:
    """A click of the test's own: 40 ms of 500 Hz that fades."""
    time_s = np.arange(rate_hz // 25) / rate_hz
    return np.round(8000 * np.sin(2 * np.pi * 500 * time_s) * np.exp(-time_s / 0.01)).astype(np.int16)


@pytest.mark.parametrize("beats_per_min", [30, 97, 200])
def test_ten_minutes_of_clicks_do_not_drift(beats_per_min: int) -> None:
    track = ClickTrack(click(COARSE_HZ), COARSE_HZ)
    track.set_rate(beats_per_min)
    samples = np.concatenate([track.read(960) for _ in range(600 * COARSE_HZ // 960)])
    found_s = onsets_s(samples.astype(float), COARSE_HZ)
    assert len(found_s) == 10 * beats_per_min
    due_s = 60.0 / beats_per_min * np.arange(len(found_s))
    assert np.abs(found_s - found_s[0] - due_s).max() < MOST_OFF_S
    assert found_s[0] < MOST_OFF_S  # at once


@pytest.mark.parametrize("block", [1, 7, 480, 4096, 100_003])
def test_blocks_of_any_size_are_the_same_sound(block: int) -> None:
    whole, parts = ClickTrack(click(), RATE_HZ), ClickTrack(click(), RATE_HZ)
    for track in (whole, parts):
        track.set_rate(110)
    count = 3 * RATE_HZ // block * block
    once = whole.read(count)
    assert np.array_equal(np.concatenate([parts.read(block) for _ in range(count // block)]), once)


@pytest.mark.parametrize("changed_s", [1.0, 1.01, 1.1, 1.3, 1.49, 1.5, 1.51])
@pytest.mark.parametrize(("before", "after"), [(60, 120), (120, 60), (100, 101), (200, 30), (30, 200)])
def test_a_change_of_the_cadence_neither_doubles_nor_swallows_a_click(
    before: int, after: int, changed_s: float
) -> None:
    track = ClickTrack(click(), RATE_HZ)
    track.set_rate(before)
    first = track.read(round(changed_s * RATE_HZ))
    track.set_rate(after)
    samples = np.concatenate([first, track.read(20 * RATE_HZ)]).astype(float)
    gaps_s = np.diff(onsets_s(samples, RATE_HZ))
    old_s, new_s = 60.0 / before, 60.0 / after
    assert gaps_s.min() > min(old_s, new_s) - MOST_OFF_S  # none is doubled
    assert gaps_s.max() < max(old_s, new_s) + MOST_OFF_S  # none is missing
    assert np.abs(gaps_s[-5:] - new_s).max() < MOST_OFF_S


def test_keys_that_change_the_cadence_again_and_again_double_none() -> None:
    track = ClickTrack(click(), RATE_HZ)
    parts = []
    for beats_per_min in [*range(90, 131), *range(130, 89, -1)]:
        track.set_rate(beats_per_min)
        parts.append(track.read(RATE_HZ // 20))
    gaps_s = np.diff(onsets_s(np.concatenate(parts).astype(float), RATE_HZ))
    assert gaps_s.min() > 60.0 / 130 - MOST_OFF_S
    assert gaps_s.max() < 60.0 / 90 + MOST_OFF_S


def test_a_rate_after_silence_clicks_at_once_and_no_click_is_cut() -> None:
    track = ClickTrack(click(), RATE_HZ)
    assert not track.read(RATE_HZ).any()  # no rate, no click
    track.set_rate(60)
    assert np.array_equal(np.concatenate([track.read(1000), track.read(2000)])[:1920], click())

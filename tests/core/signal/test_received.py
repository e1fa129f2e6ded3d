"""Tests of how many samples were expected of each sensor, how many came, and the longest gap."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from core.body import Site
from core.samples import BoolArray, FloatArray, ImuBlock
from core.session import Recording, RecordingKind
from core.signal.received import SamplesReceived, samples_received
from core.verdicts.gates import LIMITS
from tests.clock_files import ALL, TIME_S, without

RATES: Mapping[Site, float | None] = {Site.LEFT_FOOT: 100.0, Site.LEFT_SHANK: 100.0}
ALL_CAME = SamplesReceived(2000, 2000, 0.0)


def recording(**masks: BoolArray | tuple[FloatArray, BoolArray]) -> Recording:
    imu = {}
    for name, mask in masks.items():
        time_s, is_there = mask if isinstance(mask, tuple) else (TIME_S, mask)
        rate = np.sin(TIME_S * 6.0)[:, None] * np.ones(3)
        force = np.tile([0.0, 0.0, 9.81], (len(TIME_S), 1))
        imu[Site(name)] = ImuBlock(name, time_s[is_there], rate[is_there], force[is_there])
    return Recording("walk 1", RecordingKind.WALKING, "walk_1", imu)


def test_all_samples_are_all_samples_with_or_without_a_rate() -> None:
    for rates in (RATES, {}):
        counts = samples_received(recording(left_foot=ALL, left_shank=ALL), rates)
        assert counts == {Site.LEFT_FOOT: ALL_CAME, Site.LEFT_SHANK: ALL_CAME}
        assert not any(one.is_lossy for one in counts.values())


def test_more_is_lost_than_strides_bear_where_the_verdicts_begin_to_take_care(monkeypatch: pytest.MonkeyPatch) -> None:
    counts = SamplesReceived(expected=1000, received=985, longest_gap_s=0.0)
    assert counts.is_lossy
    monkeypatch.setattr("core.signal.received.LIMITS", replace(LIMITS, lost_percent=(2.0, 5.0)))
    assert not counts.is_lossy


def test_a_clock_that_is_a_little_off_loses_nothing() -> None:
    for pace in (0.985, 1.015):
        (counts,) = samples_received(recording(left_foot=(TIME_S * pace, ALL)), RATES).values()
        assert counts == ALL_CAME


def test_a_gap_is_counted_and_measured() -> None:
    counts = samples_received(recording(left_foot=without((6.0, 8.999)), left_shank=ALL), RATES)
    assert (counts[Site.LEFT_FOOT].expected, counts[Site.LEFT_FOOT].received) == (2000, 1700)
    assert counts[Site.LEFT_FOOT].longest_gap_s == pytest.approx(3.01)
    assert counts[Site.LEFT_FOOT].is_lossy
    assert counts[Site.LEFT_FOOT].lost_percent == pytest.approx(15.0)
    assert counts[Site.LEFT_SHANK] == ALL_CAME


def test_single_samples_are_a_share_and_no_gap() -> None:
    every_tenth = np.arange(len(TIME_S)) % 10 != 5
    (counts,) = samples_received(recording(left_foot=every_tenth), RATES).values()
    assert (counts.expected, counts.received, counts.longest_gap_s) == (2000, 1800, 0.0)
    assert counts.is_lossy
    few = np.arange(len(TIME_S)) % 200 != 5
    (counts,) = samples_received(recording(left_foot=few), RATES).values()
    assert counts.received == 1990
    assert not counts.is_lossy


def test_a_sensor_that_fell_silent_for_good_lacks_what_the_others_have() -> None:
    counts = samples_received(recording(left_foot=without((15.0, 30.0)), left_shank=ALL), RATES)
    assert counts[Site.LEFT_FOOT].expected == pytest.approx(2000, abs=1)
    assert counts[Site.LEFT_FOOT].received == 1500
    assert counts[Site.LEFT_FOOT].longest_gap_s == pytest.approx(5.0)


def test_packets_that_end_at_other_times_are_no_loss() -> None:
    counts = samples_received(recording(left_foot=without((19.7, 30.0)), left_shank=without((0.0, 0.2))), RATES)
    assert not any(one.is_lossy for one in counts.values())


def test_a_sensor_that_sent_nothing_is_stated() -> None:
    counts = samples_received(recording(left_shank=ALL), RATES, worn=[Site.LEFT_FOOT, Site.LEFT_SHANK])
    assert (counts[Site.LEFT_FOOT].expected, counts[Site.LEFT_FOOT].received) == (2000, 0)
    assert counts[Site.LEFT_FOOT].longest_gap_s == pytest.approx(19.99)
    assert samples_received(recording(left_shank=ALL), RATES) == {Site.LEFT_SHANK: ALL_CAME}


def test_every_second_sample_lost_shows_against_the_rate() -> None:
    half = np.arange(len(TIME_S)) % 2 == 0
    (counts,) = samples_received(recording(left_foot=half), RATES).values()
    assert counts.expected == pytest.approx(2000, abs=2)
    assert counts.received == 1000
    assert counts.is_lossy


def test_nothing_received_is_nothing_known() -> None:
    assert samples_received(recording(), RATES, worn=[Site.LEFT_FOOT]) == {}

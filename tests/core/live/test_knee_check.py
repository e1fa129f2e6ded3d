"""A foot is doubted where its own knee swings more often or less often than it lands, and nowhere else."""

from collections.abc import Sequence

import numpy as np
import pytest

from core.body import Side
from core.gait.live import FootEvent, LiveEvent
from core.gait.phases import Phase
from core.live.angle import AngleSamples
from core.live.knee_check import KneeCheck
from core.live.stride_values import StrideValues
from core.live.walking import LiveFoot, WalkingState
from core.samples import FloatArray

STRIDE_S = 1.1
LANDS = 0.28  # of a stride, after the peak of flexion in swing


def knee(strides: int, swing_deg: float = 60.0) -> AngleSamples:
    """Flexion of strides that begin in mid-stance: 15 degrees in loading, at 0.8 of each, and `swing_deg` in swing."""
    t = np.arange(0.0, strides * STRIDE_S, 0.01)
    of_stride = t / STRIDE_S % 1.0
    bends = [size * np.exp(-0.5 * ((of_stride - at) / 0.07) ** 2) for size, at in ((15.0, 0.87), (swing_deg, 0.45))]
    angle_rad = np.deg2rad(5.0 + np.sum(bends, axis=0))
    return AngleSamples(np.arange(len(t)), t, angle_rad, np.zeros_like(t))


def landings_s(strides: int) -> FloatArray:
    return STRIDE_S * (np.arange(strides) + 0.45 + LANDS)


def doubts(angles: AngleSamples, contacts_s: Sequence[float] | FloatArray) -> list[bool]:
    """After every tenth of a second, contacts reported 0.1 s late."""
    check, shown = KneeCheck(), []
    for k in range(0, len(angles), 10):
        now_s = angles.time_s[k : k + 10]
        new_s = [s for s in contacts_s if now_s[0] <= s + 0.1 < now_s[0] + 0.1]
        part = AngleSamples(angles.tick[k : k + 10], now_s, angles.angle_rad[k : k + 10], angles.sd_rad[k : k + 10])
        check.update(part, new_s)
        shown.append(check.is_doubtful)
    return shown


@pytest.mark.parametrize("swing_deg", [16.0, 35.0, 60.0])
def test_a_foot_that_lands_once_a_swing_is_never_doubted(swing_deg: float) -> None:
    assert not any(doubts(knee(12, swing_deg), landings_s(12)))


def test_a_single_lost_contact_is_no_doubt() -> None:
    assert not any(doubts(knee(12), np.delete(landings_s(12), 5)))


@pytest.mark.parametrize("how", ["half lost", "all lost", "each twice"])
def test_a_foot_whose_contacts_are_lost_or_invented_is_doubted_after_three_strides(how: str) -> None:
    every = landings_s(12)
    contacts_s = {
        "half lost": every[::2],
        "all lost": every[:0],
        "each twice": np.sort([every, every + 0.4], axis=None),
    }
    shown = doubts(knee(12), contacts_s[how])
    assert all(shown[round(5 * STRIDE_S / 0.1) :])
    assert not any(shown[: round(2 * STRIDE_S / 0.1)])


def test_doubt_ends_with_four_sound_strides_with_standing_and_with_a_gap_of_the_knee() -> None:
    angles = knee(16)
    contacts_s = landings_s(16)[6:]
    assert not any(doubts(angles, contacts_s)[round(11.5 * STRIDE_S / 0.1) :])
    is_there = AngleSamples(angles.tick, angles.time_s, angles.angle_rad.copy(), angles.sd_rad)
    is_there.angle_rad[round(6 * STRIDE_S / 0.01) :] = np.deg2rad(5.0)
    assert not doubts(is_there, [])[-1]
    is_there.angle_rad[round(6 * STRIDE_S / 0.01) :] = np.deg2rad(50.0)  # in deep flexion, as on a chair
    assert not doubts(is_there, [])[-1]
    angles.angle_rad[round(6 * STRIDE_S / 0.01)] = np.nan
    shown = doubts(angles, [])
    assert shown[round(5.9 * STRIDE_S / 0.1)]
    assert not shown[round(6.2 * STRIDE_S / 0.1)]


def test_no_value_of_a_stride_is_reported_of_a_doubtful_foot() -> None:
    contacts = tuple(LiveEvent(FootEvent.INITIAL_CONTACT, at_s, at_s + 0.1) for at_s in (1.0, 2.1))
    for is_doubtful in (False, True):
        foot = LiveFoot(contacts, (), Phase.LOADING, 100.0, 1, is_doubtful=is_doubtful)
        assert bool(StrideValues().update(WalkingState(feet={Side.LEFT: foot}))) is not is_doubtful

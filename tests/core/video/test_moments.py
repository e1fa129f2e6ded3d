"""Moments of a walk for stepping, and the four frames that show a typical stride."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from uuid import UUID

import numpy as np
import pytest

from core.body import Joint, Side
from core.gait.strides import Reason
from core.results import RecordingAnalysis
from core.verdicts.model import READ, GateReason, JointVerdicts, Verdict, assess
from core.video.clip import Clip, Sync, SyncBy
from core.video.key_frames import KeyMoment, key_frames, value_deg
from core.video.moments import Moment, moments_s
from tests.simulated import LONG_WALK, analysis_of, session_of

SURE = Sync(0.0, 0.01, SyncBy.MOTION)


class Numbered:
    """Frames that hold their number."""

    def __init__(self, count: int) -> None:
        self._count = count

    def __len__(self) -> int:
        return self._count

    def jpeg(self, number: int) -> bytes:
        return str(number).encode()


@cache
def walk() -> RecordingAnalysis:
    return analysis_of(session_of(LONG_WALK)).recordings[-1]


def clip(sync: Sync | None = SURE, later_s: float = 0.0, last_s: float = math.inf) -> Clip:
    stamped_s = np.arange(0.0, min(float(walk().time_s[-1]), last_s), 1 / 30) + later_s
    return Clip(UUID(int=1), "walk 1", 1, "", 640, 360, 30.0, stamped_s, sync, Numbered(len(stamped_s)))


def with_gait(side: Side, **change: object) -> RecordingAnalysis:
    gait = walk().gait[side]
    changed = replace(gait, strides=replace(gait.strides, **change))  # type: ignore[arg-type]  # of any field
    return replace(walk(), gait={**walk().gait, side: changed})


def test_each_kind_of_moment_is_of_its_own_leg_and_in_order_of_time() -> None:
    for side in Side:
        contacts_s = moments_s(walk(), side, Moment.INITIAL_CONTACT)
        toe_offs_s = moments_s(walk(), side, Moment.TOE_OFF)
        peaks_s = moments_s(walk(), side, Moment.PEAK_KNEE_FLEXION)
        assert len(contacts_s) > 10
        assert len(peaks_s) == len(walk().gait[side].strides)
        for times_s in (contacts_s, toe_offs_s, peaks_s):
            assert (np.diff(times_s) > 0).all()
        for peak_s in peaks_s:  # after a toe-off, before the next contact, and bent
            assert toe_offs_s[toe_offs_s < peak_s].max() > contacts_s[contacts_s < peak_s].max()
            angle_rad = np.interp(peak_s, walk().time_s, walk().joints[Joint(f"{side}_knee")].angle_rad)
            assert angle_rad > math.radians(50)


def test_a_leg_that_was_not_measured_has_no_moments() -> None:
    alone = replace(walk(), gait={Side.RIGHT: walk().gait[Side.RIGHT]}, joints={})
    assert len(moments_s(alone, Side.LEFT, Moment.INITIAL_CONTACT)) == 0
    assert len(moments_s(alone, Side.RIGHT, Moment.PEAK_KNEE_FLEXION)) == 0
    assert len(moments_s(alone, Side.RIGHT, Moment.INITIAL_CONTACT)) > 10


def test_key_frames_are_the_four_moments_of_one_stride_and_the_frames_nearest_to_them() -> None:
    found = key_frames(clip(), walk(), Side.LEFT)
    assert [one.moment for one in found] == list(KeyMoment)
    assert {one.side for one in found} == {Side.LEFT}
    strides = walk().gait[Side.LEFT].strides
    first = int(found[0].jpeg) / 30
    number = int(np.argmin(np.abs(strides.start_s - first)))
    start_s, toe_off_s, end_s = strides.start_s[number], strides.toe_off_s[number], strides.end_s[number]
    at = (start_s, (start_s + toe_off_s) / 2, toe_off_s, (toe_off_s + end_s) / 2)
    for frame, time_s in zip(found, at, strict=True):
        assert int(frame.jpeg) / 30 == pytest.approx(time_s, abs=0.5 / 30 + 1e-6)
        assert frame.percent == pytest.approx(100 * (time_s - start_s) / (end_s - start_s))
        knee_rad = np.interp(time_s, walk().time_s, walk().joints[Joint.LEFT_KNEE].angle_rad)
        assert frame.knee_deg == pytest.approx(math.degrees(knee_rad))
    assert found[0].percent == 0.0


def test_the_offset_moves_the_frames_and_not_the_moments() -> None:
    plain, moved = (
        key_frames(clip(), walk(), Side.LEFT),
        key_frames(clip(replace(SURE, offset_s=-0.5), later_s=0.5), walk(), Side.LEFT),
    )
    assert plain == moved


def test_without_an_affected_side_both_legs_have_their_frames() -> None:
    assert [one.side for one in key_frames(clip(), walk(), None)] == [Side.LEFT] * 4 + [Side.RIGHT] * 4


@pytest.mark.parametrize("sync", [None, Sync(0.0, math.nan, SyncBy.CLOCK)])
def test_a_clip_whose_times_are_not_certain_has_none(sync: Sync | None) -> None:
    assert key_frames(clip(sync), walk(), None) == ()


def test_a_stride_that_the_clip_does_not_hold_whole_is_passed_over() -> None:
    whole_s = float(walk().gait[Side.LEFT].strides.end_s[2])
    found = key_frames(clip(last_s=whole_s), walk(), Side.LEFT)
    assert len(found) == 4
    assert all(int(one.jpeg) / 30 < whole_s for one in found)
    assert key_frames(clip(last_s=0.5), walk(), Side.LEFT) == ()


def test_an_excluded_stride_is_not_typical() -> None:
    strides = walk().gait[Side.LEFT].strides
    typical = float(int(key_frames(clip(), walk(), Side.LEFT)[0].jpeg) / 30)
    number = int(np.argmin(np.abs(strides.start_s - typical)))
    reason = tuple(Reason.TURN if k == number else one for k, one in enumerate(strides.reason))
    other = key_frames(clip(), with_gait(Side.LEFT, reason=reason), Side.LEFT)
    assert abs(int(other[0].jpeg) / 30 - typical) > 0.5
    none = key_frames(clip(), with_gait(Side.LEFT, reason=(Reason.TURN,) * len(strides)), Side.LEFT)
    assert none == ()


def test_the_stride_most_like_the_mean_is_chosen_over_one_that_is_not() -> None:
    """The one that was chosen is bent by 20° more: it is no longer the nearest."""
    gait = walk().gait[Side.LEFT]
    typical = int(key_frames(clip(), walk(), Side.LEFT)[0].jpeg) / 30
    number = int(np.argmin(np.abs(gait.strides.start_s - typical)))
    curves: Mapping[Joint, np.ndarray] = {joint: values.copy() for joint, values in gait.cycles.items()}
    curves[Joint.LEFT_KNEE][number] += math.radians(20)
    bent = replace(walk(), gait={**walk().gait, Side.LEFT: replace(gait, cycles=curves)})
    assert abs(int(key_frames(clip(), bent, Side.LEFT)[0].jpeg) / 30 - typical) > 0.5


def test_an_angle_that_is_not_reported_has_no_value_and_another_has() -> None:
    height = assess([GateReason("zero", Verdict.NOT_REPORTED)])
    joints = {**walk().verdicts.joints, Joint.LEFT_KNEE: JointVerdicts(READ, height, READ)}
    doubted = replace(walk(), verdicts=replace(walk().verdicts, joints=joints))
    assert value_deg(doubted, Joint.LEFT_KNEE, 5.0) is None
    assert value_deg(doubted, Joint.RIGHT_KNEE, 5.0) is not None
    assert value_deg(walk(), Joint.LEFT_KNEE, 5.0) is not None
    assert value_deg(walk(), Joint.LEFT_KNEE, 1e6) is None

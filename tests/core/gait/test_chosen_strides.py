"""Strides that a person leaves out leave every figure and every count, are reported, and come back as they were."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Side
from core.gait.chosen_strides import leave_out, left_out_by_hand
from core.gait.strides import Reason
from core.results import Analysis, RecordingAnalysis, SideGait
from core.session import Session
from tests.simulated import WALK_OF_ONE_LEG, session_of


@pytest.fixture(scope="module")
def session() -> Session:
    return session_of(WALK_OF_ONE_LEG)


@pytest.fixture(scope="module")
def whole(session: Session) -> Analysis:
    return analyse(session)


def choose(session: Session, *times_s: float) -> Session:
    """The session, with these times of the left side's walk left out."""
    return replace(
        session,
        recordings=tuple(
            replace(recording, left_out_s={Side.LEFT: times_s}) if recording.name == "walk 1" else recording
            for recording in session.recordings
        ),
    )


def left(analysis: Analysis) -> SideGait:
    return walk_of(analysis).gait[Side.LEFT]


def walk_of(analysis: Analysis) -> RecordingAnalysis:
    return analysis.recordings[0]


def middle_of(analysis: Analysis, which: int) -> float:
    strides = left(analysis).strides
    used = np.flatnonzero(strides.is_used)[which]
    return float(strides.start_s[used] + strides.end_s[used]) / 2


def test_a_stride_that_is_left_out_is_in_no_mean_and_is_reported(session: Session, whole: Analysis) -> None:
    """By any time inside of it: its events may be found a little earlier or later by another version."""
    middle_s = middle_of(whole, 2)
    found = leave_out(whole, choose(session, middle_s, middle_of(whole, 3)).recordings)
    assert left_out_by_hand(left(found)) == 2
    assert left(found).strides.is_used.sum() == left(whole).strides.is_used.sum() - 2
    gone = np.flatnonzero(left(whole).strides.is_used)[2]
    assert left(found).strides.reason[gone] is Reason.BY_HAND
    (reported,) = [finding for finding in found.findings if finding.key == "strides_left_out_by_hand"]
    assert (reported.where, reported.numbers) == (
        "walk 1",
        {"side": "left", "count": 2, "of": len(left(whole).strides)},
    )
    for later_s in (-0.3, 0.3):
        shifted = leave_out(whole, choose(session, middle_s + later_s, middle_of(whole, 3)).recordings)
        assert left(shifted).strides.reason == left(found).strides.reason
    np.testing.assert_array_equal(left(found).cycles[Joint.LEFT_KNEE], left(whole).cycles[Joint.LEFT_KNEE])


def test_a_whole_analysis_and_one_from_what_is_known_leave_out_the_same(session: Session, whole: Analysis) -> None:
    """What is chosen changes nothing that was identified or measured."""
    chosen = choose(session, *(middle_of(whole, k) for k in range(7)))
    again, known = analyse(chosen), leave_out(whole, chosen.recordings)
    assert left(again).strides.reason == left(known).strides.reason
    assert sorted(map(str, again.findings)) == sorted(map(str, known.findings))
    np.testing.assert_array_equal(
        walk_of(again).joints[Joint.LEFT_KNEE].angle_rad, walk_of(known).joints[Joint.LEFT_KNEE].angle_rad
    )


def test_nothing_chosen_is_nothing_changed_and_what_comes_back_is_as_it_was(session: Session, whole: Analysis) -> None:
    """A choice is never made of another choice."""
    assert leave_out(whole, session.recordings) is whole
    assert leave_out(whole, choose(session).recordings) is whole
    outside = leave_out(whole, choose(session, -5.0, 1e6).recordings)
    assert left(outside).strides.reason == left(whole).strides.reason
    assert outside.findings == whole.findings


def test_a_stride_that_was_left_out_already_keeps_its_reason(session: Session, whole: Analysis) -> None:
    """Who leaves out everything is reported so, and what was found to be wrong with a stride goes on being reported."""
    strides = left(whole).strides
    every = [float(a + b) / 2 for a, b in zip(strides.start_s, strides.end_s, strict=True)]
    found = leave_out(whole, choose(session, *every).recordings)
    before, after = Counter(strides.reason), Counter(left(found).strides.reason)
    assert after[Reason.USED] == 0
    assert after[Reason.BY_HAND] == before[Reason.USED]
    assert all(after[reason] == count for reason, count in before.items() if reason is not Reason.USED)
    keys = {finding.key for finding in found.findings}
    assert {"strides_all_left_out", "strides_left_out_by_hand"} <= keys
    assert not {"no_mean", "no_spread_of_side"} & keys


def test_too_few_strides_after_a_choice_are_reported_as_too_few(session: Session, whole: Analysis) -> None:
    """The counts in the findings are those of the strides that are left."""
    used = int(left(whole).strides.is_used.sum())
    found = leave_out(whole, choose(session, *(middle_of(whole, k) for k in range(used - 2))).recordings)
    (few,) = [finding for finding in found.findings if finding.key == "no_mean"]
    assert few.numbers["count"] == 2
    assert "no_spread_of_side" not in {finding.key for finding in found.findings}

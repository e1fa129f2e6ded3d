"""Tests that missing or too few strides or peaks are reported once and at the right place."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Side, Site
from core.findings import Finding, Severity
from core.gait.strides import Reason, Strides, strides_of
from core.hip.results import PelvisAngles, PelvisTurn
from core.results import RecordingAnalysis, SideGait
from core.session import RecordingKind
from core.timed.found import Turn
from core.timed.protocols import TimedProtocol
from core.verdicts.model import Assessment, Verdict
from core.verdicts.walk_findings import about_prosthesis, about_turns, about_walk
from devices.simulation.walker import Standing, Walk, WalkerSettings
from tests.core.timed.built_tests import built_test
from tests.simulated import LONG_WALK, analysis_of, session_of

FEET: Mapping[Side, Site] = {Side.LEFT: Site.LEFT_FOOT, Side.RIGHT: Site.RIGHT_FOOT}


@pytest.fixture(scope="module")
def walk() -> RecordingAnalysis:
    return analysis_of(session_of(LONG_WALK)).recordings[-1]


def with_used(gait: SideGait, used: int, otherwise: Reason = Reason.TURN) -> SideGait:
    reason = tuple(Reason.USED if k < used else otherwise for k in range(len(gait.strides)))
    return replace(gait, strides=replace(gait.strides, reason=reason))


def without_strides(gait: SideGait) -> SideGait:
    nothing: Strides = strides_of(())
    return replace(gait, strides=nothing, cycles={joint: np.empty((0, 101)) for joint in gait.cycles}, events=())


def reported(walk: RecordingAnalysis, left: SideGait, right: SideGait) -> list[Finding]:
    return about_walk(replace(walk, gait={Side.LEFT: left, Side.RIGHT: right}), FEET)


def test_a_walk_with_enough_good_strides_is_no_news(walk: RecordingAnalysis) -> None:
    left, right = (with_used(walk.gait[side], 10) for side in Side)
    assert reported(walk, left, right) == []


def test_few_strides_make_no_spread_and_fewer_no_mean(walk: RecordingAnalysis) -> None:
    left, right = walk.gait[Side.LEFT], walk.gait[Side.RIGHT]
    (both,) = reported(walk, with_used(left, 4), with_used(right, 9))
    assert (both.key, both.severity, both.where) == ("no_spread", Severity.INFO, "walk 1")
    assert both.numbers == {"left": 4, "right": 9, "wanted": 10}
    (one,) = reported(walk, with_used(left, 10), with_used(right, 3))
    assert (one.key, one.numbers) == ("no_spread_of_side", {"side": "right", "count": 3, "wanted": 10})
    none, spread = reported(walk, with_used(left, 2), with_used(right, 5))
    assert (none.key, none.severity, none.numbers["side"]) == ("no_mean", Severity.WARNING, "left")
    assert (spread.key, spread.numbers["side"]) == ("no_spread_of_side", "right")


def test_all_strides_left_out_say_why(walk: RecordingAnalysis) -> None:
    left, right = walk.gait[Side.LEFT], with_used(walk.gait[Side.RIGHT], 10)
    (found,) = reported(walk, with_used(left, 0, Reason.TURN), right)
    assert (found.key, found.where) == ("strides_all_left_out", "walk 1, left_foot")
    assert found.numbers == {"count": len(left.strides), "turn": len(left.strides)}
    reason = (Reason.START, *(Reason.TURN,) * (len(left.strides) - 2), Reason.STOP)
    (each,) = reported(walk, replace(left, strides=replace(left.strides, reason=reason)), right)
    assert each.numbers == {"count": len(reason), "turn": len(reason) - 2, "start": 1, "stop": 1}
    doubt = reported(walk, with_used(left, 0, Reason.DOUBT), right)
    assert [finding.key for finding in doubt] == ["doubtful_strides", "strides_all_left_out"]


def test_no_stride_at_all_is_reported_of_the_walk_or_of_the_side(walk: RecordingAnalysis) -> None:
    left, right = walk.gait[Side.LEFT], walk.gait[Side.RIGHT]
    (of_walk,) = reported(walk, without_strides(left), without_strides(right))
    assert (of_walk.key, of_walk.where) == ("no_strides", "walk 1")
    (of_side,) = reported(walk, with_used(left, 10), without_strides(right))
    assert (of_side.key, of_side.where) == ("side_without_strides", "walk 1, right_foot")
    assert about_walk(replace(walk, gait={}), {}) == []  # without a sensor that could report


def test_a_peak_that_no_stride_has_is_named_unless_the_sign_is_in_doubt(walk: RecordingAnalysis) -> None:
    left, right = (with_used(walk.gait[side], 10) for side in Side)
    name = "ankle_push_off_plantarflexion_rad"
    passing = replace(left, parameters={**left.parameters, name: np.full(len(left.strides), np.nan)})
    (found,) = reported(walk, passing, right)
    assert (found.key, found.severity, found.where) == ("no_peak", Severity.INFO, "walk 1, left_ankle")
    assert found.numbers == {"peak": "ankle_push_off_plantarflexion"}
    ankle = replace(walk.verdicts.joint(Joint.LEFT_ANKLE), sign=Assessment(Verdict.NOT_REPORTED))
    doubted = replace(walk, verdicts=replace(walk.verdicts, joints={**walk.verdicts.joints, Joint.LEFT_ANKLE: ankle}))
    assert reported(doubted, passing, right) == []


@pytest.mark.parametrize(("whole", "is_reported"), [(0, True), (2, True), (3, False)])
def test_an_angle_with_gaps_in_nearly_every_stride_is_named(
    walk: RecordingAnalysis, whole: int, is_reported: bool
) -> None:
    left, right = (with_used(walk.gait[side], 10) for side in Side)
    cycles = left.cycles[Joint.LEFT_KNEE].copy()
    cycles[whole:] = np.nan
    findings = reported(walk, replace(left, cycles={**left.cycles, Joint.LEFT_KNEE: cycles}), right)
    numbers = {"count": whole, "used": 10, "wanted": 3}
    expected = [Finding("angle_without_mean", Severity.WARNING, "walk 1, left_knee", numbers)] if is_reported else []
    assert findings == expected


def test_standing_through_a_walk_is_no_walk() -> None:
    stood = session_of(WalkerSettings(seed=4, recordings=(Standing(), Standing("walk 1", duration_s=6.0))))
    walked = replace(stood, recordings=(stood.recordings[0], replace(stood.recordings[1], kind=RecordingKind.WALKING)))
    assert "no_strides" in {finding.key for finding in analyse(walked).findings}


@pytest.mark.endurance
@pytest.mark.parametrize("typed", ["left", "right", "both", "none", ""])
def test_the_late_toe_off_of_a_prosthetic_foot_that_walked_is_reported(typed: str) -> None:
    made = session_of(WalkerSettings(recordings=(Standing(), Walk()), sites=tuple(FEET.values())))
    found = analyse(replace(made, patient=replace(made.patient, prosthetic_side=typed)))
    gait = found.recordings[0].gait
    worn = [side for side in Side if typed in (side.value, "both")]
    assert [side for side in Side if gait[side].is_toe_off_biased] == worn
    reported = [one.where for one in found.findings if one.key == "prosthetic_toe_off"]
    assert reported == [f"{side}_foot" for side in worn]
    assert about_prosthesis([replace(found.recordings[0], gait={})]) == []


def timed_walk(walk: RecordingAnalysis, feet: tuple[Turn, ...], pelvis: tuple[PelvisTurn, ...]) -> RecordingAnalysis:
    unknown = np.full(len(walk.time_s), np.nan)
    test = replace(built_test(TimedProtocol.UP_AND_GO, time_s=19.0, distance_m=6.0), turns=feet)
    return replace(walk, timed=test, turns=pelvis, pelvis=PelvisAngles(unknown, unknown, unknown))


ABOUT = Turn(8.0, 9.5, np.pi)


@pytest.mark.parametrize(
    ("feet", "pelvis", "reported"),
    [
        ((ABOUT,), (PelvisTurn(7.9, 9.7, 3.0),), None),
        ((ABOUT,), (PelvisTurn(10.0, 11.0, 3.0),), None),  # feet turn a little earlier or later
        ((ABOUT,), (PelvisTurn(7.9, 9.7, 3.0), PelvisTurn(14.0, 15.0, 1.0)), None),  # less than a quarter
        ((ABOUT,), (PelvisTurn(7.9, 9.7, 3.0), PelvisTurn(24.0, 25.0, 3.0)), None),  # after the test
        ((), (), None),
        ((ABOUT,), (), (1, 0)),
        ((), (PelvisTurn(7.9, 9.7, 3.0),), (0, 1)),
        ((ABOUT,), (PelvisTurn(7.9, 9.7, -3.0),), (1, 1)),
        ((ABOUT,), (PelvisTurn(7.9, 9.7, 3.0), PelvisTurn(14.0, 15.5, -3.0)), (1, 2)),
    ],
)
def test_turns_of_feet_and_pelvis_that_contradict_are_reported_once(
    walk: RecordingAnalysis, feet: tuple[Turn, ...], pelvis: tuple[PelvisTurn, ...], reported: tuple[int, int] | None
) -> None:
    found = about_turns(timed_walk(walk, feet, pelvis))
    assert [(one.key, one.numbers["feet"], one.numbers["pelvis"]) for one in found] == (
        [] if reported is None else [("turns_contradict", *reported)]
    )


def test_without_a_pelvis_or_a_test_no_turn_is_doubted(walk: RecordingAnalysis) -> None:
    timed = timed_walk(walk, (ABOUT,), ())
    assert about_turns(replace(timed, pelvis=None)) == []
    assert about_turns(replace(timed, timed=None)) == []

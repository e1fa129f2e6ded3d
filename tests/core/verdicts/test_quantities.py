"""Each figure rests on the right verdict and is empty exactly where that is not reported."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from core.body import LEG_JOINTS, Joint, Side
from core.parameters import ParameterFile, columns_of
from core.results import RecordingAnalysis, ZeroKind
from core.verdicts.model import NOT_MEASURED, READ, Assessment, JointVerdicts, LegVerdicts, Verdict, Verdicts
from core.verdicts.quantities import (
    OF_BOTH,
    PARAMETERS,
    assessment_of,
    assessment_of_both,
    both_sides,
    joint_of,
    mean_curve,
    peak_percent,
    raw_values,
    side_mean,
    used_cycles,
    values_of,
)
from tests.core.verdicts.built_walk import calibrations, judged_walk, leg, walk

BAD, CARE = Assessment(Verdict.NOT_REPORTED), Assessment(Verdict.CARE)
# what each column needs, written out
KNEE_HEIGHTS = {f"knee_{name}_deg" for name in ("at_initial_contact", "loading_peak", "stance_minimum", "swing_peak")}
ANKLE_HEIGHTS = {
    f"ankle_{name}_deg"
    for name in (
        *("at_initial_contact", "loading_plantarflexion", "stance_dorsiflexion"),
        *("push_off_plantarflexion", "swing_dorsiflexion"),
    )
}
KNEE_EXCURSIONS = {f"knee_{name}_deg" for name in ("while_loading", "straightening", "stance_to_swing")}
ANKLE_EXCURSIONS = {f"ankle_{name}_deg" for name in ("heel_rocker", "rocker", "push_off", "toes_lifted")}
KNEE_SIGNED = {*KNEE_HEIGHTS, *KNEE_EXCURSIONS, "knee_swing_peak_percent"}
KNEE = {*KNEE_SIGNED, "knee_range_deg"}
ANKLE_SIGNED = {*ANKLE_HEIGHTS, *ANKLE_EXCURSIONS}
ANKLE = {*ANKLE_SIGNED, "ankle_range_deg"}
TIMING = {"stride_time_s", "step_time_s", "stance_percent", "swing_percent"}
DISTANCE = {"stride_length_m", "speed_m_s", "clearance_m"}


def verdicts(joints: dict[Joint, dict[str, Assessment]] | None = None, **changes: Any) -> Verdicts:
    """Everything can be read but what is changed: a joint's parts, a leg's parts of the left, or `between`."""
    found = {
        joint: JointVerdicts(**({"shape": READ, "height": READ, "sign": READ} | (joints or {}).get(joint, {})))
        for joint in LEG_JOINTS
    }
    left = LegVerdicts(changes.pop("timing", READ), changes.pop("distance", READ))
    return Verdicts(found, {Side.LEFT: left, Side.RIGHT: LegVerdicts(READ, READ)}, changes.pop("between", READ))


def with_verdicts(found: Verdicts) -> RecordingAnalysis:
    return replace(walk(), verdicts=found)


def not_reported_on(side: Side, found: Verdicts) -> set[str]:
    return {
        name
        for name in columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS)
        if assessment_of(found, side, name).verdict is Verdict.NOT_REPORTED
    }


CASES = [
    (verdicts(), set()),
    (verdicts({Joint.LEFT_KNEE: {"shape": BAD, "height": BAD}}), KNEE),
    (verdicts({Joint.LEFT_KNEE: {"height": BAD}}), KNEE_HEIGHTS),
    (verdicts({Joint.LEFT_KNEE: {"sign": BAD, "height": BAD}}), KNEE_SIGNED),
    (verdicts({Joint.LEFT_KNEE: {"sign": BAD}}), KNEE_SIGNED),
    (verdicts({Joint.LEFT_ANKLE: {"shape": BAD, "height": BAD}}), ANKLE),
    (verdicts({Joint.LEFT_ANKLE: {"height": BAD}}), ANKLE_HEIGHTS),
    (verdicts({Joint.LEFT_ANKLE: {"sign": BAD}}), ANKLE_SIGNED),
    (verdicts(timing=BAD), TIMING),
    (verdicts(distance=BAD), DISTANCE),
    (verdicts(between=BAD), {"step_time_s"}),
]


def test_every_column_is_in_one_class_of_these() -> None:
    assert {*KNEE, *ANKLE, *TIMING, *DISTANCE} == set(columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS))
    assert set(columns_of(ParameterFile.STRIDES, ParameterFile.PEAKS)) - set(PARAMETERS) == {
        *KNEE_EXCURSIONS,
        *ANKLE_EXCURSIONS,
    }  # strides.csv keeps its columns


@pytest.mark.parametrize(("found", "expected"), CASES)
def test_a_column_is_not_reported_where_what_it_rests_on_is(found: Verdicts, expected: set[str]) -> None:
    assert not_reported_on(Side.LEFT, found) == expected
    # what compares instants of both legs is the other leg's as well, and nothing else is
    assert not_reported_on(Side.RIGHT, found) == ({"step_time_s"} if found.between is BAD else set())


def test_care_and_what_was_not_worn_reach_the_column() -> None:
    assert assessment_of(verdicts(timing=CARE), Side.LEFT, "step_time_s").verdict is Verdict.CARE
    found = replace(verdicts(), joints={})
    assert assessment_of(found, Side.LEFT, "knee_range_deg") == NOT_MEASURED


def test_a_columns_joint_is_reported_by_its_name() -> None:
    assert joint_of("knee_swing_peak_percent", Side.RIGHT) is Joint.RIGHT_KNEE
    assert joint_of("ankle_range_deg", Side.LEFT) is Joint.LEFT_ANKLE
    assert joint_of("stride_time_s", Side.LEFT) is None


@pytest.mark.parametrize(("found", "expected"), CASES)
def test_values_are_empty_where_they_are_not_reported_and_else_what_was_measured(
    found: Verdicts, expected: set[str]
) -> None:
    recording = with_verdicts(found)
    gait = recording.gait[Side.LEFT]
    for name in PARAMETERS:
        values = values_of(recording, Side.LEFT, name)
        assert len(values) == len(gait.strides)
        reported, mean = side_mean(recording, Side.LEFT, name), raw_values(gait, name).mean()
        if name in expected:
            assert np.isnan(values).all()
            assert np.isnan(reported.found.mean)
            assert np.isnan(reported.found.sd)
            assert reported.found.n == 0
        else:
            np.testing.assert_array_equal(values, raw_values(gait, name))
            np.testing.assert_equal(reported.found.mean, mean)


def test_angles_are_degrees_and_means_are_of_the_strides_used() -> None:
    ranges = np.linspace(50.0, 61.0, 12)
    recording = judged_walk(walk(left=leg(Side.LEFT, knee_range_deg=ranges, left_out=2)))
    assert raw_values(recording.gait[Side.LEFT], "knee_range_deg") == pytest.approx(ranges)
    found = side_mean(recording, Side.LEFT, "knee_range_deg").found
    assert found.n == 10
    assert found.mean == pytest.approx(54.5)  # 50 to 59


def test_when_a_joint_peaks_needs_its_shape_and_its_sign_and_no_zero() -> None:
    sure = with_verdicts(verdicts())  # every curve has one peak, at 50 %
    assert peak_percent(sure, Side.LEFT, "ankle_stance_dorsiflexion_deg") == pytest.approx(50.0)
    for part in ("shape", "sign"):
        doubted = with_verdicts(verdicts({Joint.LEFT_ANKLE: {part: BAD}}))
        assert np.isnan(peak_percent(doubted, Side.LEFT, "ankle_stance_dorsiflexion_deg")).all()
    no_zero = with_verdicts(verdicts({Joint.LEFT_ANKLE: {"height": BAD}}))
    assert peak_percent(no_zero, Side.LEFT, "ankle_stance_dorsiflexion_deg") == pytest.approx(50.0)
    # the knee only passes through where its loading peak is looked for
    assert np.isnan(peak_percent(sure, Side.LEFT, "knee_loading_peak_deg")).all()


def test_a_mean_curve_needs_shape_and_sign_and_its_spread_the_shape_alone() -> None:
    def known(found: Verdicts) -> tuple[bool, bool]:
        curve = mean_curve(with_verdicts(found), Joint.LEFT_KNEE)
        return bool(np.isfinite(curve.mean).all()), bool(np.isfinite(curve.sd).all())

    assert known(verdicts()) == (True, True)
    assert known(verdicts({Joint.LEFT_KNEE: {"height": BAD}})) == (True, True)
    assert known(verdicts({Joint.LEFT_KNEE: {"sign": BAD}})) == (False, True)
    assert known(verdicts({Joint.LEFT_KNEE: {"shape": BAD}})) == (False, False)
    # the strides themselves stay, as evidence
    bad = with_verdicts(verdicts({Joint.LEFT_KNEE: {"shape": BAD}}))
    assert np.isfinite(used_cycles(bad, Joint.LEFT_KNEE)).all()


def both(found: Verdicts) -> dict[str, str]:
    return {name: str(assessment_of_both(found, name).verdict) for name in OF_BOTH}


CADENCE, SUPPORT, SPEED = "cadence_steps_min", "double_support_percent", "speed_m_s"


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (verdicts(), {CADENCE: "read", SUPPORT: "read", SPEED: "read"}),
        (verdicts(between=BAD), {CADENCE: "read", SUPPORT: "read", SPEED: "read"}),  # no clock is needed
        (verdicts(timing=CARE), {CADENCE: "care", SUPPORT: "withheld", SPEED: "read"}),
        (verdicts(timing=BAD), {CADENCE: "withheld", SUPPORT: "withheld", SPEED: "read"}),
        (verdicts(distance=CARE), {CADENCE: "read", SUPPORT: "read", SPEED: "care"}),
        (verdicts(distance=BAD), {CADENCE: "read", SUPPORT: "read", SPEED: "withheld"}),
    ],
)
def test_figures_of_both_legs_are_as_sure_as_the_worse(found: Verdicts, expected: dict[str, str]) -> None:
    assert both(found) == expected
    reported = both_sides(with_verdicts(found))
    for name, verdict in expected.items():
        assert np.isfinite(getattr(reported, name)) == (verdict in ("read", "care")), name


def test_one_leg_alone_shows_cadence_and_speed_and_no_double_support() -> None:
    whole = walk()
    recording = judged_walk(replace(whole, gait={Side.LEFT: whole.gait[Side.LEFT]}))
    assert both(recording.verdicts) == {CADENCE: "read", SUPPORT: "not_measured", SPEED: "read"}
    reported = both_sides(recording)
    assert reported.cadence_steps_min == pytest.approx(120 / 1.1)
    assert reported.speed_m_s == pytest.approx(1.3 / 1.1)
    assert np.isnan(reported.double_support_percent)
    assert both(Verdicts()) == dict.fromkeys(OF_BOTH, "not_measured")


def test_double_support_is_both_stances_less_a_stride() -> None:
    legs = {"left": leg(Side.LEFT, stance_percent=61.0), "right": leg(Side.RIGHT, stance_percent=58.5)}
    assert both_sides(judged_walk(walk(**legs))).double_support_percent == pytest.approx(19.5)
    late = {**legs, "left": leg(Side.LEFT, stance_percent=61.0, is_toe_off_biased=True)}
    assert np.isnan(both_sides(judged_walk(walk(**late))).double_support_percent)


def test_a_joint_without_a_zero_keeps_its_range_in_a_walk_that_is_judged() -> None:
    recording = judged_walk(reported=calibrations(Joint.LEFT_KNEE, zero=ZeroKind.NONE))
    assert side_mean(recording, Side.LEFT, "knee_range_deg").found.mean == pytest.approx(60.0)
    assert np.isnan(side_mean(recording, Side.LEFT, "knee_swing_peak_deg").found.mean)
    assert side_mean(recording, Side.RIGHT, "knee_swing_peak_deg").found.mean == pytest.approx(60.0)

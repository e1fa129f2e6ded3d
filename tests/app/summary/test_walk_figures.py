"""The figures of a walk: means over the strides used, a band from the same windows, and what cannot be reported."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.gait_csv import gait_tables
from app.exports.summary import summarise
from app.summary.conditions import Part, by_hand_in_words, left_out_of_parts
from app.summary.differences import SIDES, write_sides
from app.summary.reference_bands import (
    WHY_NO_BAND,
    bands_of,
    reference_curves,
    sides_with_band,
    time_distance_classes,
)
from app.summary.walk_figures import (
    MAY_BE_MIRRORED,
    NO_ZERO,
    NOT_REPORTED,
    Figure,
    few_strides_in_words,
    peak_figures,
    reason_in_words,
    side_cycle,
    strides_in_words,
    time_distance_figures,
)
from core.body import Joint, Side
from core.gait.chosen_strides import leave_out
from core.gait.strides import Reason
from core.results import Analysis, RecordingAnalysis, ZeroKind
from core.session import Recording
from core.verdicts.norms import AgeAndHeight, NoBand
from core.verdicts.quantities import both_sides
from tests.app.changed_analysis import recalibrated, rewalked, walk_of, with_few_strides, with_used
from tests.simulated import SLOW_WALK, analysis_of, session_of


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analysis_of(session_of(SLOW_WALK))


@pytest.fixture
def walk(analysis: Analysis) -> RecordingAnalysis:
    return walk_of(analysis)


def alone(walk: RecordingAnalysis) -> Part:
    return Part("A", walk.name, (walk,), {})


def named(figures: tuple[Figure, ...], name: str) -> Figure:
    (found,) = (figure for figure in figures if figure.name == name)
    return found


def test_a_peak_is_the_mean_over_the_strides_used_alone(analysis: Analysis) -> None:
    few = walk_of(with_few_strides(analysis, left=4))
    peak = named(peak_figures(alone(few), reference_curves())["knee"], "Peak flexion, swing").sides[Side.LEFT]
    cycles_deg = np.rad2deg(few.gait[Side.LEFT].cycles[Joint.LEFT_KNEE][:4])
    assert peak.n == 4
    assert peak.mean == pytest.approx(float(cycles_deg[:, 55:91].max(axis=1).mean()))


def test_the_band_of_a_peak_is_where_the_groups_mean_curve_has_its_own(walk: RecordingAnalysis) -> None:
    found = peak_figures(alone(walk), reference_curves())
    group = reference_curves()
    at = 55 + int(np.argmax(group.knee_mean_deg[55:91]))
    low, high = group.knee_mean_deg[at] - group.knee_sd_deg[at], group.knee_mean_deg[at] + group.knee_sd_deg[at]
    assert named(found["knee"], "Peak flexion, swing").band == pytest.approx((low, high))
    assert named(found["knee"], "At initial contact").band == pytest.approx((-2.556, 3.963), abs=1e-3)
    assert named(found["ankle"], "Range of motion").band is None  # a mean curve has no spread of ranges
    assert all(figure.band is None for figures in peak_figures(alone(walk), None).values() for figure in figures)


def test_without_a_zero_only_what_needs_none_is_reported(analysis: Analysis) -> None:
    walk = walk_of(recalibrated(analysis, [Joint.LEFT_KNEE], zero=ZeroKind.NONE))
    for figure in peak_figures(alone(walk), reference_curves())["knee"]:
        holds = figure.name in ("Range of motion", "Time of peak flexion in swing, %")
        assert (Side.LEFT in figure.sides) is holds, figure.name
        assert dict(figure.unknown) == ({} if holds else {Side.LEFT: NO_ZERO})
        assert Side.RIGHT in figure.sides


def test_of_a_joint_that_may_be_mirrored_only_the_range_is_reported(analysis: Analysis) -> None:
    walk = walk_of(recalibrated(analysis, [Joint.RIGHT_ANKLE], is_sign_certain=False))
    for figure in peak_figures(alone(walk), reference_curves())["ankle"]:
        expected = {} if figure.name == "Range of motion" else {Side.RIGHT: MAY_BE_MIRRORED}
        assert dict(figure.unknown) == expected, figure.name


def test_of_sensors_that_are_no_adjacent_nothing_is_reported_and_the_other_leg_is(analysis: Analysis) -> None:
    walk = walk_of(recalibrated(analysis, [Joint.RIGHT_ANKLE], is_same_joint=False))
    for figure in peak_figures(alone(walk), reference_curves())["ankle"]:
        assert dict(figure.unknown) == {Side.RIGHT: NOT_REPORTED}, figure.name
        assert set(figure.sides) == {Side.LEFT}, figure.name
    both = recalibrated(analysis, [Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE], is_same_joint=False)
    assert all(figure.band is None for figure in peak_figures(alone(walk_of(both)), reference_curves())["ankle"])
    figures = time_distance_figures(alone(walk), None, frozenset(Side))
    assert named(figures, "Stance").with_care == {Side.RIGHT}  # the foot's sensor may not be on this foot
    assert named(figures, "Double support").unknown_both == NOT_REPORTED
    assert (
        named(time_distance_figures(alone(walk_of(analysis)), None, frozenset(Side)), "Double support").unknown_both
        == ""
    )


def test_what_is_read_with_care_is_marked(analysis: Analysis) -> None:
    walk = walk_of(recalibrated(analysis, [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(8.0)))
    assert {figure.with_care for figure in peak_figures(alone(walk), None)["knee"]} == {frozenset({Side.LEFT})}
    assert {figure.with_care for figure in peak_figures(alone(walk), None)["ankle"]} == {frozenset()}
    assert "8.0°" in reason_in_words(walk.verdicts.joint(Joint.LEFT_KNEE))
    assert reason_in_words(walk.verdicts.joint(Joint.RIGHT_KNEE)) == ""


def test_time_and_distance_stand_beside_the_group_of_the_walks_speed(walk: RecordingAnalysis) -> None:
    group = bands_of(alone(walk), AgeAndHeight(30, 1.70)).values
    assert group is not None
    assert group.speed_class == "slow"
    figures = time_distance_figures(alone(walk), group, frozenset(Side))
    assert named(figures, "Walking speed").both == pytest.approx(0.95, abs=0.05)
    assert named(figures, "Walking speed").band is None
    assert named(figures, "Stride length").band == pytest.approx((2 * 0.53, 2 * 0.61))
    assert named(figures, "Cadence").band == pytest.approx((91.4, 104.4))
    assert named(figures, "Double support").band is None
    length = named(figures, "Stride length").sides[Side.LEFT].mean
    assert length / named(figures, "Stride time").sides[Side.LEFT].mean == pytest.approx(0.95, abs=0.05)


def test_a_prosthetic_leg_is_beside_no_band_and_the_sound_one_does(analysis: Analysis) -> None:
    walk = walk_of(analysis)
    assert sides_with_band(alone(walk)) == set(Side)
    prosthetic = replace(walk.gait[Side.RIGHT], is_toe_off_biased=True)
    walk = walk_of(rewalked(analysis, gait={**walk.gait, Side.RIGHT: prosthetic}))
    sound = sides_with_band(alone(walk))
    assert sound == {Side.LEFT}
    group = time_distance_classes()[0]
    assert named(time_distance_figures(alone(walk), group, sound), "Stance").band is not None
    assert named(time_distance_figures(alone(walk), group, sound), "Cadence").band is None  # is of both legs
    assert named(time_distance_figures(alone(walk), group, frozenset()), "Stance").band is None


def test_one_measured_side_still_gives_cadence_and_speed(analysis: Analysis) -> None:
    whole = walk_of(analysis)
    one_leg = walk_of(rewalked(analysis, gait={Side.RIGHT: whole.gait[Side.RIGHT]}))
    feet, both = both_sides(one_leg), both_sides(whole)
    assert feet.cadence_steps_min == pytest.approx(both.cadence_steps_min, rel=0.02)
    assert feet.speed_m_s == pytest.approx(both.speed_m_s, rel=0.02)
    assert np.isnan(feet.double_support_percent)
    for figure in peak_figures(alone(one_leg), reference_curves())["knee"]:
        assert set(figure.sides) == {Side.RIGHT}


def test_without_distances_no_group_is_chosen(analysis: Analysis) -> None:
    gait = {}
    for side, found in walk_of(analysis).gait.items():
        strides = replace(found.strides, length_m=np.full(len(found.strides), np.nan))
        gait[side] = replace(found, strides=strides)
    walk = walk_of(rewalked(analysis, gait=gait))
    bands = bands_of(alone(walk), AgeAndHeight(30, 1.70))
    assert (bands.values, bands.why_no_values) == (None, NoBand.SPEED_UNKNOWN)
    figures = time_distance_figures(alone(walk), bands.values, frozenset(Side))
    assert all(figure.band is None for figure in figures)
    assert np.isfinite(named(figures, "Cadence").both or np.nan)


def test_every_reason_for_no_band_has_its_words() -> None:
    assert set(WHY_NO_BAND) == set(NoBand)


def test_a_curve_without_its_height_keeps_its_shape(walk: RecordingAnalysis) -> None:
    found = side_cycle(alone(walk), Joint.LEFT_KNEE)
    lowered = found.about_mean()
    assert np.mean(lowered.mean.mean) == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(lowered.strides_deg + found.height_deg, found.strides_deg)


def test_strides_left_out_are_counted_with_their_reasons(walk: RecordingAnalysis) -> None:
    few = with_used(walk, Side.LEFT, 1)
    left_out = len(walk.gait[Side.LEFT].strides) - 1
    assert strides_in_words(alone(few), Side.LEFT) == f"L: 1 stride used, {left_out} excluded (turning)."
    reason = (Reason.GAP, *few.gait[Side.LEFT].strides.reason[1:])
    strides = replace(few.gait[Side.LEFT].strides, reason=reason)
    gait = replace(few.gait[Side.LEFT], strides=strides)
    stated = strides_in_words(alone(replace(few, gait={Side.LEFT: gait})), Side.LEFT)
    assert stated == f"L: 0 strides used, {left_out + 1} excluded ({left_out} turning, 1 with missing samples)."


@pytest.mark.parametrize("reason", [reason for reason in Reason if reason is not Reason.USED])
def test_every_reason_to_leave_a_stride_out_has_its_words(walk: RecordingAnalysis, reason: Reason) -> None:
    gait = walk.gait[Side.LEFT]
    strides = replace(gait.strides, reason=(reason,) * len(gait.strides))
    stated = strides_in_words(alone(replace(walk, gait={Side.LEFT: replace(gait, strides=strides)})), Side.LEFT)
    assert stated.startswith(f"L: 0 strides used, {len(gait.strides)} excluded (")
    assert "_" not in stated


def test_what_few_strides_cost_is_stated_by_side(walk: RecordingAnalysis) -> None:
    assert few_strides_in_words(alone(with_used(with_used(walk, Side.LEFT, 10), Side.RIGHT, 11))) == ""
    stated = few_strides_in_words(alone(with_used(with_used(walk, Side.LEFT, 2), Side.RIGHT, 9)))
    assert stated == "L: fewer than 3 strides, no mean. R: fewer than 10 strides, no SD."
    assert (
        few_strides_in_words(alone(with_used(with_used(walk, Side.LEFT, 0), Side.RIGHT, 11))) == ""
    )  # there is no mean


def test_a_stride_with_a_gap_is_in_no_mean_cycle(walk: RecordingAnalysis) -> None:
    gait = with_used(walk, Side.LEFT, 5).gait[Side.LEFT]
    cycles = gait.cycles[Joint.LEFT_KNEE].copy()
    cycles[1] = np.nan
    gapped = replace(walk, gait={Side.LEFT: replace(gait, cycles={Joint.LEFT_KNEE: cycles})})
    found = side_cycle(alone(gapped), Joint.LEFT_KNEE)
    kept = np.rad2deg(cycles[[0, 2, 3, 4]])
    assert found.mean.n == 4
    np.testing.assert_allclose(found.mean.mean, kept.mean(axis=0))
    np.testing.assert_allclose(found.strides_deg, kept)
    assert found.toe_off_percent == pytest.approx(float(gait.strides.stance_percent[:5].mean()))


def test_strides_left_out_by_hand_are_stated_in_words_in_the_summary_and_in_every_table(
    analysis: Analysis, tmp_path: Path
) -> None:
    """Who reads one file only has to know as well."""
    (walk,) = (recording for recording in analysis.recordings if recording.gait)
    strides = walk.gait[Side.RIGHT].strides
    out = np.flatnonzero(strides.is_used)[:2]
    middle_s = [float(strides.start_s[k] + strides.end_s[k]) / 2 for k in out]
    reported = Recording(walk.name, walk.kind, walk.folder, {}, left_out_s={Side.RIGHT: tuple(middle_s)})
    found = leave_out(analysis, [reported])
    (left,) = (recording for recording in found.recordings if recording.gait)
    assert by_hand_in_words(walk) == ""
    assert by_hand_in_words(left) == f"2 of {len(strides)} right strides excluded by hand."
    summary = summarise(found)
    right = summary["walks"]["walk 1"]["right"]
    before = summarise(analysis)["walks"]["walk 1"]["right"]
    assert right["strides_left_out_by_hand"] == 2
    assert right["strides_left_out"] == before["strides_left_out"] + 2
    assert right["knee_range_deg_mean"] != before["knee_range_deg_mean"]
    assert [f["text"] for f in summary["findings"] if f["key"] == "strides_left_out_by_hand"] == [
        f"Walk 1: Of {len(strides)} right strides, 2 were excluded by hand."
    ]
    header, rows = gait_tables(left)["strides"]
    reasons = [row[header.index("reason")] for row in rows if row[header.index("used")] == "false"]
    assert reasons.count("left_out_by_hand") == 2
    part = Part("A", "walk 1", (left,), {})
    assert (part.left_out_by_hand(Side.LEFT), part.left_out_by_hand(Side.RIGHT)) == (0, 2)
    assert left_out_of_parts([part]) == f"A: {by_hand_in_words(left)}"
    write_sides([part], (Side.LEFT, Side.RIGHT), tmp_path / SIDES)
    with (tmp_path / SIDES).open(newline="", encoding="utf-8") as file:
        of_legs = list(csv.DictReader(file))
    counts = {(row["left_left_out_by_hand"], row["right_left_out_by_hand"]) for row in of_legs}
    assert (len(of_legs) > 5, counts) == (True, {("0", "2")})

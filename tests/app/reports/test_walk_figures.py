"""The figures of a walk: means over the strides used, a band from the same windows, and what cannot be told."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.reports.comparison import Part, left_out_of_parts
from app.reports.differences import SIDES, write_sides
from app.reports.gait_csv import gait_tables
from app.reports.reference_bands import reference_curves, time_distance_classes
from app.reports.summary import summarise
from app.reports.walk_figures import (
    MAY_BE_MIRRORED,
    NO_ZERO,
    Figure,
    by_hand_in_words,
    few_strides_in_words,
    peak_figures,
    side_cycle,
    strides_in_words,
    time_distance_figures,
)
from core.analysis import analyse
from core.body import Joint, Side
from core.chosen_strides import leave_out
from core.gait.strides import Reason
from core.results import Analysis, JointCalibration, RecordingAnalysis, ZeroKind
from core.samples import Recording
from core.verdicts.gates import verdicts_of
from core.verdicts.quantities import both_sides
from devices.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate

Walked = tuple[RecordingAnalysis, dict[Joint, JointCalibration]]


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    recordings = (Standing(), FreeMotion(), Walk(strides=13, speed_m_s=0.95))
    return analyse(simulate(replace(DEMONSTRATION, recordings=recordings)).session)


@pytest.fixture
def walked(analysis: Analysis) -> Walked:
    (walk,) = (recording for recording in analysis.recordings if recording.gait)
    return walk, dict(analysis.calibrations[0].joints)


def with_used(walk: RecordingAnalysis, side: Side, count: int) -> RecordingAnalysis:
    """Leave all strides of a side out as turning, but for the first `count`."""
    gait = walk.gait[side]
    reason = (Reason.USED,) * count + (Reason.TURN,) * (len(gait.strides) - count)
    return replace(walk, gait={**walk.gait, side: replace(gait, strides=replace(gait.strides, reason=reason))})


def named(figures: tuple[Figure, ...], name: str) -> Figure:
    (found,) = (figure for figure in figures if figure.name == name)
    return found


def test_a_peak_is_the_mean_over_the_strides_used_alone(walked: Walked) -> None:
    walk, _ = walked
    few = with_used(walk, Side.LEFT, 4)
    peak = named(peak_figures(few, reference_curves())["knee"], "Swing peak").sides[Side.LEFT]
    cycles_deg = np.rad2deg(walk.gait[Side.LEFT].cycles[Joint.LEFT_KNEE][:4])
    assert peak.n == 4
    assert peak.mean == pytest.approx(float(cycles_deg[:, 55:91].max(axis=1).mean()))


def test_the_band_of_a_peak_stands_where_the_groups_mean_curve_has_its_own(walked: Walked) -> None:
    found = peak_figures(walked[0], reference_curves())
    group = reference_curves()
    at = 55 + int(np.argmax(group.knee_mean_deg[55:91]))
    low, high = group.knee_mean_deg[at] - group.knee_sd_deg[at], group.knee_mean_deg[at] + group.knee_sd_deg[at]
    assert named(found["knee"], "Swing peak").band == pytest.approx((low, high))
    assert named(found["knee"], "At initial contact").band == pytest.approx((-2.556, 3.963), abs=1e-3)
    assert named(found["ankle"], "Range").band is None  # a mean curve has no spread of ranges


def test_without_a_zero_only_what_needs_none_is_told(walked: Walked) -> None:
    walk, calibrated = walked
    calibrated[Joint.LEFT_KNEE] = replace(calibrated[Joint.LEFT_KNEE], zero=ZeroKind.NONE)
    walk = replace(walk, verdicts=verdicts_of(walk, calibrated, ()))
    for figure in peak_figures(walk, reference_curves())["knee"]:
        holds = figure.name in ("Range", "Swing peak at, %")
        assert (Side.LEFT in figure.sides) is holds, figure.name
        assert dict(figure.unknown) == ({} if holds else {Side.LEFT: NO_ZERO})
        assert Side.RIGHT in figure.sides


def test_of_a_joint_that_may_be_mirrored_only_the_range_is_told(walked: Walked) -> None:
    walk, calibrated = walked
    calibrated[Joint.RIGHT_ANKLE] = replace(calibrated[Joint.RIGHT_ANKLE], is_sign_certain=False)
    walk = replace(walk, verdicts=verdicts_of(walk, calibrated, ()))
    for figure in peak_figures(walk, reference_curves())["ankle"]:
        expected = {} if figure.name == "Range" else {Side.RIGHT: MAY_BE_MIRRORED}
        assert dict(figure.unknown) == expected, figure.name


def test_time_and_distance_stand_beside_the_group_of_the_nearest_speed(walked: Walked) -> None:
    walk, _ = walked
    figures, group = time_distance_figures(walk, both_sides(walk), time_distance_classes())
    assert group is not None
    assert group.speed_class == "slow"
    assert named(figures, "Walking speed").both == pytest.approx(0.95, abs=0.05)
    assert named(figures, "Walking speed").band is None
    assert named(figures, "Stride length").band == pytest.approx((2 * 0.53, 2 * 0.61))
    assert named(figures, "Cadence").band == pytest.approx((91.4, 104.4))
    length = named(figures, "Stride length").sides[Side.LEFT].mean
    assert length / named(figures, "Stride time").sides[Side.LEFT].mean == pytest.approx(0.95, abs=0.05)


def test_one_measured_side_still_gives_cadence_and_speed(walked: Walked) -> None:
    walk, calibrated = walked
    alone = replace(walk, gait={Side.RIGHT: walk.gait[Side.RIGHT]})
    alone = replace(alone, verdicts=verdicts_of(alone, calibrated, ()))
    feet, whole = both_sides(alone), both_sides(walk)
    assert feet.cadence_steps_min == pytest.approx(whole.cadence_steps_min, rel=0.02)
    assert feet.speed_m_s == pytest.approx(whole.speed_m_s, rel=0.02)
    assert np.isnan(feet.double_support_percent)
    for figure in peak_figures(alone, reference_curves())["knee"]:
        assert set(figure.sides) == {Side.RIGHT}


def test_without_distances_no_group_is_chosen(walked: Walked) -> None:
    walk, _ = walked
    gait = {}
    for side, found in walk.gait.items():
        strides = replace(found.strides, length_m=np.full(len(found.strides), np.nan))
        gait[side] = replace(found, strides=strides)
    walk = replace(walk, gait=gait)
    figures, group = time_distance_figures(walk, both_sides(walk), time_distance_classes())
    assert group is None
    assert all(figure.band is None for figure in figures)
    assert np.isfinite(named(figures, "Cadence").both or np.nan)


def test_strides_left_out_are_counted_with_their_reasons(walked: Walked) -> None:
    walk, _ = walked
    few = with_used(walk, Side.LEFT, 1)
    left_out = len(walk.gait[Side.LEFT].strides) - 1
    assert strides_in_words(Side.LEFT, few.gait[Side.LEFT]) == f"L: 1 stride used, {left_out} left out (turning)."
    reason = (Reason.GAP, *few.gait[Side.LEFT].strides.reason[1:])
    strides = replace(few.gait[Side.LEFT].strides, reason=reason)
    said = strides_in_words(Side.LEFT, replace(few.gait[Side.LEFT], strides=strides))
    assert said == f"L: 0 strides used, {left_out + 1} left out ({left_out} turning, 1 with missing samples)."


@pytest.mark.parametrize("reason", [reason for reason in Reason if reason is not Reason.USED])
def test_every_reason_to_leave_a_stride_out_has_its_words(walked: Walked, reason: Reason) -> None:
    gait = walked[0].gait[Side.LEFT]
    strides = replace(gait.strides, reason=(reason,) * len(gait.strides))
    said = strides_in_words(Side.LEFT, replace(gait, strides=strides))
    assert said.startswith(f"L: 0 strides used, {len(gait.strides)} left out (")
    assert "_" not in said


def test_what_few_strides_cost_is_said_by_side(walked: Walked) -> None:
    walk, _ = walked
    assert few_strides_in_words(with_used(with_used(walk, Side.LEFT, 10), Side.RIGHT, 11)) == ""
    said = few_strides_in_words(with_used(with_used(walk, Side.LEFT, 2), Side.RIGHT, 9))
    assert said == "L: under 3 strides, so the mean is shown in grey. R: under 10 strides, so without spread."
    assert few_strides_in_words(with_used(with_used(walk, Side.LEFT, 0), Side.RIGHT, 11)) == ""  # there is no mean


def test_a_stride_with_a_gap_is_in_no_mean_cycle(walked: Walked) -> None:
    walk, _ = walked
    gait = with_used(walk, Side.LEFT, 5).gait[Side.LEFT]
    cycles = gait.cycles[Joint.LEFT_KNEE].copy()
    cycles[1] = np.nan
    gapped = replace(walk, gait={Side.LEFT: replace(gait, cycles={Joint.LEFT_KNEE: cycles})})
    found = side_cycle(gapped, Joint.LEFT_KNEE)
    kept = np.rad2deg(cycles[[0, 2, 3, 4]])
    assert found.mean.n == 4
    np.testing.assert_allclose(found.mean.mean, kept.mean(axis=0))
    np.testing.assert_allclose(found.strides_deg, kept)
    assert found.toe_off_percent == pytest.approx(float(gait.strides.stance_percent[:5].mean()))


def test_strides_left_out_by_hand_are_said_in_words_in_the_summary_and_in_every_table(
    analysis: Analysis, tmp_path: Path
) -> None:
    """Who reads one file only has to know as well."""
    (walk,) = (recording for recording in analysis.recordings if recording.gait)
    strides = walk.gait[Side.RIGHT].strides
    out = np.flatnonzero(strides.is_used)[:2]
    middle_s = [float(strides.start_s[k] + strides.end_s[k]) / 2 for k in out]
    told = Recording(walk.name, walk.kind, walk.folder, {}, left_out_s={Side.RIGHT: tuple(middle_s)})
    found = leave_out(analysis, [told])
    (left,) = (recording for recording in found.recordings if recording.gait)
    assert by_hand_in_words(walk) == ""
    assert by_hand_in_words(left) == f"2 of {len(strides)} right strides left out by hand."
    summary = summarise(found)
    right = summary["walks"]["walk 1"]["right"]
    before = summarise(analysis)["walks"]["walk 1"]["right"]
    assert right["strides_left_out_by_hand"] == 2
    assert right["strides_left_out"] == before["strides_left_out"] + 2
    assert right["knee_range_deg_mean"] != before["knee_range_deg_mean"]
    assert [f["text"] for f in summary["findings"] if f["key"] == "strides_left_out_by_hand"] == [
        f"Walk 1: 2 of {len(strides)} right strides left out by hand."
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

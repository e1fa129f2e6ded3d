"""Tests of the tables of differences. They leave out what is not reported in one of the two, and report the rest."""

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import Part
from app.summary.differences import (
    comparisons_of,
    rows_along_chain,
    rows_of,
    without_common_condition,
    write_compared_cycles,
    write_differences,
    write_sides,
)
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, Side
from core.results import Analysis, Calibration, Method, SideGait, ZeroKind
from core.session import Recording, RecordingKind, Session
from tests.core.verdicts.built_walk import Reported, calibrations, judged_walk, leg, walk


def part(letter: str, reported: Reported | None = None, **changes: Any) -> Part:
    """A condition of one walk."""
    found = reported or calibrations()
    return Part(letter, f"condition {letter}", (judged_walk(walk(**changes), found),), found)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def differences(folder: Path, *parts: Part) -> dict[tuple[str, str], dict[str, str]]:
    write_differences(rows_of(Comparison(Contrast.CONDITIONS, parts)), folder / "differences.csv")
    return {(row["side"], row["parameter"]): row for row in table(folder / "differences.csv")}


def sides(folder: Path, one: Part) -> dict[str, dict[str, str]]:
    write_sides([one], (Side.LEFT, Side.RIGHT), folder / "sides.csv")
    return {row["parameter"]: row for row in table(folder / "sides.csv")}


def test_what_can_be_read_is_reported_with_its_error_and_what_it_contains(tmp_path: Path) -> None:
    found = differences(tmp_path, part("A"), part("B", left=leg(Side.LEFT, knee_range_deg=66.0)))
    row = found["left", "knee_range_deg"]
    assert (row["difference"], row["status"], row["verdict"]) == ("6.00000", "read", "exceeds_error")
    assert float(row["error"]) == pytest.approx(2.772, abs=1e-3)
    assert row["error_sources"] == "chance drift walk_to_walk"
    assert found["right", "knee_range_deg"]["verdict"] == "inside_error"
    assert found["both", "speed_m_s"]["status"] == "read"
    assert ("left", "knee_curve_difference_deg") in found


def test_what_is_not_reported_in_one_of_the_two_has_no_difference_and_no_error(tmp_path: Path) -> None:
    bad = part("B", calibrations(Joint.LEFT_KNEE, sign_margin=1.0))
    found = differences(tmp_path, part("A"), bad)
    for name in ("knee_range_deg", "knee_swing_peak_deg"):
        row = found["left", name]
        assert (row["status"], row["verdict"]) == ("withheld", "withheld")
        assert row["difference"] == row["error"] == row["mean"] == ""
        assert float(row["against_mean"]) == 60.0  # the other walk's own
    assert ("left", "knee_curve_difference_deg") not in found
    assert found["right", "knee_range_deg"]["verdict"] == "inside_error"


def test_care_reaches_the_row(tmp_path: Path) -> None:
    found = differences(tmp_path, part("A"), part("B", calibrations(Joint.LEFT_KNEE, lag_sd_s=0.005)))
    assert found["left", "knee_range_deg"]["status"] == "care"
    assert found["left", "knee_range_deg"]["verdict"] == "inside_error"
    assert found["left", "ankle_range_deg"]["status"] == "read"


def test_figures_of_both_legs_are_not_reported_where_a_walk_withholds_them(tmp_path: Path) -> None:
    """Of a condition of two walks the worse holds, although the other walk alone could report."""
    good, bad = part("A"), walk(left=leg(Side.LEFT, stance_percent=20.0))
    pooled = replace(good, letter="B", walks=(*good.walks, judged_walk(bad)))
    assert np.isnan(pooled.of_both("cadence_steps_min"))
    assert good.of_both("cadence_steps_min") == pytest.approx(120 / 1.1)
    found = differences(tmp_path, good, pooled)
    for name in ("cadence_steps_min", "double_support_percent", "speed_m_s"):
        row = found["both", name]
        assert (row["status"], row["verdict"]) == ("withheld", "withheld")
        assert row["mean"] == row["difference"] == row["error"] == ""
        assert row["against_mean"] != ""


def test_a_curve_without_a_height_is_compared_by_its_shape_alone(tmp_path: Path) -> None:
    no_zero = part("B", calibrations(Joint.LEFT_KNEE, zero=ZeroKind.NONE))
    too_high = part("C", left=leg(Side.LEFT, ankle_least_deg=30.0))
    no_sign = part("D", calibrations(Joint.RIGHT_KNEE, is_sign_certain=False))
    write_compared_cycles([part("A"), no_zero, too_high, no_sign], tmp_path / "compared_cycles.csv")
    rows = table(tmp_path / "compared_cycles.csv")
    assert [row["percent"] for row in rows] == [str(percent) for percent in range(101)]
    for curve, status, has_height, has_shape in (
        ("A_left_knee", "read", True, True),
        ("B_left_knee", "no_zero", False, True),
        ("B_right_knee", "read", True, True),
        ("C_left_ankle", "no_zero", False, True),
        ("D_right_knee", "range_only", False, False),
    ):
        assert {row[f"{curve}_status"] for row in rows} == {status}
        assert {row[f"{curve}_mean_deg"] != "" for row in rows} == {has_height}
        assert {row[f"{curve}_shape_deg"] != "" for row in rows} == {has_shape}
    shape = [float(row["B_left_knee_shape_deg"]) for row in rows]
    assert np.mean(shape) == pytest.approx(0.0, abs=1e-5)
    assert np.ptp(shape) == pytest.approx(60.0)
    found = differences(tmp_path, part("A"), too_high)
    assert ("left", "ankle_curve_difference_deg") not in found
    assert ("left", "knee_curve_difference_deg") in found


def test_legs_are_set_side_by_side_with_their_status(tmp_path: Path) -> None:
    one = part("A", calibrations(Joint.RIGHT_ANKLE, axis_sd_rad=None), left=leg(Side.LEFT, knee_range_deg=75.0))
    found = sides(tmp_path, one)
    knee, ankle, time = (found[name] for name in ("knee_range_deg", "ankle_range_deg", "stride_time_s"))
    assert (knee["difference"], knee["status"], knee["verdict"]) == ("15.00000", "read", "exceeds_error")
    # 1.96 times hypot(1.2, 0.043 * 75) and hypot(1.2, 0.043 * 60) is 8.75, and 1 ms of lag in each leg
    assert float(knee["error"]) == pytest.approx(8.8, abs=0.05)
    assert knee["mark"] == "beyond_healthy"
    assert float(knee["healthy_limit"]) == pytest.approx(10.25, abs=0.06)
    assert float(knee["low"]) == pytest.approx(15.0 - float(knee["error"]), abs=1e-4)
    assert float(knee["high"]) == pytest.approx(15.0 + float(knee["error"]), abs=1e-4)
    assert "clock" in knee["error_sources"]
    assert (ankle["status"], ankle["verdict"]) == ("withheld", "withheld")
    assert ankle["difference"] == ankle["error"] == ankle["right_mean"] == ankle["symmetry_index_percent"] == ""
    assert time["verdict"] == "no_published_figure"


def test_a_changed_alignment_is_reported_against_the_one_it_was_changed_from_too(tmp_path: Path) -> None:
    def changed_from(one: Part, since: str) -> Part:
        return replace(one, alignment=AlignmentChange(since, (PartChange(ProsthesisPart.PYLON, height_mm=3.0),)))

    first, second = part("A"), changed_from(part("B", left=leg(Side.LEFT, knee_range_deg=66.0)), "condition A")
    third = changed_from(part("C", left=leg(Side.LEFT, knee_range_deg=70.0)), "condition B")
    comparison = Comparison(Contrast.CONDITIONS, (first, second, third))
    assert [comparison.base_of(one).letter for one in comparison.parts] == ["A", "A", "B"]
    write_differences(rows_along_chain(comparison), tmp_path / "differences.csv")
    rows = [row for row in table(tmp_path / "differences.csv") if row["parameter"] == "knee_range_deg"]
    reported = {(row["part"], row["against_part"]): row["difference"] for row in rows if row["side"] == "left"}
    assert reported == {("B", "A"): "6.00000", ("C", "A"): "10.00000", ("C", "B"): "4.00000"}
    alone = Comparison(Contrast.CONDITIONS, (first, changed_from(part("B"), "gone")))
    assert alone.base_of(alone.parts[1]) is alone.parts[0]
    assert len(list(rows_along_chain(alone))) == len(list(rows_of(alone)))


def with_fitting(of: SideGait, heel_rise_deg: float, pitch_deg: float) -> SideGait:
    n = len(of.strides)
    fitting = {
        "foot_heel_rise_rad": np.full(n, np.deg2rad(heel_rise_deg)),
        "foot_pitch_at_contact_rad": np.full(n, np.deg2rad(pitch_deg)),
        "shank_at_mid_stance_rad": np.full(n, 0.1),
    }
    return replace(of, parameters={**of.parameters, **fitting})


def test_measures_for_fitting_are_reported_with_their_errors(tmp_path: Path) -> None:
    before = part("A", left=with_fitting(leg(Side.LEFT), 60.0, 12.0))
    after = part("B", left=with_fitting(leg(Side.LEFT), 66.0, 13.0))
    found = differences(tmp_path, before, after)
    rise, pitch = found["left", "foot_heel_rise_deg"], found["left", "foot_pitch_at_contact_deg"]
    assert (rise["difference"], rise["verdict"], rise["status"]) == ("6.00000", "exceeds_error", "read")
    assert float(rise["error"]) == pytest.approx(1.96 * np.sqrt(2) * 0.9, abs=0.01)
    assert (pitch["difference"], pitch["verdict"]) == ("1.00000", "inside_error")
    assert ("left", "foot_flat_percent") not in found  # was not measured
    names = [parameter for side, parameter in found if side == "left"]
    assert names.index("knee_range_deg") < names.index("foot_heel_rise_deg")


def test_a_not_reported_knee_withholds_what_the_shank_leans(tmp_path: Path) -> None:
    bad = part("B", calibrations(Joint.LEFT_KNEE, sign_margin=1.0), left=with_fitting(leg(Side.LEFT), 66.0, 13.0))
    found = differences(tmp_path, part("A", left=with_fitting(leg(Side.LEFT), 60.0, 12.0)), bad)
    row = found["left", "shank_at_mid_stance_deg"]
    assert (row["difference"], row["error"], row["verdict"]) == ("", "", "withheld")


def test_legs_differ_in_measures_for_fitting_by_more_than_their_error(tmp_path: Path) -> None:
    left, right = with_fitting(leg(Side.LEFT), 75.0, 12.0), with_fitting(leg(Side.RIGHT), 60.0, -2.0)
    found = sides(tmp_path, part("A", left=left, right=right))
    rise, pitch = found["foot_heel_rise_deg"], found["foot_pitch_at_contact_deg"]
    assert (rise["difference"], rise["verdict"]) == ("15.00000", "exceeds_error")
    assert float(rise["error"]) == pytest.approx(8.5, abs=0.01)  # healthy people's; 3.2 would make 8.9 of it
    assert (rise["mark"], rise["healthy_limit"], pitch["mark"]) == ("beyond_healthy", "8.50000", "beyond_healthy")
    assert rise["symmetry_index_percent"] != ""
    assert pitch["symmetry_index_percent"] == ""  # it may be nought, or on both sides of it


def test_an_interval_is_the_difference_less_and_plus_its_error_in_every_row(tmp_path: Path) -> None:
    """And of what is not judged there is none."""
    found = differences(tmp_path, part("A"), part("B", left=leg(Side.LEFT, knee_range_deg=66.0)))
    judged = [row for row in found.values() if row["verdict"] in ("exceeds_error", "inside_error")]
    assert len(judged) > 20
    for row in judged:
        low, high = float(row["difference"]) - float(row["error"]), float(row["difference"]) + float(row["error"])
        assert [float(row["low"]), float(row["high"])] == pytest.approx([low, high], abs=2e-5)
        assert row["mark"] == ("beyond_error" if row["verdict"] == "exceeds_error" else "")
        assert row["healthy_limit"] == ""  # legs of one walk have it, no walks
    for row in found.values():
        assert row in judged or row["low"] == row["high"] == row["mark"] == ""
    knee = found["left", "knee_range_deg"]  # 1.96 sqrt(2) 1.0
    assert [float(knee["low"]), float(knee["high"])] == pytest.approx([3.23, 8.77], abs=0.01)
    assert knee["beyond_speed"] == ""  # both walked at one speed


def test_what_goes_with_speed_is_taken_out_beside_and_the_error_of_the_difference_stays(tmp_path: Path) -> None:
    """0.2 m/s faster at over 0.8 m/s makes -1 point of stance, and 0.3 of that in the error: 0.55, 0.55 and 0.3."""

    def at(letter: str, speed_m_s: float, stance_percent: float) -> Part:
        left, right = (leg(side, length_m=1.1 * speed_m_s, stance_percent=stance_percent, time_s=1.1) for side in Side)
        return part(letter, left=left, right=right)

    slow, fast = at("A", 1.0, 62.0), at("B", 1.2, 58.0)
    row = differences(tmp_path, slow, fast)["left", "stance_percent"]
    assert float(row["difference"]) == pytest.approx(-4.0)
    assert float(row["error"]) == pytest.approx(1.96 * np.hypot(0.55, 0.55), abs=0.01)
    assert float(row["beyond_speed"]) == pytest.approx(-3.0, abs=1e-4)
    error = 1.96 * np.sqrt(0.55**2 + 0.55**2 + 0.3**2)
    assert float(row["beyond_speed_low"]) == pytest.approx(-3.0 - error, abs=0.01)
    assert float(row["beyond_speed_high"]) == pytest.approx(-3.0 + error, abs=0.01)
    assert differences(tmp_path, slow, fast)["left", "ankle_range_deg"]["beyond_speed"] == ""  # no slope is known


def test_stride_length_is_set_side_by_side_and_never_judged(tmp_path: Path) -> None:
    """Feet travel equally far: of healthy people 41 of 100 would be called."""
    one = part("A", left=leg(Side.LEFT, length_m=1.5), right=leg(Side.RIGHT, length_m=1.2))
    length = sides(tmp_path, one)["stride_length_m"]
    assert float(length["left_mean"]) > float(length["right_mean"])
    assert (length["verdict"], length["mark"], length["low"]) == ("no_published_figure", "", "")


@pytest.mark.parametrize(("stance", "mark"), [(62.0, ""), (63.6, "beyond_error"), (65.0, "beyond_healthy")])
def test_legs_bear_the_mark_of_what_they_differ_by(tmp_path: Path, stance: float, mark: str) -> None:
    """The right has 60 %; the error is 3.0 points, and 95 of 100 healthy people differ by less than 4.0."""
    row = sides(tmp_path, part("A", left=leg(Side.LEFT, stance_percent=stance)))["stance_percent"]
    assert row["mark"] == mark
    assert float(row["healthy_limit"]) == pytest.approx(4.0, abs=0.1)


COLUMNS = (  # as other programs read them
    "part,name,walks,against_part,against_name,against_walks,side,parameter,n,mean,sd,against_n,against_mean,"
    "against_sd,difference,error,error_sources,status,verdict,left_out_by_hand,against_left_out_by_hand,chosen_before,"
    "low,high,beyond_speed,beyond_speed_low,beyond_speed_high,mark,healthy_limit"
)


def knee(low_deg: float, high_deg: float, n: int) -> SideGait:
    """A left leg whose knee range grows evenly."""
    return leg(Side.LEFT, n, knee_range_deg=np.linspace(low_deg, high_deg, n))


def test_each_figure_is_under_its_name_and_with_its_walks(tmp_path: Path) -> None:
    """Held against the strides themselves, column by column."""
    before, after = knee(58.0, 62.0, 12), knee(63.0, 71.0, 14)
    one = Part("A", "barefoot", (judged_walk(walk(left=before)),), calibrations())
    twice = (judged_walk(walk(left=after)), judged_walk(walk(left=after, name="walk 2")))
    other = Part("B", "shoes", twice, calibrations())
    write_differences(rows_of(Comparison(Contrast.CONDITIONS, (one, other))), tmp_path / "differences.csv")
    assert (tmp_path / "differences.csv").read_text(encoding="utf-8").splitlines()[0] == COLUMNS
    rows = {(row["side"], row["parameter"]): row for row in table(tmp_path / "differences.csv")}
    row = rows["left", "knee_range_deg"]
    assert (row["part"], row["name"], row["walks"]) == ("B", "shoes", "walk 1; walk 2")
    assert (row["against_part"], row["against_name"], row["against_walks"]) == ("A", "barefoot", "walk 1")
    ranges_deg = np.tile(np.linspace(63.0, 71.0, 14), 2), np.linspace(58.0, 62.0, 12)
    assert (row["n"], row["against_n"]) == ("28", "12")
    for prefix, found_deg in zip(("", "against_"), ranges_deg, strict=True):
        assert float(row[f"{prefix}mean"]) == pytest.approx(found_deg.mean(), abs=1e-4)
        assert float(row[f"{prefix}sd"]) == pytest.approx(found_deg.std(ddof=1), abs=1e-4)
    assert row["difference"] == "7.00000"
    cadence = rows["both", "cadence_steps_min"]
    assert (cadence["part"], cadence["against_part"], cadence["n"], cadence["sd"]) == ("B", "A", "", "")
    assert float(cadence["mean"]) == pytest.approx(120 / 1.1, abs=1e-3)
    assert (cadence["difference"], cadence["verdict"]) == ("0.00000", "inside_error")


def test_a_not_reported_figure_is_of_the_part_that_it_is_reported_of(tmp_path: Path) -> None:
    bad = part("B", calibrations(Joint.LEFT_KNEE, sign_margin=1.0))
    found = differences(tmp_path, part("A"), bad)
    for row in (found["left", "knee_range_deg"], found["left", "ankle_range_deg"], found["both", "speed_m_s"]):
        assert (row["part"], row["against_part"]) == ("B", "A")


def test_curves_are_reported_of_every_joint_that_can_be_and_how_far_they_are_apart(tmp_path: Path) -> None:
    """The first joint of a leg, or of the other leg, takes none of those after it along."""
    higher = part("B", left=leg(Side.LEFT, knee_least_deg=4.0), right=leg(Side.RIGHT, ankle_least_deg=-7.0))
    found = differences(tmp_path, part("A"), higher)
    curves = {place: row for place, row in found.items() if place[1].endswith("_curve_difference_deg")}
    assert {place: row["difference"] for place, row in curves.items()} == {
        ("left", "knee_curve_difference_deg"): "4.00000",
        ("left", "ankle_curve_difference_deg"): "0.00000",
        ("right", "knee_curve_difference_deg"): "0.00000",
        ("right", "ankle_curve_difference_deg"): "3.00000",
    }
    assert {(row["error"], row["verdict"], row["mean"], row["n"]) for row in curves.values()} == {
        ("", "no_published_figure", "", "")
    }
    bad = part("C", calibrations(Joint.LEFT_KNEE, sign_margin=1.0))
    assert {place for place in differences(tmp_path, part("A"), bad) if place[1].endswith("curve_difference_deg")} == {
        ("left", "ankle_curve_difference_deg"),
        ("right", "knee_curve_difference_deg"),
        ("right", "ankle_curve_difference_deg"),
    }


@pytest.mark.parametrize(("strides", "is_reported"), [(2, False), (3, True)])
def test_a_curve_of_fewer_than_three_strides_is_not_compared(tmp_path: Path, strides: int, is_reported: bool) -> None:
    """Its verdict withholds it already; what is pooled of a walk of two and none counts for itself."""
    found = differences(tmp_path, part("A"), part("B", left=leg(Side.LEFT, strides)))
    assert (("left", "knee_curve_difference_deg") in found) is is_reported


def test_a_mean_curve_has_its_spread_and_its_strides_under_their_names(tmp_path: Path) -> None:
    write_compared_cycles([part("A", left=knee(50.0, 61.0, 12))], tmp_path / "compared_cycles.csv")
    middle = table(tmp_path / "compared_cycles.csv")[50]  # where each stride is at its range
    ranges_deg = np.linspace(50.0, 61.0, 12)
    assert float(middle["A_left_knee_mean_deg"]) == pytest.approx(ranges_deg.mean(), abs=1e-4)
    assert float(middle["A_left_knee_stride_sd_deg"]) == pytest.approx(ranges_deg.std(ddof=1), abs=1e-4)
    assert middle["A_left_knee_n"] == "12"


@pytest.mark.parametrize(("strides", "has_index"), [(2, False), (3, True)])
def test_symmetry_is_of_sizes_and_of_three_strides(tmp_path: Path, strides: int, has_index: bool) -> None:
    one = part("A", left=leg(Side.LEFT, strides, time_s=1.2), right=leg(Side.RIGHT, 12, time_s=1.0))
    found = sides(tmp_path, one)
    index = found["stride_time_s"]["symmetry_index_percent"]
    assert index == (f"{100 * 0.2 / 1.1:.5f}" if has_index else "")
    assert found["knee_at_initial_contact_deg"]["symmetry_index_percent"] == ""  # a height is no size


def visit(*walks: tuple[str, str]) -> tuple[Session, Analysis]:
    """A visit of walks by name and condition."""
    recordings = tuple(
        Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {}, condition=condition)
        for name, condition in walks
    )
    analysed = tuple(judged_walk(walk(name=name)) for name, _ in walks)
    calibration = Calibration(tuple(name for name, _ in walks), calibrations())
    return Session(recordings), Analysis(Method.ROBUST, False, (calibration,), analysed)


def test_conditions_of_a_visit_are_compared_and_visits_by_their_conditions() -> None:
    first = visit(("walk 1", "barefoot"), ("walk 2", "shoes"))
    second, third = visit(("walk 1", "shoes")), visit(("walk 1", "orthosis"), ("walk 2", "barefoot"))
    alone = comparisons_of([first])
    assert [[part.letter for part in one.parts] for one in alone] == [["A", "B"]]
    assert comparisons_of([second]) == []
    for visits, within, between in (
        ([first, second], [["1A", "1B"]], [[("1", "shoes"), ("2", "shoes")]]),
        (
            [first, second, third],
            [["1A", "1B"], ["3A", "3B"]],
            [[("1", "shoes"), ("2", "shoes")], [("1", "barefoot"), ("3", "barefoot")]],
        ),
    ):
        found = comparisons_of(visits)
        conditions = [one for one in found if one.kind is Contrast.CONDITIONS]
        assert [[part.letter for part in one.parts] for one in conditions] == within
        pairs = [one for one in found if one.kind is Contrast.VISITS]
        assert [[(part.letter[0], part.name) for part in one.parts] for one in pairs] == between


def test_a_visit_without_a_condition_of_the_first_is_named_by_its_number() -> None:
    first, other = visit(("walk 1", "barefoot")), visit(("walk 1", "orthosis"))
    assert without_common_condition([first, other, first, other]) == [2, 4]
    assert without_common_condition([first, visit()]) == []  # nothing was walked

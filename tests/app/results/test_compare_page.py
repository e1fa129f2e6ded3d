"""Walks, visits and legs compared: what is on the axes, what is judged, and that a file has every number drawn."""

import csv
import datetime
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.results.compare_page import CURVES, PLOT, TABLE
from app.results.compared_table import comparison_table, side_table_row
from app.results.compared_words import conclusion
from app.results.result_page import ResultPage
from app.results.tools_row import ANSWER, COMPARE, STRIDES, WHOLE
from app.summary.comparison import Comparison, Contrast, compare_sides, first_and_second
from app.summary.conditions import Part, conditions_of
from app.summary.differences import (
    COMPARED_CYCLES,
    DIFFERENCES,
    SIDES,
    rows_of,
    write_compared_cycles,
    write_differences,
    write_sides,
)
from app.summary.numbers_in_words import MARKS
from app.summary.request import AnalysedVisit
from app.summary.visits import ComparedVisits, WalkedVisit, conditions_in_words, parts_of_visits, visits_by_condition
from app.theme.icons import Icon
from app.widgets.table_cells import TextCell
from app.widgets.text import SEMIBOLD
from app.widgets.trend_cell import TrendCell
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, JointKind, Side
from core.results import Analysis, ZeroKind
from core.session import Session
from core.verdicts.gates import judged
from core.verdicts.measurement_error import ErrorSource, Judgement, Mark
from core.verdicts.sigmas import ComparisonKind
from tests.app.changed_analysis import recalibrated, with_few_strides
from tests.app.room import settle, words_cut
from tests.simulated import THREE_WALKS, analysis_of, session_of

DIGITS = 1e-5


@cache
def session() -> Session:
    """Three walks of two conditions."""
    found = session_of(THREE_WALKS)
    conditions = {"walk 1": "barefoot", "walk 2": "barefoot", "walk 3": "AFO"}
    return replace(
        found, recordings=tuple(replace(one, condition=conditions.get(one.name, "")) for one in found.recordings)
    )


@cache
def analysis() -> Analysis:
    return analysis_of(session())


@pytest.fixture
def parts() -> tuple[Part, ...]:
    return conditions_of(analysis(), session().recordings)


@pytest.fixture
def page(shared_page: ResultPage) -> ResultPage:
    """The walks of the visit compared, whatever a test before compared."""
    page = shared_page
    page.resize(1064, 672)
    page.set_room(1064, 672)
    page.compare.view.choose(PLOT)
    page.set_has_visits(False)
    show_walks_compared(page)
    page.compare.kinds.setCurrentIndex(0)
    page.compare.bases.setCurrentIndex(0)
    return page


def show_walks_compared(page: ResultPage) -> None:
    page.show_visit(AnalysedVisit(session(), analysis()))
    page.leave_behind()
    page.show()
    page.view.choose(COMPARE)


def choose(page: ResultPage, kind: Contrast) -> None:
    page.compare.kinds.setCurrentIndex(page.compare.kinds.findData(kind))


def compare_visits(page: ResultPage, *visits: WalkedVisit) -> None:
    """Choose to compare visits, then give those."""
    page.compare.set_has_visits(True)
    choose(page, Contrast.VISITS)
    if visits:
        page.show_visits(visits_by_condition(visits), conditions_in_words(visits), parts_of_visits(visits))


def lines_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def differences(page: ResultPage) -> dict[tuple[str, Side], float]:
    found = page.compare.comparison
    assert found is not None
    return {(row.measure.column, row.side): row.difference.difference for row in found.rows}


def test_walks_of_one_condition_are_taken_together(parts: tuple[Part, ...]) -> None:
    assert [(part.letter, part.name, len(part.walks)) for part in parts] == [("A", "barefoot", 2), ("B", "AFO", 1)]
    one_by_one = [walk.gait[Side.LEFT].strides.is_used.sum() for walk in parts[0].walks]
    assert parts[0].strides(Side.LEFT) == sum(one_by_one)


def test_a_walk_is_called_in_the_boxes_of_results_as_its_condition_is_in_the_comparison(
    result_page: ResultPage,
) -> None:
    page = result_page
    page.show_visit(AnalysedVisit(session(), analysis()))
    offered = [page.recordings.itemText(row) for row in range(page.recordings.count())]
    assert offered == ["free motion", "A barefoot", "A2 barefoot", "B AFO"]
    assert [page.recordings.itemData(row) for row in range(4)] == ["free motion", "walk 1", "walk 2", "walk 3"]
    chips = [button.text() for button in page.compare.chips.buttons]
    assert [chip.split(" · ")[0] for chip in chips] == ["A barefoot", "B AFO"]
    walks = [row for row in range(page.thin.count()) if isinstance(page.thin.itemData(row), str)]
    assert page.recordings.currentData() == "walk 3"  # of the latest condition
    assert [page.thin.itemText(row) for row in walks] == ["A barefoot", "A2 barefoot"]


def test_a_walk_that_gets_another_condition_stays_on_the_screen_under_its_new_name(page: ResultPage) -> None:
    page.recordings.setCurrentIndex(page.recordings.findData("walk 3"))
    renamed = (replace(one, condition="stick") if one.name == "walk 3" else one for one in session().recordings)
    page.show_visit(AnalysedVisit(replace(session(), recordings=tuple(renamed)), analysis()))
    assert (page.recordings.currentData(), page.recordings.currentText()) == ("walk 3", "B stick")
    assert page.whole.charts.accessibleName() == "Knee and ankle angles of B stick"


@pytest.mark.parametrize("condition", ["Barefoot", "Own shoes with insoles of four millimetres"])
def test_in_a_small_window_no_view_of_a_prosthetic_patient_scrolls_to_and_fro(page: ResultPage, condition: str) -> None:
    """With the longest words, what is compared included; a bar that scrolls up and down takes its part of the width."""
    width, bar = 896, 12  # of a window of 960 x 600, beside the rail
    reported = (replace(one, condition=condition if one.name != "walk 3" else "AFO") for one in session().recordings)
    patient = replace(session().patient, prosthetic_side="left", affected_side="left")
    visit = replace(session(), recordings=tuple(reported), patient=patient)
    page.set_room(700, 472)  # what was narrower before
    page.set_room(width, 472)
    page.set_has_visits(True)
    page.show_visit(AnalysedVisit(visit, replace(analysis(), affected_side=Side.LEFT)))
    shown = []
    for view in (ANSWER, COMPARE, WHOLE, STRIDES):
        page.view.choose(view)
        for kind in range(page.compare.kinds.count() if view == COMPARE else 1):
            page.compare.kinds.setCurrentIndex(kind)
            settle()
            shown.append((view, page.compare.kinds.currentText(), page.minimumSizeHint().width()))
    page.view.choose(ANSWER)
    page.all_figures.click()
    settle()
    shown.append(("figures", "", page.minimumSizeHint().width()))
    assert "Prosthetic vs sound side" in {words for _, words, _ in shown}
    assert [one for one in shown if one[2] > width - bar] == []


def test_curves_differences_and_table_can_be_reached_in_a_window_of_any_size(page: ResultPage) -> None:
    """In one of 960 px their choice lay in the card that the curves hide, or beyond the edge."""
    for widths in ((1064, 896), (1064, 700, 896), (896, 700), (896, 1064), (896, 1700)):
        page.view.choose(COMPARE)
        for width in widths:
            page.resize(width, 672)
            page.set_room(width, 672)
        settle()
        choice = page.compare.view
        assert choice.isVisible() is (widths[-1] < 1700), widths  # there all of them stand side by side
        assert words_cut(page) == [], widths
        page.view.choose(ANSWER)
        assert not choice.isVisible(), widths


def test_a_letter_stays_its_conditions_where_another_has_no_strides() -> None:
    walked = tuple(one for one in analysis().recordings if one.name not in ("walk 1", "walk 2"))
    (part,) = conditions_of(replace(analysis(), recordings=walked), session().recordings)
    assert (part.letter, part.name) == ("B", "AFO")


def test_walks_after_strapping_again_are_of_another_part_and_judged_as_between_visits() -> None:
    reported = tuple(replace(one, is_restrapped_before=one.name == "walk 2") for one in session().recordings)
    parts = conditions_of(analysis(), reported)
    assert [part.attachment for part in parts] == [0, 1, 1]
    found = Comparison(Contrast.CONDITIONS, parts)
    kinds = {found.error_kind(part) for part in found.others}
    assert kinds == {ComparisonKind.STRAPPINGS}
    by_column = {row.measure.column: row.difference for row in found.rows if row.side is Side.LEFT}
    # 1.96 sqrt(2) hypot(1.2, 0.043 * 57.5) = 7.6, and chance
    assert by_column["knee_range_deg"].error == pytest.approx(7.7, abs=0.2)
    assert ErrorSource.STRAPS in by_column["knee_range_deg"].sources
    assert ErrorSource.ZERO in by_column["knee_swing_peak_deg"].sources
    assert by_column["ankle_range_deg"].is_unverified


def test_within_one_attachment_the_error_holds_what_walks_differ_by_and_no_strapping(parts: tuple[Part, ...]) -> None:
    found = Comparison(Contrast.CONDITIONS, parts)
    (row,) = (row for row in found.rows if row.side is Side.RIGHT and row.measure.column == "ankle_rocker_deg")
    assert row.difference.error < 12.4  # of strapping and two zeros
    assert ErrorSource.WALKS in row.difference.sources
    assert row.difference.difference == pytest.approx(row.value.mean - row.other.mean)
    assert ErrorSource.STRAPS not in row.difference.sources


def test_without_a_common_zero_range_is_compared_and_height_is_not(parts: tuple[Part, ...]) -> None:
    knee = Joint.LEFT_KNEE
    other = replace(parts[1].calibrated[knee], zero=ZeroKind.GONIOMETER)
    changed = (parts[0], replace(parts[1], calibrated={**parts[1].calibrated, knee: other}))
    reported = {
        row.measure.column: row.is_reported
        for row in Comparison(Contrast.CONDITIONS, changed).rows
        if row.side is Side.LEFT
    }
    assert not reported["knee_swing_peak_deg"]
    assert reported["knee_range_deg"]
    assert reported["ankle_range_deg"]


def test_the_affected_leg_is_reported_against_the_sound_one(parts: tuple[Part, ...]) -> None:
    assert first_and_second(Side.RIGHT) == (Side.RIGHT, Side.LEFT)
    left = {row.measure.column: row for row in compare_sides(parts[0], (Side.LEFT, Side.RIGHT))}
    right = {row.measure.column: row for row in compare_sides(parts[0], (Side.RIGHT, Side.LEFT))}
    swing = "knee_swing_peak_deg"
    assert right[swing].difference.difference == pytest.approx(-left[swing].difference.difference)
    assert math.isnan(right[swing].symmetry_percent)
    assert math.isfinite(right["knee_range_deg"].symmetry_percent)


def test_every_number_of_the_comparison_is_in_its_files(page: ResultPage, tmp_path: Path) -> None:
    compare = page.compare
    found = compare.comparison
    assert found is not None
    write_differences(rows_of(found), tmp_path / DIFFERENCES)
    write_compared_cycles(found.parts, tmp_path / COMPARED_CYCLES)
    rows = {(row["parameter"], row["side"], row["part"]): row for row in lines_of(tmp_path / DIFFERENCES)}
    judged = [row for row in found.rows if row.is_reported]
    assert judged
    for row in judged:
        side = "both" if row.measure.is_of_walk else str(row.side)
        reported = rows[row.measure.column, side, row.part.letter]
        assert float(reported["difference"]) == pytest.approx(row.difference.difference, abs=DIGITS)
        assert float(reported["error"]) == pytest.approx(row.difference.error, abs=DIGITS)
        assert reported["verdict"] == row.difference.judgement
    drawn = [dot.value for group in compare.card.plot.groups for row in group.rows for dot in row.dots]
    written = [float(row["difference"]) for row in rows.values() if row["difference"]]
    assert drawn
    assert all(any(abs(value - other) < DIGITS for other in written) for value in drawn)
    cycles = lines_of(tmp_path / COMPARED_CYCLES)
    for (side, kind), frame in compare.frames.items():
        joint = kind.of(side)
        assert frame.isVisible() is not joint.is_hip
        if joint.is_hip:
            continue
        assert len(frame.chart.curves) == 2
        for curve in frame.chart.curves:
            column = [float(row[f"{curve.letter}_{joint}_mean_deg"]) for row in cycles]
            np.testing.assert_allclose(column, curve.angle_deg, atol=DIGITS)


def test_every_number_of_the_legs_is_in_its_file(page: ResultPage, parts: tuple[Part, ...], tmp_path: Path) -> None:
    """Of whichever condition the legs are looked at."""
    compare = page.compare
    choose(page, Contrast.SIDES)
    write_sides(parts, (Side.LEFT, Side.RIGHT), tmp_path / SIDES)
    written = lines_of(tmp_path / SIDES)
    seen = set()
    for part in parts:
        compare.bases.setCurrentIndex(compare.bases.findData(part.letter))
        reported = [float(row["difference"]) for row in written if row["part"] == part.letter and row["difference"]]
        drawn = [dot.value for group in compare.card.plot.groups for row in group.rows for dot in row.dots]
        assert len(drawn) == len(compare.card.plot.groups) > 0
        assert all(any(abs(value - other) < DIGITS for other in reported) for value in drawn)
        seen.add(tuple(drawn))
    assert len(seen) == len(parts) == 2


def test_what_is_turned_off_leaves_axes_and_table(page: ResultPage) -> None:
    compare = page.compare
    compare.chips.buttons[0].click()
    assert [curve.letter for curve in compare.frames[Side.LEFT, JointKind.KNEE].chart.curves] == ["B"]
    assert compare.bases.count() == 1
    assert compare.comparison is not None
    assert not compare.comparison.rows


def test_another_starting_point_turns_the_differences(page: ResultPage) -> None:
    compare = page.compare
    before = differences(page)
    compare.bases.setCurrentIndex(1)
    assert compare.card.title.text() == "Change from B"
    after = differences(page)
    assert all(after[key] == pytest.approx(-before[key], nan_ok=True) for key in before)


def test_visits_are_asked_for_once_and_reported_when_there_are_none(
    qtbot: QtBot, result_page: ResultPage, parts: tuple[Part, ...]
) -> None:
    page, compare = result_page, result_page.compare
    compare.set_has_visits(True)
    show_walks_compared(page)
    with qtbot.waitSignal(compare.visits_requested):
        choose(page, Contrast.VISITS)
    assert compare.nothing.isVisible()
    compare.show_visits([])
    assert "No earlier visit" in compare.nothing.text()
    compare.show_visits([ComparedVisits("AFO", parts, ())])
    assert compare.comparison is not None
    assert compare.comparison.kind is Contrast.VISITS
    assert compare.card.plot.isVisible()


def walked(
    visit: str, found: Analysis | None = None, day: datetime.date | None = None, **conditions: str
) -> WalkedVisit:
    """A visit whose walks 1 to 3 had these conditions; a walk that is not named was not recorded."""
    names = {name.replace("_", " "): condition for name, condition in conditions.items()}
    recordings = [replace(one, condition=names[one.name]) for one in session().recordings if one.name in names]
    found = found or analysis()
    found = replace(found, recordings=tuple(one for one in found.recordings if one.name in names))
    return WalkedVisit(visit, found, recordings, day)


def test_visits_are_compared_condition_by_condition_and_never_pooled() -> None:
    """Alignment B of the first visit is no part of what A or C is reported against."""
    visits = [
        walked("May", walk_1="A", walk_2="A", walk_3="B"),
        walked("June", walk_1="C"),
        walked("July", walk_1="C", walk_2="A", walk_3="D"),
    ]
    found = {one.condition: one for one in visits_by_condition(visits)}
    reported = {
        condition: [(part.letter, part.name, [walk.name for walk in part.walks]) for part in one.parts]
        for condition, one in found.items()
    }
    assert reported == {
        "C": [("2", "June", ["walk 1"]), ("3", "July", ["walk 1"])],
        "A": [("1", "May", ["walk 1", "walk 2"]), ("3", "July", ["walk 2"])],
    }
    assert {condition: one.without for condition, one in found.items()} == {"C": ("May",), "A": ("June",)}


def test_walks_without_a_condition_are_reported_against_such_only_and_not_taken_together() -> None:
    stated = walked("May", walk_1="walk 1")  # as a condition of that name
    unstated = walked("June", walk_1="", walk_2="")
    assert visits_by_condition([stated, unstated]) == ()
    (only,) = visits_by_condition([unstated, unstated])
    assert [[walk.name for walk in part.walks] for part in only.parts] == [["walk 2"], ["walk 2"]]


def test_one_condition_after_the_other_is_chosen_on_the_screen(page: ResultPage) -> None:
    compare = page.compare
    compare_visits(
        page,
        walked("May", walk_1="A", walk_3="B"),
        walked("June", walk_1="B"),
        walked("July", walk_1="A", walk_2="B"),
    )
    words = [compare.kinds.itemText(k) for k in range(compare.kinds.count())]
    assert words[1:3] == ["Visits, A", "Visits, B"]
    assert (compare.kind, compare.card.title.text()) == (Contrast.VISITS, "Change from 1, A")
    assert "Not compared, as they have no walk in this condition: June." in compare.conclusion.text()
    compare.kinds.setCurrentIndex(2)
    assert (compare.kind, compare.card.title.text()) == (Contrast.VISITS, "Change from 1, B")
    assert compare.comparison is not None
    assert [part.name for part in compare.comparison.parts] == ["May", "June", "July"]
    assert "Not compared" not in compare.conclusion.text()
    compare.kinds.setCurrentIndex(0)
    assert "Not compared" not in compare.conclusion.text()


def test_any_conditions_of_any_visits_can_be_chosen(page: ResultPage) -> None:
    """The first and the last to begin with; between visits by the error of a new strapping and another day."""
    compare = page.compare
    visits = (
        walked("May", walk_1="A", walk_3="B"),
        walked("July", walk_1="C"),
    )
    compare_visits(page, *visits)
    choose(page, Contrast.CHOSEN)
    assert compare.comparison is not None
    assert [part.name for part in compare.comparison.parts] == ["May, A", "July, C"]
    assert {compare.comparison.error_kind(part) for part in compare.comparison.others} == {ComparisonKind.VISITS}
    assert compare.card.title.text() == "Change from 1A"
    compare.chips.choose(["1A", "1B"])
    compare.chips.turned.emit()
    assert [part.name for part in compare.comparison.parts] == ["May, A", "May, B"]
    assert {compare.comparison.error_kind(part) for part in compare.comparison.others} == {ComparisonKind.ATTACHED}


def test_speed_cadence_and_stride_length_stand_first_and_are_judged(page: ResultPage) -> None:
    visits = walked("May", walk_1="A"), walked("July", walk_3="A")
    compare_visits(page, *visits)
    assert page.compare.comparison is not None
    _, rows = comparison_table(page.compare.comparison, 5)
    names = list(dict.fromkeys(str(row.cells[1].words) for row in rows))
    assert names[:3] == ["Walking speed, m/s", "Cadence, steps/min", "Stride length, m"]


def heads(page: ResultPage) -> list[str]:
    """Of the columns behind leg and measure."""
    return [column.head.words for column in page.compare.card.table.cells.columns][2:]


def test_visits_stand_under_their_days_and_changes_beside_their_error(page: ResultPage) -> None:
    """Walks of one visit have no day over them."""
    assert heads(page) == ["A", "B", "B \N{MINUS SIGN} A", "likely between"]
    compare_visits(page, *(walked(day, walk_1="A") for day in ("3 May", "1 June", "5 July")))
    days = ["1 3 May", "2 1 June", "3 5 July"]
    assert heads(page) == [*days, "trend; grey: error", "3 \N{MINUS SIGN} 1", "likely between"]
    found = page.compare.comparison
    assert found is not None
    of_last = {row.measure.column: row for row in found.rows if row.part.letter == "3"}
    speed, cadence = of_last["speed_m_s"].difference, of_last["cadence_steps_min"].difference
    assert speed.error > 0
    reported = [line[-1] for line in table_words(page)]
    low, high = (f"{edge:+.2f}".replace("-", "\N{MINUS SIGN}") for edge in speed.interval)
    assert reported[0] == f"{low} to {high}"
    assert (reported[1] == "\N{EN DASH}") is not (cadence.error > 0)


def test_visits_without_a_common_condition_are_not_compared_and_that_is_stated(page: ResultPage) -> None:
    compare = page.compare
    visits = (
        walked("May", walk_1="A", walk_2=""),
        walked("July", walk_1="B"),
    )
    compare_visits(page, *visits)
    assert compare.nothing.text() == (
        "This visit shares no condition with an earlier visit, so the visits are not compared. "
        "May: A, no condition recorded. July: B. To compare any two visits or conditions, choose “Any visits and "
        "conditions”."
    )
    assert not compare.card.plot.isVisible()
    assert compare.kinds.itemText(compare.kinds.currentIndex()) == "Visits"


def test_no_word_is_cut(page: ResultPage) -> None:
    for room in ((1064, 672), (1680, 952), (736, 432)):
        page.set_room(*room)
        page.resize(*room)
        for view, segment in zip((CURVES, PLOT, TABLE), page.compare.view.segments, strict=True):
            if not segment.isHidden():
                page.compare.view.choose(view)
                assert words_cut(page) == [], (room, view)


def shown(page: ResultPage, found: Analysis, kind: Contrast) -> str:
    """Show an analysis compared in a way, and give what is concluded."""
    page.show_visit(AnalysedVisit(session(), found))
    choose(page, kind)
    return page.compare.conclusion.text()


def bent_more(by_deg: float, joint: Joint = Joint.RIGHT_KNEE) -> Analysis:
    """With the range of one joint larger in every walk."""
    name = f"{'knee' if joint.is_knee else 'ankle'}_range_rad"
    recordings = []
    for one in analysis().recordings:
        gait = dict(one.gait)
        if joint.side in gait:
            found = gait[joint.side]
            parameters = {**found.parameters, name: found.parameters[name] + np.deg2rad(by_deg)}
            gait[joint.side] = replace(found, parameters=parameters)
        recordings.append(replace(one, gait=gait))
    return judged(replace(analysis(), recordings=tuple(recordings)))


def test_between_legs_only_what_is_worth_a_sentence_is_stated(page: ResultPage, snapshot: SnapshotAssertion) -> None:
    legs = {
        "within error": analysis(),
        "the right knee bends 20° more": bent_more(20.0),
        "the right ankle bends 20° more": bent_more(20.0, Joint.RIGHT_ANKLE),
        "9.3°, and healthy people differ by 10.2": bent_more(6.0),
    }
    assert {case: shown(page, one, Contrast.SIDES) for case, one in legs.items()} == snapshot


def test_between_walks_only_what_is_worth_a_sentence_is_stated(page: ResultPage) -> None:
    page.show_visit(AnalysedVisit(session(), analysis()))
    found = page.compare.comparison
    assert found is not None
    wording = [row for row in found.rows if row.is_reported and row.difference.is_worth_a_sentence]
    quiet = [row for row in found.rows if row.is_reported and not row.difference.is_worth_a_sentence]
    assert quiet
    assert page.compare.conclusion.text().count("Likely between ") == min(len(wording), 3)
    few = replace(found, parts=(found.parts[0], found.parts[0]))
    assert not any(row.difference.is_worth_a_sentence for row in few.rows)


def table_words(page: ResultPage) -> list[list[str]]:
    """The leg, the name and the cells of every row."""
    return [line.split("\t") for line in page.compare.card.table.as_text().split("\n")[1:]]


def test_every_cell_of_the_table_states_leg_measure_and_part(page: ResultPage) -> None:
    """Legs stand in a column of their own, where rows are of one of them."""
    cells, wording = page.compare.card.table.cells, Qt.ItemDataRole.AccessibleTextRole
    shown(page, analysis(), Contrast.CONDITIONS)
    assert not page.compare.card.table.isColumnHidden(0)
    length = 2  # the first row of a leg: speed and cadence are of both
    assert (cells.index(length, 0).data(), cells.index(length, 0).data(wording)) == ("L", "left")
    received = str(cells.index(length, 4).data(wording))
    assert received.startswith(f"L {cells.index(length, 1).data()}, B \N{MINUS SIGN} A: ")
    assert received.endswith(f": {cells.index(length, 4).data()}")
    shown(page, analysis(), Contrast.SIDES)
    assert page.compare.card.table.isColumnHidden(0)
    assert str(cells.index(0, 2).data(wording)).startswith(f"{cells.index(0, 1).data()}, L: ")
    assert all(not line[0] for line in table_words(page))


def test_what_lies_beyond_its_error_is_marked_and_nothing_else(parts: tuple[Part, ...]) -> None:
    rows = compare_sides(parts[0], (Side.LEFT, Side.RIGHT))
    knee = next(row for row in rows if row.measure.column == "knee_range_deg")
    for judgement, mark in (
        (Judgement.INSIDE_ERROR, Mark.NONE),
        (Judgement.EXCEEDS_ERROR, Mark.ERROR),
        (Judgement.EXCEEDS_ERROR, Mark.HEALTHY),
    ):
        row = replace(knee, difference=replace(knee.difference, judgement=judgement, mark=mark))
        cell = side_table_row(row, ["L", "R", "L - R", "likely between", "symmetry, %"]).cells[4]
        assert isinstance(cell, TextCell)
        assert (cell.small, cell.mark) == (MARKS[mark], None)
        assert (cell.weight == SEMIBOLD) is (mark is not Mark.NONE)


def test_an_error_that_could_not_be_verified_bears_a_dagger_in_the_table(page: ResultPage) -> None:
    visits_shown(page, analysis(), bent_more(30.0, Joint.RIGHT_ANKLE))
    rows = {(side, name): cells for side, name, *cells in table_words(page)}
    ankle, knee = (rows["R", name] for name in ("Ankle range of motion", "Knee flexion, stance to swing"))
    assert any("\N{DAGGER}" in cell for cell in ankle)
    assert not any("\N{DAGGER}" in cell for cell in knee)
    assert "\N{DAGGER} based on a value" in page.compare.error.text()
    assert "sensor attachment" in page.compare.error.text()
    shown(page, analysis(), Contrast.CONDITIONS)
    assert "\N{DAGGER}" not in page.compare.error.text()
    reported = page.compare.error.text()
    for words in ("variation between strides", "drift within a walk", "variation between walks"):
        assert words in reported
    assert "strapping" not in reported
    stance = [cells[2] for _, name, *cells in table_words(page) if name.startswith("Stance")]
    assert len(stance) == 2
    assert "\N{DAGGER}" not in "".join(stance)  # measured by ourselves


def test_what_is_not_reported_is_in_no_comparison(page: ResultPage) -> None:
    doubtful = recalibrated(analysis(), [Joint.RIGHT_ANKLE], is_same_joint=False, sign_margin=1.05)
    shown(page, doubtful, Contrast.SIDES)
    rows = {name: cells for _, name, *cells in table_words(page)}
    assert rows["Ankle range of motion"][1:3] == ["not reported", "\N{EN DASH}"]
    assert rows["Ankle range of motion"][0] not in ("not reported", "\N{EN DASH}")
    assert "not reported" not in rows["Knee range of motion"]
    shown(page, doubtful, Contrast.CONDITIONS)
    frame = page.compare.frames[Side.RIGHT, JointKind.ANKLE]
    assert frame.chart.curves == ()
    assert "A: not reported. Sensor positions could not be confirmed" in frame.note
    assert len(page.compare.frames[Side.LEFT, JointKind.ANKLE].chart.curves) == 2
    assert "not reported" not in page.compare.frames[Side.LEFT, JointKind.ANKLE].note


def test_two_strides_have_neither_a_curve_nor_a_toe_off() -> None:
    part = conditions_of(with_few_strides(analysis(), left=2), session().recordings)[0]
    few, enough = (part.curve(joint, is_about_mean=False) for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE))
    assert (few.is_known, few.is_few, math.isfinite(few.toe_off_percent)) == (False, True, False)
    assert (enough.is_known, enough.is_few, math.isfinite(enough.toe_off_percent)) == (True, False, True)
    assert enough.toe_off_label == part.letter


def test_without_a_zero_curves_are_compared_about_their_mean(page: ResultPage) -> None:
    shown(page, recalibrated(analysis(), [Joint.LEFT_KNEE], zero=ZeroKind.NONE), Contrast.CONDITIONS)
    frame = page.compare.frames[Side.LEFT, JointKind.KNEE]
    assert [float(np.mean(curve.angle_deg)) for curve in frame.chart.curves] == [pytest.approx(0.0, abs=1e-9)] * 2
    assert "0° is the mean angle over the gait cycle." in frame.note
    assert frame.chart.described.band is None
    assert "mean of the stride" not in page.compare.frames[Side.RIGHT, JointKind.KNEE].note


def test_a_change_counts_from_the_first_visit_that_can_be_read_and_states_so() -> None:
    gated = recalibrated(analysis(), [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(11.0))
    days = (("May", gated), ("June", analysis()), ("July", analysis()))
    (visits,) = visits_by_condition([walked(name, found, walk_1="A") for name, found in days])
    found = Comparison(Contrast.VISITS, visits.parts)
    _, rows = comparison_table(found, 5)
    ranges = [row.cells for row in rows if row.cells[1].words == "Knee range of motion"]
    of_range = {cells[0].side: cells for cells in ranges if isinstance(cells[0], TextCell)}
    first, third = (of_range[Side.LEFT][k] for k in (2, 6))
    assert isinstance(first, TextCell)
    assert isinstance(third, TextCell)
    assert (first.mark, first.small) == (Icon.NOT_REPORTED, "not reported")
    assert third.small.startswith("from 2")
    assert "from 2" in third.words
    assert not any("from" in str(cell.words) for cell in of_range[Side.RIGHT])


def visits_shown(page: ResultPage, *analyses: Analysis) -> str:
    """Show visits of these analyses under one condition, ten days apart, and give what is concluded."""
    days = [datetime.date(2026, 5, 1) + datetime.timedelta(days=10 * k) for k in range(len(analyses))]
    compare_visits(page, *(walked(str(day), one, day, walk_1="A") for day, one in zip(days, analyses, strict=True)))
    return page.compare.conclusion.text()


def marked(page: ResultPage) -> list[tuple[Side | None, str]]:
    """The leg and the measure of every change that the table marks."""
    found = []
    for row in page.compare.card.table.cells.rows:
        leg, name, *cells = row.cells
        if any(isinstance(cell, TextCell) and {"●", "○"}.intersection(cell.small) for cell in cells):
            assert isinstance(leg, TextCell)
            found.append((leg.side, name.words))
    return found


def measures(page: ResultPage) -> set[str]:
    return {row.cells[1].words for row in page.compare.card.table.cells.rows}


def test_of_visits_the_change_to_the_latest_is_stated_and_marked(page: ResultPage, snapshot: SnapshotAssertion) -> None:
    """Of ankles of 26.8 and 56.8° the error is 1.96 sqrt(2) 3.3 = 9.1 and chance, from another maker's sensors."""
    bent, ankle = bent_more(30.0), bent_more(30.0, Joint.RIGHT_ANKLE)
    few = with_few_strides(analysis(), left=5, right=5)
    visits = {
        "a knee": (analysis(), analysis(), bent),
        "a knee, gone at the latest": (analysis(), bent, analysis()),
        "an ankle has its dagger": (analysis(), analysis(), ankle),
        "an ankle, gone at the latest": (analysis(), ankle, analysis()),
        "nothing of the latest is judged": (analysis(), analysis(), few),
        "nothing of the one before is judged": (analysis(), few, analysis()),
    }
    found = {case: (visits_shown(page, *those), marked(page)) for case, those in visits.items()}
    assert found == snapshot
    page.compare.chips.choose(["1"])
    page.compare.chips.turned.emit()
    assert page.compare.conclusion.text() == ""  # of one visit there is no change


def test_from_the_latest_visit_as_base_the_one_before_is_reported(page: ResultPage) -> None:
    visits_shown(page, analysis(), bent_more(30.0), analysis())
    found = page.compare.comparison
    assert found is not None
    assert any(row.exceeds for row in found.rows)  # as the picture of the differences shows in any case
    page.compare.bases.setCurrentIndex(2)
    assert heads(page)[-2:] == ["2 \N{MINUS SIGN} 3", "likely between"]
    assert "range of motion at visit 2, 30.0° more than at visit 3 (62.0°)" in page.compare.conclusion.text()
    assert marked(page) == [(Side.RIGHT, "Knee range of motion")]


def test_the_conclusion_speaks_of_all_sentences_there_are() -> None:
    (visits,) = visits_by_condition([walked(day, walk_1="A") for day in ("May", "July")])
    row = next(row for row in Comparison(Contrast.VISITS, visits.parts).rows if row.is_reported)
    assert conclusion(["a", "b", "c", "d"], [row]) == ["a", "b", "c", "The table shows all differences."]
    assert conclusion(["a", "b", "c"], [row]) == ["a", "b", "c"]


def test_the_trend_of_a_row_states_its_values_and_where_there_is_none(page: ResultPage) -> None:
    gated = recalibrated(analysis(), [Joint.LEFT_KNEE], axis_sd_rad=np.deg2rad(11.0))
    visits_shown(page, analysis(), gated, analysis())
    trends = {
        (cell.side, row.cells[1].words): cell
        for row in page.compare.card.table.cells.rows
        for cell in row.cells
        if isinstance(cell, TrendCell)
    }
    left = trends[Side.LEFT, "Knee flexion, stance to swing"]
    assert [math.isfinite(value) for value in left.values] == [True, False, True]
    assert left.places == pytest.approx((0.0, 0.5, 1.0))
    assert left.stated.startswith("L Knee flexion, stance to swing, trend; grey: error: 1 ")
    assert ", 2 –, 3 " in left.stated
    assert "–" not in trends[Side.RIGHT, "Knee flexion, stance to swing"].stated
    assert trends[None, "Walking speed, m/s"].band is not None
    shown(page, analysis(), Contrast.CONDITIONS)
    rows = page.compare.card.table.cells.rows
    assert not any(isinstance(cell, TrendCell) for row in rows for cell in row.cells)


def test_between_visits_the_table_is_brief_until_all_is_asked_for(page: ResultPage) -> None:
    card = page.compare.card
    page.compare.view.choose(TABLE)
    visits_shown(page, analysis(), analysis(), analysis())
    assert card.all_measures.isVisible()
    assert "Knee flexion, stance to swing" in measures(page)
    assert not {"Knee range of motion", "Ankle range of motion", "Peak knee flexion, swing"} & measures(page)
    card.all_measures.click()
    assert {"Knee range of motion", "Ankle range of motion", "Peak knee flexion, swing"} <= measures(page)
    card.all_measures.click()
    visits_shown(page, analysis(), analysis(), bent_more(30.0))
    assert "Knee range of motion" in measures(page)  # what is marked is never left out
    assert "Ankle range of motion" not in measures(page)
    shown(page, analysis(), Contrast.CONDITIONS)
    assert not card.all_measures.isVisible()
    assert "Ankle range of motion" in measures(page)


@pytest.mark.parametrize("view", [PLOT, TABLE])
def test_five_visits_are_shown_without_scrolling(page: ResultPage, view: str) -> None:
    page.compare.view.choose(view)
    visits_shown(page, analysis(), analysis(), analysis(), analysis(), bent_more(30.0))
    QApplication.processEvents()
    page.resize(1064, 672)  # the answer, shown before, had asked for more
    QApplication.processEvents()
    assert (page.width(), page.height()) == (1064, 672)
    area = page.compare.card.area
    assert (area.verticalScrollBar().maximum(), area.horizontalScrollBar().maximum()) == (0, 0)
    assert words_cut(page) == []


def test_of_many_visits_the_base_and_the_latest_have_a_column_and_the_trend_has_all() -> None:
    days = ("May", "June", "July", "August")
    (visits,) = visits_by_condition([walked(day, walk_1="A") for day in days])
    found = Comparison(Contrast.VISITS, visits.parts)
    columns, rows = comparison_table(found, 3)
    names = ["1 May", "3 July", "4 August", "trend; grey: error", "4 \N{MINUS SIGN} 1", "likely between"]
    assert [column.head.words for column in columns[2:]] == names
    assert {len(cell.values) for row in rows for cell in row.cells if isinstance(cell, TrendCell)} == {4}
    columns, _ = comparison_table(found, 5)
    assert [column.head.words for column in columns[2:6]] == ["1 May", "2 June", "3 July", "4 August"]


def test_where_room_is_short_every_view_can_be_left_again(page: ResultPage) -> None:
    for room in ((736, 432), (1064, 592)):
        page.set_room(*room)
        page.resize(*room)
        for view in (CURVES, PLOT, TABLE):
            page.compare.view.choose(view)
            assert page.compare.view.isVisible()
        page.set_room(1064, 672)
        assert page.compare.view.isVisible()


@pytest.fixture
def three(page: ResultPage) -> ResultPage:
    """Three conditions, the last of which was changed from the first."""
    changed = AlignmentChange("A", (PartChange(ProsthesisPart.PYLON, height_mm=3.0),))
    reported = {"walk 1": ("A", None), "walk 2": ("B", None), "walk 3": ("C", changed)}
    recordings = tuple(
        replace(one, condition=reported[one.name][0], alignment=reported[one.name][1]) if one.name in reported else one
        for one in session().recordings
    )
    page.show_visit(AnalysedVisit(replace(session(), recordings=recordings), analysis()))
    return page


def pair(page: ResultPage) -> tuple[str, str]:
    """What is shown, and what it is against."""
    found = page.compare.comparison
    assert found is not None
    assert len(found.parts) == 2
    return found.others[0].letter, found.against.letter


def test_any_two_walks_are_compared_by_keys(qtbot: QtBot, three: ResultPage) -> None:
    page = three
    assert len(page.compare.chips.chosen) == 3
    page.activateWindow()
    qtbot.waitUntil(page.isActiveWindow)
    QTest.keyClick(page, Qt.Key.Key_3)
    assert pair(page) == ("C", "A")  # which it was changed from
    QTest.keyClick(page, Qt.Key.Key_2, Qt.KeyboardModifier.ShiftModifier)
    assert pair(page) == ("C", "B")
    shown = page.compare.comparison
    assert shown is not None
    row = next(row for row in shown.rows if row.measure.column == "knee_range_deg" and row.side is Side.LEFT)
    apart = row.part.value(Side.LEFT, "knee_range_deg").mean - row.against.value(Side.LEFT, "knee_range_deg").mean
    assert row.difference.difference == pytest.approx(apart)
    QTest.keyClick(page, Qt.Key.Key_1)
    assert pair(page) == ("A", "B")
    QTest.keyClick(page, Qt.Key.Key_9)  # there is none
    assert pair(page) == ("A", "B")
    assert page.compare.bases.currentData() == "B"


def test_with_shift_a_letter_becomes_what_the_other_is_against(three: ResultPage) -> None:
    buttons = three.compare.chips.buttons
    three.compare.choose_pair(2, is_second=False)
    with_shift(buttons[1])
    assert pair(three) == ("C", "B")
    with_shift(three.compare.chips.buttons[2])  # itself: then the one beside it is shown
    assert pair(three)[1] == "C"
    QTest.mouseClick(three.compare.chips.buttons[0], Qt.MouseButton.LeftButton)
    assert len(three.compare.chips.chosen) == 3  # without it is added, as always


def with_shift(button: QAbstractButton) -> None:
    QTest.mouseClick(button, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier)


def test_legs_have_no_pair(three: ResultPage) -> None:
    three.compare.kinds.setCurrentIndex(three.compare.kinds.count() - 1)
    before = three.compare.side_rows
    three.compare.choose_pair(1, is_second=False)
    assert three.compare.side_rows is before

"""The page of questions: what is stated comes only where it is so, nothing is judged, and nobody is named."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QLabel
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.cohort.study.groups import GroupAnswer, Grouping, GroupQuestion, GroupRow, answer
from app.cohort.study.measures import measure_words
from app.cohort.study.parameter_table import ParameterTable
from app.home.cohort.cohort_page import MOST_DRAWN, QuestionsPage
from app.home.cohort.cohort_table import MOST_ROWS, groups_table
from app.home.cohort.cohort_text import group_name, notes, sentence
from app.plots.group_plot import GroupLine, GroupPlot
from tests.app.cohort.study.study_tables import MEASURE, random_rows, write_rows
from tests.app.room import words_cut

WHOLE = GroupRow("barefoot", 12, 12, 24, 58.4, 6.1, 1.76, 3.88, 9.2, 0, 0, 0, 0)
FEW = replace(
    WHOLE, group="shoes", sessions=2, patients=2, sd=math.nan, standard_error=math.nan, half_interval=math.nan
)


def found(*rows: GroupRow, grouping: Grouping = Grouping.CONDITION, **more: int) -> GroupAnswer:
    sessions = sum(row.sessions for row in rows)
    reported = {"sessions": sessions, "patients": sessions, "simulated": 0, "simulated_left_out": 0} | more
    return GroupAnswer(GroupQuestion(MEASURE, grouping), rows, **reported)


@pytest.fixture
def page(qtbot: QtBot) -> QuestionsPage:
    page = QuestionsPage()
    qtbot.addWidget(page)
    page.set_room(1064)
    page.resize(1064, 700)
    page.show_table("batch/parameters.parquet", ["stance_percent", MEASURE], tuple(Grouping))
    page.show()
    return page


def shown(page: QuestionsPage) -> str:
    return " ".join(label.text() for label in page.findChildren(QLabel) if label.isVisible())


def test_a_note_comes_where_it_is_so_and_not_where_it_is_not(snapshot: SnapshotAssertion) -> None:
    assert notes(found(WHOLE)) == []
    assert {
        "a group of few sessions": notes(found(WHOLE, FEW)),
        "sessions in several groups": notes(found(WHOLE, FEW, sessions=12)),
        "several sessions of one person": notes(found(WHOLE, patients=5)),
        "all of one person": notes(found(WHOLE, patients=1)),
        "of how many people is not known": notes(found(WHOLE, patients=0)),
        "simulated": notes(found(WHOLE, simulated=3)),
        "simulated and left out": notes(found(WHOLE, simulated_left_out=1)),
        "not reported": notes(found(replace(WHOLE, withheld=4))),
        "caution": notes(found(replace(WHOLE, with_care=5))),
        "not measured": notes(found(replace(WHOLE, not_measured=6))),
    } == snapshot


def test_the_sentence_states_what_is_shown_and_how_many_stand_behind_it(snapshot: SnapshotAssertion) -> None:
    none = replace(WHOLE, sessions=0, mean=math.nan, half_interval=math.nan)
    assert {
        "two groups": sentence(found(WHOLE, FEW)),
        "all as one": sentence(found(WHOLE, grouping=Grouping.ALL)),
        "no session": sentence(found(none)),
    } == snapshot


def test_nothing_is_judged_however_far_groups_lie_apart(page: QuestionsPage) -> None:
    page.show_answer(found(WHOLE, replace(WHOLE, group="shoes", mean=20.0)))
    words = shown(page).lower()
    assert [one for one in ("better", "worse", "significant", "normal", "larger", "smaller") if one in words] == []
    assert "groups are not tested for differences" in words


def test_the_chart_and_the_table_have_the_same_groups(page: QuestionsPage) -> None:
    empty = replace(WHOLE, group="none", sessions=0, mean=math.nan, half_interval=math.nan)
    page.show_answer(found(WHOLE, FEW, empty))
    assert [(line.label, line.mean, line.count) for line in page.plot.lines] == [
        ("barefoot", 58.4, "12 sessions"),
        ("shoes", 58.4, "2 sessions"),
    ]
    texts = [[cell.words for cell in row.cells] for row in page.table.cells.rows]
    assert texts == [
        ["barefoot", "12", "24", "58.4", "6.1", "54.5 to 62.3", "9.2", "0"],
        ["shoes", "2", "24", "58.4", "–", "–", "9.2", "0"],
        ["none", "0", "24", "–", "6.1", "–", "9.2", "0"],
    ]
    assert "barefoot: 58.4 °, plus or minus 3.9, 12 sessions" in page.plot.accessibleDescription()


def test_of_many_groups_the_largest_are_drawn_and_the_rest_is_reported(page: QuestionsPage) -> None:
    rows = [replace(WHOLE, group=f"g{k:03d}", sessions=3 + k) for k in range(MOST_ROWS + 20)]
    page.show_answer(found(*rows))
    assert [line.label for line in page.plot.lines] == [row.group for row in rows[-MOST_DRAWN:]]
    assert len(page.table.cells.rows) == MOST_ROWS
    assert "The CSV has all groups" in shown(page)
    page.show_answer(found(WHOLE))
    assert "The CSV has all groups" not in shown(page)


def test_nobody_is_named_on_the_page(page: QuestionsPage, tmp_path: Path) -> None:
    with ParameterTable.opened(write_rows(random_rows(4, 20), tmp_path / "p.parquet")) as table:
        for grouping in Grouping:
            page.show_answer(answer(table, GroupQuestion(MEASURE, grouping)))
            words = shown(page) + page.table.as_text() + str(page.plot.lines)
            assert "session 1" not in words
            assert "patient " not in words


def test_a_narrow_table_leaves_columns_to_the_file() -> None:
    for is_narrow, hidden in ((False, 0), (True, 3)):
        columns, _ = groups_table(found(WHOLE), is_narrow=is_narrow)
        assert sum(column.is_hidden for column in columns) == hidden


def test_what_was_chosen_stays_when_another_table_has_it_too(page: QuestionsPage) -> None:
    page.measure.setCurrentIndex(page.measure.findData("stance_percent"))
    page.grouping.setCurrentIndex(page.grouping.findData("leg"))
    page.show_table("other", [MEASURE, "stance_percent"], (Grouping.AGE, Grouping.LEG))
    assert page.question == GroupQuestion("stance_percent", Grouping.LEG)
    page.show_table("third", [MEASURE], (Grouping.AGE,))
    assert page.question == GroupQuestion(MEASURE, Grouping.AGE)


def test_every_change_of_a_control_asks_again(page: QuestionsPage) -> None:
    received: list[object] = []
    page.question_changed.connect(received.append)
    page.included.choose("care")
    page.simulated.click()
    page.grouping.setCurrentIndex(page.grouping.findData("speed"))
    page.measure.setCurrentIndex(page.measure.findData(MEASURE))
    stance = "stance_percent"
    assert received == [
        GroupQuestion(stance, Grouping.CONDITION, has_care=True),
        GroupQuestion(stance, Grouping.CONDITION, has_care=True, has_simulated=True),
        GroupQuestion(stance, Grouping.SPEED, has_care=True, has_simulated=True),
        GroupQuestion(MEASURE, Grouping.SPEED, has_care=True, has_simulated=True),
    ]


def test_without_a_table_it_is_stated_how_one_comes_to_be(qtbot: QtBot, page: QuestionsPage) -> None:
    assert "gaitwright batch" not in shown(page)
    page.forget_table()
    assert "gaitwright batch" in shown(page)
    assert not any(control.isVisible() for control in (page.measure, page.grouping, page.included, page.simulated))
    with qtbot.waitSignal(page.making_requested):
        page.make_table.click()
    with qtbot.waitSignal(page.table_requested):
        page.first_table.click()


def test_a_group_is_called_what_it_is(snapshot: SnapshotAssertion) -> None:
    groups = {
        Grouping.AGE: ("0", "18", "80", ""),
        Grouping.SPEED: ("0", "0.8", "1.6"),
        Grouping.LEG: ("prosthetic", "other", "neither"),
        Grouping.SIDE: ("left", "both"),
        Grouping.CONDITION: ("left", ""),
    }
    assert {one.name: {group: group_name(one, group) for group in groups[one]} for one in groups} == snapshot


def test_a_parameter_that_nobody_named_keeps_its_own_name_and_unit() -> None:
    words = measure_words("toe_angle_deg")
    assert (words.with_unit, words.decimals) == ("Toe angle, °", 1)


def test_a_dot_lies_at_its_mean_is_hollow_without_interval_and_all_is_inside_the_axis(qtbot: QtBot) -> None:
    plot = GroupPlot()
    qtbot.addWidget(plot)
    lines = [GroupLine("a", 50.0, 5.0, "9 sessions"), GroupLine("b", 70.0, math.nan, "1 session")]
    plot.show_groups(lines, "Knee ROM, °", "Means", "result")
    plot.resize(600, plot.height())
    low, high, step = plot.axis
    assert low <= 45.0
    assert high >= 70.0
    assert (high - low) / step == pytest.approx(round((high - low) / step))
    image = plot.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    is_dark = [
        image.pixelColor(round(plot.x_of(line.mean)), 32 * k + 16).lightness() < 128 for k, line in enumerate(lines)
    ]
    assert is_dark == [True, False]
    assert image.pixelColor(round(plot.x_of(53.0)), 16).lightness() < 128  # the bar
    assert words_cut(plot) == []


@pytest.mark.parametrize("values", [(0.0,), (60.0,), (-3.0, 4.0), (0.98, 0.981), (1e5, 1.2e5)])
def test_any_means_have_an_axis_with_round_ends(qtbot: QtBot, values: tuple[float, ...]) -> None:
    plot = GroupPlot()
    qtbot.addWidget(plot)
    plot.show_groups([GroupLine("a", value, math.nan, "1") for value in values], "", "", "")
    low, high, step = plot.axis
    assert low < high
    assert low <= min(values) <= max(values) <= high
    assert 1 <= (high - low) / step <= 8

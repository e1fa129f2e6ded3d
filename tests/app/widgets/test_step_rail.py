"""The rail: states in words, keys, one stop for Tab, and names where there is no room for them."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import set_scale
from app.theme.icons import Icon
from app.widgets.rail_row import RailForm, RailRow, StepState
from app.widgets.step_rail import StepRail, home_below
from tests.app.room import settle, words_cut

STEPS = (
    RailRow("Patient", "Left prosthetic", StepState.DONE),
    RailRow("Stand still", "skipped, reported", StepState.SKIPPED),
    RailRow("Free motion", "left knee 3.8°", StepState.ATTENTION),
    RailRow("Walking", "Recording walk 3", StepState.CURRENT),
    RailRow("Results"),
)


@pytest.fixture
def window(qtbot: QtBot) -> QWidget:
    window = QWidget()
    qtbot.addWidget(window)
    return window


@pytest.fixture
def rail(window: QWidget) -> StepRail:
    rail = StepRail()
    rail.setParent(window)
    window.resize(500, 800)
    rail.setGeometry(0, 0, 216, 800)
    rail.show_rows(STEPS)
    window.show()
    settle()
    return rail


def test_a_row_states_its_place_name_state_and_what_came_of_it(rail: StepRail) -> None:
    assert [row.accessibleName() for row in rail.rows] == [
        "Step 1 of 5, Patient, done, Left prosthetic",
        "Step 2 of 5, Stand still, skipped, skipped, reported",
        "Step 3 of 5, Free motion, needs checking, left knee 3.8°",
        "Step 4 of 5, Walking, current, Recording walk 3",
        "Step 5 of 5, Results, to do",
    ]


def test_rows_look_different_in_every_state(rail: StepRail) -> None:
    rings = [row.grab(row._ring().toRect()).toImage() for row in rail.rows]
    assert not any(one == other for k, one in enumerate(rings) for other in rings[:k])


def test_a_press_shows_the_step(rail: StepRail, qtbot: QtBot) -> None:
    with qtbot.waitSignal(rail.step_pressed, check_params_cb=lambda number: number == 2):
        QTest.mouseClick(rail.rows[2], Qt.MouseButton.LeftButton)
    with qtbot.waitSignal(rail.below_pressed, check_params_cb=lambda name: name == "settings"):
        QTest.mouseClick(rail.below[1], Qt.MouseButton.LeftButton)


@pytest.mark.parametrize("key", [Qt.Key.Key_Return, Qt.Key.Key_Space])
def test_arrows_go_from_row_to_row_and_enter_or_space_presses_one(rail: StepRail, qtbot: QtBot, key: Qt.Key) -> None:
    rail.focus()
    assert rail.focusWidget() is rail.rows[3]
    QTest.keyClick(rail.rows[3], Qt.Key.Key_Down)
    QTest.keyClick(rail.rows[4], Qt.Key.Key_Down)
    assert rail.below[0].hasFocus()
    QTest.keyClick(rail.below[0], Qt.Key.Key_Home)
    QTest.keyClick(rail.rows[0], Qt.Key.Key_Up)
    assert rail.rows[0].hasFocus()
    with qtbot.waitSignal(rail.step_pressed, check_params_cb=lambda number: number == 0):
        QTest.keyClick(rail.rows[0], key)


def test_tab_stops_once_and_where_it_was_left(rail: StepRail) -> None:
    def stops() -> list[QWidget]:
        return [row for row in (*rail.rows, *rail.below) if row.focusPolicy() & Qt.FocusPolicy.TabFocus]

    assert stops() == [rail.rows[3]]
    rail.rows[1].setFocus()
    assert stops() == [rail.rows[1]]


def test_rows_keep_the_focus_when_they_are_shown_again(rail: StepRail) -> None:
    rail.rows[3].setFocus()
    rail.show_rows(
        (*STEPS[:3], RailRow("Walking", "3 walks", StepState.DONE), RailRow("Results", "", StepState.CURRENT))
    )
    assert rail.rows[3].hasFocus()


def test_the_compact_rail_names_the_row_that_has_the_focus(rail: StepRail) -> None:
    rail.set_form(RailForm.COMPACT)
    settle()
    assert [text.text for row in rail.rows for text in row.painted_texts()] == ["4", "5"]
    rail.rows[4].setFocus()
    assert rail._tag.isVisible()
    assert rail._tag.text() == "Results"
    assert rail._tag.x() >= rail.width()
    rail.rows[4].clearFocus()
    assert not rail._tag.isVisible()


def test_home_has_icons_instead_of_numbers_and_no_line(rail: StepRail) -> None:
    rows = (
        RailRow("Patients", state=StepState.CURRENT, icon=Icon.HOME),
        RailRow("Open demonstration", icon=Icon.PLAY),
        RailRow("Import recordings", icon=Icon.IMPORT),
    )
    rail.show_rows(rows)
    rail.show_below(home_below(can_lock=False), "Everything stays on this computer, encrypted.")
    assert [row.accessibleName() for row in rail.rows] == [
        "Patients, current",
        "Open demonstration",
        "Import recordings",
    ]
    assert len(rail.below) == 3
    settle()
    assert words_cut(rail) == []


def test_a_low_rail_scrolls_to_the_row_that_has_the_focus(rail: StepRail) -> None:
    rail.setGeometry(0, 0, 216, 300)
    settle()
    rail.below[2].setFocus()
    assert not rail.below[2].visibleRegion().isEmpty()


@pytest.mark.parametrize("scale", [0.8, 1.0, 2.0])
@pytest.mark.parametrize("form", list(RailForm))
@pytest.mark.usefixtures("pseudo_language")
def test_longer_words_take_another_line_and_are_not_cut(rail: StepRail, scale: float, form: RailForm) -> None:
    set_scale(scale)
    rail.set_form(form)
    rail.show_rows(tuple(RailRow(f"{row.title} unumgänglich", f"{row.note} und noch mehr", row.state) for row in STEPS))
    rail.setGeometry(0, 0, rail.width(), 1600)
    assert words_cut(rail) == []


def test_an_icon_without_its_word_is_as_large_as_the_ring_of_a_step(rail: StepRail) -> None:
    assert rail.below[-1].icon_box().width() == 20  # beside "Help"
    rail.set_form(RailForm.COMPACT)
    assert all(row.icon_box().width() == 26 for row in rail.below)
    set_scale(2.0)
    assert all(row.icon_box().width() == 52 for row in rail.below)

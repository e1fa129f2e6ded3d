"""The Walking page: none yet, recording, asking, between; by mouse, by keys, and in words for who cannot see it."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import set_scale
from app.widgets.field import Field
from app.wizard.walking.page import WalkingPage
from app.wizard.walking.readout import LiveLane, LiveTrace, PhaseSpan, WalkingReadout
from app.wizard.walking.walk_list import WalkRow, WalkState
from core.body import Joint, Side
from core.gait.phases import Phase
from tests.app.room import words_cut
from tests.app.shared_page import shared

KEPT = WalkRow("1", "A", "Barefoot", WalkState.KEPT, 18)
DISCARDED = WalkRow("2", "B", "Shoes", WalkState.DISCARDED, 17)
ASKING = WalkRow("3", "C", "AFO", WalkState.ASKING, 12)
RECORDING = WalkRow("3", "C", "AFO", WalkState.RECORDING)
RECOVERED = WalkRow("4", "B", "Shoes", WalkState.RECOVERED, 9)
LABELS = ("Barefoot", "Shoes", "AFO")


@pytest.fixture(scope="module")
def one_page(qapp: QApplication) -> Iterator[WalkingPage]:
    """Made once: that takes longer than most tests of it."""
    yield from shared(WalkingPage())


@pytest.fixture
def page(qtbot: QtBot, one_page: WalkingPage) -> Iterator[WalkingPage]:
    """Nothing is walked, and there is room."""
    one_page.resize(1064, 600)
    one_page.show_labels(LABELS, "Shoes")
    with qtbot.waitActive(one_page):
        one_page.show()
        one_page.activateWindow()
    yield one_page
    one_page.set_compact(False)
    one_page.show_walks(())
    one_page.show_message("")
    one_page.show_received([])


def renamed(page: WalkingPage, *rows: WalkRow) -> tuple[QAbstractButton, Field]:
    """Press the pen of the first walk; gives it and the field in its place."""
    page.show_walks(rows)
    edit = page.walks.buttons[0]
    assert isinstance(edit, QAbstractButton)
    edit.click()
    return edit, page.walks.findChildren(Field)[0]


def test_a_kept_walk_is_renamed_where_it_was_made(qtbot: QtBot, page: WalkingPage) -> None:
    edit, field = renamed(page, KEPT, DISCARDED)
    assert edit.accessibleName() == "Rename A Barefoot"
    assert field.isVisible()
    assert not edit.isVisible()
    QTest.keyClicks(field.line_edit, "Own shoes")
    page.show_walks((replace(KEPT, strides=19), DISCARDED))  # counted meanwhile
    assert field.isVisible()
    with qtbot.waitSignal(page.walks.renamed) as signal:
        QTest.keyClick(field.line_edit, Qt.Key.Key_Return)
    assert signal.args == ["1", "Own shoes"]
    page.show_walks((replace(KEPT, label="Own shoes"), DISCARDED))
    assert not field.isVisible()
    assert [one.accessibleName() for one in page.walks.buttons] == ["Rename A Own shoes", "Include B Shoes again"]


@pytest.mark.parametrize("keys", ["Barefoot", " "])
def test_a_name_that_stays_or_is_empty_renames_nothing(qtbot: QtBot, page: WalkingPage, keys: str) -> None:
    _, field = renamed(page, KEPT)
    QTest.keyClicks(field.line_edit, keys)
    with qtbot.assertNotEmitted(page.walks.renamed):
        QTest.keyClick(field.line_edit, Qt.Key.Key_Return)
    assert not field.isVisible()


def test_escape_takes_back_what_was_typed_as_a_name(qtbot: QtBot, page: WalkingPage) -> None:
    """It went to the window, and the words were kept on leaving."""
    at_window = QShortcut(QKeySequence(Qt.Key.Key_Escape), page)
    edit, field = renamed(page, KEPT)
    QTest.keyClicks(field.line_edit, "Own shoes")
    with qtbot.assertNotEmitted(page.walks.renamed), qtbot.assertNotEmitted(at_window.activated):
        QTest.keyClick(field.line_edit, Qt.Key.Key_Escape)
    assert not field.isVisible()
    edit.click()
    assert field.text == "Barefoot"
    at_window.deleteLater()


def test_a_double_click_or_f2_names_a_kept_walk_and_no_other(page: WalkingPage) -> None:
    page.show_walks((KEPT, DISCARDED))
    kept, discarded = (row for row in page.walks.findChildren(QWidget) if hasattr(row, "field"))
    kept_field, discarded_field = page.walks.findChildren(Field)
    QTest.mouseDClick(discarded, Qt.MouseButton.LeftButton)
    assert not discarded_field.isVisible()
    QTest.mouseDClick(kept, Qt.MouseButton.LeftButton)
    assert kept_field.isVisible()
    QTest.keyClick(kept_field.line_edit, Qt.Key.Key_Return)
    assert not kept_field.isVisible()
    QTest.keyClick(page.walks.buttons[0], Qt.Key.Key_F2)
    assert kept_field.isVisible()
    QTest.keyClick(discarded, Qt.Key.Key_F2)
    assert not discarded_field.isVisible()


def live(now_s: float = 5.0, knee_deg: float = 30.4, is_provisional: bool = False) -> WalkingReadout:
    time_s = np.arange(int(now_s * 100)) / 100
    knee = LiveTrace(time_s, np.full(len(time_s), math.radians(knee_deg)))
    ankle = LiveTrace(time_s, np.zeros(len(time_s)), is_provisional)
    lane = LiveLane((PhaseSpan(Phase.SWING, 1.0, None),))
    return WalkingReadout(
        now_s,
        {
            Joint.LEFT_KNEE: knee,
            Joint.RIGHT_KNEE: LiveTrace(time_s, np.full(len(time_s), np.nan)),
            Joint.LEFT_ANKLE: ankle,
        },
        {Side.LEFT: lane},
        {Side.LEFT: 14, Side.RIGHT: 13},
        101.4,
    )


def texts(page: WalkingPage) -> list[str]:
    """What can be read now."""
    labels = [label.text() for label in page.findChildren(QLabel) if label.isVisible()]
    return labels + [button.text() for button in page.findChildren(QAbstractButton) if button.isVisible()]


def test_before_the_first_walk_it_states_what_to_do(page: WalkingPage) -> None:
    assert "Choose a condition, then press Space." in texts(page)
    assert not page.charts.isVisible()
    assert "Next condition: A" in texts(page)


def test_while_a_walk_is_recorded_curves_and_figures_are_all_there_is(page: WalkingPage) -> None:
    page.show_walks((KEPT, RECORDING))
    page.show_view(live())
    assert page.charts.isVisible()
    assert page.notice.isVisible()  # its place is reserved
    assert {"14", "13", "101", "recording"} <= set(texts(page))
    assert not page.next.isVisible()
    assert not page.walks.restrapped.isVisible()


def test_a_message_moves_nothing_while_a_walk_is_recorded(page: WalkingPage) -> None:
    page.show_walks((RECORDING,))
    QApplication.processEvents()
    before = page.charts.geometry()
    page.show_message("R foot: no signal for 2 s", "Recording continues.")
    QApplication.processEvents()
    assert page.charts.geometry() == before
    assert "R foot: no signal for 2 s" in texts(page)
    page.show_message("")
    assert "R foot: no signal for 2 s" not in texts(page)


def test_a_stopped_walk_is_kept_or_discarded(page: WalkingPage, qtbot: QtBot) -> None:
    page.show_walks((KEPT, ASKING), "L 12, R 11 strides")
    assert {"Include 12 strides", "Exclude", "L 12, R 11 strides", "include or exclude?"} <= set(texts(page))
    with qtbot.waitSignal(page.keep_pressed) as kept:
        page.stopped.keep.click()
    assert kept.args == ["3"]
    with qtbot.waitSignal(page.discard_pressed) as discarded:
        page.stopped.discard.click()
    assert discarded.args == ["3"]
    page.show_walks((KEPT, DISCARDED))
    assert not page.stopped.isVisible()


def test_what_was_discarded_can_come_back(page: WalkingPage, qtbot: QtBot) -> None:
    page.show_walks((KEPT, DISCARDED))
    (undo,) = [one for one in page.walks.buttons if one.accessibleName().startswith("Include")]
    assert undo.accessibleName() == "Include B Shoes again"
    with qtbot.waitSignal(page.walks.undo_pressed) as undone:
        QTest.keyClick(undo, Qt.Key.Key_Return)
    assert undone.args == ["2"]


def test_a_recovered_walk_asks_as_a_stopped_one_does(page: WalkingPage) -> None:
    page.show_walks((KEPT, RECOVERED))
    assert {"recovered, needs review", "B  Shoes: recovered", "Include 9 strides"} <= set(texts(page))
    page.show_walks((KEPT, RECOVERED, ASKING))
    assert "C  AFO: stopped" in texts(page)  # the newest question first


def test_keys_choose_the_label_with_their_digit(page: WalkingPage, qtbot: QtBot) -> None:
    with qtbot.waitSignal(page.label_chosen) as chosen:
        assert page.choose_digit(3)
    assert chosen.args == ["AFO"]
    assert page.next.chooser.choice == "AFO"
    assert not page.choose_digit(4)
    page.show_walks((RECORDING,))
    assert not page.choose_digit(1)


def test_arrows_go_from_label_to_label(page: WalkingPage) -> None:
    (first,) = (one for one in page.next.chooser.buttons if one.focusPolicy() is Qt.FocusPolicy.TabFocus)
    assert (first.text(), first.isChecked()) == ("Shoes", True)
    first.setFocus()
    QTest.keyClick(first, Qt.Key.Key_Right)
    assert page.next.chooser.choice == "AFO"
    second = QApplication.focusWidget()
    assert second is not None
    QTest.keyClick(second, Qt.Key.Key_Right)
    assert page.next.chooser.choice == "Barefoot"


def test_the_focus_lies_on_no_button_so_that_space_starts_and_stops(page: WalkingPage) -> None:
    page.focus()
    assert QApplication.focusWidget() is page.empty
    QTest.mouseClick(page.next.chooser.buttons[0], Qt.MouseButton.LeftButton)
    assert QApplication.focusWidget() is page.empty
    page.show_walks((RECORDING,))
    assert QApplication.focusWidget() is page.charts
    page.show_walks((ASKING,))
    page.stopped.keep.setFocus()
    page.show_walks((replace(ASKING, state=WalkState.KEPT),))
    assert QApplication.focusWidget() is page.charts


def test_other_words_are_a_label_too(page: WalkingPage, qtbot: QtBot) -> None:
    field = page.next.chooser.own.line_edit
    field.setFocus()
    QTest.keyClicks(field, "new foot")
    with qtbot.waitSignal(page.label_chosen) as chosen:
        QTest.keyClick(field, Qt.Key.Key_Return)
    assert chosen.args == ["new foot"]
    assert not any(button.isChecked() for button in page.next.chooser.buttons)
    page.show_labels(LABELS, "new foot")
    assert page.next.chooser.own.text == "new foot"
    page.choose_digit(1)
    assert page.next.chooser.own.text == ""


def letters(page: WalkingPage, rows: tuple[WalkRow, ...], *digits: int) -> list[str]:
    """Of the next walk: with its own label, and with that of each digit."""
    page.show_labels(LABELS, "Shoes")
    page.show_walks(rows)
    found = []
    for digit in (None, *digits):
        assert digit is None or page.choose_digit(digit)
        (stated,) = [text for text in texts(page) if text.startswith("Next condition: ")]
        found.append(stated.removeprefix("Next condition: "))
    return found


def test_a_condition_keeps_its_letter_unless_sensors_were_strapped_again(page: WalkingPage) -> None:
    assert letters(page, (KEPT, DISCARDED), 3, 1) == ["B", "C", "A"]
    second, gone = replace(KEPT, id="5", letter="A2"), replace(DISCARDED, id="6", letter="", label="Barefoot")
    assert letters(page, (KEPT, second, gone), 1) == ["B", "A"]
    names = ["Rename A Barefoot", "Rename A2 Barefoot", "Include Barefoot again"]
    assert [one.accessibleName() for one in page.walks.buttons] == names
    assert letters(page, (replace(KEPT, is_of_old_straps=True),), 1)[-1] == "B"


def test_sensors_strapped_again_are_reported_with_the_consequence(page: WalkingPage, qtbot: QtBot) -> None:
    page.show_walks((KEPT,))
    assert "Standing still and free motion must then be repeated." in page.walks.restrapped.accessibleDescription()
    with qtbot.waitSignal(page.walks.restrapped.clicked):
        QTest.keyClick(page.walks.restrapped, Qt.Key.Key_Return)


def test_charts_are_reported_in_words(page: WalkingPage) -> None:
    page.show_walks((RECORDING,))
    page.show_view(live(50.0))
    assert page.charts.accessibleDescription() == (
        "14 strides. Left 14. Right 13. Cadence 101 steps per minute. Left knee 30°. Right knee missing. Left ankle 0°."
    )
    page.show_view(live(50.5, knee_deg=50.0))
    assert "Left knee 30°" in page.charts.accessibleDescription()  # once a second is enough to listen to
    page.show_view(live(51.1, knee_deg=50.0))
    assert "Left knee 50°" in page.charts.accessibleDescription()


def test_a_provisional_ankle_is_stated(page: WalkingPage) -> None:
    page.show_walks((RECORDING,))
    page.show_view(live(is_provisional=True))
    assert "L provisional until five strides" in texts(page)
    page.show_view(live(5.1))
    assert "L provisional until five strides" not in texts(page)


def test_rows_are_read_with_their_state(page: WalkingPage) -> None:
    page.show_walks((KEPT, DISCARDED, RECORDING))
    names = [row.accessibleName() for row in page.walks.findChildren(QWidget) if hasattr(row, "field")]
    assert names == ["A, Barefoot, 18 strides, included", "B, Shoes, excluded", "C, AFO, recording"]


@pytest.mark.parametrize("is_compact", [False, True])
def test_simulated_is_stated_over_knee_ankle_and_phases(page: WalkingPage, is_compact: bool) -> None:
    page.show_walks((RECORDING,))
    page.set_compact(is_compact)
    page.set_simulated(True)
    assert texts(page).count("SIMULATED") == 3
    page.set_simulated(False)
    assert "SIMULATED" not in texts(page)


def test_in_little_room_curves_and_walks_are_two_tabs(page: WalkingPage) -> None:
    page.set_compact(True)
    page.resize(896, 428)
    page.show_walks((KEPT, RECORDING))
    assert page.charts.isVisible()
    assert page.figures.isVisible()
    assert not page.walks.isVisible()
    page.show_walks((KEPT, ASKING))
    assert not page.charts.isVisible()
    assert page.stopped.isVisible()
    page.tabs.choose("curves")
    assert page.charts.isVisible()
    assert not page.walks.isVisible()


ROOMS = [(0.8, 850, 480, False), (1.0, 1064, 600, False), (1.0, 736, 388, True), (2.0, 1128, 456, True)]


@pytest.mark.usefixtures("pseudo_language")
@pytest.mark.parametrize(("scale", "width", "height", "is_compact"), ROOMS)
def test_no_word_is_cut_in_a_language_as_long_as_german(
    qtbot: QtBot, scale: float, width: int, height: int, is_compact: bool
) -> None:
    page = WalkingPage()
    qtbot.addWidget(page)
    page.show()
    set_scale(scale)
    page.set_compact(is_compact)
    page.resize(width, height)
    page.show_labels((*LABELS, "Alignment A"), "a knee with more friction")
    page.set_simulated(True)
    for rows in ((), (KEPT, RECORDING), (KEPT, DISCARDED, ASKING)):
        page.show_walks(rows, "L 12, R 11 strides · 101 steps/min · 0:24")
        page.show_view(live(is_provisional=True))
        page.show_message("")
        assert words_cut(page) == []
        for area in page.findChildren(QScrollArea):  # nothing lies beside what is in sight
            inside = area.widget()
            if area.isVisible() and inside is not None:
                assert inside.width() <= area.viewport().width()
        page.show_message("R foot: no signal for 2 s.", "Recording goes on. Right ankle and phases are missing.")
        assert words_cut(page) == []


@pytest.fixture
def in_window(qtbot: QtBot) -> tuple[QWidget, WalkingPage]:
    """In a window above a button, which Space would press and which would have the focus next."""
    window, page = QWidget(), WalkingPage()
    column = QVBoxLayout(window)
    column.addWidget(page)
    column.addWidget(QPushButton("Back"))
    qtbot.addWidget(window)
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()
    return window, page


def test_a_walk_stopped_in_a_small_window_leaves_the_focus_on_no_button(in_window: tuple[QWidget, WalkingPage]) -> None:
    _, page = in_window
    page.set_compact(True)
    page.show_labels(LABELS, "Shoes")
    page.show_walks((RECORDING,))
    page.focus()
    assert QApplication.focusWidget() is page.charts
    page.show_walks((ASKING,))
    assert QApplication.focusWidget() is page.walks
    page.show_walks((KEPT,))
    assert QApplication.focusWidget() is page.walks
    page.show_walks((KEPT, RECORDING))
    assert not isinstance(QApplication.focusWidget(), QAbstractButton)


def test_a_walk_that_does_not_begin_leaves_the_focus_where_space_starts_it(
    qtbot: QtBot, in_window: tuple[QWidget, WalkingPage]
) -> None:
    _, page = in_window
    page.show_walks((RECORDING,))
    page.focus()
    qtbot.waitUntil(page.charts.hasFocus)
    page.show_walks(())
    assert page.empty.hasFocus()


def test_what_other_programs_receive_is_stated_while_it_is_on(page: WalkingPage) -> None:
    page.show_walks((RECORDING,))
    assert not page.output.isVisible()
    page.show_output("Live output is on: LSL.")
    assert page.output.isVisible()
    assert page.output.text() == "Live output is on: LSL."
    page.show_output("")
    assert not page.output.isVisible()

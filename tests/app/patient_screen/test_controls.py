"""The operator's controls: a target is typed and never proposed, what is gated cannot be chosen, all by keys."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.patient_screen.controls import Choice, ControlsCard, choices
from core.body import Side
from core.targets import Target, TargetMeasure
from tests.app.room import words_cut


@pytest.fixture
def card(qtbot: QtBot) -> ControlsCard:
    card = ControlsCard()
    qtbot.addWidget(card)
    card.resize(1016, 160)
    card.show()
    return card


def typed(card: ControlsCard, text: str) -> None:
    card.target.line_edit.clear()
    QTest.keyClicks(card.target.line_edit, text)
    QTest.keyClick(card.target.line_edit, Qt.Key.Key_Return)


def test_a_target_is_what_was_typed_for_a_measure_of_a_leg(qtbot: QtBot, card: ControlsCard) -> None:
    assert card.target.text == ""
    with qtbot.waitSignal(card.target_set) as reported:
        typed(card, "55")
    assert reported.args == [Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55)]
    with qtbot.waitSignal(card.target_set) as reported:
        card.side.choose(Side.RIGHT)
    assert reported.args == [Target(TargetMeasure.KNEE_SWING_PEAK, Side.RIGHT, 55)]  # it stays as the side changes
    assert card.target.text == "55"
    card.measure.choose(TargetMeasure.CADENCE)
    assert not card.side.isVisible()
    with qtbot.waitSignal(card.target_set) as reported:
        typed(card, "110")
    assert reported.args == [Target(TargetMeasure.CADENCE, None, 110)]
    card.measure.choose(TargetMeasure.KNEE_SWING_PEAK)
    with qtbot.waitSignal(card.target_set) as reported:
        card.side.choose(Side.LEFT)
    assert reported.args == [Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55)]


def test_enter_in_a_field_sets_what_is_typed_and_is_for_no_other(qtbot: QtBot, card: ControlsCard) -> None:
    received: list[int] = []

    class Page(QWidget):
        def keyPressEvent(self, event: QKeyEvent) -> None:
            received.append(event.key())

    page = Page()
    qtbot.addWidget(page)
    card.setParent(page)
    page.show()
    for field in (card.target, card.rate):
        field.line_edit.setFocus()
        QTest.keyClicks(field.line_edit, "55")
        QTest.keyClick(field.line_edit, Qt.Key.Key_Return)
    assert received == []
    card.measure.segments[0].setFocus()
    QTest.keyClick(card.measure.segments[0], Qt.Key.Key_Return)
    assert received == [Qt.Key.Key_Return]  # a choice has no use for it
    card.setParent(None)


@pytest.mark.usefixtures("pseudo_language")
@pytest.mark.parametrize("width", [640, 1016])
def test_no_word_of_the_card_is_cut_when_what_is_typed_is_wrong(qtbot: QtBot, width: int) -> None:
    card = ControlsCard()
    qtbot.addWidget(card)
    card.show()
    card.resize(width, card.sizeHint().height())
    typed(card, "555")
    card.resize(card.width(), card.sizeHint().height())
    assert words_cut(card) == []
    typed(card, "")
    card.tick.click()
    card.resize(card.width(), card.sizeHint().height())
    assert words_cut(card) == []


def test_a_figure_that_makes_no_sense_sets_no_target(qtbot: QtBot, card: ControlsCard) -> None:
    with qtbot.waitSignal(card.target_set) as reported:
        typed(card, "555")
    assert reported.args == [None]
    assert card.target.is_wrong


def test_what_is_gated_cannot_be_chosen_and_states_why(qtbot: QtBot, card: ControlsCard) -> None:
    typed(card, "55")
    why = "There is no standing reference, so absolute angles are not reported."
    with qtbot.waitSignal(card.target_set) as reported:
        card.show_reasons({(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT): why})
    assert card.side.choice == Side.RIGHT  # which is not gated
    assert reported.args == [None]
    left, _right = card.side.segments
    assert not left.isEnabled()
    both: dict[Choice, str] = {(TargetMeasure.KNEE_SWING_PEAK, side): why for side in Side}
    card.show_reasons(both)
    knee, foot, *_ = card.measure.segments
    assert not knee.isEnabled()
    assert foot.isChecked()
    assert card.reason == ""
    card.show_reasons({})
    assert knee.isEnabled()
    assert left.isEnabled()


def test_where_nothing_can_be_a_target_the_reason_is_there(card: ControlsCard) -> None:
    card.show_reasons(dict.fromkeys(choices(), "There is no foot sensor."))
    assert card.reason == "There is no foot sensor."
    assert not card.target.isEnabled()
    card.show_reasons({})
    assert card.reason == ""
    assert card.target.isEnabled()


def test_the_metronome_is_started_with_the_typed_rate_and_stopped(qtbot: QtBot, card: ControlsCard) -> None:
    with qtbot.assertNotEmitted(card.metronome_pressed):
        card.tick.click()
    assert card.rate.is_wrong
    QTest.keyClicks(card.rate.line_edit, "96")
    with qtbot.waitSignal(card.metronome_pressed) as reported:
        QTest.keyClick(card.tick, Qt.Key.Key_Space)
    assert reported.args == [96]
    card.show_metronome(96)
    assert card.tick.text() == "Stop metronome"
    with qtbot.waitSignal(card.metronome_pressed) as reported:
        card.tick.click()
    assert reported.args == [0]

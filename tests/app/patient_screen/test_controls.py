"""The operator's controls: a target is typed and never proposed, what is gated cannot be chosen, all by keys."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.patient_screen.controls import Choice, ControlsCard, choices
from app.widgets.notice import Notice
from app.widgets.text import Text
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


@pytest.fixture
def targets(card: ControlsCard) -> list[Target | None]:
    """Each target that was set, none where one was taken back."""
    received: list[Target | None] = []
    card.target_set.connect(received.append)
    return received


@pytest.fixture
def rates(card: ControlsCard) -> list[int]:
    """At which the metronome was started; 0 where it was stopped."""
    received: list[int] = []
    card.metronome_pressed.connect(received.append)
    return received


def typed(card: ControlsCard, text: str) -> None:
    card.target.line_edit.clear()
    QTest.keyClicks(card.target.line_edit, text)
    QTest.keyClick(card.target.line_edit, Qt.Key.Key_Return)


def test_a_target_is_what_was_typed_for_a_measure_of_a_leg(card: ControlsCard, targets: list[Target | None]) -> None:
    assert card.target.text == ""
    typed(card, "55")
    card.side.choose(Side.RIGHT)
    assert card.target.text == "55"  # it stays as the side changes
    card.measure.choose(TargetMeasure.CADENCE)
    assert not card.side.isVisible()
    typed(card, "110")
    card.measure.choose(TargetMeasure.KNEE_SWING_PEAK)
    card.side.choose(Side.LEFT)
    knee, cadence = TargetMeasure.KNEE_SWING_PEAK, TargetMeasure.CADENCE
    required = [Target(knee, Side.LEFT, 55), Target(knee, Side.RIGHT, 55), Target(cadence, None, 110)]
    assert [one for one in targets if one is not None] == [*required, required[1], required[0]]


def test_enter_sets_what_is_typed_goes_from_a_choice_to_it_and_is_for_no_other(
    qtbot: QtBot, card: ControlsCard
) -> None:
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
    for choice in (card.measure.segments[0], card.side.segments[1]):
        choice.setFocus()
        QTest.keyClick(choice, Qt.Key.Key_Return)
        assert page.focusWidget() is card.target.line_edit
        assert card.target.line_edit.selectedText() == "55"  # typing takes its place
    assert received == []
    QTest.keyClick(card.target.line_edit, Qt.Key.Key_F7)
    assert received == [Qt.Key.Key_F7]
    card.setParent(None)


def test_all_of_it_is_reached_and_changed_by_keys_alone(
    qtbot: QtBot, card: ControlsCard, targets: list[Target | None], rates: list[int]
) -> None:
    card.focus()

    def press(key: Qt.Key) -> None:
        QTest.keyClick(card.focusWidget(), key)

    seen = []
    for _ in card.controls:
        seen.append(card.focusWidget())
        press(Qt.Key.Key_Tab)
    chosen = [one for one in card.controls if one not in (*card.measure.segments[1:], *card.side.segments[1:])]
    assert seen[: len(chosen)] == chosen  # arrows go on from the choice that has it
    card.focus()
    press(Qt.Key.Key_Right)
    press(Qt.Key.Key_Tab)
    press(Qt.Key.Key_Right)
    press(Qt.Key.Key_Return)
    QTest.keyClicks(card.focusWidget(), "12")
    press(Qt.Key.Key_Return)
    assert targets[-1] == Target(TargetMeasure.FOOT_STRIKE, Side.RIGHT, 12)
    press(Qt.Key.Key_Tab)
    with qtbot.waitSignal(card.tone_set) as tone:
        press(Qt.Key.Key_Space)
    assert tone.args == [False]
    press(Qt.Key.Key_Tab)
    QTest.keyClicks(card.focusWidget(), "96")
    press(Qt.Key.Key_Return)
    assert rates == [96]


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


def test_a_figure_that_makes_no_sense_sets_no_target(card: ControlsCard, targets: list[Target | None]) -> None:
    typed(card, "555")
    assert targets == [None]
    assert card.target.is_wrong


def test_what_is_gated_cannot_be_chosen_and_states_why(card: ControlsCard, targets: list[Target | None]) -> None:
    typed(card, "55")
    why = "There is no standing reference, so absolute angles are not reported."
    card.show_reasons({(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT): why})
    assert card.side.choice == Side.RIGHT  # which is not gated
    assert targets[-1] is None
    left, _right = card.side.segments
    assert not left.isEnabled()
    assert words_of(card) == [f"Knee in swing, left cannot be a target: {why}"]
    both: dict[Choice, str] = {(TargetMeasure.KNEE_SWING_PEAK, side): why for side in Side}
    card.show_reasons(both)
    knee, foot, *_ = card.measure.segments
    assert not knee.isEnabled()
    assert foot.isChecked()
    assert card.reason == ""
    assert words_of(card) == [f"Knee in swing cannot be a target: {why}"]
    card.show_reasons({})
    assert knee.isEnabled()
    assert left.isEnabled()
    assert words_of(card) == []


def words_of(card: ControlsCard) -> list[str]:
    """The lines that state what cannot be a target."""
    lines = [one.text() for one in card.findChildren(Text) if one.isVisible() and "cannot be a target" in one.text()]
    return [line for text in lines for line in text.splitlines()]


def test_what_was_chosen_by_hand_comes_back_once_it_is_possible(qtbot: QtBot, card: ControlsCard) -> None:
    why: dict[Choice, str] = {(TargetMeasure.KNEE_SWING_PEAK, side): "No free motion." for side in Side}
    card.show_reasons(why)
    assert card.choice == (TargetMeasure.FOOT_STRIKE, Side.LEFT)
    card.show_reasons({})  # as soon as the free motion is evaluated
    assert card.choice == (TargetMeasure.KNEE_SWING_PEAK, Side.LEFT)
    card.side.choose(Side.RIGHT)
    card.show_reasons({(TargetMeasure.KNEE_SWING_PEAK, Side.RIGHT): "No signal."})
    assert card.choice == (TargetMeasure.KNEE_SWING_PEAK, Side.LEFT)
    card.show_reasons({})
    assert card.choice == (TargetMeasure.KNEE_SWING_PEAK, Side.RIGHT)
    card.show_reasons(why)
    typed(card, "10")  # a target of the foot, by hand
    card.show_reasons({})
    assert card.choice == (TargetMeasure.FOOT_STRIKE, Side.RIGHT)


def test_where_nothing_can_be_a_target_the_reason_is_there(card: ControlsCard) -> None:
    card.show_reasons(dict.fromkeys(choices(), "There is no foot sensor."))
    assert card.reason == "There is no foot sensor."
    assert words_of(card) == [
        "Knee in swing; Foot at contact; Stance symmetry; Cadence cannot be a target: There is no foot sensor."
    ]
    assert not card.target.isEnabled()
    card.show_reasons({})
    assert card.reason == ""
    assert card.target.isEnabled()


def test_what_is_typed_out_of_range_is_stated_in_the_place_of_the_status(card: ControlsCard) -> None:
    def shown() -> set[str]:
        return {one.text for one in card.findChildren(Notice) if one.isVisible()}

    card.show_status("No target yet.", "Type one and press Enter.")
    assert shown() == {"No target yet. Type one and press Enter."}
    typed(card, "555")
    assert shown() == {"Enter a whole number from 5 to 100°."}
    typed(card, "55")
    assert shown() == {"No target yet. Type one and press Enter."}


def test_the_metronome_is_started_with_the_typed_rate_and_stopped(card: ControlsCard, rates: list[int]) -> None:
    card.tick.click()
    assert card.rate.is_wrong
    assert rates == []
    QTest.keyClicks(card.rate.line_edit, "96")
    QTest.keyClick(card.tick, Qt.Key.Key_Space)
    assert rates == [96]
    card.show_metronome(96)
    assert card.tick.text() == "Stop metronome"
    card.tick.click()
    card.show_metronome(0)
    typed_rate(card, "100", Qt.Key.Key_Tab)  # who only passes by starts nothing
    assert rates == [96, 0]
    typed_rate(card, "100", Qt.Key.Key_Return)
    assert rates == [96, 0, 100]
    card.show_metronome(100)
    enter, tab = Qt.Key.Key_Return, Qt.Key.Key_Tab
    for text, key, rate in (("110", enter, 110), ("110", tab, 110), ("", enter, 0)):
        rates.clear()
        typed_rate(card, text, key)
        assert set(rates) == {rate}


def typed_rate(card: ControlsCard, text: str, key: Qt.Key) -> None:
    card.rate.line_edit.setFocus()
    card.rate.line_edit.selectAll()
    QTest.keyClick(card.rate.line_edit, Qt.Key.Key_Delete)
    QTest.keyClicks(card.rate.line_edit, text)
    QTest.keyClick(card.rate.line_edit, key)

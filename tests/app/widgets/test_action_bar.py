"""The action bar: what is filled, what is reported, the inverse bar, and focus that is never lost."""

import gc
import weakref
from dataclasses import replace
from functools import partial

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.theme.colours import LIGHT
from app.theme.icons import Icon
from app.widgets.action_bar import ActionBar, BarAction, BarState, RecordingNote
from tests.app.idle_action import idle
from tests.app.room import settle, words_cut

STOP = idle("Stop walk", "Space", Icon.STOP)


def recording(elapsed_s: float = 0.0, has_sound: bool = True) -> BarState:
    return BarState(STOP, recording=RecordingNote("Recording walk 3", "Saved continuously.", elapsed_s, has_sound))


@pytest.fixture
def bar(qtbot: QtBot) -> ActionBar:
    bar = ActionBar()
    qtbot.addWidget(bar)
    bar.resize(1064, 72)
    bar.show()
    return bar


def ground(bar: ActionBar) -> QColor:
    return bar.grab().toImage().pixelColor(4, bar.height() // 2)


def test_a_verb_is_filled_only_if_pressing_it_is_requested(bar: ActionBar) -> None:
    bar.show_state(BarState(idle("Continue to walking", "Enter")))
    assert bar.primary.is_filled
    bar.show_state(BarState(idle("Stop early", "Space", is_requested=False)))
    assert not bar.primary.is_filled


def test_each_verb_shows_that_it_was_pressed(bar: ActionBar, qtbot: QtBot) -> None:
    quiet = (idle("Repeat one leg"), idle("Swap"))
    bar.show_state(BarState(idle("Go on"), others=(idle("Keep"), idle("Discard")), quiet=quiet))
    reported: list[str] = []
    bar.back_pressed.connect(lambda: reported.append("Back"))
    bar.pressed.connect(lambda action: reported.append(action.text))
    for button in (bar.back, *bar.quiet, *bar.others, bar.primary):
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    assert reported == ["Back", "Repeat one leg", "Swap", "Keep", "Discard", "Go on"]


def test_a_button_does_what_it_states_also_where_the_words_stay_and_the_deed_does_not(bar: ActionBar) -> None:
    done: list[str] = []
    bar.pressed.connect(lambda action: action.run())
    for deed in ("left", "right"):
        bar.show_state(BarState(BarAction("Repeat one leg", partial(done.append, deed))))
        bar.primary.click()
    assert done == ["left", "right"]
    kept = weakref.ref(bar.primary.verb.run)
    bar.show_state(BarState())
    gc.collect()
    assert kept() is None, "whoever is gone is not held by a button that nobody sees"


def test_words_of_a_screen_reader_follow_the_verb(bar: ActionBar) -> None:
    bar.show_state(BarState(idle("Include 18 strides", "K")))
    assert bar.primary.accessibleName() == "Include 18 strides"
    assert bar.primary.accessibleDescription() == "Key K"
    bar.show_state(BarState(idle("Write report")))
    assert bar.primary.accessibleName() == "Write report"
    assert bar.primary.accessibleDescription() == ""


def test_a_verb_that_is_off_cannot_be_pressed(bar: ActionBar) -> None:
    reported: list[BarAction] = []
    bar.pressed.connect(reported.append)
    bar.show_state(BarState(replace(idle("Stand still"), is_enabled=False), note="Two sensors are still to be placed."))
    QTest.mouseClick(bar.primary, Qt.MouseButton.LeftButton)
    assert reported == []


def test_the_bar_is_inverse_while_recording_and_at_no_other_time(bar: ActionBar) -> None:
    reported: list[bool] = []
    bar.recording_changed.connect(reported.append)
    bar.show_state(BarState(idle("Start walk")))
    assert ground(bar) == QColor(LIGHT.surface)
    bar.show_state(recording())
    assert ground(bar) == QColor(LIGHT.inv)
    assert bar.back.isHidden()
    bar.show_state(BarState(idle("Start walk")))
    assert ground(bar) == QColor(LIGHT.surface)
    assert reported == [True, False]


def test_the_time_goes_on_without_anything_else_being_painted(bar: ActionBar) -> None:
    bar.show_state(recording(17.2))
    before = bar.primary.geometry()
    bar.show_state(recording(18.0))
    clock = bar.findChildren(type(bar._clock))[0]
    assert [text.text for text in clock.painted_texts()] == ["00:18"]
    assert bar.primary.geometry() == before


def test_the_bell_shows_whether_it_is_on(bar: ActionBar, qtbot: QtBot) -> None:
    bar.show_state(recording())
    assert bar.sound.text() == "Sound on"
    with qtbot.waitSignal(bar.sound_pressed):
        bar.sound.click()
    bar.show_state(recording(has_sound=False))
    assert bar.sound.text() == "Sound off"


def test_without_back_the_first_quiet_verb_is_in_its_place(bar: ActionBar) -> None:
    bar.show_state(BarState(idle("Go on"), quiet=(idle("New patient"),)))
    back = bar.back.x()
    bar.show_state(BarState(idle("Go on"), quiet=(idle("New patient"),), has_back=False))
    assert bar.quiet[0].x() == back


def test_the_focus_goes_to_the_primary_verb_where_its_button_goes(bar: ActionBar) -> None:
    bar.show_state(BarState(idle("Keep"), others=(idle("Discard"),)))
    bar.others[0].setFocus()
    bar.show_state(BarState(idle("Start walk")))
    assert bar.focusWidget() is bar.primary


def test_a_button_keeps_the_focus_when_its_word_is_another(bar: ActionBar) -> None:
    bar.show_state(BarState(idle("Start walk", "Space")))
    bar.primary.setFocus()
    bar.show_state(recording())
    assert bar.focusWidget() is bar.primary


@pytest.mark.parametrize("width", [1064, 896, 736, 368])
@pytest.mark.parametrize("note", ["", "If you stop now, angles are unreliable for the left knee."])
def test_nothing_is_cut_and_nothing_overlaps(bar: ActionBar, width: int, note: str) -> None:
    state = BarState(idle("Reconnect R foot", "Enter"), (idle("Go on without"),), (idle("Repeat one leg"),), note)
    bar.show_state(state)
    bar.resize(width, bar.height())
    settle()
    assert words_cut(bar) == []
    boxes = [button.geometry() for button in bar.tab_order]
    boxes += [text.geometry() for text in (bar._title, bar._note) if text.text()]
    assert not any(one.intersects(other) for k, one in enumerate(boxes) for other in boxes[:k])


def test_a_double_click_is_one_press(bar: ActionBar) -> None:
    bar.show_state(BarState(idle("Start walk", "Space", Icon.PLAY)))
    pressed: list[BarAction] = []
    bar.pressed.connect(pressed.append)
    QTest.mouseClick(bar.primary, Qt.MouseButton.LeftButton)
    QTest.mouseDClick(bar.primary, Qt.MouseButton.LeftButton)  # as the second of the two arrives
    assert len(pressed) == 1

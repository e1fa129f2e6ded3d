"""A key that the bar shows is the bar's, whatever has the focus: at every step, with every widget that can have it."""

from functools import partial

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QPlainTextEdit,
    QTextEdit,
    QWidget,
)
from pytestqt.qtbot import QtBot

from app.storage.exchange import import_session
from app.widgets.action_bar import BarAction, BarState
from app.wizard import wizard as wizard_module
from app.wizard.step import StepId
from app.wizard.walking.step import WalkingStep
from app.wizard.wizard import Wizard
from app.workers.library_controller import LibraryController
from core.session import Session
from tests.app.wizard.present import present

TEXTS = {"Enter": "Go on", "Space": "Record again", "L": "Repeat left", "R": "Repeat right", "X": "Exclude"}
KEYS = {"Enter": Qt.Key.Key_Return, "Space": Qt.Key.Key_Space, "L": Qt.Key.Key_L, "R": Qt.Key.Key_R, "X": Qt.Key.Key_X}


def watched(wizard: Wizard, number: StepId, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Show every key on the bar of a step, and write down what of the bar is pressed instead of doing it."""
    pressed: list[str] = []
    step = wizard.steps[number]
    monkeypatch.setattr(wizard_module, "DEAF_S", 0.0)
    primary, other, *quiet = (BarAction(text, partial(pressed.append, text), key) for key, text in TEXTS.items())
    monkeypatch.setattr(step, "bar", lambda: BarState(primary, (other,), tuple(quiet)))
    monkeypatch.setattr(step, "on_intent", lambda _intent: False)
    step.changed.emit()
    return pressed


def focusable(wizard: Wizard) -> list[QWidget]:
    QApplication.processEvents()
    return [
        one
        for one in wizard.findChildren(QWidget)
        if one.isVisible()
        and one.isEnabled()
        and one.focusPolicy() is not Qt.FocusPolicy.NoFocus
        and one.focusProxy() is None
        and one.window() is wizard
    ]


def writes(widget: QWidget, key: str) -> bool:
    """Whether the widget writes what this key types."""
    if isinstance(widget, (QPlainTextEdit, QTextEdit)):
        return not widget.isReadOnly()
    if isinstance(widget, QComboBox):
        return widget.isEditable() and key != "Enter"
    if not isinstance(widget, (QLineEdit, QAbstractSpinBox)) or widget.isReadOnly() or key == "Enter":
        return False
    hints = widget.inputMethodHints()
    is_figures = isinstance(widget, QAbstractSpinBox) or bool(
        hints & (Qt.InputMethodHint.ImhFormattedNumbersOnly | Qt.InputMethodHint.ImhDigitsOnly)
    )
    return not (key == "Space" and is_figures)


def misses(wizard: Wizard, pressed: list[str]) -> list[str]:
    """Press each key on each widget, and give where something else was done than the bar states."""
    wrong: list[str] = []
    for widget in focusable(wizard):
        is_elsewhere = not wizard.shell.bar.isAncestorOf(widget)
        wrong += presses(widget, pressed, is_elsewhere)
    return wrong


def presses(widget: QWidget, pressed: list[str], is_elsewhere: bool) -> list[str]:
    wrong: list[str] = []
    done: list[None] = []

    def note() -> None:
        done.append(None)

    if isinstance(widget, QAbstractButton) and is_elsewhere:
        widget.clicked.connect(note)
    for key, does in TEXTS.items():
        widget.setFocus()
        if QApplication.focusWidget() is widget:  # else another of its field has it
            pressed.clear()
            QTest.keyClick(widget, KEYS[key])
            if pressed != ([] if writes(widget, key) else [does]) or done:
                wrong.append(f"{key} on {type(widget).__name__} {widget.accessibleName()!r}: {pressed}")
            done.clear()
    if isinstance(widget, QAbstractButton) and is_elsewhere:
        widget.clicked.disconnect(note)
    return wrong


@pytest.mark.parametrize("number", list(StepId))
def test_a_key_on_the_bar_presses_the_bar_whatever_has_the_focus(
    wizard: Wizard, monkeypatch: pytest.MonkeyPatch, number: StepId
) -> None:
    wizard.begin(None)
    monkeypatch.setattr(type(wizard.steps[number]), "cannot_enter", "")
    wizard.go_to(number)
    pressed = watched(wizard, number, monkeypatch)
    assert len(focusable(wizard)) > len(TEXTS) + 1
    assert misses(wizard, pressed) == []


@pytest.mark.endurance
def test_it_does_so_on_pages_that_are_full_of_results(
    qtbot: QtBot,
    wizard: Wizard,
    controller: LibraryController,
    simulated_session: Session,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    opened = present(controller.state).library
    import_session(opened, simulated_session, lambda _share, _what: None, "DEMO-1")
    wizard.show_session(opened.library.sessions.list()[0].id)
    visit = present(wizard.visit)
    qtbot.waitUntil(lambda: wizard.step_id is StepId.RESULTS and not visit.evaluation.is_busy)
    for number in StepId:
        monkeypatch.setattr(type(wizard.steps[number]), "cannot_enter", "")
        wizard.go_to(number)
        pressed = watched(wizard, number, monkeypatch)
        assert misses(wizard, pressed) == [], wizard.steps[number].title
    qtbot.waitUntil(lambda: visit.preview.is_idle)


def test_i_and_k_include_the_walk_just_stopped_x_and_d_exclude_it(
    wizard: Wizard, monkeypatch: pytest.MonkeyPatch
) -> None:
    wizard.begin(None)
    step = wizard.steps[StepId.WALKING]
    assert isinstance(step, WalkingStep)
    kept: list[bool] = []
    monkeypatch.setattr(step, "_keep", lambda _walk, *, is_kept: kept.append(is_kept))
    monkeypatch.setattr(wizard_module, "DEAF_S", 0.0)
    monkeypatch.setattr(type(step), "cannot_enter", "")
    wizard.go_to(StepId.WALKING)
    button = wizard.shell.bar.back
    button.setFocus()
    keys = (Qt.Key.Key_I, Qt.Key.Key_K, Qt.Key.Key_X, Qt.Key.Key_D)
    for key in keys:
        QTest.keyClick(button, key)
    assert kept == []  # there is no walk to include
    monkeypatch.setattr(type(step), "_asked", property(lambda _step: object()))
    for key in keys:
        QTest.keyClick(button, key)
    assert kept == [True, True, False, False]


def test_with_shift_space_and_enter_press_what_has_the_focus(wizard: Wizard, monkeypatch: pytest.MonkeyPatch) -> None:
    wizard.begin(None)
    pressed = watched(wizard, StepId.PATIENT, monkeypatch)
    clicks: list[None] = []
    back = wizard.shell.bar.back
    back.clicked.disconnect()
    back.clicked.connect(lambda: clicks.append(None))
    back.setFocus()
    for key in (Qt.Key.Key_Space, Qt.Key.Key_Return):
        QTest.keyClick(back, key, Qt.KeyboardModifier.ShiftModifier)
    assert (len(clicks), pressed) == (2, [])


def test_a_key_of_a_button_that_cannot_be_pressed_presses_nothing_else(
    wizard: Wizard, monkeypatch: pytest.MonkeyPatch
) -> None:
    wizard.begin(None)
    pressed = watched(wizard, StepId.PATIENT, monkeypatch)
    shut = BarAction("Go on", partial(pressed.append, "Go on"), "Enter", is_enabled=False)
    monkeypatch.setattr(wizard.steps[StepId.PATIENT], "bar", lambda: BarState(shut))
    wizard.steps[StepId.PATIENT].changed.emit()
    left: list[None] = []
    wizard.left.connect(lambda: left.append(None))
    wizard.shell.bar.back.setFocus()
    QTest.keyClick(wizard.shell.bar.back, Qt.Key.Key_Return)
    assert (pressed, left) == ([], [])


def test_a_visit_that_was_left_is_not_held_by_the_bar(wizard: Wizard) -> None:
    wizard.begin(None)
    bar = wizard.shell.bar
    assert bar.primary.verb.text == "Attach sensors"
    wizard.leave()
    assert bar.state == BarState()
    assert {button.verb.text for button in (*bar.others, *bar.quiet, bar.primary)} == {""}

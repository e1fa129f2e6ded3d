"""A key that the bar shows is the bar's, whatever has the focus: at every step, with every widget that can have it."""

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
from app.wizard.wizard import PATIENT, REPORT, RESULTS, Wizard
from app.workers.library_controller import LibraryController
from core.samples import Session

ALL = BarState(
    primary=BarAction("Go on", "Enter"),
    others=(BarAction("Record again", "Space"),),
    quiet=(BarAction("Repeat left", "L"), BarAction("Repeat right", "R"), BarAction("Discard", "D")),
)
DOES = {"Enter": "primary", "Space": "other 0", "L": "quiet 0", "R": "quiet 1", "D": "quiet 2"}
KEYS = {"Enter": Qt.Key.Key_Return, "Space": Qt.Key.Key_Space, "L": Qt.Key.Key_L, "R": Qt.Key.Key_R, "D": Qt.Key.Key_D}
WAIT_MS = 60_000


def watched(wizard: Wizard, number: int, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Show every key on the bar of a step, and write down what of the bar is pressed instead of doing it."""
    pressed: list[str] = []
    step = wizard.steps[number]
    monkeypatch.setattr(wizard_module, "DEAF_S", 0.0)
    monkeypatch.setattr(step, "bar", lambda: ALL)
    monkeypatch.setattr(step, "on_intent", lambda _intent: False)
    monkeypatch.setattr(step, "on_primary", lambda: pressed.append("primary"))
    monkeypatch.setattr(step, "on_other", lambda k: pressed.append(f"other {k}"))
    monkeypatch.setattr(step, "on_quiet", lambda k: pressed.append(f"quiet {k}"))
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
    """Press each key on each widget, and give where something else was done than the bar says."""
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
    for key, does in DOES.items():
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


@pytest.mark.parametrize("number", range(PATIENT, REPORT + 1))
def test_a_key_on_the_bar_presses_the_bar_whatever_has_the_focus(
    wizard: Wizard, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    wizard.begin(None)
    monkeypatch.setattr(type(wizard.steps[number]), "cannot_enter", "")
    wizard.go_to(number)
    pressed = watched(wizard, number, monkeypatch)
    assert len(focusable(wizard)) > len(ALL.quiet) + 3
    assert misses(wizard, pressed) == []


@pytest.mark.endurance
def test_it_does_so_on_pages_that_are_full_of_results(
    qtbot: QtBot,
    wizard: Wizard,
    controller: LibraryController,
    simulated_session: Session,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert controller.state is not None
    opened = controller.state.library
    import_session(opened, simulated_session, lambda _share, _what: None, "DEMO-1")
    wizard.show_session(opened.library.sessions.list()[0].id)
    visit = wizard.visit
    assert visit is not None
    qtbot.waitUntil(lambda: wizard.step_number == RESULTS and not visit.evaluation.is_busy, timeout=WAIT_MS)
    for number in range(PATIENT, REPORT + 1):
        monkeypatch.setattr(type(wizard.steps[number]), "cannot_enter", "")
        wizard.go_to(number)
        pressed = watched(wizard, number, monkeypatch)
        assert misses(wizard, pressed) == [], wizard.steps[number].title
    qtbot.waitUntil(lambda: visit.preview.is_idle, timeout=WAIT_MS)


def test_with_shift_space_and_enter_press_what_has_the_focus(wizard: Wizard, monkeypatch: pytest.MonkeyPatch) -> None:
    wizard.begin(None)
    pressed = watched(wizard, PATIENT, monkeypatch)
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
    pressed = watched(wizard, PATIENT, monkeypatch)
    monkeypatch.setattr(wizard.steps[PATIENT], "bar", lambda: BarState(BarAction("Go on", "Enter", is_enabled=False)))
    wizard.steps[PATIENT].changed.emit()
    left: list[None] = []
    wizard.left.connect(lambda: left.append(None))
    wizard.shell.bar.back.setFocus()
    QTest.keyClick(wizard.shell.bar.back, Qt.Key.Key_Return)
    assert (pressed, left) == ([], [])

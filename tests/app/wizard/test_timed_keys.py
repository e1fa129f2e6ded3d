"""Tests that the wizard lets a presenter's clicker be Space while a timed test runs, and only then."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.wizard.keys import Intent, KeyAction
from app.wizard.step import Step, StepId
from app.wizard.walking.step import WalkingStep
from app.wizard.wizard import Wizard


def test_the_wizard_shows_its_keys_whether_a_step_takes_a_clicker(
    qtbot: QtBot, wizard: Wizard, monkeypatch: pytest.MonkeyPatch
) -> None:
    wizard.begin(None)
    pressed: list[Intent] = []
    step = wizard.steps[StepId.WALKING]
    assert isinstance(step, WalkingStep)

    def take(_step: Step, intent: Intent) -> bool:
        pressed.append(intent)
        return True

    monkeypatch.setattr(type(wizard.current), "on_intent", take)
    wizard.setFocus()
    QTest.keyClick(wizard.window().focusWidget() or wizard.window(), Qt.Key.Key_PageDown)
    assert Intent(KeyAction.RUN) not in pressed
    monkeypatch.setattr(type(wizard.current), "takes_clicker", property(lambda _self: True))
    assert wizard.current is not None
    wizard.current.changed.emit()
    wizard.shell.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    wizard.shell.setFocus()
    QTest.keyClick(wizard.window().focusWidget() or wizard.window(), Qt.Key.Key_PageDown)
    assert pressed[-1:] == [Intent(KeyAction.RUN)]

"""The step of the report: its keys."""

import pytest
from pytestqt.qtbot import QtBot

from app.theme import Look
from app.wizard.keys import Action, Intent
from app.wizard.steps.report_step import ReportStep
from app.wizard.visit import Visit


def test_ctrl_s_saves_as_its_cap_says(qtbot: QtBot, visit: Visit, monkeypatch: pytest.MonkeyPatch) -> None:
    step = ReportStep(Look(), visit, visit.desk)
    qtbot.addWidget(step.page)
    primary = step.bar().primary
    assert primary is not None
    assert primary.key == "Ctrl S"
    pressed = []
    monkeypatch.setattr(step, "on_primary", lambda: pressed.append("save"))
    assert step.on_intent(Intent(Action.SAVE))
    assert pressed == ["save"]
    assert not step.on_intent(Intent(Action.RUN))

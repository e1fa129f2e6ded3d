"""Pages are made before somebody comes to them, and none of them holds up the screen."""

import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition
from app.results.result_page import ResultPage
from app.wizard import wizard as wizard_module
from app.wizard.step import StepId
from app.wizard.wizard import Wizard
from app.wizard.worn_sensors import SourceChoice
from app.workers.preload import preload
from core.body import LEG_SITES
from core.session import Patient, Session
from devices.simulation.replay import ReplaySource
from tests.app.watchdog import Watchdog

LOOK_MS = 700  # at each page


@pytest.fixture
def preparing(wizard: Wizard, monkeypatch: pytest.MonkeyPatch) -> Wizard:
    """A wizard for which all is imported, in a hurry."""
    monkeypatch.setattr(wizard_module, "is_preloaded", lambda: True)
    wizard._preparing.setInterval(1)
    return wizard


def test_all_pages_are_made_while_the_first_is_looked_at(qtbot: QtBot, preparing: Wizard) -> None:
    preparing.begin(None)
    qtbot.waitUntil(lambda: not preparing.to_prepare)
    made = preparing.shell.pages
    assert set(made) == set(StepId)
    assert preparing.shell.page is made[StepId.PATIENT]
    assert made[StepId.RESULTS].findChildren(ResultPage)


def test_nothing_is_made_ahead_amid_a_recording(
    qtbot: QtBot, preparing: Wizard, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Wizard, "is_recording", True)
    preparing.begin(None)
    qtbot.wait(50)
    assert list(preparing.shell.pages) == [StepId.PATIENT]


@pytest.mark.endurance
def test_a_whole_session_never_holds_up_the_screen(
    qtbot: QtBot, wizard: Wizard, simulated_session: Session, watchdog: Watchdog, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = ReplaySource(simulated_session, finishes=True)
    choice = SourceChoice("patient", "Patient", lambda: Acquisition([source]), is_simulated=True)
    monkeypatch.setattr(wizard_module, "choices", lambda: (choice,))
    with watchdog.paused():
        preload(lambda _share, _what: None)
    wizard.begin(None)
    visit = wizard.visit
    assert visit is not None
    qtbot.waitUntil(lambda: not wizard.to_prepare)
    visit.patient.edit(Patient(code="DEMO-9"))
    visit.patient.commit()
    qtbot.waitUntil(lambda: visit.patient.stored is not None)
    wizard.go_to(StepId.SENSORS)
    qtbot.waitUntil(lambda: visit.session is not None)
    visit.sensors.search(visit.choices[0])
    qtbot.waitUntil(lambda: bool(visit.sensors.status))
    visit.sensors.assign_all(dict(zip(visit.sensors.status, LEG_SITES, strict=True)))
    qtbot.wait(LOOK_MS)
    wizard.go_to(StepId.STAND_STILL)
    qtbot.wait(LOOK_MS)
    wizard.press_primary()
    qtbot.waitUntil(lambda: wizard.step_id is StepId.FREE_MOTION)
    qtbot.waitUntil(lambda: wizard.step_id is StepId.WALKING)
    qtbot.wait(LOOK_MS)
    wizard.press_primary()
    qtbot.waitUntil(lambda: wizard.is_recording)
    qtbot.wait(12_000)
    wizard.press_primary()
    qtbot.waitUntil(lambda: bool(visit.recordings.walks) and not visit.evaluation.is_busy)
    visit.recordings.keep(visit.recordings.walks[-1], True)
    for step in (StepId.RESULTS, StepId.REPORT, StepId.PATIENT):
        wizard.go_to(step)
        qtbot.wait(3 * LOOK_MS)
    qtbot.waitUntil(lambda: visit.preview.is_idle)

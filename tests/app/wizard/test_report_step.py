"""The report step shows what will print, keeps the clinician's words, and saves the files that were chosen."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.theme import Look
from app.widgets.step_rail import StepState
from app.wizard.keys import Action, Intent
from app.wizard.steps.report_step import ReportStep
from app.wizard.visit import Visit
from app.workers.library_desk import LibraryDesk
from core.analysis import analyse
from core.body import Site
from core.results import Analysis
from core.samples import Session
from tests.app.wizard.test_visit import begin

WAIT_MS = 60_000  # on a busy machine


@pytest.fixture(scope="module")
def analysis(simulated_session: Session) -> Analysis:
    return analyse(simulated_session)


@pytest.fixture
def step(
    qtbot: QtBot,
    desk: LibraryDesk,
    visit: Visit,
    worn: dict[str, Site],
    simulated_session: Session,
    analysis: Analysis,
) -> Iterator[ReportStep]:
    begin(qtbot, visit, worn)
    visit.evaluation.session, visit.evaluation.analysis = simulated_session, analysis
    step = ReportStep(Look(), visit, desk)
    qtbot.addWidget(step.page)
    step.page.resize(1016, 600)
    step.page.show()
    step.enter()
    yield step
    step.leave()


def test_pages_are_shown_and_made_anew_with_the_words(qtbot: QtBot, step: ReportStep, visit: Visit) -> None:
    sheets = step.page.report.sheets
    qtbot.waitUntil(lambda: sheets.count >= 5, timeout=WAIT_MS)
    step.page.report.comment.setPlainText("Keep alignment C.")
    step.leave()
    assert step.comment == "Keep alignment C."
    state, session = visit.desk.state, visit.session
    assert state is not None
    assert session is not None
    sessions, session_id = state.library.library.sessions, session.id
    qtbot.waitUntil(lambda: sessions.get(session_id).comment == "Keep alignment C.", timeout=WAIT_MS)


def test_the_chosen_files_are_saved(qtbot: QtBot, step: ReportStep, tmp_path: Path) -> None:
    out = tmp_path / "results"
    step.page.report.formats.choose(["csv"])
    chosen: Callable[[str], None] = step._on_folder_selected
    chosen(str(out))
    qtbot.waitUntil(lambda: step.state is StepState.DONE, timeout=WAIT_MS)
    assert (out / "report.pdf").read_bytes().startswith(b"%PDF-")
    assert (out / "summary.json").exists()
    assert not (out / "session.rrd").exists()


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

"""Killed at any point, started again, gone on with: what was recorded and stated is there, and what is open is
asked."""

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any
from uuid import UUID

import pytest
from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.storage.stored import PlacedSensor, RecordingState
from app.system.settings import Settings
from app.widgets.rail_row import StepState
from app.wizard import wizard as wizard_module
from app.wizard.report.step import ReportStep
from app.wizard.results.step import ResultsStep
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.wizard import Wizard
from app.workers.library_controller import LibraryController
from core.body import LEG_SITES, Joint, Side, Site
from tests.app.wizard.conftest import PASSPHRASE
from tests.app.wizard.present import present
from tests.safety.wizard_kills import COMMENT, CONDITION, SPEED, Point

LOST_S = 0.25  # of our time: as the journal promises at worst

pytestmark = [
    pytest.mark.endurance,
    pytest.mark.skipif(os.name == "nt", reason="SIGKILL is POSIX's"),
]


def killed_at(point: Point, folder: Path, untouched: Path, *more: str) -> dict[str, Any]:
    """Lead the application to a point, and kill it there; returns what it stated of what it had."""
    library = shutil.copytree(untouched, folder / "library")
    command = [sys.executable, "-m", "tests.safety.wizard_kills", str(library), PASSPHRASE, str(point), *more]
    with subprocess.Popen(command, cwd=Path(__file__).parents[3], stdout=subprocess.PIPE, text=True) as child:
        try:
            line = present(child.stdout).readline()
        finally:
            child.send_signal(signal.SIGKILL)
    assert line, "it ended before it came to its point"
    reported: dict[str, Any] = json.loads(line)
    return reported


@pytest.fixture
def controller() -> Iterator[LibraryController]:
    """Nothing is open yet."""
    controller = LibraryController()
    yield controller
    controller.finish()


@pytest.fixture
def start_again(
    qtbot: QtBot, qapp: QApplication, controller: LibraryController, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str], tuple[Home, Wizard]]]:
    """Open the library as the next start does, and then the session that was killed."""
    monkeypatch.setattr(wizard_module, "choices", tuple)
    made: list[Wizard] = []

    def start(session: str) -> tuple[Home, Wizard]:
        settings = Settings(QSettings(str(tmp_path / "again.ini"), QSettings.Format.IniFormat))
        home, wizard = Home(controller, settings), Wizard(controller, settings)
        made.append(wizard)
        for widget in (home, wizard):
            qtbot.addWidget(widget)
            widget.resize(1280, 800)
        home.show()
        with qtbot.waitSignal(controller.opened):
            controller.open(lambda holder: holder.open(tmp_path / "library", PASSPHRASE))
        state = present(controller.state)
        home.show_library(state)
        if state.interrupted:
            with qtbot.waitSignal(home.recovering.recovered):
                pass
        wizard.show()
        wizard.show_session(UUID(session))
        qtbot.waitUntil(lambda: wizard.shell.page is not None)
        return home, wizard

    yield start
    for wizard in made:
        wizard.finish()


def visit_of(wizard: Wizard) -> Visit:
    assert wizard.visit is not None
    return wizard.visit


def wait_for_place(qtbot: QtBot, wizard: Wizard, step: StepId) -> None:
    """Wait until the session that was taken up is at this step; what it holds may still be read."""
    qtbot.waitUntil(lambda: wizard.current is not None and wizard.step_id == step)


def samples_of(visit: Visit) -> dict[str, dict[str, int]]:
    return {
        recording.details.name: {str(site): len(block) for site, block in recording.read_back.imu.items()}
        for recording in visit.recordings.every
        if recording.read_back is not None
    }


Start = Callable[[str], tuple[Home, Wizard]]


def test_amid_a_walk(qtbot: QtBot, start_again: Start, untouched_library: Path, tmp_path: Path) -> None:
    """All of it is there but the last moment, and it is asked whether it is kept."""
    reported = killed_at(Point.WALKING, tmp_path, untouched_library)
    home, wizard = start_again(reported["session"])
    assert "of A Shoes was recovered" in home.banner.text
    visit = visit_of(wizard)
    (walk,) = visit.recordings.walks
    assert walk.stored.state is RecordingState.RECOVERED
    wait_for_place(qtbot, wizard, StepId.WALKING)
    assert walk.read_back is not None
    assert set(walk.read_back.imu) == set(LEG_SITES)
    for block in walk.read_back.imu.values():
        assert float(block.time_s[-1] - block.time_s[0]) > reported["heard_s"] - LOST_S * SPEED
    assert {name: count for name, count in samples_of(visit).items() if name != "walk 1"} == reported["takes"]
    assert "was recovered" in page_notice(qtbot, wizard)


def test_amid_a_walk_with_a_sensor_on_the_pelvis(start_again: Start, untouched_library: Path, tmp_path: Path) -> None:
    reported = killed_at(Point.WALKING, tmp_path, untouched_library, "--pelvis")
    _, wizard = start_again(reported["session"])
    (walk,) = visit_of(wizard).recordings.walks
    assert walk.stored.state is RecordingState.RECOVERED
    assert walk.read_back is not None
    assert set(walk.read_back.imu) == set(Site)
    for block in walk.read_back.imu.values():
        assert float(block.time_s[-1] - block.time_s[0]) > reported["heard_s"] - LOST_S * SPEED
    assert set(visit_of(wizard).rests) == {worn.name for worn in placed(visit_of(wizard)).values()}


def placed(visit: Visit) -> Mapping[Site, PlacedSensor]:
    placement = present(visit.recordings.walks[-1].stored.placement)
    return placement.sensors


def page_notice(qtbot: QtBot, wizard: Wizard) -> str:
    step = wizard.current
    assert isinstance(step, WalkingStep)
    qtbot.waitUntil(lambda: bool(step.page.notice.text))
    return step.page.notice.text


def test_before_a_walk_was_kept_or_discarded(
    qtbot: QtBot, start_again: Start, untouched_library: Path, tmp_path: Path
) -> None:
    """It is whole, and the question is still there; answered, it is asked no more."""
    reported = killed_at(Point.ASKED, tmp_path, untouched_library)
    _, wizard = start_again(reported["session"])
    visit = visit_of(wizard)
    assert samples_of(visit) == reported["takes"]
    assert visit.recordings.walks[0].stored.state is RecordingState.CLOSED
    wait_for_place(qtbot, wizard, StepId.WALKING)
    step = wizard.current
    assert isinstance(step, WalkingStep)
    assert (step.state, step.note) == (StepState.ATTENTION, "include or exclude?")
    step.page.keep_pressed.emit(str(visit.recordings.walks[0].id))
    qtbot.waitUntil(lambda: visit.recordings.walks[0].stored.is_decided)
    wizard.show_session(UUID(reported["session"]))
    qtbot.waitUntil(lambda: wizard.visit is not visit and wizard.shell.page is not None)
    wait_for_place(qtbot, wizard, StepId.RESULTS)


def check_corrections(qtbot: QtBot, wizard: Wizard, reported: dict[str, Any]) -> None:
    """All that was put right holds, in the library and in what is computed of it."""
    visit = visit_of(wizard)
    assert samples_of(visit) == reported["takes"]
    first, second = visit.recordings.walks
    assert (first.details.condition, dict(first.details.left_out_s)) == (CONDITION, {Side.LEFT: (4.0,)})
    assert (first.details.is_kept, second.details.is_kept) == (True, False)
    assert visit.details.turned_sign == {Joint.LEFT_KNEE: -1}
    qtbot.waitUntil(lambda: visit.evaluation.analysis is not None and not visit.evaluation.is_busy)
    assert visit.evaluation.session is not None
    assert visit.evaluation.session.turned_sign == {Joint.LEFT_KNEE: -1}
    walks = [recording.name for recording in visit.evaluation.session.recordings if recording.name.startswith("walk")]
    assert walks == ["walk 1"]


def test_amid_the_results(qtbot: QtBot, start_again: Start, untouched_library: Path, tmp_path: Path) -> None:
    """Every correction is there: a stride left out, a condition, a sign, a walk that does not count."""
    reported = killed_at(Point.RESULTS, tmp_path, untouched_library)
    _, wizard = start_again(reported["session"])
    wait_for_place(qtbot, wizard, StepId.RESULTS)
    check_corrections(qtbot, wizard, reported)
    step = wizard.current
    assert isinstance(step, ResultsStep)
    qtbot.waitUntil(lambda: step.note == "1 included" and step.state is StepState.DONE)


@pytest.mark.parametrize("point", [Point.REPORT, Point.SAVING])
def test_amid_the_report(
    qtbot: QtBot, start_again: Start, untouched_library: Path, tmp_path: Path, point: Point
) -> None:
    """What was typed is there; a report that was not written whole is not there, and can be written again."""
    reported = killed_at(point, tmp_path, untouched_library)
    out = tmp_path / "out"
    assert not out.exists()
    _, wizard = start_again(reported["session"])
    wait_for_place(qtbot, wizard, StepId.RESULTS)
    check_corrections(qtbot, wizard, reported)
    wizard.go_to(StepId.REPORT)
    step = wizard.current
    assert isinstance(step, ReportStep)
    assert step.page.report.comment.toPlainText() == COMMENT
    qtbot.waitUntil(step.can_save)
    step.save_in(str(out))
    qtbot.waitUntil(lambda: step.exported == out)
    (report,) = out.glob("*.pdf")
    assert report.read_bytes().startswith(b"%PDF")

"""A session that a crash cut short is taken up where it was left, and nothing cut short passes for whole."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.storage.stored import RecordingState
from app.system.settings import Settings
from app.widgets.rail_row import StepState
from app.wizard import wizard as wizard_module
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.standing.step import StandStillStep
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.wizard import Wizard
from app.workers.library_controller import LibraryController
from core.body import Site
from core.calibration.rest import rest_of
from core.session import RecordingKind
from tests.app.wizard.begun_visit import begin, record, resumed
from tests.app.wizard.present import present


@pytest.fixture
def left(qtbot: QtBot, visit: Visit, worn: dict[str, Site], monkeypatch: pytest.MonkeyPatch) -> Visit:
    """A visit with sensors on, whose recordings nobody evaluates."""
    monkeypatch.setattr(Visit, "evaluate", lambda *_: None)
    begin(qtbot, visit, worn)
    return visit


@pytest.fixture
def wizard(
    qtbot: QtBot, qapp: QApplication, controller: LibraryController, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Wizard]:
    monkeypatch.setattr(wizard_module, "choices", tuple)
    wizard = Wizard(controller, Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat)))
    qtbot.addWidget(wizard)
    yield wizard
    wizard.finish()


def landed(qtbot: QtBot, wizard: Wizard, left: Visit) -> StepId:
    """Open the session that was left as Home does, and say at which step that is."""
    wizard.show_session(present(left.session).id)
    qtbot.waitUntil(lambda: wizard.current is not None and wizard.shell.page is not None)
    assert wizard.current is not None
    return wizard.step_id


def test_a_session_is_taken_up_where_something_is_to_be_done(qtbot: QtBot, wizard: Wizard, left: Visit) -> None:
    record(qtbot, left, RecordingKind.STANDING, 0.5)
    assert landed(qtbot, wizard, left) == StepId.SENSORS
    walk = record(qtbot, left, RecordingKind.WALKING, 0.5)
    assert landed(qtbot, wizard, left) == StepId.WALKING  # nobody has stated yet whether it is kept
    left.recordings.keep(walk, is_kept=True)
    qtbot.waitUntil(lambda: left.recordings.walks[0].stored.is_decided)
    assert landed(qtbot, wizard, left) == StepId.RESULTS
    library = present(left.controller.state).library.library
    files = {journal.segment: journal.sha256 for journal in walk.stored.journals}
    library.recordings.close(walk.id, RecordingState.RECOVERED, files)
    assert landed(qtbot, wizard, left) == StepId.WALKING  # where it is kept or discarded


def test_what_a_crash_cut_short_is_not_done(qtbot: QtBot, left: Visit) -> None:
    standing = record(qtbot, left, RecordingKind.STANDING, 6.0)
    moved = record(qtbot, left, RecordingKind.FREE_MOTION, 0.5)
    imu = present(standing.read_back).imu
    shown, moves = StandStillStep(left), FreeMotionStep(left)

    def rest(seconds: float) -> None:
        rests = {site: rest_of(block) for site, block in imu.items()}
        left.rests = {str(site): replace(found, duration_s=seconds) for site, found in rests.items() if found}

    rest(2.1)
    assert (shown.state, shown.note) == (StepState.TODO, "")
    rest(3.0)
    assert (shown.state, shown.note) == (StepState.DONE, "3.0 s, reference set")
    assert moves.state is StepState.DONE
    recovered = replace(moved, stored=replace(moved.stored, state=RecordingState.RECOVERED))
    left.recordings.every = tuple(
        recovered if recording.id == moved.id else recording for recording in left.recordings.every
    )
    assert (moves.state, moves.note) == (StepState.ATTENTION, "stopped early")


@pytest.mark.endurance
def test_a_clock_that_is_set_back_between_recordings_changes_nothing_of_their_order(
    qtbot: QtBot, left: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    record(qtbot, left, RecordingKind.STANDING, 0.5)
    true_ns = time.time_ns
    monkeypatch.setattr(time, "time_ns", lambda: true_ns() - 86_400_000_000_000)  # the ids sort by it
    record(qtbot, left, RecordingKind.FREE_MOTION, 0.5)
    record(qtbot, left, RecordingKind.WALKING, 0.5)
    again = resumed(qtbot, left)
    assert [recording.details.name for recording in again.recordings.every] == ["standing", "free motion", "walk 1"]
    again.finish()

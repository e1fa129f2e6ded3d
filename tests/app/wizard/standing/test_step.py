"""The step of standing on a simulated patient: it ends by itself, begins again when somebody moves, can be skipped."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.recorder import Recorder
from app.storage.opened import OpenedLibrary
from app.storage.stored import LibraryError
from app.widgets.rail_row import StepState
from app.wizard.keys import Intent, KeyAction
from app.wizard.standing.page import StandPhase
from app.wizard.standing.step import StandStillStep
from app.wizard.visit import Visit
from core.body import Joint, Site
from core.session import RecordingKind
from devices.simulation.replay import ReplaySource
from tests.app.wizard.begun_visit import begin
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press

SPACE = Intent(KeyAction.RUN)


@pytest.fixture
def step(qtbot: QtBot, visit: Visit, worn: dict[str, Site]) -> Iterator[StandStillStep]:
    begin(qtbot, visit, worn)
    step = StandStillStep(visit)
    qtbot.addWidget(step.page)
    step.page.show()
    step.enter()
    yield step
    step.leave()
    qtbot.waitUntil(lambda: not visit.recordings.is_recording)


def ticks(qtbot: QtBot, step: StandStillStep, until: Callable[[], bool]) -> None:
    def reached() -> bool:
        step.tick()
        return until()

    qtbot.waitUntil(reached)


def phase(step: StandStillStep) -> StandPhase:
    return step.page.view.phase


def test_movement_is_seen_before_the_count_begins(qtbot: QtBot, step: StandStillStep) -> None:
    ticks(qtbot, step, lambda: len(step.page.view.movement_deg_s) == 6)
    assert phase(step) is StandPhase.READY
    verb = present(step.bar().primary)
    assert (verb.text, verb.key) == ("Start countdown", "Space")


def test_three_seconds_are_recorded_and_the_wizard_goes_on_by_itself(
    qtbot: QtBot, step: StandStillStep, visit: Visit, worn: dict[str, Site]
) -> None:
    with qtbot.waitSignal(step.done):
        assert step.on_intent(SPACE)
        ticks(qtbot, step, lambda: phase(step) is StandPhase.DONE)
    standing = present(visit.recordings.standing)
    for block in present(standing.read_back).imu.values():
        assert block.time_s[-1] - block.time_s[0] >= 3.0
    assert set(visit.rests) == set(worn)
    assert step.state is StepState.DONE
    assert step.note.endswith("s, reference set")


def test_no_zero_is_called_set_while_the_library_has_not_taken_the_standing(
    qtbot: QtBot, step: StandStillStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is still to be read back is called so; what the library refuses for good is a standing to be repeated."""

    def refusing(recorder: Recorder, opened: OpenedLibrary) -> object:
        recorder.halt()
        raise LibraryError("This session is no longer in the library", "Reload the session")

    monkeypatch.setattr(Recorder, "stop", refusing)
    monkeypatch.setattr("app.wizard.reading_back.MOST_READINGS", 2)
    monkeypatch.setattr("app.wizard.reading_back.READ_AGAIN_MS", 200)
    assert step.on_intent(SPACE)
    ticks(qtbot, step, lambda: phase(step) is StandPhase.DONE)
    assert (step.state, step.note) == (StepState.TODO, "being loaded")
    qtbot.waitUntil(lambda: visit.recordings.is_idle)
    assert visit.recordings.standing is None
    assert (step.state, step.note) == (StepState.TODO, "")
    assert phase(step) is StandPhase.READY


def test_who_moves_makes_the_count_begin_again(
    qtbot: QtBot, step: StandStillStep, source: ReplaySource, visit: Visit
) -> None:
    step.on_intent(SPACE)
    qtbot.waitUntil(lambda: visit.recordings.is_recording)

    def is_seen_to_move() -> bool:
        source.shake(f"DEMO-{Site.LEFT_THIGH}")  # its two seconds are soon over, at this speed
        return Site.LEFT_THIGH in step.page.view.moved

    ticks(qtbot, step, is_seen_to_move)
    assert phase(step) is StandPhase.COUNTING
    ticks(qtbot, step, lambda: phase(step) is StandPhase.DONE)


def test_a_silent_sensor_holds_the_count(
    qtbot: QtBot, step: StandStillStep, source: ReplaySource, visit: Visit
) -> None:
    source.silence(f"DEMO-{Site.RIGHT_FOOT}")
    step.on_intent(SPACE)
    ticks(qtbot, step, lambda: step.page.view.silent == (Site.RIGHT_FOOT,))
    assert phase(step) is StandPhase.COUNTING
    source.wake(f"DEMO-{Site.RIGHT_FOOT}")
    ticks(qtbot, step, lambda: phase(step) is StandPhase.DONE)


def test_who_cannot_stand_is_not_recorded(qtbot: QtBot, step: StandStillStep, visit: Visit) -> None:
    step.on_intent(SPACE)
    qtbot.waitUntil(lambda: visit.recordings.is_recording)
    step.page.cannot_stand_pressed.emit()
    assert step.state is StepState.SKIPPED
    qtbot.waitUntil(lambda: not visit.recordings.is_recording)
    qtbot.waitUntil(lambda: visit.recordings.standing is None)
    with qtbot.waitSignal(step.done):
        press(step)
    step.page.can_stand_pressed.emit()
    assert not visit.has_skipped_standing
    assert step.page.view.phase is StandPhase.READY


def test_leaving_during_the_count_keeps_nothing(qtbot: QtBot, step: StandStillStep, visit: Visit) -> None:
    step.on_intent(SPACE)
    qtbot.waitUntil(lambda: visit.recordings.is_recording)
    step.leave()
    qtbot.waitUntil(lambda: not visit.recordings.is_recording)
    qtbot.waitUntil(lambda: visit.recordings.standing is None)
    assert not visit.rests


def test_the_goniometer_is_reported_in_radians_and_nought_is_the_standing_itself(
    qtbot: QtBot, step: StandStillStep, visit: Visit
) -> None:
    step.page.zero.edited.emit(Joint.LEFT_KNEE, 15.0)
    step.page.zero.edited.emit(Joint.RIGHT_KNEE, 0.0)
    assert dict(visit.details.zero_rad) == {Joint.LEFT_KNEE: pytest.approx(np.deg2rad(15.0))}
    qtbot.waitUntil(lambda: visit.session is not None and Joint.LEFT_KNEE in visit.session.details.zero_rad)
    step.enter()
    assert step.page.zero.fields[Joint.LEFT_KNEE].value == pytest.approx(15.0)


def test_simulated_patient_is_asked_to_stand(
    qtbot: QtBot, step: StandStillStep, source: ReplaySource, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[RecordingKind | None] = []
    monkeypatch.setattr(source, "ask", asked.append)
    step.on_intent(SPACE)
    assert asked == [RecordingKind.STANDING]

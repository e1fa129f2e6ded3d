"""A timed test through the Walking step: chosen by T, started and ended by the motion or a key, kept with its keys."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from pytestqt.qtbot import QtBot

from app.wizard.keys import Intent, KeyAction
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from core.body import Site
from core.session import Patient, RecordingKind, Session
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import DEMONSTRATION, Standing, Walk
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.patient_time import PatientTime
from tests.app.wizard.walking.shown_step import RUN, shown_step, start, stop
from tests.simulated import session_of

NEXT_TEST = Intent(KeyAction.NEXT_TEST)


@pytest.fixture(scope="module")
def simulated_session() -> Session:
    """A patient who is a while before each walk."""
    walk = Walk(strides=14, standing_before_s=3.0)
    played = (Standing(duration_s=10.0), walk, replace(walk, name="walk 2"))
    return session_of(replace(DEMONSTRATION, recordings=played))


@pytest.fixture
def step(qtbot: QtBot, visit: Visit, worn: dict[str, Site], patient_time: PatientTime) -> Iterator[WalkingStep]:
    """Of a patient who has stood still, entered, and looked at as the wizard does."""
    begin(qtbot, visit, worn, Patient(code="DEMO-7"))
    patient_time.is_held = lambda: visit.recordings.is_recording and not visit.recordings.has_begun
    record(qtbot, visit, RecordingKind.STANDING, 4.0)
    with shown_step(qtbot, visit) as step:
        yield step


def is_for_clicker(step: WalkingStep) -> bool:
    return step.takes_clicker


@pytest.mark.endurance
def test_ten_metres_by_the_motion_alone(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    assert step.on_intent(NEXT_TEST)
    assert step.page.next.test.currentText() == "10-metre walk"
    with qtbot.waitSignal(visit.recordings.ended):  # which stops by itself
        step.on_intent(RUN)
        qtbot.waitUntil(lambda: step.page.timed.isVisible())
        assert is_for_clicker(step)
        qtbot.waitUntil(lambda: step.page.timed.time.text not in ("", "0.0"))
    assert not is_for_clicker(step)
    (walk,) = visit.recordings.walks
    assert walk.details.test == PlannedTest(TimedProtocol.TEN_METRES)
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)
    assert step.page.timed_result.isVisible()
    assert step.page.timed_result.first.text().startswith("10-metre walk: ")
    analysis = visit.evaluation.analysis
    assert analysis is not None
    found = analysis.recordings[-1].timed
    assert found is not None
    assert found.distance_m == 10.0
    assert found.missing == ()


@pytest.mark.endurance
def test_a_key_at_the_tape_wins_and_is_kept(
    qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime
) -> None:
    step.on_intent(NEXT_TEST)
    with qtbot.waitSignal(visit.recordings.ended):
        step.on_intent(RUN)
        qtbot.waitUntil(lambda: step.page.timed.time.text not in ("", "0.0", "0.1", "0.2"))
        patient_time.wait(qtbot, 3.0)
        step.on_intent(RUN)  # at the tape, long before the sensors' 10 m
    (walk,) = visit.recordings.walks
    assert walk.details.test is not None
    assert walk.details.test.start_key_s is None
    pressed_s = walk.details.test.end_key_s
    assert pressed_s is not None
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)
    analysis = visit.evaluation.analysis
    assert analysis is not None
    found = analysis.recordings[-1].timed
    assert found is not None
    assert found.end_s == pressed_s
    assert found.distance_m == 10.0
    assert found.sensor_distance_m < 9.0
    assert "Check the position of the tape" in step.page.timed_result.then.text()


def test_esc_breaks_a_test_off_and_no_test_is_a_walk_as_ever(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    step.on_intent(NEXT_TEST)
    start(qtbot, step, visit)
    with qtbot.waitSignal(visit.recordings.ended):
        assert step.on_intent(Intent(KeyAction.LEAVE))
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)
    assert "time not measured" in step.page.timed_result.first.text()
    for _ in TimedProtocol:
        step.on_intent(NEXT_TEST)
    assert step.page.next.test.currentIndex() == 0
    start(qtbot, step, visit)
    assert not step.takes_clicker
    assert not step.page.timed.isVisible()
    stop(qtbot, step, visit)
    assert visit.recordings.walks[-1].details.test is None
    assert not step.page.timed_result.isVisible()
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)

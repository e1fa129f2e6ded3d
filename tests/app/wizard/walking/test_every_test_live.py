"""Every timed test as the demonstration's patient performs it, by keys, through the acquisition as real sensors."""

from collections.abc import Iterator
from functools import partial

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.wizard.keys import Intent, KeyAction
from app.wizard.resuming import rests_of
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.walking.timed_result import TimedResultView
from core.body import LEG_SITES, Site
from core.session import Patient, RecordingKind
from core.timed.found import NotValid, TimedTest
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.demonstration_patient import DemonstrationPatient
from devices.simulation.replay import DEMONSTRATION_NAMES
from devices.simulation.walker import FreeMotion, Standing, Tissue, WalkerSettings
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.patient_time import PatientTime
from tests.app.wizard.walking.shown_step import shown_step

RUN, NEXT_TEST, COURSE, LEAVE = map(
    Intent, (KeyAction.RUN, KeyAction.NEXT_TEST, KeyAction.ENTER_FIELDS, KeyAction.LEAVE)
)


@pytest.fixture
def source(patient_time: PatientTime) -> DemonstrationPatient:
    still = WalkerSettings(
        seed=1, tissue=Tissue.SOFT, recordings=(Standing(duration_s=10.0), FreeMotion(duration_s=6.0))
    )
    return DemonstrationPatient(still, now_ns=patient_time.now_ns)


@pytest.fixture
def worn() -> dict[str, Site]:
    return {DEMONSTRATION_NAMES[site]: site for site in LEG_SITES}


@pytest.fixture
def step(qtbot: QtBot, visit: Visit, worn: dict[str, Site], patient_time: PatientTime) -> Iterator[WalkingStep]:
    """Of a patient who has stood still."""
    begin(qtbot, visit, worn, Patient(code="DEMO-7"))
    patient_time.is_held = lambda: visit.recordings.is_recording and not visit.recordings.has_begun
    record(qtbot, visit, RecordingKind.STANDING, 4.0)
    qtbot.waitUntil(lambda: bool(rests_of(visit.recordings.every)))
    visit.rests = rests_of(visit.recordings.every)
    with shown_step(qtbot, visit, 660) as step:
        yield step


def choose(step: WalkingStep, protocol: TimedProtocol) -> None:
    while step.page.next.test.currentData() != str(protocol):
        assert step.on_intent(NEXT_TEST)


def _seconds(shown: str) -> float:
    return float(shown) if shown else 0.0


def led(qtbot: QtBot, step: WalkingStep, visit: Visit, protocol: TimedProtocol, ends_at_s: float = 0.0) -> TimedTest:
    """Lead a test from Space to its result; one of minutes is ended by Space when so much has passed."""
    choose(step, protocol)
    with qtbot.waitSignal(visit.recordings.ended):
        assert step.on_intent(RUN)
        if ends_at_s:
            qtbot.waitUntil(lambda: _seconds(step.page.timed.time.text) > ends_at_s)
            assert step.on_intent(RUN)
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)
    analysis = visit.evaluation.analysis
    assert analysis is not None
    found = analysis.recordings[-1].timed
    assert found is not None
    assert found.protocol is protocol
    assert step.page.timed_result.isVisible()
    return found


@pytest.mark.endurance
@pytest.mark.parametrize(
    ("protocol", "ends_at_s"),
    [(one, 30.0 if one in (TimedProtocol.TWO_MINUTES, TimedProtocol.SIX_MINUTES) else 0.0) for one in TimedProtocol],
)
def test_every_test_gives_a_result(
    qtbot: QtBot, step: WalkingStep, visit: Visit, protocol: TimedProtocol, ends_at_s: float
) -> None:
    found = led(qtbot, step, visit, protocol, ends_at_s)
    assert found.missing == ()
    assert found.not_valid == ((NotValid.OTHER_TIME,) if ends_at_s else ())
    assert found.time_s == pytest.approx(ends_at_s, abs=1.0) if ends_at_s else found.time_s > 5.0
    if protocol is TimedProtocol.UP_AND_GO:
        assert len(found.parts) == 6
        assert sum(part.time_s for part in found.parts) == pytest.approx(found.time_s, abs=0.05)
    if protocol is TimedProtocol.SIT_TO_STAND:
        assert len(found.rises) == 5
    if protocol is TimedProtocol.STAIRS:
        assert {one.is_up for one in found.stairs} == {True, False}


def _shows(view: TimedResultView, *, is_valid: bool) -> bool:
    return view.not_valid.isVisible() is not is_valid


@pytest.mark.endurance
def test_a_course_of_another_length_is_not_valid_until_the_length_is_put_right(
    qtbot: QtBot, step: WalkingStep, visit: Visit
) -> None:
    choose(step, TimedProtocol.UP_AND_GO)
    assert step.on_intent(COURSE)
    field = step.page.next.course.field.line_edit
    assert field.hasFocus()
    QTest.keyClicks(field, "3")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert not field.hasFocus()
    assert led(qtbot, step, visit, TimedProtocol.UP_AND_GO).is_valid
    assert visit.recordings.walks[-1].details.test == PlannedTest(TimedProtocol.UP_AND_GO)
    view = step.page.timed_result
    for typed, is_valid in (("6", False), ("3", True)):
        view.entry.length.line_edit.setFocus()
        view.entry.length.line_edit.selectAll()
        QTest.keyClicks(view.entry.length.line_edit, typed)
        QTest.keyClick(view.entry.length.line_edit, Qt.Key.Key_Return)
        qtbot.waitUntil(partial(_shows, view, is_valid=is_valid))
    assert view.first.text().startswith("Timed Up and Go: ")


def test_t_shows_what_it_arms_esc_turns_it_off_and_what_is_no_length_starts_none(step: WalkingStep) -> None:
    shown = []
    for _ in range(len(TimedProtocol) + 1):
        step.on_intent(NEXT_TEST)
        shown.append((step.page.next.test.currentText(), step.page.next.course.isVisible()))
    assert [name for name, _ in shown] == [
        *("10-metre walk", "2-minute walk", "6-minute walk", "Timed Up and Go"),
        *("5 \N{MULTIPLICATION SIGN} sit to stand", "Stairs", "No timed test"),
    ]
    assert [has_course for _, has_course in shown] == [True, True, True, True, False, False, False]
    step.on_intent(NEXT_TEST)
    assert step.on_intent(LEAVE)
    assert step.page.next.test.currentText() == "No timed test"
    assert not step.on_intent(LEAVE), "then Esc is whoever else's"
    choose(step, TimedProtocol.UP_AND_GO)
    field = step.page.next.course.field.line_edit
    field.setFocus()
    field.selectAll()
    for typed, is_possible in (("0", False), ("x", False), ("2.5", True)):
        field.selectAll()
        QTest.keyClicks(field, typed)
        primary, note = step.bar().primary, step.bar().note
        assert primary is not None
        assert primary.is_enabled is is_possible
        assert ("Enter the length" in note) is not is_possible

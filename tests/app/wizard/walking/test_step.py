"""The Walking step on the demonstration patient: Space starts and stops, walks are kept or not, losses are stated."""

from collections.abc import Iterator

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.acquisition.recorder import Recorder
from app.patient_screen.window import PatientWindow
from app.storage.stored import LibraryError
from app.wizard.keys import Intent, KeyAction
from app.wizard.results.step import ResultsStep
from app.wizard.resuming import rests_of
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.walking.readout import WalkingReadout
from app.wizard.walking.step import WalkingStep
from app.wizard.walking.walk_list import WalkState
from app.wizard.worn_sensors import WornSensors
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, Side, Site
from core.session import Patient
from core.targets import Target, TargetMeasure, TargetTally, tallies_of
from devices.simulation.replay import ReplaySource
from tests.app.wizard.begun_visit import begin
from tests.app.wizard.patient_time import BEHIND_S, PatientTime
from tests.app.wizard.pressing import press
from tests.app.wizard.walking.shown_step import RUN, calibrate, shown_step, start, stop

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three


@pytest.fixture
def step(qtbot: QtBot, visit: Visit, worn: dict[str, Site], patient_time: PatientTime) -> Iterator[WalkingStep]:
    """Of a patient who wears six sensors, entered, and looked at as the wizard does."""
    begin(qtbot, visit, worn, Patient(code="DEMO-7", birth_year=1970, prosthetic_side="left"))
    patient_time.is_held = lambda: visit.recordings.is_recording and not visit.recordings.has_begun
    with shown_step(qtbot, visit) as step:
        yield step


def walk(qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime, seconds: float) -> None:
    start(qtbot, step, visit)
    patient_time.wait(qtbot, seconds)
    stop(qtbot, step, visit)


def folds_sensors(step: WalkingStep) -> bool:
    return step.folds_sensors


def takes_clicker(step: WalkingStep) -> bool:
    return step.takes_clicker


def states(step: WalkingStep) -> list[tuple[str, str, WalkState]]:
    return [(row.letter, row.label, row.state) for row in step.page.rows]


def test_space_starts_and_stops_and_keeps(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    calibrate(qtbot, visit)
    primary = step.bar().primary
    assert primary is not None
    assert (primary.text, primary.is_requested) == ("Start walk", True)
    start(qtbot, step, visit)
    recording = step.bar().recording
    assert recording is not None
    assert recording.title == "Recording A Alignment A"
    assert step.note == "Recording A Alignment A"
    assert step.cannot_leave
    qtbot.waitUntil(lambda: max(step.page.live.strides.values(), default=0) >= 5)
    qtbot.waitUntil(lambda: set(step.page.live.knees) == set(step.page.live.ankles))
    assert step.page.live.cadence_steps_min > 60
    stop(qtbot, step, visit)
    assert states(step) == [("A", "Alignment A", WalkState.ASKING)]
    assert step.page.bench.isVisible()  # in the place of the question: the leg is prosthetic
    assert folds_sensors(step)
    assert not step.cannot_leave
    bar = step.bar()
    assert bar.primary is not None
    assert (bar.primary.text, [one.text for one in bar.others]) == ("Include A", ["Repeat A"])
    for _ in range(2):
        QTest.keyClick(step.page.bench.alignments.fields.steppers["turns"], Qt.Key.Key_Plus)
    assert [one.text for one in step.bar().others] == ["Walk with B"]
    with qtbot.waitSignal(visit.recordings.begun):
        step.on_intent(RUN)  # keeps it, and starts the next
    assert states(step) == [("A", "Alignment A", WalkState.KEPT), ("B", "Alignment B", WalkState.RECORDING)]
    assert not folds_sensors(step)
    stop(qtbot, step, visit)
    turned = AlignmentChange("Alignment A", (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, turns=0.25),))
    assert [one.stored.details.alignment for one in visit.recordings.walks] == [None, turned]
    assert not bar_states_change(step)
    assert next_label(step) == "Next: Alignment C"
    back = next(one for one in step.bar().others if one.text == "Return to A")
    assert back.key == "R"
    press(step, "Return to A")
    assert next_label(step) == "Next: Alignment A again"
    assert [one.text for one in step.bar().others] == ["Walk with A2"]
    assert step.bench.next_walk()[1] == AlignmentChange(
        "Alignment B", (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, turns=-0.25),), returns_to="Alignment A"
    )
    step.undo()
    assert next_label(step) == "Next: Alignment C"
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def next_label(step: WalkingStep) -> str:
    """What the bar beside the list of walks states of the next walk."""
    step.bench.is_requested = False
    note = step.bar().note
    step.bench.is_requested = True
    return note


def test_what_the_patient_reached_is_shown_and_kept_with_the_walk(
    qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime
) -> None:
    calibrate(qtbot, visit)
    assert step.on_intent(Intent(KeyAction.PATIENT_SCREEN))
    controls = step.page.patient_controls
    assert controls.isVisible()
    knee, *_ = controls.measure.segments
    assert not knee.isEnabled()  # nobody has seen its sensors rest, so its angle drifts
    assert step.on_intent(Intent(KeyAction.PATIENT_SCREEN))
    assert not controls.isVisible()
    step.leave()
    visit.rests = rests_of(visit.recordings.every)
    step.enter()
    assert step.on_intent(Intent(KeyAction.PATIENT_SCREEN))
    assert knee.isEnabled()
    (window,) = [one for one in QApplication.topLevelWidgets() if isinstance(one, PatientWindow) and one.isVisible()]
    required = Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 45)
    controls.target_set.emit(required)
    walk(qtbot, step, visit, patient_time, 11.0)  # the replay's walk goes on beyond
    assert len(window.view.last) >= 3
    shown = window.view.last
    assert all(50 <= peak <= 75 for peak in shown[-3:])  # its pose jumped as the walk was asked for
    qtbot.waitUntil(lambda: visit.recordings.walks[0].details.note != "")
    (tally,) = tallies_of(visit.recordings.walks[0].details.note)
    assert tally.target == required
    assert tally.strides >= len(shown)
    assert tally.strides >= tally.reached >= max(3, sum(peak >= required.value for peak in shown))
    assert step.on_intent(Intent(KeyAction.LEAVE))
    assert not controls.isVisible()
    walk(qtbot, step, visit, patient_time, 4.0)  # without the screen: nothing is noted
    assert visit.recordings.walks[1].details.note == ""
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def bar_states_change(step: WalkingStep) -> bool:
    return any(one.text.startswith("Walk with") for one in step.bar().others)


def test_five_strides_find_the_ankles_axes_again(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    calibrate(qtbot, visit)
    start(qtbot, step, visit)
    qtbot.waitUntil(lambda: bool(step.page.live.ankles))
    assert any(ankle.is_provisional for ankle in step.page.live.ankles.values())
    qtbot.waitUntil(lambda: not any(ankle.is_provisional for ankle in step.page.live.ankles.values()))
    looked_at = visit.evaluation.session
    assert looked_at is not None
    assert looked_at.recordings[-1].condition == "Alignment A"  # a part of it is at the bench under its own name
    stop(qtbot, step, visit)
    results = ResultsStep(visit)
    qtbot.addWidget(results.page)
    results.enter()  # what was evaluated last holds a part of this walk only
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def test_a_walk_is_discarded_and_comes_back(
    qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime
) -> None:
    walk(qtbot, step, visit, patient_time, 4.0)
    assert step.page.received.rows == ()  # nothing is stated of samples that all came
    assert step.page.received.isHidden()
    with qtbot.waitSignal(step.offered) as offered:
        step.on_intent(Intent(KeyAction.DISCARD))
    assert offered.args == ["A Alignment A excluded."]
    qtbot.waitUntil(lambda: not visit.recordings.walks[0].details.is_kept)
    assert states(step) == [("", "Alignment A", WalkState.DISCARDED)]
    step.undo()
    qtbot.waitUntil(lambda: visit.recordings.walks[0].details.is_kept)
    assert states(step) == [("A", "Alignment A", WalkState.KEPT)]
    assert step.bar().primary is not None
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


@pytest.mark.parametrize("action", [KeyAction.IDENTIFY, KeyAction.KEEP])
def test_i_includes_the_walk_just_stopped_as_k_does_and_nothing_else(
    qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime, action: KeyAction
) -> None:
    assert not step.on_intent(Intent(action))
    walk(qtbot, step, visit, patient_time, 2.0)
    assert states(step) == [("A", "Alignment A", WalkState.ASKING)]
    assert step.on_intent(Intent(action))
    qtbot.waitUntil(lambda: states(step) == [("A", "Alignment A", WalkState.KEPT)])
    assert not step.on_intent(Intent(action))
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def test_space_pressed_twice_at_the_end_keeps_what_the_patient_reached(
    qtbot: QtBot, step: WalkingStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    tally = TargetTally(Target(TargetMeasure.CADENCE, None, 100), reached=3, strides=5)
    reached = [(tally,)]
    assert step.feedback is not None
    monkeypatch.setattr(step.feedback, "end_walk", lambda: reached.pop() if reached else ())
    start(qtbot, step, visit)
    with qtbot.waitSignal(visit.recordings.ended):
        step.on_intent(RUN)
        assert step.cannot_leave == "The walk is being loaded."
        step.on_intent(RUN)
    qtbot.waitUntil(lambda: tallies_of(visit.recordings.walks[0].details.note) == (tally,))
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def test_a_walk_that_is_refused_ends_its_test_and_leaves_what_was_reported_of_the_prosthesis(
    qtbot: QtBot, step: WalkingStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_arguments: object, **_more: object) -> None:
        raise LibraryError("A recording needs 620 MB of free disk", "Delete files")

    monkeypatch.setattr(Recorder, "begin", refuse)
    step.page.bench.alignments.fields.steppers["turns"].stepped.emit(1)
    step.on_intent(Intent(KeyAction.NEXT_TEST))
    with qtbot.waitSignal(visit.recordings.refused):
        step.on_intent(RUN)
        assert takes_clicker(step)
    assert not takes_clicker(step)
    assert step.bench.entry.parts
    assert step.bar().quiet


def test_that_clocks_have_drifted_apart_is_shown_when_it_comes(
    qtbot: QtBot, step: WalkingStep, monkeypatch: pytest.MonkeyPatch
) -> None:
    qtbot.wait(100)
    with qtbot.waitSignal(step.changed):
        monkeypatch.setattr(WornSensors, "are_loose", True)


def test_digits_choose_what_the_next_walk_is_called(
    qtbot: QtBot, step: WalkingStep, visit: Visit, patient_time: PatientTime
) -> None:
    assert step.on_intent(Intent(KeyAction.LABEL, 4))
    walk(qtbot, step, visit, patient_time, 2.0)
    assert visit.recordings.walks[0].details.condition == "Barefoot"
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def test_a_silent_sensor_is_stated_and_so_is_its_return(
    qtbot: QtBot, step: WalkingStep, visit: Visit, source: ReplaySource
) -> None:
    start(qtbot, step, visit)
    source.silence("DEMO-right_foot")
    qtbot.waitUntil(lambda: "R foot: no signal for" in step.page.notice.text)
    assert "right ankle, right gait phases" in step.page.notice.text
    source.wake("DEMO-right_foot")
    qtbot.waitUntil(lambda: "R foot: signal back after" in step.page.notice.text)
    stop(qtbot, step, visit)
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def test_a_lossy_radio_is_stated_with_counts_while_and_after_it_is_walked(
    qtbot: QtBot, step: WalkingStep, visit: Visit, source: ReplaySource, patient_time: PatientTime
) -> None:
    start(qtbot, step, visit)
    patient_time.wait(qtbot, 4.0)
    assert "samples received" not in step.page.notice.text
    source.silence("DEMO-right_foot")
    patient_time.wait(qtbot, 1.5)
    source.wake("DEMO-right_foot")
    patient_time.wait(qtbot, 3.0)
    qtbot.waitUntil(lambda: "samples received." in step.page.notice.text)
    assert step.page.notice.text.startswith("R foot: ")
    assert step.page.received.isHidden()
    stop(qtbot, step, visit)
    (row,) = step.page.received.rows
    assert row.site is Site.RIGHT_FOOT
    # what a reader has not passed on yet when the sensor falls silent or wakes belongs to the silence or not
    assert row.counts.longest_gap_s == pytest.approx(1.5, abs=2 * BEHIND_S)
    assert row.counts.expected - row.counts.received == pytest.approx(100.0 * row.counts.longest_gap_s, abs=3)
    assert not step.page.received.isHidden()
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def test_sensors_strapped_again_go_back_to_standing(qtbot: QtBot, step: WalkingStep, visit: Visit) -> None:
    with qtbot.waitSignal(step.jumped) as jumped:
        step.page.walks.restrapped.click()
    assert jumped.args == [StepId.STAND_STILL]
    assert visit.recordings.is_restrapped
    assert step.cannot_enter
    assert not step.on_intent(Intent(KeyAction.KEEP))


def test_who_left_before_the_sensors_were_live_again_is_not_fetched_back(
    qtbot: QtBot, step: WalkingStep, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(WornSensors, "are_in_memory", True)
    step.page.walks.restrapped.click()
    step.leave()
    with qtbot.assertNotEmitted(step.jumped):
        step.memory.lives.emit()  # as when walks are sent live on the sensors' step


def test_while_no_sensor_is_received_the_charts_go_on_with_a_gap(
    qtbot: QtBot, step: WalkingStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    press(step)
    qtbot.waitUntil(lambda: visit.recordings.is_recording)
    acquisition, shown = visit.sensors.acquisition, list[WalkingReadout]()
    assert acquisition is not None
    monkeypatch.setattr(step.page, "show_view", shown.append)
    monkeypatch.setattr(acquisition, "silent_s", lambda: dict.fromkeys(acquisition.sensors, 4.0))
    qtbot.waitUntil(lambda: len(shown) > 3 and set(shown[-1].missing) == set(visit.sensors.site_of.values()))
    silent_since_s = shown[-1].now_s
    qtbot.waitUntil(lambda: shown[-1].now_s > silent_since_s)
    assert all(lane.silent_s[-1][1] is None for lane in shown[-1].lanes.values())
    stop(qtbot, step, visit)
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy)


def test_while_no_sensor_is_received_no_walk_is_started(
    qtbot: QtBot, step: WalkingStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    primary = step.bar().primary
    assert primary is not None
    assert (primary.text, primary.is_enabled) == ("Start walk", True)
    acquisition = visit.sensors.acquisition
    assert acquisition is not None
    silent_s = dict.fromkeys(acquisition.sensors, 4.0)
    monkeypatch.setattr(acquisition, "silent_s", lambda: silent_s)
    with qtbot.waitSignal(step.changed):
        pass
    primary = step.bar().primary
    assert primary is not None
    assert not primary.is_enabled
    assert step.bar().note.startswith("No signal from any sensor. Switch the sensors on, or move the receiver closer")
    silent_s[acquisition.sensors[0]] = 0.0  # one is received
    with qtbot.waitSignal(step.changed):
        pass
    primary = step.bar().primary
    assert primary is not None
    assert primary.is_enabled


def test_without_sensors_it_cannot_be_entered(visit: Visit) -> None:
    step = WalkingStep(visit)
    assert step.cannot_enter == "Enter the patient's code first."
    assert Joint.LEFT_KNEE not in visit.sensors.joints

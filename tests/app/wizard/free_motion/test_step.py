"""The step of free motion on a simulated patient: gauges close, it ends by itself, and one leg can be repeated."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
from pytestqt.qtbot import QtBot

from app.storage.stored import Limits
from app.system import sounds
from app.system.sounds import Sound
from app.widgets.gauge import GaugeState
from app.widgets.rail_row import StepState
from app.wizard.free_motion.estimator import FreeMotionView
from app.wizard.free_motion.page import FreeMotionPage
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.keys import Intent, KeyAction
from app.wizard.visit import Visit
from app.wizard.worn_corrections import opposite
from app.workers.library_controller import LibraryController
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.live.free_motion import FreeMotionState
from core.prosthesis import AmputationLevel, FootKind, Prosthesis
from core.session import RecordingKind
from devices.simulation.replay import ReplaySource
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.free_motion.test_hints import motion, state
from tests.app.wizard.free_motion.test_side_question import chains
from tests.app.wizard.patient_time import PatientTime
from tests.app.wizard.pressing import press

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

SPACE = Intent(KeyAction.RUN)
WORN = {f"DEMO-{site}": site for site in LEG_SITES}
CLOSED = {joint: state(0.8, 6.0, None, is_closed=True) for joint in LEG_JOINTS}
SURE = {joint: state(0.4, 4.0, None, is_closed=True) for joint in LEG_JOINTS}
LOOSE = replace(SURE[Joint.LEFT_KNEE], axis_sd_with_floor_rad=math.radians(6.0))


@pytest.fixture
def step(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site], patient_time: PatientTime, monkeypatch: pytest.MonkeyPatch
) -> Iterator[FreeMotionStep]:
    monkeypatch.setattr(visit, "evaluate", lambda: None)  # a second each, and tried elsewhere
    begin(qtbot, visit, worn)
    patient_time.is_held = lambda: visit.recordings.is_recording and not visit.recordings.has_begun
    step = FreeMotionStep(visit)
    qtbot.addWidget(step.page)
    step.page.show()
    yield step
    step.leave()
    qtbot.waitUntil(lambda: not visit.recordings.is_recording)
    visit.evaluation.finish()


def ticks(qtbot: QtBot, step: FreeMotionStep, until: Callable[[], bool]) -> None:
    def reached() -> bool:
        step.tick()
        return until()

    qtbot.waitUntil(reached)


def states(page: FreeMotionPage) -> set[GaugeState]:
    return {gauge.face.state for gauge in page.gauges.values()}


def knows(step: FreeMotionStep) -> bool:
    """Whether every gauge has a figure."""
    centres = [gauge.face.centre for gauge in step.page.gauges.values()]
    return all(centre is not None and centre.share > 0 for centre in centres)


def enter(qtbot: QtBot, step: FreeMotionStep) -> None:
    """Until every gauge has a figure."""
    step.enter()
    ticks(qtbot, step, lambda: knows(step))


def test_it_records_at_once_and_goes_on_by_itself_when_all_gauges_are_closed(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    step.enter()
    assert step.page.band.hint.sentence == "Move either leg"
    ticks(qtbot, step, lambda: knows(step))
    show_message(step, FreeMotionState(CLOSED))
    with qtbot.waitSignal(step.done):
        ticks(qtbot, step, lambda: states(step.page) == {GaugeState.ENOUGH, GaugeState.CENTRE})
        verb = step.bar().primary
        assert verb is not None
        assert (verb.text, verb.is_requested) == ("Continue to walking", True)
    moved = visit.recordings.free_motion
    assert moved is not None
    assert moved.read_back is not None
    assert set(moved.read_back.imu) == set(LEG_SITES)
    assert (step.state, step.note) == (StepState.DONE, "enough movement")


def test_a_plateau_is_stated_and_left_to_the_therapist(qtbot: QtBot, step: FreeMotionStep, visit: Visit) -> None:
    step.enter()
    qtbot.waitUntil(lambda: visit.recordings.is_recording)
    ticks(qtbot, step, lambda: step._estimator is not None)
    show_message(step, FreeMotionState(CLOSED | {Joint.LEFT_KNEE: state(3.8, 6.0, is_plateau=True)}))
    ticks(qtbot, step, lambda: step.page.band.hint.sentence == "Uncertainty no longer falls")
    assert not step._settled.isActive()
    bar = step.bar()
    assert (
        bar.note == "Left knee: axis uncertainty 3.8°, limit 1.5°. If you continue, the report states this uncertainty."
    )
    assert [verb.text for verb in bar.quiet] == ["Repeat left"]


def test_stopping_early_states_its_price_and_goes_on(qtbot: QtBot, step: FreeMotionStep, visit: Visit) -> None:
    enter(qtbot, step)
    bar = step.bar()
    assert bar.primary is not None
    assert (bar.primary.text, bar.primary.is_requested) == ("Stop early", False)
    assert bar.note
    with qtbot.waitSignal(step.done):
        assert step.on_intent(SPACE)
    assert visit.recordings.free_motion is not None
    assert step.state is StepState.ATTENTION


def test_a_replay_that_has_ended_is_stated_and_is_recorded_again_from_its_beginning(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    step.enter()
    ticks(qtbot, step, lambda: step._estimator is not None)
    open_joints = motion({joint: state(3.8, 6.0) for joint in LEG_JOINTS})
    show_message(step, open_joints)
    ticks(qtbot, step, lambda: step.page.band.hint.sentence == "The replay has ended")
    bar = step.bar()
    assert bar.primary is not None
    assert bar.primary.text == "Continue to walking"
    assert [verb.text for verb in bar.others] == ["Record again"]
    assert (
        bar.note == "Left knee: axis uncertainty 3.8°, limit 1.5°. If you continue, the report states this uncertainty."
    )
    press(step, "Record again")
    ticks(qtbot, step, lambda: len(visit.recordings.every) == 1 and visit.recordings.has_begun)
    assert not visit.recordings.every[0].details.is_kept
    assert step.page.band.hint.sentence != "The replay has ended"
    ticks(qtbot, step, lambda: knows(step))


def test_a_replay_without_free_motion_states_so_and_what_did_not_move_does_not_count(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, source: ReplaySource
) -> None:
    source._by_kind[RecordingKind.FREE_MOTION] = []
    step.enter()
    ticks(
        qtbot, step, lambda: step.page.band.hint.sentence == "Replay has no free motion" and bool(step._motion.joints)
    )
    assert [verb.text for verb in step.bar().others] == []
    with qtbot.waitSignals([step.done, step.reported], order="strict"):
        press(step)
    qtbot.waitUntil(lambda: visit.recordings.free_motion is None)
    assert len(visit.recordings.every) == 1  # nothing is deleted
    assert step.state is StepState.TODO


def test_one_leg_begins_again_while_the_motion_goes_on(qtbot: QtBot, step: FreeMotionStep) -> None:
    enter(qtbot, step)
    assert step.on_intent(Intent(KeyAction.RIGHT_LEG))
    ticks(qtbot, step, lambda: step._estimator is not None and step._estimator.state.repeated is Side.RIGHT)
    ticks(qtbot, step, lambda: True)
    left, right = (step.page.gauges[joint].face for joint in (Joint.LEFT_KNEE, Joint.RIGHT_KNEE))
    ticks(qtbot, step, lambda: step.page.gauges[Joint.RIGHT_KNEE].face != right)
    assert step.page.gauges[Joint.LEFT_KNEE].face.centre == left.centre


def test_a_leg_that_is_repeated_later_leaves_the_other_legs_recording_in_force(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, patient_time: PatientTime
) -> None:
    enter(qtbot, step)
    with qtbot.waitSignal(step.done):
        press(step)
    left = step.page.gauges[Joint.LEFT_KNEE].face.centre
    press(step, "Repeat right")
    ticks(qtbot, step, lambda: visit.recordings.has_begun and knows(step))
    patient_time.wait(qtbot, 1.0)
    assert step.page.gauges[Joint.LEFT_KNEE].face.centre == left
    with qtbot.waitSignal(visit.recordings.ended):
        press(step)
    repeated = visit.recordings.free_motion
    assert repeated is not None
    assert repeated.read_back is not None
    assert {site.side for site in repeated.read_back.imu} == {Side.RIGHT}
    qtbot.waitUntil(lambda: visit.session is not None and set(visit.session.details.sensors) == set(LEG_SITES))


def test_leaving_before_a_leg_has_moved_is_stated_and_does_not_count(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    step.enter()
    qtbot.waitUntil(lambda: visit.recordings.is_recording)
    with qtbot.waitSignal(step.reported) as reported:
        step.leave()
    assert reported.args[0] == "Free motion was left before a leg moved, so it is not used."
    qtbot.waitUntil(lambda: visit.recordings.free_motion is None)
    assert len(visit.recordings.every) == 1  # nothing is deleted
    assert step.state is StepState.TODO


def test_leaving_before_its_end_keeps_what_has_moved_unless_another_is_in_force(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    enter(qtbot, step)
    with qtbot.waitSignal(step.reported) as reported:
        step.leave()
    assert reported.args[0].startswith("Free motion was left early. It is still used")
    kept, note = visit.recordings.free_motion, step.note
    assert kept is not None
    assert kept.read_back is not None
    assert len(kept.read_back.imu) == len(LEG_SITES)
    assert note.startswith("enough movement for")
    assert note.endswith("of 2 ankle centres")
    assert reported.args[0] == f"Free motion was left early. It is still used: {note}."
    step.enter()
    assert not visit.recordings.is_recording
    press(step, "Record again")
    ticks(qtbot, step, lambda: visit.recordings.is_recording and knows(step))
    with qtbot.waitSignal(step.reported) as reported:
        step.leave()
    assert reported.args[0] == "Free motion was left early. The previous one still applies."
    qtbot.waitUntil(lambda: not visit.recordings.every[1].details.is_kept)
    assert visit.recordings.free_motion is not None
    assert visit.recordings.free_motion.id == kept.id
    assert step.note == note


def test_a_knee_that_is_no_hinge_is_not_counted_as_enough_but_named(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, monkeypatch: pytest.MonkeyPatch
) -> None:
    received: list[Sound] = []
    monkeypatch.setattr(sounds, "play", received.append)
    visit.patient.edit(replace(visit.patient.details, prosthetic_side="left"))
    enter(qtbot, step)
    show_message(step, motion(SURE | {Joint.LEFT_KNEE: state(3.8, 9.0)}))
    left = step.page.gauges[Joint.LEFT_KNEE]
    ticks(qtbot, step, lambda: left.face.axis is not None and left.face.axis.figure == "3.8")
    assert Sound.READY in received
    received.clear()
    show_message(step, FreeMotionState(SURE | {Joint.LEFT_KNEE: LOOSE}))
    with qtbot.waitSignal(step.done):  # more motion would not make it one
        ticks(qtbot, step, lambda: GaugeState.LOOSE in states(step.page))
        assert step.page.band.hint.sentence == "Left knee: not a hinge"
    assert step.note == "enough movement for 1 of 2 knees, 2 of 2 ankle centres; left knee: not a hinge"
    assert step.state is StepState.ATTENTION
    assert Sound.READY not in received


def test_the_knee_above_a_transtibial_prosthesis_is_none_that_has_to_be_a_hinge(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    """Of the side alone it was required like a mechanical one, and then reported to be none."""
    below = {Side.LEFT: Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)}
    visit.patient.edit(replace(visit.patient.details, prosthetic_side="left", prostheses=below))
    step.enter()
    assert step.page.gauges[Joint.LEFT_ANKLE].face.note.startswith("Foot without ankle joint")
    left, right = step.page.gauges[Joint.LEFT_KNEE], step.page.gauges[Joint.RIGHT_KNEE]
    ticks(qtbot, step, lambda: left.face.centre is not None and left.face.centre.share > 0)
    closed = SURE.copy()
    del closed[Joint.LEFT_ANKLE]
    show_message(step, motion(closed | {Joint.LEFT_KNEE: state(3.8, 9.0)}))
    ticks(qtbot, step, lambda: left.face.axis is not None and left.face.axis.figure == "3.8")
    assert left.face.axis is not None
    assert right.face.axis is not None
    assert left.face.axis.required == right.face.axis.required == "1.5°"
    show_message(step, FreeMotionState(closed | {Joint.LEFT_KNEE: LOOSE}))
    with qtbot.waitSignal(step.done):
        ticks(qtbot, step, lambda: left.face.state is GaugeState.ENOUGH)
    assert step.note == "enough movement"


def test_a_free_motion_that_holds_is_not_recorded_again_unasked(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    record(qtbot, visit, RecordingKind.FREE_MOTION, 2.0)
    step.enter()
    assert not visit.recordings.is_recording
    assert step.page.band.hint.sentence == "Free motion recorded"
    with qtbot.waitSignal(step.done):
        press(step)


def test_a_missing_foot_sensor_and_a_foot_without_joint_have_no_gauge(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, worn: dict[str, Site]
) -> None:
    visit.sensors.assign_all({name: site for name, site in worn.items() if site is not Site.RIGHT_FOOT})
    visit.record.set_limits(Limits(without_ankle=frozenset({Side.LEFT})))
    step.enter()
    assert step.page.gauges[Joint.RIGHT_ANKLE].face.note == "No sensor on R foot: no right ankle angle."
    assert step.page.gauges[Joint.LEFT_ANKLE].face.note.startswith("Foot without ankle joint")
    ticks(qtbot, step, lambda: visit.recordings.is_recording and step.page.band.hint.sentence != "Move either leg")
    assert step.page.gauges[Joint.LEFT_ANKLE].face.state is GaugeState.ABSENT


def test_what_a_recording_before_it_reported_neither_ends_nor_counts_for_the_next(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    """While the library has not answered, and once it was stopped."""
    step.enter()
    ticks(qtbot, step, lambda: visit.recordings.has_begun)
    show_message(step, FreeMotionState(CLOSED))
    ticks(qtbot, step, lambda: step._settled.isActive())
    with qtbot.waitSignal(visit.recordings.ended):
        step.on_intent(SPACE)
    qtbot.waitUntil(lambda: not visit.recordings.is_recording)
    note = step.note
    step.on_intent(SPACE)  # another
    for _ in range(6):
        step.tick()  # the library has not answered
    assert not step._settled.isActive()
    assert not step._motion.joints
    ticks(qtbot, step, lambda: visit.recordings.has_begun)
    still = {joint: replace(state(9.0, 60.0), moved_s=0.0) for joint in LEG_JOINTS}
    show_message(step, FreeMotionState(still))
    ticks(qtbot, step, lambda: bool(step._motion.joints))
    step.on_intent(SPACE)
    for _ in range(6):
        step.tick()
    assert step.note == note  # no leg moved, so the one before it stays in force
    with qtbot.waitSignal(visit.recordings.ended):
        pass


def test_swapped_labels_change_places_and_what_was_recorded_is_corrected(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    enter(qtbot, step)
    assert visit.recordings.is_recording
    visit.sensors.doubt(swapped(Site.LEFT_THIGH, Site.LEFT_SHANK))
    press(step)
    assert visit.sensors.sensor_at[Site.LEFT_THIGH] == f"DEMO-{Site.LEFT_SHANK}"
    with qtbot.waitSignal(step.done):
        press(step)

    def is_corrected() -> bool:
        recording = visit.recordings.free_motion
        placement = recording.stored.placement if recording is not None else None
        return placement is not None and placement.sensors[Site.LEFT_THIGH].name == f"DEMO-{Site.LEFT_SHANK}"

    qtbot.waitUntil(is_corrected)


@pytest.mark.parametrize(
    "mixed",
    [
        {Site.LEFT_SHANK: Site.RIGHT_THIGH, Site.RIGHT_THIGH: Site.LEFT_SHANK},
        {Site.LEFT_THIGH: Site.LEFT_SHANK, Site.LEFT_SHANK: Site.LEFT_FOOT, Site.LEFT_FOOT: Site.LEFT_THIGH},
    ],
    ids=["two", "three"],
)
def test_sensors_that_are_mixed_up_are_detected_and_one_key_puts_them_right(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, worn: dict[str, Site], mixed: dict[Site, Site]
) -> None:
    visit.sensors.assign_all({name: mixed.get(site, site) for name, site in worn.items()})
    step.enter()
    ticks(qtbot, step, lambda: step.is_in_doubt)
    press(step)
    assert visit.sensors.site_of == worn
    assert visit.recordings.is_recording
    ticks(qtbot, step, lambda: knows(step))
    with qtbot.waitSignal(step.done):
        press(step)
    assert not step.is_in_doubt


def test_labels_swapped_in_a_visit_that_is_closed_amid_the_motion_are_in_the_library(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, controller: LibraryController
) -> None:
    enter(qtbot, step)
    assert visit.recordings.is_recording
    visit.sensors.doubt(swapped(Site.LEFT_THIGH, Site.LEFT_SHANK))
    press(step)
    with qtbot.waitSignal(visit.recordings.ended):
        visit.close()
    qtbot.waitUntil(lambda: visit.is_idle)
    assert visit.session is not None
    assert controller.state is not None
    (stored,) = controller.state.library.library.sessions.get(visit.session.id).recordings
    assert stored.placement is not None
    assert stored.placement.sensors[Site.LEFT_THIGH].name == f"DEMO-{Site.LEFT_SHANK}"


def test_sensors_that_nobody_placed_are_placed_once_the_motion_shows(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, worn: dict[str, Site]
) -> None:
    visit.sensors.leave_to_motion(True)
    step.enter()
    ticks(qtbot, step, lambda: visit.recordings.has_begun)  # from then on the motion is looked at
    ticks(qtbot, step, lambda: step.page.band.hint.sentence == "Move the left leg first")
    assert states(step.page) == {GaugeState.OPEN}
    show_message(step)
    ticks(qtbot, step, lambda: visit.sensors.site_of == worn)


def test_two_legs_that_begin_together_are_reported_apart_by_asking(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit
) -> None:
    visit.sensors.leave_to_motion(True)
    step.enter()
    ticks(qtbot, step, lambda: step._unplaced is not None)
    shanks = [f"DEMO-{Site.LEFT_SHANK}", f"DEMO-{Site.RIGHT_SHANK}"]
    together = chains(*shanks)
    question, unplaced = step.page.question, step._unplaced
    assert unplaced is not None
    step.ask_for_side(together)
    assert question.notice.text == f"Both legs moved at once. Which leg has {shanks[0]} on the shank?"
    step.page.question.answered.emit(1)
    assert step.question.reported is None  # the library knows it of the left leg
    assert question.notice.text == f"{shanks[0]} was on the left leg before. Which leg is it on now?"
    step.page.question.answered.emit(1)
    assert unplaced._answer == (shanks[0], Side.RIGHT)
    for _ in range(3):
        step.ask_for_side(together)  # the estimator has not taken it yet
    assert question.notice.text == f"{shanks[0]} is now assigned to the right leg."
    assert [button.text() for button in question.buttons if not button.isHidden()] == ["Undo"]
    step.page.question.answered.emit(1)
    assert step.question.reported is None
    assert "Both legs moved at once" in question.notice.text
    step.page.question.answered.emit(0)
    assert question.notice.text == f"{shanks[0]} is now assigned to the left leg."


def test_a_leg_that_was_named_wrongly_changes_places_when_that_is_undone(
    qtbot: QtBot, step: FreeMotionStep, visit: Visit, worn: dict[str, Site]
) -> None:
    visit.sensors.leave_to_motion(True)
    step.enter()
    ticks(qtbot, step, lambda: step._unplaced is not None)
    shank = f"DEMO-{Site.LEFT_SHANK}"
    step.ask_for_side(chains(shank, f"DEMO-{Site.RIGHT_SHANK}"))
    for _ in range(2):  # the library knows it of the left leg
        step.page.question.answered.emit(1)
    visit.sensors.assign_all({sensor: opposite(site) for sensor, site in worn.items()})  # as the motion then reports
    for number in (1, 0):
        step.page.question.answered.emit(number)
    assert visit.sensors.site_of == worn
    assert step.page.question.notice.text == f"{shank} is now assigned to the left leg."
    step._stop()
    ticks(qtbot, step, step.page.question.isHidden)


def swapped(one: Site, other: Site) -> dict[Site, Site]:
    return {one: other, other: one}


def show_message(step: FreeMotionStep, motion: FreeMotionState | None = None) -> None:
    """Let the step hear this of the motion: on a busy machine the estimator itself takes its time."""
    step._estimator = Reported(motion)  # type: ignore[assignment]  # as far as the step asks it


class Reported:
    """An estimator that knows everything already."""

    def __init__(self, motion: FreeMotionState | None = None) -> None:
        self.state = FreeMotionView(motion or FreeMotionState(), site_of=WORN)

"""Walks in the sensors' memories: made ready, recorded, fetched now or later, and what a lost link leaves to do."""

from collections.abc import Callable, Iterator

import pytest
from pytestqt.qtbot import QtBot

from app.editing.session_recording import SessionRecording
from app.widgets.action_bar import BarState
from app.wizard.keys import Intent, KeyAction
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.walking.walk_list import WalkState
from app.wizard.worn_sensors import SourceChoice
from core.timed.protocols import TimedProtocol
from tests.app.wizard.emulated_dots import dot_choice, open_dots
from tests.app.wizard.pressing import press
from tests.devices.dot.fast_radio import FastRadio

pytestmark = pytest.mark.endurance  # radios and memories take their time

RUN = Intent(KeyAction.RUN)
FOR_EVER_NS = 10**15


@pytest.fixture
def choice(radio: FastRadio) -> SourceChoice:
    return dot_choice(radio)


@pytest.fixture
def walking(qtbot: QtBot, visit: Visit, step: SensorsStep) -> Iterator[Callable[[int], WalkingStep]]:
    """Open the sensors, their walks recorded at so many Hz, and enter the step."""
    entered: list[WalkingStep] = []

    def enter(record_hz: int) -> WalkingStep:
        open_dots(qtbot, visit, step, record_hz)
        with qtbot.waitSignal(visit.changed):
            step.leave()
        one = WalkingStep(visit)
        qtbot.addWidget(one.page)
        one.page.resize(1064, 672)
        one.page.show()
        one.enter()
        entered.append(one)
        return one

    yield enter
    for one in entered:
        one.leave()
        one.deleteLater()


def texts(bar: BarState) -> tuple[str, list[str]]:
    return bar.primary.text if bar.primary is not None else "", [one.text for one in (*bar.others, *bar.quiet)]


def make_ready(qtbot: QtBot, visit: Visit, step: WalkingStep) -> None:
    press(step)
    assert visit.sensors.sync.is_running
    qtbot.waitUntil(lambda: visit.sensors.are_ready_for_walks and visit.sensors.sync.is_idle)


def walk(qtbot: QtBot, visit: Visit, step: WalkingStep) -> None:
    """Start a walk and stop it."""
    assert step.on_intent(RUN)
    qtbot.waitUntil(lambda: visit.recordings.has_begun)
    qtbot.wait(60)
    step.on_intent(RUN)


def whole_walk(visit: Visit, radio: FastRadio) -> SessionRecording:
    """The only walk, with every sample that the sensors have stored."""
    (fetched,) = visit.recordings.walks
    assert fetched.read_back is not None
    stored = [len(dot.memory.files[0].ticks) for dot in radio.dots]
    assert [len(block) for block in fetched.read_back.imu.values()] == stored
    return fetched


def walk_out_of_reach(qtbot: QtBot, visit: Visit, radio: FastRadio, step: WalkingStep) -> None:
    """A walk of which the second sensor sends a part, and is then out of reach."""
    radio.dots[1].faults.unreachable_after_drop_s = 1e6
    radio.dots[1].faults.drops_export_after = [20]
    walk(qtbot, visit, step)
    qtbot.waitUntil(lambda: visit.recordings.fetches.failure[0] != "")


def test_a_walk_in_memories_is_made_ready_recorded_and_fetched(
    qtbot: QtBot, visit: Visit, radio: FastRadio, walking: Callable[[int], WalkingStep]
) -> None:
    step = walking(120)
    assert texts(step.bar()) == ("Prepare the sensors", ["Record walks live", "Patient screen"])
    assert step.page.memory.shown.title == "Walks are recorded in the sensors"
    assert step.page.memory.isVisible()
    step.on_intent(RUN)
    assert not visit.recordings.is_recording, "they are not ready"
    make_ready(qtbot, visit, step)
    assert texts(step.bar())[0] == "Start walk"
    assert step.page.memory.isHidden()
    assert step.cannot_leave == ""
    assert "First set them to send data live, on the Sensors step" in visit.cannot_calibrate
    step.on_intent(RUN)
    qtbot.waitUntil(lambda: visit.recordings.has_begun)
    assert step.page.memory.shown.title == "The sensors are recording to memory"
    assert step.page.figures.isHidden()
    recording = step.bar().recording
    assert recording is not None
    assert "Stored in the sensors." in recording.note
    qtbot.wait(60)
    step.on_intent(RUN)
    assert step.bar().note == "The walk is being fetched."
    assert "A walk is being fetched" in step.cannot_leave
    assert step.note == "being fetched"
    assert [row.state for row in step.page.rows] == [WalkState.IN_SENSORS]
    qtbot.waitUntil(lambda: len(visit.recordings.walks) == 1)
    fetched = whole_walk(visit, radio)
    assert fetched.lacks == ()
    assert not any(dot.memory.cut_recordings for dot in radio.dots)
    assert step.page.memory.isHidden()
    assert step.cannot_leave == ""
    step.memory.go_live()
    qtbot.waitUntil(lambda: not visit.sensors.are_in_memory and visit.sensors.sync.is_idle)
    with qtbot.waitSignal(step.done):
        press(step, "Results")


def test_a_walk_may_be_fetched_later_and_a_lost_sensor_is_named_and_tried_again(
    qtbot: QtBot, visit: Visit, radio: FastRadio, walking: Callable[[int], WalkingStep]
) -> None:
    step = walking(120)
    make_ready(qtbot, visit, step)
    walk_out_of_reach(qtbot, visit, radio, step)
    assert step.page.memory.shown.what == "DOT 0002 is out of range."
    assert texts(step.bar())[:1] == ("Fetch again",)
    press(step, "Fetch later")
    assert texts(step.bar()) == ("Start walk", ["Fetch 1 walk", "Patient screen"])
    assert step.page.memory.isHidden()
    assert [one.name for one in visit.recordings.in_sensors] == ["walk 1"]
    radio.dots[1].faults.unreachable_until_ns = 0
    press(step, "Fetch 1 walk")
    qtbot.waitUntil(lambda: len(visit.recordings.walks) == 1)
    assert "Fetch 1 walk" not in texts(step.bar())[1]
    whole_walk(visit, radio)


def test_a_walk_that_is_fetched_later_holds_up_no_live_one_and_is_before_it(
    qtbot: QtBot, visit: Visit, walking: Callable[[int], WalkingStep]
) -> None:
    step = walking(120)
    make_ready(qtbot, visit, step)
    walk(qtbot, visit, step)
    step.page.memory.stop_pressed.emit()
    qtbot.waitUntil(lambda: visit.recordings.fetches.is_idle)
    step.memory.send_live()
    qtbot.waitUntil(lambda: not visit.sensors.are_in_memory and visit.sensors.sync.is_idle)
    qtbot.waitUntil(lambda: not visit.sensors.are_silent)
    walk(qtbot, visit, step)
    qtbot.waitUntil(lambda: [one.details.name for one in visit.recordings.walks] == ["walk 2"])
    assert not visit.recordings.is_recording
    assert texts(step.bar())[1] == ["Fetch 1 walk", "Patient screen"]
    press(step, "Fetch 1 walk")
    qtbot.waitUntil(lambda: len(visit.recordings.walks) == 2)
    assert [one.details.name for one in visit.recordings.walks] == ["walk 1", "walk 2"]


def test_a_visit_that_is_left_with_a_walk_in_the_sensors_ends(
    qtbot: QtBot, visit: Visit, radio: FastRadio, walking: Callable[[int], WalkingStep]
) -> None:
    step = walking(120)
    make_ready(qtbot, visit, step)
    walk_out_of_reach(qtbot, visit, radio, step)
    press(step, "Fetch later")
    visit.close()
    qtbot.waitUntil(lambda: visit.is_idle)


def test_at_the_live_rate_they_are_ready_at_once_and_live_again_for_a_timed_test(
    qtbot: QtBot, visit: Visit, radio: FastRadio, walking: Callable[[int], WalkingStep]
) -> None:
    step = walking(60)
    qtbot.waitUntil(lambda: visit.sensors.are_ready_for_walks and visit.sensors.sync.is_idle)
    assert texts(step.bar()) == ("Start walk", ["Patient screen"])
    step.page.next.test.chosen.emit(TimedProtocol.UP_AND_GO.value)
    assert "Choose no test, or record walks live" in step.bar().note
    assert texts(step.bar()) == ("Start Timed Up and Go", ["Record walks live", "Patient screen"])
    step.on_intent(RUN)
    assert not visit.recordings.is_recording
    press(step, "Record walks live")
    qtbot.waitUntil(lambda: not visit.sensors.are_in_memory and visit.sensors.sync.is_idle)
    assert all(dot.is_streaming and dot.is_synchronised for dot in radio.dots)
    assert texts(step.bar()) == ("Start Timed Up and Go", ["Patient screen"])
    assert "Timed tests need" not in step.bar().note


def test_a_failure_before_walks_is_named_and_walks_may_be_sent_live_instead(
    qtbot: QtBot, visit: Visit, radio: FastRadio, walking: Callable[[int], WalkingStep]
) -> None:
    step = walking(120)
    radio.dots[1].faults.sync_results = [0x07] * 2
    press(step)
    qtbot.waitUntil(lambda: visit.sensors.sync.failure[0] != "" and visit.sensors.sync.is_idle)
    assert step.page.memory.shown.what == "Not synchronised: DOT 0002 (clock rate differs too much)."
    assert texts(step.bar()) == ("Try again", ["Record walks live", "Patient screen"])
    press(step, "Record walks live")
    qtbot.waitUntil(lambda: not visit.sensors.are_loose and visit.sensors.sync.is_idle)
    assert texts(step.bar())[0] == "Start walk"
    assert step.page.memory.isHidden()


def test_sensors_strapped_again_are_live_before_they_stand_still(
    qtbot: QtBot, visit: Visit, walking: Callable[[int], WalkingStep]
) -> None:
    step = walking(60)
    qtbot.waitUntil(lambda: visit.sensors.are_ready_for_walks and visit.sensors.sync.is_idle)
    assert visit.cannot_calibrate != ""
    with qtbot.waitSignal(step.jumped):
        step.page.walks.restrapped.click()
    assert visit.cannot_calibrate == ""

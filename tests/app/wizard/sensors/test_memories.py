"""What the sensors' memories hold: reported, fetched where it was left, erased once it was stated what is lost by
that."""

from dataclasses import replace
from datetime import datetime
from typing import Any

import pytest
from pytestqt.qtbot import QtBot

from app.acquisition import dot_memories
from app.acquisition.dot_memories import KnownRecording, known
from app.acquisition.memory_fetching import FETCHED
from app.storage.journal.decoding import DecodedJournal, decode
from app.storage.opened import OpenedLibrary
from app.wizard.keys import Intent, KeyAction
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from app.wizard.worn_sensors import SourceChoice
from app.workers.library_controller import LibraryController
from core.session import RecordingKind
from devices.dot.messages import start_recording
from devices.dot.samples import DRIVER
from devices.emulators.dot import EmulatedDot
from tests.app.wizard.emulated_dots import dot_choice, open_dots, rows_of
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press
from tests.devices.dot.fast_radio import FastRadio

SEPARATE_UTC_S = 1_700_000_000


@pytest.fixture
def choice(radio: FastRadio) -> SourceChoice:
    return dot_choice(radio)


@pytest.fixture
def opened(qtbot: QtBot, visit: Visit, step: SensorsStep) -> SensorsStep:
    """The step, its sensors open, worn and known to the library."""
    open_dots(qtbot, visit, step, 60)
    with qtbot.waitSignal(visit.changed):
        visit.place_sensors()
    return step


def left_by_itself(dot: EmulatedDot, utc_s: int = SEPARATE_UTC_S) -> None:
    """Let it record for a moment, as if by its maker's own program."""
    dot.is_streaming = False
    dot.write(0x7001, start_recording(utc_s).packed())


def reported_lines(step: SensorsStep) -> list[list[str]]:
    """What the list states, but for when."""
    return [[cell.words for cell in row.cells][1:] for row in rows_of(step.page.memories.list)]


def look(qtbot: QtBot, step: SensorsStep) -> None:
    press(step, "Sensor memory")
    wait(qtbot, step)


def wait(qtbot: QtBot, step: SensorsStep) -> None:
    assert step.memories.is_busy
    assert step.cannot_leave == "The sensors are being queried. Wait until they have answered, or cancel."
    qtbot.waitUntil(lambda: not step.memories.is_busy)
    assert step.cannot_leave == ""


def walk_in_memory(qtbot: QtBot, visit: Visit, *, is_fetched: bool) -> None:
    sensors, recordings = visit.sensors, visit.recordings
    assert sensors.acquisition is not None
    present(sensors.dots).make_ready_to_record()
    recordings.begin(sensors.acquisition, RecordingKind.WALKING, "Shoes")
    qtbot.waitUntil(lambda: recordings.has_begun)
    qtbot.wait(60)
    recordings.stop()
    if is_fetched:
        qtbot.waitUntil(lambda: len(recordings.walks) == 1)


@pytest.mark.endurance
def test_empty_memories_are_reported_and_live_comes_back(qtbot: QtBot, opened: SensorsStep, visit: Visit) -> None:
    assert [one.text for one in opened.bar().quiet] == ["Sensor memory"]
    look(qtbot, opened)
    assert opened.page.memories.isVisible()
    assert opened.page.memories.title == "The sensor memory is empty"
    assert visit.sensors.are_in_memory
    press(opened)
    qtbot.waitUntil(lambda: not visit.sensors.are_in_memory and visit.sensors.sync.is_idle)
    assert opened.page.memories.isHidden()
    assert present(visit.sensors.dots).are_one_at(60), "they were not synchronised anew"


def test_what_is_kept_is_erased_after_a_second_press(
    qtbot: QtBot, opened: SensorsStep, visit: Visit, radio: FastRadio
) -> None:
    walk_in_memory(qtbot, visit, is_fetched=True)
    look(qtbot, opened)
    assert reported_lines(opened) == [["2 sensors", "Saved: A Shoes."]]
    bar = opened.bar()
    assert present(bar.primary).text == "Back to the sensors"
    assert [other.text for other in bar.others] == ["Erase sensor memory"]
    assert bar.quiet == ()  # it is offered once
    press(opened, "Erase sensor memory")
    assert [len(dot.memory.files) for dot in radio.dots] == [1, 1]
    assert "recording in the sensor memory is saved completely in this library" in opened.page.memories.notice.text
    assert [other.text for other in opened.bar().others] == ["Erase now"]
    press(opened, "Erase now")
    wait(qtbot, opened)
    assert [len(dot.memory.files) for dot in radio.dots] == [0, 0]
    assert opened.page.memories.title == "The sensor memory is empty"
    assert opened.page.focusWidget() is opened.page.memories, "Enter would press another button"


def test_no_other_sensors_are_opened_while_these_are_asked(qtbot: QtBot, opened: SensorsStep, visit: Visit) -> None:
    press(opened, "Sensor memory")
    open_ones = visit.sensors.acquisition
    with qtbot.waitSignal(opened.reported) as reported:
        opened.page.source_chosen.emit(DRIVER)
    assert reported.args is not None
    assert "The sensors are being queried" in reported.args[0]
    assert not opened.on_intent(Intent(KeyAction.IDENTIFY)), "a light was lit of a sensor that is not in sight"
    wait(qtbot, opened)
    assert visit.sensors.acquisition is open_ones


@pytest.mark.endurance
def test_what_a_closed_visit_left_in_the_sensors_is_fetched_where_the_session_goes_on(
    qtbot: QtBot, opened: SensorsStep, visit: Visit, radio: FastRadio
) -> None:
    recordings, last = visit.recordings, radio.dots[1].faults
    last.drops_export_after, last.unreachable_after_drop_s = [20], 1e6
    walk_in_memory(qtbot, visit, is_fetched=False)
    qtbot.waitUntil(lambda: recordings.fetches.failure[0] != "")
    recordings.fetch_later()
    recordings.close()
    assert recordings.in_sensors == ()
    visit.read_again()  # as a session that is gone on with is read
    qtbot.waitUntil(lambda: len(recordings.walks) == 1)
    assert [walk.details.is_kept for walk in recordings.walks] == [False]
    last.unreachable_until_ns = 0
    look(qtbot, opened)
    assert reported_lines(opened) == [["2 sensors", "Not fetched: Shoes."]]
    bar = opened.bar()
    assert present(bar.primary).text == "Fetch walk"
    press(opened)
    wait(qtbot, opened)
    qtbot.waitUntil(lambda: len(recordings.walks) == 2)
    fetched = recordings.walks[1]
    assert fetched.details.condition == "Shoes"
    assert [len(block) for block in present(fetched.read_back).imu.values()] == [
        len(dot.memory.files[0].ticks) for dot in radio.dots
    ]
    assert reported_lines(opened) == [["2 sensors", "Saved: A Shoes."]]


def test_what_is_not_of_this_library_is_not_fetched_and_is_named_before_it_is_lost(
    qtbot: QtBot, opened: SensorsStep, visit: Visit, radio: FastRadio
) -> None:
    present(visit.sensors.dots).fall_silent()
    for dot in radio.dots:
        left_by_itself(dot)
    qtbot.wait(40)
    for dot in radio.dots:
        dot.write(0x7001, bytes.fromhex("010141bd"))
    look(qtbot, opened)
    assert reported_lines(opened) == [["2 sensors", "Not recorded with this library."]]
    bar = opened.bar()
    assert present(bar.primary).text == "Back to the sensors"
    press(opened, "Erase sensor memory")
    assert "1 recording is not saved in this library and would be lost." in opened.page.memories.notice.text
    assert [other.text for other in opened.bar().others] == ["Erase now, losing unsaved data"]
    assert [len(dot.memory.files) for dot in radio.dots] == [1, 1]
    press(opened, "Erase now, losing unsaved data")
    wait(qtbot, opened)
    assert [len(dot.memory.files) for dot in radio.dots] == [0, 0]


@pytest.mark.endurance
def test_a_sensor_that_is_out_of_reach_is_reported_and_asked_again(
    qtbot: QtBot, opened: SensorsStep, visit: Visit, radio: FastRadio
) -> None:
    radio.dots[1].faults.unreachable_until_ns = radio.now_ns() + 10**15
    radio.air.drop(radio.dots[1])
    look(qtbot, opened)
    assert "A sensor is out of range." in opened.page.memories.notice.text
    assert opened.page.memories.title == "The content of the sensor memory is unknown"
    bar = opened.bar()
    assert present(bar.primary).text == "Try again"
    assert [quiet.text for quiet in bar.quiet] == ["Back to the sensors"]
    radio.dots[1].faults.unreachable_until_ns = 0
    press(opened)
    wait(qtbot, opened)
    assert opened.page.memories.notice.isHidden()
    assert opened.page.memories.title == "The sensor memory is empty"


def test_a_recording_is_found_by_the_second_in_which_it_was_begun(
    qtbot: QtBot, opened: SensorsStep, visit: Visit, controller: LibraryController
) -> None:
    walk_in_memory(qtbot, visit, is_fetched=True)
    (walk,) = visit.recordings.walks
    utc_s = int(datetime.fromisoformat(walk.details.started).timestamp())
    found: list[KnownRecording] = []

    def ask(library: OpenedLibrary) -> None:
        found.extend(known(library, one) for one in (utc_s, utc_s + 1))

    controller.run(ask, None, None, visit)
    qtbot.waitUntil(lambda: len(found) == 2)
    assert [row.id for row in found[0].rows] == [walk.id]
    assert found[0].kept == frozenset({"DOT 0001", "DOT 0002"})
    assert found[0].lacking == frozenset()
    assert found[1].rows == ()
    assert found[1].kept == frozenset()


def test_what_lacked_when_it_was_fetched_first_and_was_had_then_is_not_lacking(
    qtbot: QtBot, opened: SensorsStep, visit: Visit, controller: LibraryController, monkeypatch: pytest.MonkeyPatch
) -> None:
    walk_in_memory(qtbot, visit, is_fetched=True)
    (walk,) = visit.recordings.walks
    utc_s = int(datetime.fromisoformat(walk.details.started).timestamp())

    def fetched_before(*journal: Any) -> DecodedJournal:
        """The same, with a first attempt that was not reported where the first sensor's file ends."""
        whole = decode(*journal)
        count = len(whole.sensors["DOT 0001"].block)
        first = replace(whole.marks[0], text=f'{FETCHED}{{"DOT 0001": [{utc_s}, {count}, false]}}')
        return replace(whole, marks=(first, *whole.marks))

    monkeypatch.setattr(dot_memories, "decode", fetched_before)
    found: list[KnownRecording] = []
    controller.run(lambda library: found.append(known(library, utc_s)), None, None, visit)
    qtbot.waitUntil(lambda: len(found) == 1)
    assert found[0].kept == frozenset({"DOT 0001", "DOT 0002"})
    assert found[0].lacking == frozenset()

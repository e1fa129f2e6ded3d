"""Movella DOTs before they are opened: asked, ticked, synchronised step by step, and what a failure leaves to do."""

import pytest
from pytestqt.qtbot import QtBot

from app.widgets.action_bar import BarState
from app.widgets.sensors_progress import LineState
from app.wizard.keys import Intent, KeyAction
from app.wizard.sensors.step import REPLAY, SensorsStep
from app.wizard.visit import Visit
from app.wizard.worn_sensors import SourceChoice
from devices.dot.messages import SyncResult, start_recording
from devices.dot.samples import DRIVER
from devices.emulators.dot_memory import RECORDING
from tests.app.wizard.emulated_dots import dot_choice, has_asked_all, rows_of
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press
from tests.devices.dot.fast_radio import FastRadio


@pytest.fixture
def choice(radio: FastRadio) -> SourceChoice:
    return dot_choice(radio)


@pytest.fixture
def asked(qtbot: QtBot, step: SensorsStep) -> SensorsStep:
    """The step, once both have informed of themselves."""
    step.page.source_chosen.emit(DRIVER)
    qtbot.waitUntil(lambda: has_asked_all(step))
    return step


def verb(bar: BarState) -> tuple[str, bool]:
    assert bar.primary is not None
    return bar.primary.text, bar.primary.is_enabled


def words_of(step: SensorsStep, row: int) -> list[str]:
    """What a line of the list states, from left to right."""
    return [cell.words for cell in rows_of(step.page.dots.list)[row].cells]


def test_each_that_was_received_shows_of_itself_and_is_worn_until_its_tick_is_turned(
    qtbot: QtBot, asked: SensorsStep
) -> None:
    form = asked.page.dots
    assert form.isVisible()
    qtbot.waitUntil(lambda: words_of(asked, 1)[3] == "2.4.0")
    assert words_of(asked, 0) == ["DOT 0001", "strong, \N{MINUS SIGN}50 dBm", "85 %", "2.4.0", ""]
    assert verb(asked.bar()) == ("Synchronise 2 sensors", True)
    form.turned.emit(1)
    assert verb(asked.bar()) == ("Use this sensor", True)
    form.turned.emit(0)
    assert verb(asked.bar())[1] is False
    assert asked.bar().note == "Tick the sensors that are worn."
    assert asked.cannot_leave == ""


def test_a_light_blinks_and_links_are_left_when_other_sources_are_required(
    qtbot: QtBot, asked: SensorsStep, radio: FastRadio, visit: Visit
) -> None:
    asked.page.dots.list.choose(1)
    assert asked.on_intent(Intent(KeyAction.IDENTIFY))
    qtbot.waitUntil(lambda: radio.dots[1].blinked == 1)
    assert radio.dots[0].blinked == 0
    asked.page.dots.back.click()
    assert not asked.setup.is_on
    assert asked.page.nothing.isVisible()
    qtbot.waitUntil(lambda: visit.sensors.is_idle)


def test_a_stored_session_may_be_required_instead(asked: SensorsStep) -> None:
    asked.page.source_chosen.emit(REPLAY)
    assert asked.page.stored.isVisible()
    assert not asked.setup.is_on
    asked.page.stored.back.click()
    assert asked.page.nothing.isVisible()


def test_synchronising_is_reported_step_by_step_and_gives_sensors_on_one_clock(
    qtbot: QtBot, asked: SensorsStep, visit: Visit
) -> None:
    shown = []
    visit.sensors.sync.changed.connect(lambda: shown.append(asked.page.progress.shown))
    with qtbot.waitSignal(visit.sensors.opened):
        press(asked)
        assert asked.bar() == BarState()
        assert "The sensors are being synchronised" in asked.cannot_leave
        qtbot.waitUntil(asked.page.progress.isVisible)
    assert any(one.sentence.startswith("The sensors are comparing their clocks") for one in shown)
    shares = [one.share for one in shown if one.share is not None and one.lines]
    assert shares == sorted(shares)
    assert asked.cannot_leave == ""
    dots = present(visit.sensors.dots)
    assert dots.are_one_at(60)
    assert [one.info.clock for one in visit.sensors.placed().values()] == []
    assert visit.is_simulated


@pytest.mark.endurance
def test_a_sensor_that_does_not_follow_is_named_and_can_be_left_out(
    qtbot: QtBot, asked: SensorsStep, visit: Visit, radio: FastRadio
) -> None:
    radio.dots[1].faults.sync_results = [SyncResult.FEW_SAMPLES] * 2
    press(asked)
    qtbot.waitUntil(lambda: not asked.setup.is_synchronising and bool(asked.bar().others))
    assert "Not synchronised: DOT 0002 (received too little from the others)." in asked.page.dots.notice.text
    assert words_of(asked, 1)[4] == "received too little from the others"
    assert words_of(asked, 0)[4] == ""
    assert verb(asked.bar()) == ("Try again", True)
    assert [other.text for other in asked.bar().others] == ["Go on without DOT 0002"]
    with qtbot.waitSignal(visit.sensors.opened):
        press(asked, "Go on without DOT 0002")
    assert present(visit.sensors.acquisition).sensors == ("DOT 0001",)


def test_whoever_cancels_comes_back_to_the_list_and_nobody_stays_synchronised(
    qtbot: QtBot, asked: SensorsStep, radio: FastRadio, visit: Visit
) -> None:
    press(asked)
    qtbot.waitUntil(lambda: asked.page.progress.shown.lines[0].state is not LineState.TO_DO)
    asked.page.progress.stop.click()
    assert asked.page.progress.shown.title == "The sensors are being released"
    qtbot.waitUntil(lambda: asked.page.dots.isVisible())
    assert asked.page.dots.notice.isHidden()
    assert not any(dot.is_synchronised for dot in radio.dots)
    assert visit.sensors.acquisition is None


def test_what_a_sensor_records_is_stopped_before_anything_is_set(
    qtbot: QtBot, step: SensorsStep, radio: FastRadio
) -> None:
    dot = radio.dots[0]
    dot.write(0x7001, start_recording(1_700_000_000).packed())
    step.page.source_chosen.emit(DRIVER)
    qtbot.waitUntil(lambda: words_of(step, 0)[4] == "recording to memory")
    assert verb(step.bar()) == ("Stop these recordings", True)
    assert "The recordings stay in the sensor memory" in step.bar().note
    press(step)
    qtbot.waitUntil(lambda: verb(step.bar())[0] == "Synchronise 2 sensors")
    assert dot.memory.state != RECORDING
    assert len(dot.memory.files) == 1


def test_one_that_does_not_answer_states_so_and_is_asked_until_it_does(
    qtbot: QtBot, step: SensorsStep, radio: FastRadio
) -> None:
    radio.dots[1].faults.unreachable_until_ns = radio.now_ns() + 10**15
    step.page.source_chosen.emit(DRIVER)
    qtbot.waitUntil(lambda: words_of(step, 1)[4] == "does not respond: press its button")
    radio.dots[1].faults.unreachable_until_ns = 0
    qtbot.waitUntil(lambda: words_of(step, 1)[4] == "")


def test_a_step_that_is_left_asks_nobody_any_more(qtbot: QtBot, asked: SensorsStep, visit: Visit) -> None:
    asked.leave()
    assert not asked.setup.is_on
    qtbot.waitUntil(lambda: visit.sensors.is_idle)

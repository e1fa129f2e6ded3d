"""The step of the sensors, on the simulated patient: received, shaken, placed, silent and back."""

import threading

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition
from app.widgets.rail_row import StepState
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.keys import Intent, KeyAction
from app.wizard.sensors.page import Way
from app.wizard.sensors.step import REMEMBERED_LOOKS, REPLAY, SensorsStep
from app.wizard.standing.step import StandStillStep
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.wizard import Wizard
from app.wizard.worn_sensors import SourceChoice
from core.body import Site
from core.session import Session
from devices.live import SourceRefusedError
from devices.simulation.replay import ReplaySource
from tests.app.wizard.present import present
from tests.app.wizard.pressing import press

TICKS_FOR_ROWS = 24  # of which three times rows and eight times traces are shown


@pytest.fixture
def source(simulated_session: Session) -> ReplaySource:
    """Slow enough for a shake of a second to be seen by the screen."""
    return ReplaySource(simulated_session, speed=4.0)


def open_source(qtbot: QtBot, visit: Visit, step: SensorsStep) -> None:
    with qtbot.waitSignal(visit.sensors.opened):
        step.page.nothing.buttons[0].click()
    qtbot.waitUntil(lambda: len(visit.sensors.status) == 6)
    tick(step)


def tick(step: SensorsStep) -> bool:
    """Let time pass for the step; False, so that a wait can begin with it."""
    for _ in range(TICKS_FOR_ROWS):
        step.tick()
    return False


def test_without_a_source_the_choices_stand_in_the_page(step: SensorsStep) -> None:
    assert step.page.nothing.isVisible()
    assert [button.text() for button in step.page.nothing.buttons] == ["Fast patient", "Replay of a stored session"]
    assert step.bar().primary is None
    assert step.state is StepState.TODO


def test_sensors_are_placed_by_keys_and_reported_to_the_library(
    qtbot: QtBot, visit: Visit, step: SensorsStep, worn: dict[str, Site]
) -> None:
    open_source(qtbot, visit, step)
    page = step.page
    assert set(page.list.rows) == set(worn)
    verb = present(step.bar().primary)
    assert not verb.is_enabled
    for sensor, site in worn.items():
        page.list.select(sensor)
        assert step.on_intent(Intent(KeyAction.LABEL, list(Site).index(site) + 1))
    assert visit.sensors.site_of == worn
    assert step.note == "6 of 6 assigned"
    assert step.state is StepState.DONE
    verb = present(step.bar().primary)
    assert verb.is_requested
    with qtbot.waitSignal(step.done):
        press(step)
    with qtbot.waitSignal(visit.changed):
        step.leave()
    assert visit.session is not None
    assert visit.session.placements[-1].site_of == worn
    count = len(visit.session.placements)
    step.enter()
    step.leave()
    qtbot.wait(50)
    assert len(visit.session.placements) == count, "what the library knows is not told twice"


def test_traces_show_what_the_sensors_turned(qtbot: QtBot, visit: Visit, step: SensorsStep) -> None:
    open_source(qtbot, visit, step)
    shank = list(visit.sensors.status)[1]
    shown: list[dict[str, np.ndarray]] = []
    step.page.show_traces = shown.append  # type: ignore[method-assign, assignment]  # what the page is shown
    qtbot.waitUntil(lambda: tick(step) or np.isfinite(shown[-1][shank]).sum() > 100)
    assert {len(values) for values in shown[-1].values()} == {250}


def test_a_shaken_sensor_takes_the_place_that_is_next(
    qtbot: QtBot, visit: Visit, step: SensorsStep, source: ReplaySource
) -> None:
    open_source(qtbot, visit, step)
    step.page.ways.segments[1].click()
    foot = list(visit.sensors.status)[5]
    source.shake(foot)
    qtbot.waitUntil(lambda: tick(step) or bool(visit.sensors.site_of))
    assert visit.sensors.site_of == {foot: Site.LEFT_THIGH}


def test_a_silent_sensor_is_asked_for_again_and_keeps_its_place(
    qtbot: QtBot, visit: Visit, step: SensorsStep, source: ReplaySource, worn: dict[str, Site]
) -> None:
    open_source(qtbot, visit, step)
    visit.sensors.assign_all(worn)
    foot = visit.sensors.sensor_at[Site.RIGHT_FOOT]
    source.silence(foot)
    qtbot.waitUntil(lambda: tick(step) or step.state is StepState.ATTENTION)
    bar = step.bar()
    assert present(bar.primary).text == "Reconnect R foot"
    assert [verb.text for verb in bar.others] == ["Go on without right ankle"]
    assert "R foot: no signal for" in step.page.notice.text
    source.wake(foot)
    with qtbot.waitSignal(visit.sensors.opened):
        press(step)
    assert visit.sensors.site_of == worn
    tick(step)
    assert not any(row.sensor.is_lossy for row in step.page.list.rows.values()), "what it lost while silent is past"


def test_left_to_the_motion_goes_on_without_places(qtbot: QtBot, visit: Visit, step: SensorsStep) -> None:
    open_source(qtbot, visit, step)
    step.page.ways.segments[2].click()
    assert step.note == "from free motion"
    assert step.state is StepState.DONE
    verb = present(step.bar().primary)
    assert verb.is_enabled
    assert step.page.place_selected(2)
    assert not visit.sensors.is_left_to_motion
    assert step.page.way is Way.DRAG


def test_the_set_up_of_the_last_visit_is_worn_at_once(
    qtbot: QtBot, visit: Visit, step: SensorsStep, worn: dict[str, Site]
) -> None:
    visit.placement_before = {**worn, "gone": Site.LEFT_FOOT}
    open_source(qtbot, visit, step)
    assert visit.sensors.site_of == worn


def remember(visit: Visit, step: SensorsStep, places: dict[str, Site]) -> None:
    """Enter the page with the last visit's set-up."""
    step.leave()
    visit.placement_before, visit.source_before = places, visit.known_choices[0].key
    step.enter()


def test_the_source_of_the_last_visit_opens_and_the_page_goes_on_once_all_its_sensors_are_received(
    qtbot: QtBot, visit: Visit, step: SensorsStep, worn: dict[str, Site]
) -> None:
    done: list[bool] = []
    step.done.connect(lambda: done.append(True))
    remember(visit, step, worn)

    def went_on() -> bool:
        tick(step)
        return bool(done)

    qtbot.waitUntil(went_on)
    assert visit.sensors.site_of == worn
    for _ in range(REMEMBERED_LOOKS):
        tick(step)
    assert done == [True]  # whoever comes back stays


def test_the_page_stays_where_a_sensor_of_the_last_visit_is_missing_or_another_set_up_is_worn(
    qtbot: QtBot, visit: Visit, step: SensorsStep, worn: dict[str, Site]
) -> None:
    remember(visit, step, {**worn, "gone": Site.PELVIS})
    qtbot.waitUntil(lambda: tick(step) or visit.sensors.acquisition is not None)
    with qtbot.assertNotEmitted(step.done):
        for _ in range(REMEMBERED_LOOKS):
            tick(step)
    visit.placement_before = {}
    with qtbot.assertNotEmitted(step.done):
        for _ in range(REMEMBERED_LOOKS):
            tick(step)


def test_without_the_last_visits_set_up_no_source_opens_by_itself(visit: Visit, step: SensorsStep) -> None:
    remember(visit, step, {})
    tick(step)
    assert not visit.sensors.is_searching
    assert visit.sensors.acquisition is None


def test_a_real_patient_is_offered_no_simulated_sensors(qtbot: QtBot, visit: Visit) -> None:
    visit.known_choices = ()
    step = SensorsStep(visit)
    qtbot.addWidget(step.page)
    assert step.cannot_enter == "Enter the patient's code first."
    step.enter()
    step.page.show()
    assert step.page.nothing.buttons == []
    step.leave()
    step.deleteLater()


def test_what_a_search_finds_while_the_page_is_in_sight_is_offered(
    qtbot: QtBot, visit: Visit, step: SensorsStep
) -> None:
    found = SourceChoice("ximu3", "x-io x-IMU3, 6 sensors", visit.known_choices[0].make)
    step.page.activateWindow()
    step.page.nothing.buttons[0].setFocus()
    visit.known_choices = (found, *visit.known_choices)  # as the thread of the search does it
    tick(step)
    assert [button.text() for button in step.page.nothing.buttons][:2] == [found.name, "Fast patient"]
    assert step.page.sources.itemText(0) == found.name
    qtbot.waitUntil(step.page.nothing.buttons[1].hasFocus)


def test_a_search_that_is_stopped_gives_the_sources_back(visit: Visit, step: SensorsStep) -> None:
    may_end = threading.Event()

    def make() -> Acquisition:
        may_end.wait(10)
        raise SourceRefusedError("No sensor found", "Switch the sensors on")

    visit.known_choices = (SourceChoice("slow", "Slow", make),)
    step.page.source_chosen.emit("slow")
    assert step.page.searching.isVisible()
    step.page.searching.stop.click()
    assert step.page.nothing.isVisible()
    may_end.set()


def test_whom_a_network_asks_is_reported_only_as_long_as_it_is_chosen(
    qtbot: QtBot, visit: Visit, step: SensorsStep
) -> None:
    asks = SourceChoice("net", "Network", visit.known_choices[0].make, asks=("This asks every computer.", "Again."))
    visit.known_choices = (*visit.known_choices, asks)
    tick(step)
    sources = step.page.sources
    sources.setCurrentIndex(sources.findData("net"))
    sources.activated.emit(sources.currentIndex())
    assert "This asks every computer." in step.page.nothing.notice.text
    assert sources.currentIndex() == -1, "nothing is asked there yet"
    step.page.source_chosen.emit(REPLAY)
    step.page.stored.back.click()
    assert step.page.nothing.notice.text == ""


@pytest.mark.usefixtures("pseudo_language")
def test_what_is_refused_is_stated_in_the_users_language(qtbot: QtBot, visit: Visit, step: SensorsStep) -> None:
    def make() -> Acquisition:
        raise SourceRefusedError("{place} is in use by another program", "Close that program", place="COM{7}")

    visit.known_choices = (SourceChoice("taken", "Taken", make),)
    with qtbot.waitSignal(visit.refused) as refused:
        step.page.source_chosen.emit("taken")
    what, remedy = refused.args
    assert what.startswith("[COM{7} ")
    assert (what[-2:], remedy[:1], remedy[-2:]) == ("].", "[", "].")


@pytest.fixture
def simulated_on_a_patient(
    qtbot: QtBot, visit: Visit, step: SensorsStep, worn: dict[str, Site], monkeypatch: pytest.MonkeyPatch
) -> Visit:
    """Simulated sensors that a search found, on a patient who is none of the demonstration's."""
    open_source(qtbot, visit, step)
    visit.sensors.assign_all(worn)
    monkeypatch.setattr("app.wizard.visit.DEMO", "NOBODY")
    assert not visit.may_simulate
    return visit


def test_simulated_sensors_are_refused_at_once_on_a_patient_of_the_clinic(
    simulated_on_a_patient: Visit, step: SensorsStep
) -> None:
    visit = simulated_on_a_patient
    bar = step.bar()
    assert bar.note == (
        "These sensors are simulated and DEMO-7 is not a demonstration patient. Nothing would be recorded."
    )
    assert bar.primary is not None
    assert (bar.primary.text, bar.others[0].text) == ("Choose other sensors", "Start with a demonstration patient")
    assert (step.state, step.note) == (StepState.ATTENTION, "not for this patient")
    for other in (StandStillStep, FreeMotionStep, WalkingStep):
        assert other(visit).cannot_enter == bar.note
    press(step)
    assert visit.sensors.acquisition is None
    assert step.page.nothing.isVisible()
    assert not visit.cannot_record


def test_simulated_sensors_are_not_refused_on_the_demonstrations_patient(
    qtbot: QtBot, visit: Visit, step: SensorsStep, worn: dict[str, Site]
) -> None:
    open_source(qtbot, visit, step)
    visit.sensors.assign_all(worn)
    assert not visit.cannot_record
    assert step.state is StepState.DONE
    assert step.bar().primary is not None
    assert "simulated" not in step.bar().note


def test_who_has_simulated_sensors_is_led_to_a_demonstration_patient(
    qtbot: QtBot, simulated_on_a_patient: Visit, step: SensorsStep
) -> None:
    with qtbot.waitSignal(step.demonstration_required):
        press(step, "Start with a demonstration patient")
    step.leave()
    qtbot.wait(50)
    session = present(simulated_on_a_patient.session)
    assert session.placements == ()  # what sends nothing to be kept is worn nowhere


@pytest.mark.parametrize("code", ["DEMO-1", "DEMO-2"])
def test_the_demonstration_begins_with_its_patient_found_or_to_be_made(
    qtbot: QtBot, wizard: Wizard, monkeypatch: pytest.MonkeyPatch, code: str
) -> None:
    monkeypatch.setattr("app.wizard.wizard.DEMO_PATIENT", code)
    wizard.begin(None)
    first = wizard.visit
    wizard.steps[StepId.PATIENT].demonstration_required.emit()
    assert wizard.visit is not first
    assert wizard.visit is not None
    patient = wizard.visit.patient
    qtbot.waitUntil(lambda: patient.details.code == code)
    assert (patient.stored is not None) is (code == "DEMO-1")
    assert wizard.visit.may_simulate
    with qtbot.waitSignal(wizard.visit.changed):
        wizard.press_primary()
    qtbot.waitUntil(lambda: isinstance(wizard.current, SensorsStep))

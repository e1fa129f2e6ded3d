"""Sensors that the motion contradicts: one key puts them where it detects them, and no way ends there."""

from collections.abc import Iterator

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.theme.notifier import ThemeNotifier
from app.widgets.rail_row import StepState
from app.wizard.free_motion.step import FreeMotionStep
from app.wizard.sensors.step import SensorsStep
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.wizard import Wizard
from core.body import Site
from core.placement.labels import groups_of
from core.session import RecordingKind
from tests.app.wizard.begun_visit import begin, record
from tests.app.wizard.pressing import press

THIGH, SHANK, FOOT = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT
MIXED = {THIGH: SHANK, SHANK: FOOT, FOOT: THIGH}


@pytest.fixture
def moved(
    qtbot: QtBot, visit: Visit, worn: dict[str, Site], monkeypatch: pytest.MonkeyPatch
) -> Iterator[FreeMotionStep]:
    """The step after a free motion has been recorded."""
    monkeypatch.setattr(visit, "evaluate", lambda: None)
    begin(qtbot, visit, worn)
    record(qtbot, visit, RecordingKind.FREE_MOTION, 0.5)
    step = FreeMotionStep(ThemeNotifier(), visit)
    qtbot.addWidget(step.page)
    step.page.show()
    step.enter()
    yield step
    step.leave()


@pytest.mark.parametrize("detected", [{THIGH: SHANK, SHANK: THIGH}, MIXED], ids=["two", "three"])
def test_detected_positions_are_used_by_the_primary_button_and_the_step_goes_on(
    qtbot: QtBot, visit: Visit, moved: FreeMotionStep, detected: dict[Site, Site]
) -> None:
    visit.sensors.doubt(detected)
    primary = moved.bar().primary
    assert primary is not None
    assert (primary.text, primary.key, primary.is_enabled) == ("Use detected positions", "Enter", True)
    assert moved.state is StepState.ATTENTION
    moved.enter()
    assert moved.page.band.hint.sentence == "Positions look swapped"
    before = dict(visit.sensors.site_of)
    with qtbot.waitSignals([moved.done, moved.reported, visit.worn.corrected], timeout=10_000):
        press(moved)
    assert visit.sensors.site_of == {name: detected.get(site, site) for name, site in before.items()}
    free = visit.recordings.free_motion
    assert free is not None
    assert free.stored.placement is not None
    names = {site: sensor.name for site, sensor in free.stored.placement.sensors.items()}
    assert names == visit.sensors.sensor_at  # what was recorded is of the new positions
    assert moved.bar().primary != primary


def test_without_a_doubt_the_primary_button_goes_on(visit: Visit, moved: FreeMotionStep) -> None:
    primary = moved.bar().primary
    assert primary is not None
    assert (primary.text, moved.state) == ("Continue to walking", StepState.DONE)


def test_positions_can_be_checked_and_kept_as_they_are(
    qtbot: QtBot, visit: Visit, moved: FreeMotionStep, worn: dict[str, Site]
) -> None:
    visit.sensors.doubt(MIXED)
    assert [(one.text, one.key) for one in moved.bar().quiet] == [("Check positions", "P")]
    with qtbot.waitSignal(moved.jumped) as jumped:
        press(moved, "Check positions")
    assert jumped.args == [StepId.SENSORS]
    sensors = SensorsStep(ThemeNotifier(), visit)
    qtbot.addWidget(sensors.page)
    sensors.enter()
    words = "L thigh, L shank and L foot look mixed up. Change the sensor positions, or continue with the current ones."
    assert sensors.page.notice.text == words
    assert (sensors.state, sensors.note) == (StepState.ATTENTION, "positions look swapped")
    sensors.leave()
    assert visit.sensors.site_of == worn
    sensors.enter()
    assert sensors.page.notice.text == "All six sensors are assigned and connected."
    primary = moved.bar().primary
    assert primary is not None
    assert primary.text == "Continue to walking"
    visit.sensors.doubt(MIXED)  # the motion still reports it
    assert not visit.sensors.detected
    sensors.deleteLater()


def test_a_position_that_is_changed_by_hand_ends_the_doubt(visit: Visit, moved: FreeMotionStep) -> None:
    visit.sensors.doubt(MIXED)
    visit.sensors.assign(visit.sensors.sensor_at[THIGH], SHANK)
    assert not moved.labels.is_in_doubt


def test_sensors_left_to_the_motion_after_it_are_found_by_another(visit: Visit, moved: FreeMotionStep) -> None:
    visit.sensors.leave_to_motion(True)
    moved.enter()
    assert visit.recordings.is_recording
    assert moved.bar().primary is not None


def test_a_motion_that_shows_no_positions_leads_to_them(qtbot: QtBot, visit: Visit, moved: FreeMotionStep) -> None:
    visit.sensors.leave_to_motion(True)
    moved.enter()
    done: list[None] = []
    moved.done.connect(lambda: done.append(None))
    with qtbot.waitSignal(moved.reported, timeout=10_000) as reported:
        press(moved)
    assert reported.args[0] == "Sensor positions could not be detected."
    bar = moved.bar()
    assert bar.primary is not None
    assert (bar.primary.text, [one.text for one in bar.quiet]) == ("Start free motion", ["Check positions"])
    assert done == []


def test_groups_are_the_cycles_in_which_sensors_change_places() -> None:
    right = Site.RIGHT_THIGH, Site.RIGHT_SHANK
    assert groups_of(MIXED | dict(zip(right, reversed(right), strict=True))) == [(THIGH, SHANK, FOOT), right]


def test_the_keys_on_the_bar_use_and_check_the_positions(wizard: Wizard, monkeypatch: pytest.MonkeyPatch) -> None:
    wizard.begin(None)
    step = wizard.steps[StepId.FREE_MOTION]
    gone: list[StepId] = []
    monkeypatch.setattr(type(step), "cannot_enter", "")
    wizard.go_to(StepId.FREE_MOTION)
    visit = wizard.visit
    assert visit is not None
    visit.sensors.doubt(MIXED)
    assert set(wizard.shell.bar.keys) == {"Enter", "Space", "P"}
    step.jumped.disconnect()
    step.jumped.connect(gone.append)
    wizard.shell.bar.back.setFocus()
    QTest.keyClick(wizard.shell.bar.back, Qt.Key.Key_P)
    assert gone == [StepId.SENSORS]

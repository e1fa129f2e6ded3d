"""Sensors that are not where they are stated to be: what is put right holds for what it was stated about, and no
more."""

from collections.abc import Iterator

import pytest
from pytestqt.qtbot import QtBot

from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from core.body import Site
from core.session import RecordingKind
from tests.app.wizard.begun_visit import record


@pytest.fixture
def sensors_step(qtbot: QtBot, looked_at: Visit) -> Iterator[SensorsStep]:
    step = SensorsStep(looked_at)
    qtbot.addWidget(step.page)
    yield step
    step.deleteLater()


def swap_thighs(qtbot: QtBot, visit: Visit, step: SensorsStep) -> None:
    """On the page Sensors, as a user does."""
    step.enter()
    visit.sensors.assign(visit.sensors.sensor_at[Site.LEFT_THIGH], Site.RIGHT_THIGH)
    with qtbot.waitSignal(visit.changed):
        step.leave()


def left_thighs(visit: Visit) -> list[str]:
    """Which sensor each recording has at the left thigh, by its name."""
    placements = [recording.stored.placement for recording in visit.recordings.every]
    return [placement.sensors[Site.LEFT_THIGH].name for placement in placements if placement is not None]


def test_labels_that_were_swapped_are_put_right_in_all_recordings(
    qtbot: QtBot, visit: Visit, sensors_step: SensorsStep
) -> None:
    for kind in (RecordingKind.STANDING, RecordingKind.WALKING):
        record(qtbot, visit, kind, 0.5)
    swap_thighs(qtbot, visit, sensors_step)
    qtbot.waitUntil(lambda: left_thighs(visit) == ["DEMO-right_thigh"] * 2)


def test_sensors_that_were_strapped_on_otherwise_leave_what_was_recorded_before(
    qtbot: QtBot, visit: Visit, sensors_step: SensorsStep
) -> None:
    record(qtbot, visit, RecordingKind.STANDING, 0.5)
    visit.recordings.say_restrapped()
    swap_thighs(qtbot, visit, sensors_step)
    record(qtbot, visit, RecordingKind.STANDING, 0.5)
    assert left_thighs(visit) == ["DEMO-left_thigh", "DEMO-right_thigh"]
    swap_thighs(qtbot, visit, sensors_step)  # it was stated wrongly: put right since the strapping, not before
    qtbot.waitUntil(lambda: left_thighs(visit) == ["DEMO-left_thigh"] * 2)
    record(qtbot, visit, RecordingKind.STANDING, 0.5)
    assert left_thighs(visit) == ["DEMO-left_thigh"] * 3

"""Sensors that change places after standing and free motion: what was found of them holds no longer as it is."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtTest import QSignalSpy
from pytestqt.qtbot import QtBot

from app.wizard.evaluation import Evaluation
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from core.body import LEG_JOINTS, Joint, Side, Site
from core.samples import ImuBlock
from core.session import Recording, RecordingKind, Session
from tests.app.wizard.begun_visit import record
from tests.app.wizard.present import present

THIGH, SHANK = Site.LEFT_THIGH, Site.LEFT_SHANK


@pytest.fixture
def calibrated(
    qtbot: QtBot, looked_at: Visit, worn: dict[str, Site], monkeypatch: pytest.MonkeyPatch
) -> Iterator[SensorsStep]:
    """A visit whose joints were found from what its sensors recorded, at the page Sensors."""
    visit = looked_at
    record(qtbot, visit, RecordingKind.FREE_MOTION, 0.5)
    imu = {site: ImuBlock(name, *np.zeros((1, 0)), *np.zeros((2, 0, 3))) for name, site in worn.items()}
    visit.evaluation.session = Session((Recording("free motion", RecordingKind.FREE_MOTION, "f", imu),))
    monkeypatch.setattr(Evaluation, "calibration", dict.fromkeys(LEG_JOINTS))
    step = SensorsStep(visit)
    qtbot.addWidget(step.page)
    step.enter()
    yield step
    step.deleteLater()


def test_what_was_found_of_a_joint_holds_for_the_sensors_it_was_found_with(
    visit: Visit, calibrated: SensorsStep
) -> None:
    assert set(visit.calibration) == set(LEG_JOINTS)
    sensors = visit.sensors
    sensors.assign(sensors.sensor_at[THIGH], Site.RIGHT_THIGH)  # both knees have another thigh now
    assert set(visit.calibration) == {Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE}


def test_it_holds_again_once_it_was_found_again_under_the_new_places(visit: Visit, calibrated: SensorsStep) -> None:
    sensors, evaluated = visit.sensors, present(visit.evaluation.session)
    sensors.assign(sensors.sensor_at[THIGH], SHANK)
    assert set(visit.calibration) == {Joint.RIGHT_KNEE, Joint.RIGHT_ANKLE}
    free = evaluated.recordings[0]
    imu = {**free.imu, THIGH: free.imu[SHANK], SHANK: free.imu[THIGH]}
    visit.evaluation.session = replace(evaluated, recordings=(replace(free, imu=imu),))
    assert set(visit.calibration) == set(LEG_JOINTS)


def test_new_places_of_the_same_sensors_are_stated_and_a_sign_turned_by_hand_is_forgotten(
    qtbot: QtBot, visit: Visit, calibrated: SensorsStep
) -> None:
    for joint in (Joint.LEFT_KNEE, Joint.RIGHT_ANKLE):
        visit.record.set_turned(joint, -1)
    visit.sensors.assign(visit.sensors.sensor_at[THIGH], Site.RIGHT_THIGH)
    reported = QSignalSpy(calibrated.reported)
    with qtbot.waitSignal(visit.worn.corrected):
        calibrated.leave()
    assert reported.at(0)[0] == "Sensor positions changed. Standing reference and calibration are calculated again."
    assert not visit.recordings.is_restrapped
    assert visit.details.turned_sign == {Joint.RIGHT_ANKLE: -1}


def test_another_sensor_at_a_place_asks_for_another_standing_and_free_motion(
    qtbot: QtBot, visit: Visit, calibrated: SensorsStep
) -> None:
    visit.sensors.assign(visit.sensors.sensor_at[THIGH], None)
    visit.sensors.assign(visit.sensors.sensor_at[Site.LEFT_FOOT], THIGH)
    reported = QSignalSpy(calibrated.reported)
    calibrated.leave()
    assert reported.at(0)[0] == "Another sensor is worn. Standing reference and calibration are no longer valid."
    assert visit.recordings.must_move
    assert Joint.LEFT_KNEE not in visit.calibration
    qtbot.waitUntil(lambda: not visit.record.is_busy)


def test_a_sensor_that_was_taken_off_leaves_what_was_found_of_the_others(
    qtbot: QtBot, visit: Visit, calibrated: SensorsStep
) -> None:
    visit.sensors.assign(visit.sensors.sensor_at[Site.LEFT_FOOT], None)
    reported = QSignalSpy(calibrated.reported)
    with qtbot.waitSignal(visit.changed):
        calibrated.leave()
    assert reported.count() == 0
    assert not visit.recordings.must_move
    assert Joint.LEFT_KNEE in visit.calibration


def test_places_that_stay_say_nothing(visit: Visit, calibrated: SensorsStep) -> None:
    reported = QSignalSpy(calibrated.reported)
    calibrated.leave()
    assert reported.count() == 0


def test_sides_that_are_swapped_are_swapped_for_what_is_recorded_next(
    qtbot: QtBot, visit: Visit, calibrated: SensorsStep
) -> None:
    left = visit.sensors.sensor_at[THIGH]
    with qtbot.waitSignal(visit.worn.corrected):
        visit.worn.swap_sides()
    assert visit.sensors.site_of[left] is Site.RIGHT_THIGH
    walk = record(qtbot, visit, RecordingKind.WALKING, 0.5)
    assert present(walk.stored.placement).sensors[Site.RIGHT_THIGH].name == left
    assert {site.side for site in visit.sensors.site_of.values()} == set(Side)

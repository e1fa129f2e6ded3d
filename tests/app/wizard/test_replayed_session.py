"""A stored session is replayed through the whole wizard, in real time, up to its results."""

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from app.wizard.sensors.step import SensorsStep
from app.wizard.step import StepId
from app.wizard.wizard import Wizard
from core.body import LEG_JOINTS, LEG_SITES, Joint, Side, Site
from core.results import Analysis
from core.session import Patient, Recording, RecordingKind, Session
from devices.files.session_folder import read_session, write_session
from devices.files.xsens_mtmanager import mtmanager_trial
from devices.simulation.walker import DEMONSTRATION
from tests.app.wizard.begun_visit import save_patient
from tests.app.wizard.present import present
from tests.simulated import analysis_of, session_of
from tests.trials_of_files import import_with

pytestmark = pytest.mark.endurance  # as long as the patients take, a minute or two each
BONES = {"femur": "thigh", "tibia": "shank", "calcn": "foot"}


def lead_to_standing(qtbot: QtBot, wizard: Wizard, folder: Path) -> None:
    """Replay a folder for a new patient, and go on to the step of standing."""
    wizard.begin(None)
    visit = present(wizard.visit)
    save_patient(qtbot, visit, Patient(code="DEMO-8"))
    wizard.go_to(StepId.SENSORS)
    sensors = wizard.current
    assert isinstance(sensors, SensorsStep)
    with qtbot.waitSignal(visit.sensors.opened):
        sensors.stored.replay_folder(folder)
    assert set(visit.sensors.sensor_at) == set(LEG_SITES)
    wizard.press_primary()
    assert wizard.step_id is StepId.STAND_STILL


def record_walk(qtbot: QtBot, wizard: Wizard, seconds: float) -> None:
    visit = present(wizard.visit)
    with qtbot.waitSignal(visit.recordings.begun):
        wizard.press_primary()
    qtbot.wait(round(1000 * seconds))
    with qtbot.waitSignal(visit.recordings.ended):
        wizard.press_primary()


def results(qtbot: QtBot, wizard: Wizard) -> Analysis:
    visit = present(wizard.visit)
    wizard.go_to(StepId.RESULTS)
    qtbot.waitUntil(lambda: not visit.evaluation.is_busy and visit.evaluation.analysis is not None)
    analysis = present(visit.evaluation.analysis)
    assert analysis.is_simulated, "nobody was measured now"
    assert all(recording.stored.is_simulated for recording in visit.recordings.every)
    return analysis


def range_deg(analysis: Analysis, joint: Joint) -> float:
    """Of the last walk's mean cycle."""
    cycles = analysis.recordings[-1].gait[joint.side].cycles[joint]
    return float(np.rad2deg(np.ptp(np.nanmean(cycles, axis=0))))


def test_the_demonstrations_folder_gives_what_its_analysis_gives(qtbot: QtBot, wizard: Wizard, tmp_path: Path) -> None:
    folder = tmp_path / "session"
    write_session(session_of(DEMONSTRATION), folder)
    lead_to_standing(qtbot, wizard, folder)
    wizard.press_primary()
    qtbot.waitUntil(lambda: wizard.step_id is StepId.FREE_MOTION)
    qtbot.wait(30_000)
    if wizard.step_id is StepId.FREE_MOTION:
        wizard.press_primary()
    qtbot.waitUntil(lambda: wizard.step_id is StepId.WALKING)
    record_walk(qtbot, wizard, 20.0)
    analysis, stored = results(qtbot, wizard), analysis_of(read_session(folder))
    visit = present(wizard.visit)
    assert min(visit.evaluation.strides("walk 1").values()) >= 8
    for joint in LEG_JOINTS:
        assert range_deg(analysis, joint) == pytest.approx(range_deg(stored, joint), abs=3.0), joint


def test_a_real_walk_without_standing_goes_as_far(
    qtbot: QtBot, wizard: Wizard, test_data: Callable[[str], Path], tmp_path: Path
) -> None:
    source = test_data("vendor_exports/xsens_mtmanager")
    worn = {}
    for sensor in ET.parse(source / "OpenSenseExample_myIMUMappings.xml").iter("ExperimentalSensor"):
        bone, side, *_ = (sensor.findtext("name_in_model") or "").split("_")
        if bone in BONES:
            worn[Site(f"{'left' if side == 'l' else 'right'}_{BONES[bone]}")] = sensor.attrib["name"]
    imported = import_with(mtmanager_trial, sorted(source.glob("OpenSenseExample_*")), worn, "walk 1")
    folder = tmp_path / "real"
    write_session(Session((Recording("walk 1", RecordingKind.WALKING, "walk_1", imported.imu),)), folder)
    lead_to_standing(qtbot, wizard, folder)
    wizard.go_to(StepId.FREE_MOTION)
    qtbot.wait(12_000)
    wizard.press_primary()
    qtbot.waitUntil(lambda: wizard.step_id is StepId.WALKING)
    record_walk(qtbot, wizard, 24.0)
    analysis = results(qtbot, wizard)
    visit = present(wizard.visit)
    strides = visit.evaluation.strides("walk 1")
    assert {side: strides[side] >= 8 for side in Side} == dict.fromkeys(Side, True)
    assert "rate_from_orientation" in {finding.key for finding in analysis.findings}, "as the file has it"

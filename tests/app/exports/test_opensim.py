"""Read our motion files with OpenSim itself: every row, whatever is missing, and what a model makes of it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.exports.opensim_motion import COORDINATES, Model, write_motion
from app.exports.opensim_orientations import write_orientations
from core.body import LEG_JOINTS, Side
from core.results import RecordingAnalysis
from devices.files.opensim_orientations import read_opensim_orientations
from devices.simulation.walker_truth import RecordingTruth
from tests.app.exports.conftest import Visit
from tests.app.exports.test_parts import missing

pytestmark = pytest.mark.endurance
MISSING = "OpenSim (the extra opensim) is not installed"


@pytest.fixture(autouse=True)
def _writes_its_log_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_opensim_reads_every_row(walk: RecordingAnalysis, tmp_path: Path) -> None:
    opensim = pytest.importorskip("opensim", reason=MISSING)
    half_s = float(walk.time_s[len(walk.time_s) // 2])
    cases = {
        "whole": walk,
        "short": missing(walk, slice(300, 309)),
        "split": missing(walk, slice(0, 20), slice(300, 340)),
        "slipped": replace(walk, slipped_from_s={Side.RIGHT: half_s}),
    }
    for name, recording in cases.items():
        assert write_motion(recording, True, tmp_path / f"{name}.mot") == ""
    assert len(list(tmp_path.glob("*.mot"))) == 6
    for path in tmp_path.glob("*.mot"):
        header, *lines = path.read_text().split("endheader\n")[1].splitlines()
        table = opensim.TimeSeriesTable(str(path))
        values = np.array([[float(cell) for cell in line.split("\t")] for line in lines])
        assert list(table.getColumnLabels()) == header.split("\t")[1:]
        assert table.getNumRows() == opensim.Storage(str(path)).getSize() == len(lines)
        np.testing.assert_array_equal(np.array(table.getIndependentColumn()), values[:, 0])
        np.testing.assert_array_equal(table.getMatrix().to_numpy(), values[:, 1:])
        assert table.getTableMetaDataString("inDegrees") == "yes"


SEGMENTS = {"femur": (0.0, 0.0, 0.0), "tibia": (0.0, -0.4, 0.0), "calcn": (0.0, -0.43, 0.0)}  # where each hangs
# Rajagopal2016.osim has these ranges, in radians, and clamps all of them
RAJAGOPAL = {
    "hip_flexion": (-0.52359878, 2.0943951),
    "knee_angle": (0.0, 2.0944),
    "ankle_angle": (-0.6981317, 0.52359878),
}


def like_rajagopal(opensim: Any) -> Any:
    """Two legs that hang from the ground, with the names, signs and limits of Rajagopal's model."""
    model = opensim.Model()
    for side in ("r", "l"):
        parent = model.getGround()
        for (name, (low, high)), (segment, place) in zip(RAJAGOPAL.items(), SEGMENTS.items(), strict=True):
            body = opensim.Body(f"{segment}_{side}", 1.0, opensim.Vec3(0), opensim.Inertia(1.0))
            turned = opensim.Vec3(np.pi if name == "knee_angle" else 0.0, 0.0, 0.0)  # its knee flexes about -z
            places = (opensim.Vec3(*place), turned, body, opensim.Vec3(0), turned)
            joint = opensim.PinJoint(f"{name}_joint_{side}", parent, *places)
            coordinate = joint.updCoordinate()
            coordinate.setName(f"{name}_{side}")
            coordinate.setRangeMin(low)
            coordinate.setRangeMax(high)
            coordinate.set_clamped(True)
            model.addBody(body)
            model.addJoint(joint)
            parent = body
    return model


@pytest.mark.parametrize("name", Model)
def test_a_model_moves_as_the_patient_did_and_within_its_limits(
    walk: RecordingAnalysis, truth: RecordingTruth, test_data: Callable[[str], Path], tmp_path: Path, name: Model
) -> None:
    """Whatever a model calls positive, the shank is behind the thigh's line, and the toes are up, by the true angle."""
    opensim = pytest.importorskip("opensim", reason=MISSING)
    if name is Model.GAIT2392:
        model = opensim.Model(str(test_data("opensim_models/gait2392_thelen2003muscle.osim")))
    else:
        model = like_rajagopal(opensim)
    write_motion(walk, True, tmp_path / "angles.mot", name)
    state = model.initSystem()
    table = opensim.TableProcessor(str(tmp_path / "angles.mot")).processAndConvertToRadians(model)
    table_of_states = opensim.TableProcessor(str(tmp_path / "angles.mot"))
    table_of_states.append(opensim.TabOpUseAbsoluteStateNames())
    states = opensim.StatesTrajectory.createFromStatesTable(
        model, table_of_states.processAndConvertToRadians(model), True, True, False
    )
    assert states.getSize() == table.getNumRows() == len(walk.time_s)
    rows = range(0, table.getNumRows(), 5)
    for joint in LEG_JOINTS:
        letter = joint.side[0]
        coordinate = model.getCoordinateSet().get(COORDINATES[joint])
        values = table.getDependentColumn(COORDINATES[joint]).to_numpy()
        upper, lower = ("femur", "tibia") if joint.is_knee else ("tibia", "calcn")
        one, two = (model.getBodySet().get(f"{body}_{letter}") for body in (upper, lower))
        found_deg = []
        for row in rows:
            coordinate.setValue(state, values[row])
            assert coordinate.getValue(state) == pytest.approx(values[row], abs=1e-6)  # it is clamped nowhere
            assert coordinate.getRangeMin() - 1e-6 <= values[row] <= coordinate.getRangeMax() + 1e-6
            model.realizePosition(state)
            down = two.expressVectorInAnotherFrame(state, opensim.Vec3(0, -1, 0), one)  # of the lower, in the upper one
            behind_deg = np.rad2deg(np.arctan2(-down.get(0), -down.get(1)))
            found_deg.append(behind_deg if joint.is_knee else -behind_deg)
        known = truth.joints[joint]
        true_deg = np.rad2deg(np.interp(walk.time_s[::5], known.time_s, known.angle_rad - known.standing_rad))
        if joint.is_knee and name is Model.RAJAGOPAL2016:
            true_deg = np.maximum(true_deg, 0.0)
        # gait2392 turns its ankle about an oblique axis, of which the side view has less
        assert np.sqrt(np.mean((np.array(found_deg) - true_deg) ** 2)) < (1.5 if joint.is_knee else 2.5), joint


def test_a_coordinate_beyond_its_range_would_be_clamped(tmp_path: Path) -> None:
    """So that the limits above are limits of OpenSim's, not of our belief."""
    opensim = pytest.importorskip("opensim", reason=MISSING)
    model = like_rajagopal(opensim)
    state = model.initSystem()
    knee = model.getCoordinateSet().get("knee_angle_r")
    knee.setValue(state, np.deg2rad(-4.0))
    assert knee.getValue(state) == 0.0
    knee.setValue(state, np.deg2rad(30.0))
    assert knee.getValue(state) == pytest.approx(np.deg2rad(30.0))


@pytest.fixture(scope="module")
def orientations(visit: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("orientations")
    write_orientations(*visit, folder, "orientations.sto")
    return folder


def one_of(folder: Path, recording: str) -> str:
    (path,) = folder.glob(f"{recording}*/orientations.sto")
    return str(path)


def test_opensim_reads_our_orientations_and_we_read_its_own(orientations: Path, tmp_path: Path) -> None:
    opensim = pytest.importorskip("opensim", reason=MISSING)
    path = one_of(orientations, "walk")
    table = opensim.TimeSeriesTableQuaternion(path)
    ours = read_opensim_orientations(Path(path))
    assert tuple(table.getColumnLabels()) == ours.sensors
    assert table.getTableMetaDataString("DataRate") == "100.000000"
    np.testing.assert_allclose(np.array(table.getIndependentColumn()), ours.time_s, atol=1e-9)
    for row in range(0, table.getNumRows(), 50):
        for k in range(len(ours.sensors)):
            q = table.getRowAtIndex(row).getElt(0, k)
            np.testing.assert_allclose([q.get(i) for i in range(4)], ours.q_earth_from_sensor[row, k], atol=1e-8)
    opensim.STOFileAdapterQuaternion.write(table, str(tmp_path / "its_own.sto"))
    again = read_opensim_orientations(tmp_path / "its_own.sto")
    assert again.sensors == ours.sensors
    np.testing.assert_allclose(again.time_s, ours.time_s, atol=1e-6)
    np.testing.assert_allclose(again.q_earth_from_sensor, ours.q_earth_from_sensor, atol=1e-6)


def test_opensense_moves_its_model_as_the_patient_moved(
    orientations: Path, truth: RecordingTruth, test_data: Callable[[str], Path], tmp_path: Path
) -> None:
    """Sensors placed by our recording standing, inverse kinematics of a step of our walk."""
    opensim = pytest.importorskip("opensim", reason=MISSING)
    upright = opensim.Vec3(-0.5 * np.pi, 0.0, 0.0)
    placer = opensim.IMUPlacer()
    placer.set_model_file(str(test_data("opensim_models/gait2392_thelen2003muscle.osim")))
    placer.set_orientation_file_for_calibration(one_of(orientations, "standing"))
    placer.set_sensor_to_opensim_rotations(upright)
    placer.run(False)
    placer.getCalibratedModel().printToXML(str(tmp_path / "placed.osim"))
    tool = opensim.IMUInverseKinematicsTool()
    tool.set_model_file(str(tmp_path / "placed.osim"))
    tool.set_orientations_file(one_of(orientations, "walk"))
    tool.set_sensor_to_opensim_rotations(upright)
    tool.set_results_directory(str(tmp_path))
    tool.set_time_range(0, 4.0)
    tool.set_time_range(1, 5.5)
    tool.run(False)
    table = opensim.TimeSeriesTable(str(tmp_path / "ik_orientations.mot"))
    time_s = np.array(table.getIndependentColumn())
    for joint in LEG_JOINTS:
        found_deg = table.getDependentColumn(COORDINATES[joint]).to_numpy() * (-1.0 if joint.is_knee else 1.0)
        known = truth.joints[joint]
        true_deg = np.rad2deg(np.interp(time_s, known.time_s, known.angle_rad - known.standing_rad))
        assert np.sqrt(np.mean((found_deg - true_deg) ** 2)) < (1.0 if joint.is_knee else 2.5), joint

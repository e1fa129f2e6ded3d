"""Read our motion files with OpenSim itself: every row, whatever is missing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.opensim_motion import COORDINATES, write_motion
from core.body import Side
from core.results import Analysis, RecordingAnalysis
from core.session import RecordingKind, Session
from tests.app.exports.test_parts import missing

pytestmark = pytest.mark.endurance


@pytest.fixture(autouse=True)
def _writes_its_log_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def walk(visit: tuple[Session, Analysis]) -> RecordingAnalysis:
    return next(r for r in visit[1].recordings if r.kind is RecordingKind.WALKING)


def test_opensim_reads_every_row(walk: RecordingAnalysis, tmp_path: Path) -> None:
    opensim = pytest.importorskip("opensim", reason="OpenSim (the extra opensim) is not installed")
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


def test_a_model_takes_our_coordinates(walk: RecordingAnalysis, tmp_path: Path) -> None:
    opensim = pytest.importorskip("opensim", reason="OpenSim (the extra opensim) is not installed")
    write_motion(walk, True, tmp_path / "angles.mot")
    model = opensim.Model()
    parent = model.getGround()
    for name in (COORDINATES[joint] for joint in walk.joints):
        body = opensim.Body(f"body_{name}", 1.0, opensim.Vec3(0), opensim.Inertia(1.0))
        joint = opensim.PinJoint(f"joint_{name}", parent, body)
        joint.updCoordinate().setName(name)
        model.addBody(body)
        model.addJoint(joint)
    model.initSystem()
    table = opensim.TableProcessor(str(tmp_path / "angles.mot"))
    table.append(opensim.TabOpUseAbsoluteStateNames())
    states = opensim.StatesTrajectory.createFromStatesTable(
        model, table.processAndConvertToRadians(model), True, True, False
    )
    assert states.getSize() == len(walk.time_s)
    for joint, found in walk.joints.items():
        coordinate = model.getCoordinateSet().get(COORDINATES[joint])
        for row in (0, len(walk.time_s) // 2, len(walk.time_s) - 1):
            value = coordinate.getValue(states.get(row))
            assert value == pytest.approx(found.angle_rad[row], abs=1e-6)

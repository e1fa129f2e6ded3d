"""Tests that every format leaves out the height of angles whose zero nobody measured.

Their shape and range are kept.
"""

import json
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import openpyxl
import pytest

from app.exports.exports import export_from_folder
from app.exports.result_folder import write_results
from core.body import LEG_JOINTS, Joint
from devices.simulation.walker import FreeMotion, SimulatedSession, Walk, WalkerSettings
from tests.app.exports.conftest import OF_FIGURES
from tests.app.exports.written_tables import csv_rows
from tests.simulated import analysis_of, simulation_of


@pytest.fixture(scope="module")
def simulated() -> SimulatedSession:
    """A patient who never stood still for it."""
    return simulation_of(WalkerSettings(seed=2, recordings=(FreeMotion(), Walk(strides=13))))


@pytest.fixture(scope="module")
def folder(simulated: SimulatedSession, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("no_zero")
    analysis = analysis_of(simulated.session)
    lines = export_from_folder(simulated.session, analysis, OF_FIGURES, place, is_identified=True)
    (place / "lines").write_text("\n".join(lines), encoding="utf-8")
    write_results(simulated.session, analysis, place)
    return place


def sheet(folder: Path, title: str) -> list[dict[str, Any]]:
    header, *rows = openpyxl.load_workbook(folder / "gaitwright.xlsx")[title].iter_rows(values_only=True)
    return [dict(zip([str(name) for name in header], row, strict=True)) for row in rows]


def test_a_workbook_states_not_reported_where_a_csv_file_is_empty(folder: Path) -> None:
    strides = sheet(folder, "Strides")
    assert len(strides) > 20
    for row in strides:
        for peak in ("knee_swing_peak_deg", "knee_at_initial_contact_deg", "ankle_stance_dorsiflexion_deg"):
            assert row[peak] is None, peak
        assert row["knee_height_status"] == row["ankle_height_status"] == "Not reported"
        for known in ("knee_range_deg", "ankle_range_deg", "stance_percent", "stride_length_m"):
            assert isinstance(row[known], float), known
    (path,) = folder.glob("walk*/strides.csv")
    for line in csv_rows(path):
        assert line["knee_swing_peak_deg"] == ""
        assert float(line["knee_range_deg"]) > 30.0


def test_cycles_have_a_shape_about_their_own_mean_and_no_height(folder: Path) -> None:
    walk = [row for row in sheet(folder, "Cycles") if row["recording"] == "walk 1"]
    assert len(walk) == 101
    for joint in LEG_JOINTS:
        assert {row[f"{joint}_mean_deg"] for row in walk} == {None}
        assert {row[f"{joint}_status"] for row in walk} == {"Curve shape only"}
        shape_deg = np.array([row[f"{joint}_shape_deg"] for row in walk], dtype=float)
        assert np.mean(shape_deg) == pytest.approx(0.0, abs=1e-3)
        assert np.ptp(shape_deg) > (45.0 if joint.is_knee else 15.0)
        assert all(isinstance(row[f"{joint}_stride_sd_deg"], float) for row in walk)


def test_the_summary_has_no_figure_of_a_height(folder: Path) -> None:
    reported = {(row["side"], row["parameter"]): row for row in sheet(folder, "Summary")}
    for side in ("left", "right"):
        assert reported[side, "knee_swing_peak_deg"]["mean"] is None
        assert reported[side, "knee_range_deg"]["mean"] == pytest.approx(62.0, abs=6.0)
    statuses = {name: row["status"] for (side, name), row in reported.items() if side == "left"}
    assert statuses["knee_swing_peak_deg"] == "Not reported"
    reasons = "reasons"
    assert len(reported["left", "knee_swing_peak_deg"][reasons]) > 20
    assert reported["left", "knee_range_deg"][reasons] is None
    assert statuses["knee_range_deg"] == statuses["stance_percent"] == "Good"
    assert reported["left", "knee_range_deg"]["measure"] == "Knee range of motion"


def test_fhir_gives_a_reason_for_a_missing_height(folder: Path) -> None:
    entries = json.loads((folder / "fhir_bundle.json").read_text())["entry"]
    reported = {
        one["code"]["coding"][-1]["code"]: one
        for one in (entry["resource"] for entry in entries)
        if one.get("bodySite", {}).get("text") == "left leg"
    }
    missing, known = reported["knee_swing_peak_deg"], reported["knee_range_deg"]
    assert "valueQuantity" not in missing
    (coding,) = missing["dataAbsentReason"]["coding"]
    assert coding["system"] == "http://terminology.hl7.org/CodeSystem/data-absent-reason"
    assert coding["code"] == "error"
    assert missing["status"] == "preliminary"
    assert "dataAbsentReason" not in known
    assert known["status"] == "final"
    assert "interpretation" not in json.dumps(entries)


def test_a_c3d_holds_shapes_and_a_motion_file_no_angle(folder: Path, simulated: SimulatedSession) -> None:
    (path,) = folder.glob("walk*/angles.c3d")
    read = ezc3d.c3d(str(path))
    labels = read["parameters"]["POINT"]["LABELS"]["value"]
    assert sorted(labels) == ["LAnkleAngles_SHAPE", "LKneeAngles_SHAPE", "RAnkleAngles_SHAPE", "RKneeAngles_SHAPE"]
    points = read["data"]["points"][0]
    truth = simulated.truth.recordings["walk 1"].joints
    named = {"LK": Joint.LEFT_KNEE, "RK": Joint.RIGHT_KNEE, "LA": Joint.LEFT_ANKLE, "RA": Joint.RIGHT_ANKLE}
    time_s = (
        truth[Joint.LEFT_KNEE].time_s[0] + np.arange(points.shape[1]) / read["parameters"]["POINT"]["RATE"]["value"][0]
    )
    for label, shape_deg in zip(labels, points, strict=True):
        known = truth[named[label[:2]]]
        true_deg = np.rad2deg(np.interp(time_s, known.time_s, known.angle_rad))
        assert np.mean(shape_deg) == pytest.approx(0.0, abs=0.01)
        assert np.std(shape_deg - (true_deg - true_deg.mean())) < 1.5, label
    assert list(folder.glob("walk*/*.mot")) == []


def test_a_c3d_and_the_line_for_a_motion_file_say_what_they_left_out(folder: Path) -> None:
    (path,) = folder.glob("walk*/angles.c3d")
    parameters = ezc3d.c3d(str(path))["parameters"]
    status = dict(text.split(": ", 1) for text in parameters["PROCESSING"]["STATUS"]["value"])
    assert set(status) == {str(joint) for joint in LEG_JOINTS}
    assert all(text.startswith("no_zero: ") and text.isascii() for text in status.values())
    for label, words in zip(
        parameters["POINT"]["LABELS"]["value"], parameters["POINT"]["DESCRIPTIONS"]["value"], strict=True
    ):
        bends = "knee flexion" if "Knee" in label else "ankle dorsiflexion"
        assert words == f"x: {bends} less its mean, for there is no zero; y, z not measured"
    (line,) = (line for line in (folder / "lines").read_text(encoding="utf-8").splitlines() if line.startswith("walk"))
    assert line.startswith(
        "walk 1, mot: This recording has no angle to export as a pose. There is no standing reference"
    )

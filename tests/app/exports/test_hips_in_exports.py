"""Tests that hips and pelvis are in every format, with the signs of the simulated patient.

They are left out where they are not reported.

Names, codes and signs are written out here, never taken from the code that writes them.
"""

import json
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import openpyxl
import pytest
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from app.exports.c3d_angles import write_c3d
from app.exports.fhir_bundle import bundle
from app.exports.opensim_motion import write_motion
from app.exports.spreadsheet import write_spreadsheet
from app.review import rerun_log
from app.review.rerun_log import write_log
from core.body import Joint, Side, hip_of
from core.results import Analysis
from core.samples import FloatArray
from tests.app.hip_visits import LATE_S, hip_analysis, hip_session
from tests.core.hip.hip_sessions import analysed, truth, walk_of, with_hip

HIPS = (Joint.LEFT_HIP, Joint.RIGHT_HIP)


@pytest.fixture(scope="module")
def gated() -> Analysis:
    """Of the left hip nothing may be read."""
    return with_hip(hip_analysis(), Joint.LEFT_HIP, margin=1.2)


def true_deg(side: Side, name: str, time_s: FloatArray) -> FloatArray:
    known = truth(analysed(late_s=LATE_S)[0], side, late_s=LATE_S)
    return np.rad2deg(np.interp(time_s, known.time_s, getattr(known, name)))


def apart(found: FloatArray, true: FloatArray) -> float:
    return float(np.sqrt(np.nanmean((found - true) ** 2)))


def read_motion(path: Path) -> tuple[str, dict[str, FloatArray]]:
    head, body = path.read_text(encoding="ascii").split("endheader\n")
    names, *rows = body.splitlines()
    table = np.array([[float(cell) for cell in row.split("\t")] for row in rows])
    return head, dict(zip(names.split("\t"), table.T, strict=True))


def test_the_motion_file_moves_a_model_as_the_patient_moved(tmp_path: Path) -> None:
    """In OpenSim x points forward, y up and z to the right; a turn about an axis follows the right hand."""
    walk = walk_of(hip_analysis())
    write_motion(walk, True, tmp_path / "walk.mot")
    _, columns = read_motion(tmp_path / "walk.mot")
    time_s = columns["time"]
    for side, letter in ((Side.LEFT, "l"), (Side.RIGHT, "r")):
        assert apart(columns[f"hip_flexion_{letter}"], true_deg(side, "flexion_rad", time_s)) < 1.0
        assert apart(columns[f"hip_adduction_{letter}"], -true_deg(side, "abduction_rad", time_s)) < 1.5
    made = analysed(late_s=LATE_S)[0].moved[-1].pelvis
    assert made is not None
    leaning, listing = np.deg2rad(columns["pelvis_tilt"]), np.deg2rad(columns["pelvis_list"])
    true_left_up = np.interp(time_s, made.time_s, made.rotations[:, 2, 1])
    left_up = np.sin(listing)  # the height of z = -1 once turned about x
    known = np.isfinite(left_up)
    assert np.corrcoef(left_up[known], true_left_up[known])[0, 1] > 0.9
    # the pelvis's own up, seen along its heading: forward is positive
    heading = np.arctan2(made.rotations[:, 1, 0], made.rotations[:, 0, 0])
    forward = made.rotations[:, 0, 2] * np.cos(heading) + made.rotations[:, 1, 2] * np.sin(heading)
    leant = -np.sin(leaning)  # how far forward y = 1 goes, turned about z
    true_leant = np.interp(time_s, made.time_s, forward)
    assert np.corrcoef(leant[known], true_leant[known])[0, 1] > 0.5
    assert "hip_rotation_r" not in columns
    assert "pelvis_rotation" not in columns


def test_a_not_reported_hip_is_no_column_of_a_motion_file_and_the_head_states_why(
    gated: Analysis, tmp_path: Path
) -> None:
    write_motion(walk_of(gated), True, tmp_path / "walk.mot")
    head, columns = read_motion(tmp_path / "walk.mot")
    assert {"hip_flexion_r", "hip_adduction_r", "pelvis_tilt"} <= set(columns)
    assert not {"hip_flexion_l", "hip_adduction_l"} & set(columns)
    assert [line for line in head.splitlines() if line.startswith("hip_flexion_l is left out, withheld: Sensor pos")]
    no_frame = walk_of(with_hip(gated, Joint.RIGHT_HIP, margin=1.2))
    write_motion(no_frame, True, tmp_path / "none.mot")
    assert not {"pelvis_tilt", "pelvis_list"} & set(read_motion(tmp_path / "none.mot")[1])


def test_a_c3d_has_flexion_and_adduction_of_each_hip_that_is_reported(gated: Analysis, tmp_path: Path) -> None:
    write_c3d(walk_of(hip_analysis()), True, tmp_path / "walk.c3d")
    read = ezc3d.c3d(str(tmp_path / "walk.c3d"))
    labels = read["parameters"]["POINT"]["LABELS"]["value"]
    walk = walk_of(hip_analysis())
    for side, letter in ((Side.LEFT, "L"), (Side.RIGHT, "R")):
        x, y, z, *_ = read["data"]["points"][:, labels.index(f"{letter}HipAngles")]
        hip = walk.hips[hip_of(side)]
        assert np.nanmax(x) == pytest.approx(np.rad2deg(np.nanmax(hip.angle_rad)), abs=0.05)
        assert np.nanmax(y) == pytest.approx(-np.rad2deg(np.nanmin(hip.abduction_rad)), abs=0.05)
        assert np.nanmax(np.abs(z)) == 0.0
    write_c3d(walk_of(gated), True, tmp_path / "gated.c3d")
    read = ezc3d.c3d(str(tmp_path / "gated.c3d"))
    labels = read["parameters"]["POINT"]["LABELS"]["value"]
    assert "LHipAngles" not in labels
    assert "RHipAngles" in labels
    status = read["parameters"]["PROCESSING"]["STATUS"]["value"]
    assert [
        stated for stated in status if stated.startswith("left_hip: withheld: Sensor positions could not be confirmed")
    ]
    assert "right_hip: read" in status


def test_without_a_sure_heading_a_c3d_states_that_abduction_is_not_reported(tmp_path: Path) -> None:
    unsure = with_hip(hip_analysis(), *HIPS, heading_sd_rad=np.deg2rad(7.0), is_3d=False)
    write_c3d(walk_of(unsure), True, tmp_path / "walk.c3d")
    read = ezc3d.c3d(str(tmp_path / "walk.c3d"))
    point = read["parameters"]["POINT"]
    at = point["LABELS"]["value"].index("LHipAngles")
    assert np.nanmax(np.abs(read["data"]["points"][1, at])) == 0.0
    assert "adduction" not in point["DESCRIPTIONS"]["value"][at]


def observations(analysis: Analysis) -> dict[tuple[str, str], dict[str, Any]]:
    found = {}
    for entry in json.loads(json.dumps(bundle(hip_session(), analysis)))["entry"]:
        one = entry["resource"]
        if one["resourceType"] == "Observation":
            side = one.get("bodySite", {}).get("text", "").removesuffix(" leg")
            found[one["code"]["coding"][-1]["code"], side] = one
    return found


def test_fhir_has_the_hips_and_states_why_one_is_absent(gated: Analysis) -> None:
    found = observations(gated)
    reported = found["hip_range_deg", "right"]["valueQuantity"]
    assert (reported["system"], reported["code"]) == ("http://unitsofmeasure.org", "deg")
    gait = walk_of(gated).gait[Side.RIGHT]
    used = gait.strides.is_used
    assert reported["value"] == pytest.approx(np.rad2deg(gait.parameters["hip_range_rad"][used]).mean(), abs=0.051)
    missing = found["hip_range_deg", "left"]
    assert "valueQuantity" not in missing
    assert missing["dataAbsentReason"]["coding"][0]["code"]
    assert "Sensor positions could not be confirmed" in json.dumps(missing["dataAbsentReason"])
    assert not [name for name, _ in found if "hip_rotation" in name]


@pytest.mark.endurance
def test_the_workbook_names_what_is_not_reported_of_a_hip(gated: Analysis, tmp_path: Path) -> None:
    write_spreadsheet(hip_session(), gated, tmp_path / "visit.xlsx")
    book = openpyxl.load_workbook(tmp_path / "visit.xlsx")
    rows = {(row[2], row[3]): row for row in book["Summary"].iter_rows(values_only=True)}
    assert (rows["left", "hip_range_deg"][4], rows["left", "hip_range_deg"][9]) == (None, "Not reported")
    assert rows["right", "hip_range_deg"][4] == pytest.approx(50.0, abs=4.0)
    assert not [name for _, name in rows if "hip_rotation" in str(name)]
    head, *cycles = book["Cycles"].iter_rows(values_only=True)
    for column, is_not_reported in (
        ("left_hip_mean_deg", True),
        ("left_hip_abduction_mean_deg", True),
        ("right_hip_mean_deg", False),
        ("right_hip_abduction_mean_deg", False),
    ):
        cells = {row[head.index(column)] for row in cycles}
        assert (cells == {None}) is is_not_reported, column


def moving(path: Path) -> set[str]:
    """What the walk shows."""
    return {chunk.entity_path for chunk in RrdReader(path).stream() if "walking_1" in chunk.timeline_names}


@pytest.mark.endurance
def test_a_log_shows_hips_the_pelvis_and_its_angles_where_they_may_be_read(gated: Analysis, tmp_path: Path) -> None:
    write_log(hip_session(), gated, tmp_path / "visit.rrd")
    drawn = moving(tmp_path / "visit.rrd")
    assert {"/angles/right_hip/result", "/withheld/left_hip/result", "/legs/pelvis"} <= drawn
    assert {"/pelvis/tilt", "/pelvis/obliquity", "/pelvis/rotation"} <= drawn
    assert "/angles/left_hip/result" not in drawn
    column = rerun_log.side_views(gated, Side.RIGHT)
    assert column is not None
    views = [view for view in column.contents if isinstance(view, rrb.View)]
    assert views[0].name == "right hip: flexion, °"


@pytest.mark.endurance
def test_a_log_has_no_pelvis_where_no_hip_can_be_read(gated: Analysis, tmp_path: Path) -> None:
    none = with_hip(gated, Joint.RIGHT_HIP, margin=1.2)
    write_log(hip_session(), none, tmp_path / "none.rrd")
    drawn = moving(tmp_path / "none.rrd")
    assert not [name for name in drawn if name.startswith("/pelvis") or name == "/legs/pelvis"]

"""Tests of what each format does with what is doubtful: leave it out, name it otherwise, or give the reason."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import openpyxl
import pytest
from syrupy.assertion import SnapshotAssertion

from app.exports.c3d_angles import write_c3d
from app.exports.fhir_bundle import bundle
from app.exports.figures import SIMULATED
from app.exports.opensim_motion import write_motion
from app.exports.spreadsheet import write_spreadsheet
from app.exports.summary import summarise
from core.body import Joint, Side
from core.gait.strides import Reason
from core.results import Analysis, RecordingAnalysis
from core.session import Session
from core.verdicts.gates import judged
from core.verdicts.model import READ, Assessment, GateReason, JointVerdicts, Verdict, assess
from tests.app.exports.conftest import Visit

NO_ZERO = assess([GateReason("zero", Verdict.NOT_REPORTED)])
NO_SIGN = assess([GateReason("sign", Verdict.NOT_REPORTED, 0.1, 0.25)])
NO_AXIS = assess([GateReason("axis", Verdict.NOT_REPORTED, 12.0, 9.0, "deg")])
Bundled = dict[tuple[str, str], dict[str, Any]]


def doubted(walk: RecordingAnalysis, parts: Mapping[Joint, tuple[Assessment, Assessment, Assessment]]) -> Any:
    joints = {**walk.verdicts.joints, **{joint: JointVerdicts(*one) for joint, one in parts.items()}}
    return replace(walk, verdicts=replace(walk.verdicts, joints=joints))


@pytest.fixture
def mixed(walk: RecordingAnalysis) -> RecordingAnalysis:
    """Each joint in another doubt; the left knee in none."""
    return doubted(
        walk,
        {
            Joint.LEFT_KNEE: (READ, READ, READ),
            Joint.LEFT_ANKLE: (READ, NO_ZERO, READ),
            Joint.RIGHT_KNEE: (READ, NO_SIGN, NO_SIGN),
            Joint.RIGHT_ANKLE: (NO_AXIS, NO_AXIS, READ),
        },
    )


def test_a_c3d_names_a_shape_and_leaves_out_what_may_be_mirrored_or_is_not_reported(
    mixed: RecordingAnalysis, tmp_path: Path, snapshot: SnapshotAssertion
) -> None:
    write_c3d(mixed, False, tmp_path / "angles.c3d")
    read = ezc3d.c3d(str(tmp_path / "angles.c3d"))
    point = read["parameters"]["POINT"]
    assert point["LABELS"]["value"] == point["ANGLES"]["value"] == ["LKneeAngles", "LAnkleAngles_SHAPE"]
    knee, ankle = read["data"]["points"][0]
    assert np.nanmean(ankle) == pytest.approx(0.0, abs=1e-3)
    assert np.ptp(ankle) == pytest.approx(np.rad2deg(np.ptp(mixed.joints[Joint.LEFT_ANKLE].angle_rad)), abs=1e-3)
    assert np.nanmean(knee) == pytest.approx(np.rad2deg(np.mean(mixed.joints[Joint.LEFT_KNEE].angle_rad)), abs=1e-3)
    assert [point["DESCRIPTIONS"]["value"], read["parameters"]["PROCESSING"]["STATUS"]["value"]] == snapshot


def test_a_motion_file_leaves_out_what_is_no_pose_and_states_why(
    mixed: RecordingAnalysis, tmp_path: Path, snapshot: SnapshotAssertion
) -> None:
    write_motion(mixed, False, tmp_path / "angles.mot")
    head, body = (tmp_path / "angles.mot").read_text(encoding="ascii").split("endheader\n")
    assert body.splitlines()[0] == "time\tknee_angle_l"
    assert "nColumns=2\n" in head
    assert [line for line in head.splitlines() if " is " in line] == snapshot


def test_once_a_strap_slipped_a_format_without_a_status_per_row_has_no_angle(
    walk: RecordingAnalysis, tmp_path: Path
) -> None:
    at = len(walk.time_s) // 2
    slipped = replace(walk, slipped_from_s={Side.RIGHT: float(walk.time_s[at])})
    write_c3d(slipped, False, tmp_path / "angles.c3d")
    read = ezc3d.c3d(str(tmp_path / "angles.c3d"))
    labels = read["parameters"]["POINT"]["LABELS"]["value"]
    known = dict(zip(labels, np.isfinite(read["data"]["points"][0]), strict=True))
    for label in ("LKneeAngles", "LAnkleAngles"):
        assert known[label].all()
    for label in ("RKneeAngles", "RAnkleAngles"):
        np.testing.assert_array_equal(np.flatnonzero(known[label]), np.arange(at))
    residuals = read["data"]["meta_points"]["residuals"][0]
    np.testing.assert_array_equal(residuals[labels.index("RKneeAngles")] < 0, ~known["RKneeAngles"])
    write_motion(slipped, False, tmp_path / "angles.mot")
    whole, left = ((tmp_path / f"angles_{number}.mot").read_text().split("endheader\n") for number in (1, 2))
    assert [len(body.splitlines()) - 1 for _, body in (whole, left)] == [at, len(walk.time_s) - at]
    assert whole[1].splitlines()[0] == "time\tknee_angle_r\tknee_angle_l\tankle_angle_r\tankle_angle_l"
    assert left[1].splitlines()[0] == "time\tknee_angle_l\tankle_angle_l"
    assert "knee_angle_r is not known in this part.\nankle_angle_r is not known in this part.\n" in left[0]


def observations(session: Session, analysis: Analysis) -> Bundled:
    found = {}
    for entry in bundle(session, analysis)["entry"]:
        one = entry["resource"]
        if one["resourceType"] == "Observation":
            found[one["code"]["coding"][-1]["code"], one.get("bodySite", {}).get("text", "")] = one
    return found


def component(one: Mapping[str, Any], code: str) -> Any:
    (found,) = [part for part in one["component"] if part["code"]["coding"][0]["code"] == code]
    return found


def changed(visit: Visit, walk: RecordingAnalysis) -> Analysis:
    recordings = tuple(walk if one.name == walk.name else one for one in visit[1].recordings)
    return replace(visit[1], recordings=recordings)


def test_a_not_reported_figure_has_its_reason_in_place_of_a_value(visit: Visit, mixed: RecordingAnalysis) -> None:
    found = observations(visit[0], changed(visit, mixed))
    one = found["ankle_range_deg", "right leg"]
    assert "valueQuantity" not in one
    assert one["status"] == "preliminary"
    (coding,) = one["dataAbsentReason"]["coding"]
    assert coding["system"] == "http://terminology.hl7.org/CodeSystem/data-absent-reason"
    assert coding["code"] == "error"
    assert one["dataAbsentReason"]["text"].startswith("The calibration has an uncertainty of ±12.0°")
    assert {part["code"]["coding"][0]["code"] for part in one["component"]} == {"side", "strides_used"}
    assert found["knee_swing_peak_deg", "right leg"]["dataAbsentReason"]["text"].startswith(
        "Flexion and extension could not be distinguished"
    )
    assert found["knee_range_deg", "right leg"]["status"] == "final"
    assert not any({"interpretation", "referenceRange"} & set(one) for one in found.values())


def test_a_bundle_interprets_nothing(visit: Visit) -> None:
    """No figure is high, low, normal or abnormal: what it means is for who reads it."""
    resources = [entry["resource"] for entry in bundle(*visit)["entry"]]
    observations = [one for one in resources if one["resourceType"] == "Observation"]
    assert len(observations) > 40
    for reported in (*observations, *(part for one in observations for part in one.get("component", ()))):
        assert "interpretation" not in reported


def test_what_nobody_wore_was_not_performed(visit: Visit, walk: RecordingAnalysis) -> None:
    joints = {joint: angle for joint, angle in walk.joints.items() if joint.side is Side.LEFT}
    alone = replace(walk, joints=joints, gait={Side.LEFT: walk.gait[Side.LEFT]}, clocks=None)
    found = observations(visit[0], judged(changed(visit, alone)))
    for name in ("knee_range_deg", "stance_percent", "stride_length_m", "step_time_s"):
        one = found[name, "right leg"]
        assert (one["status"], "valueQuantity" in one) == ("cancelled", False)
        assert one["dataAbsentReason"]["coding"][0]["code"] == "not-performed"
    assert found["double_support_percent", ""]["dataAbsentReason"]["coding"][0]["code"] == "not-performed"
    assert found["knee_range_deg", "left leg"]["valueQuantity"]["value"] > 30
    assert found["cadence_steps_min", ""]["valueQuantity"]["value"] > 50


@pytest.mark.parametrize(("used", "status"), [(10, "final"), (9, "preliminary"), (3, "preliminary")])
def test_under_ten_strides_nothing_is_final(visit: Visit, walk: RecordingAnalysis, used: int, status: str) -> None:
    gait = walk.gait[Side.LEFT]
    assert len(gait.strides) >= 10
    reason = (Reason.USED,) * used + (Reason.TURN,) * (len(gait.strides) - used)
    few = replace(walk, gait={**walk.gait, Side.LEFT: replace(gait, strides=replace(gait.strides, reason=reason))})
    found = observations(visit[0], judged(changed(visit, few)))
    reported = {name: one for (name, side), one in found.items() if side == "left leg" and "valueQuantity" in one}
    assert len(reported) > 10
    assert {one["status"] for one in reported.values()} == {status}
    for one in reported.values():
        notes = [note["text"] for note in one["note"]]
        assert any(text.startswith(f"Few strides ({used} used, 10 required)") for text in notes) == (status != "final")
        assert component(one, "strides_used")["valueInteger"] == used


def test_the_error_of_a_figure_is_a_component_and_a_column(visit: Visit, tmp_path: Path) -> None:
    reported = summarise(visit[1])["walks"]
    (walk,) = reported.values()
    found = observations(*visit)
    write_spreadsheet(*visit, tmp_path / "book.xlsx")
    header, *rows = openpyxl.load_workbook(tmp_path / "book.xlsx")["Summary"].iter_rows(values_only=True)
    sheet = {(row[2], row[3]): dict(zip(header, row, strict=True)) for row in rows}
    for name in ("knee_range_deg", "stance_percent", "stride_length_m"):
        error = walk["left"][f"{name}_error"]
        assert error > 0
        assert component(found[name, "left leg"], "error")["valueQuantity"]["value"] == pytest.approx(error, abs=0.05)
        assert sheet["left", name]["error"] == pytest.approx(error, rel=1e-14)
        words = {"read": "Good", "care": "Caution"}
        assert sheet["left", name]["status"] == words[walk["left"][f"{name}_status"]]
    json.dumps(reported, allow_nan=False)


def test_a_workbook_of_simulated_data_states_it_in_its_first_row(visit: Visit, tmp_path: Path) -> None:
    session, analysis = visit
    for is_simulated in (True, False):
        path = tmp_path / f"{is_simulated}.xlsx"
        write_spreadsheet(session, replace(analysis, is_simulated=is_simulated), path)
        first = openpyxl.load_workbook(path)["About"]["A2"].value
        assert (first == SIMULATED) is is_simulated


def test_a_workbook_has_no_number_where_a_figure_is_not_reported(
    visit: Visit, mixed: RecordingAnalysis, tmp_path: Path
) -> None:
    write_spreadsheet(visit[0], changed(visit, mixed), tmp_path / "book.xlsx")
    book = openpyxl.load_workbook(tmp_path / "book.xlsx")
    header, *rows = book["Summary"].iter_rows(values_only=True)
    assert {row[header.index("mean")] for row in rows if row[header.index("status")] == "Not reported"} == {None}
    header, *rows = book["Strides"].iter_rows(values_only=True)
    for row in rows:
        reported = dict(zip(header, row, strict=True))
        is_right = reported["side"] == "right"
        for name, status in (("ankle_range_deg", "ankle_shape_status"), ("knee_swing_peak_deg", "knee_height_status")):
            assert (reported[name] is None) == (reported[status] == "Not reported") == is_right
        assert isinstance(reported["knee_range_deg"], float)
    header, *rows = book["Cycles"].iter_rows(values_only=True)
    columns = dict(zip(header, zip(*rows, strict=True), strict=True))
    assert {name for name, cells in columns.items() if set(cells) == {None}} == {
        *("left_ankle_mean_deg", "right_knee_mean_deg", "right_knee_shape_deg"),
        *("right_ankle_mean_deg", "right_ankle_shape_deg", "right_ankle_stride_sd_deg"),
    }
    statuses = {name: set(cells) for name, cells in columns.items() if str(name).endswith("_status")}
    assert statuses == {
        "left_knee_status": {"Good"},
        "left_ankle_status": {"Curve shape only"},
        "right_knee_status": {"Range of motion only"},
        "right_ankle_status": {"Not reported"},
    }
    grey = {cell.column for row in book["Cycles"].iter_rows(min_row=2) for cell in row if cell.fill.fill_type}
    assert len(grey) == 6  # what is not reported is seen
    about = {row[0]: str(row[1]) for row in book["About"].iter_rows(values_only=True)}
    name = mixed.name
    assert about[f"{name}, left knee, shape"] == "Good"
    assert about[f"{name}, right ankle, shape"].startswith("Not reported: The calibration has an uncertainty of ±12.0°")
    assert about[f"{name}, both legs, between"] == "Good"

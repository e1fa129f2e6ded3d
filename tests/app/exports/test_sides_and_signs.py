"""Tests of left and right, knee and ankle, and the signs. In every format they are those of the simulated patient.

Names and codes are written out here, never taken from the code that writes them; the angles and events to compare with
are the simulated patient's own.
"""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import openpyxl
import pytest

from app.exports.exports import Format, export_from_folder
from core.body import LEG_JOINTS, Joint, Side
from core.samples import FloatArray
from devices.simulation.walker import RecordingTruth, Standing, Walk, WalkerSettings
from tests.app.exports.written_tables import csv_rows
from tests.simulated import analysis_of, simulation_of

MOT = {
    "knee_angle_l": Joint.LEFT_KNEE,
    "knee_angle_r": Joint.RIGHT_KNEE,
    "ankle_angle_l": Joint.LEFT_ANKLE,
    "ankle_angle_r": Joint.RIGHT_ANKLE,
}
C3D = {
    "LKneeAngles": Joint.LEFT_KNEE,
    "RKneeAngles": Joint.RIGHT_KNEE,
    "LAnkleAngles": Joint.LEFT_ANKLE,
    "RAnkleAngles": Joint.RIGHT_ANKLE,
}
CSV = {
    "left_knee_deg": Joint.LEFT_KNEE,
    "right_knee_deg": Joint.RIGHT_KNEE,
    "left_ankle_deg": Joint.LEFT_ANKLE,
    "right_ankle_deg": Joint.RIGHT_ANKLE,
}
SNOMED = "http://snomed.info/sct"
LOWER_LIMBS = {
    "left": "32153003",
    "right": "62175007",
}  # |Structure of left lower limb|, |Structure of right lower limb|
SNOMED_SIDES = {"7771000": "left", "24028007": "right"}  # 7771000 |Left|, 24028007 |Right|
UCUM = {
    "knee_range_deg": "deg",
    "stance_percent": "%",
    "stride_time_s": "s",
    "stride_length_m": "m",
    "speed_m_s": "m/s",
    "cadence_steps_min": "/min",
}


def walk_folder(exported: Path) -> Path:
    (motion,) = exported.glob("walk*/angles.mot")
    return motion.parent


def true_deg(truth: RecordingTruth, joint: Joint, time_s: FloatArray) -> FloatArray:
    """The joint's angle from standing, flexion and dorsiflexion positive."""
    known = truth.joints[joint]
    return np.rad2deg(np.interp(time_s, known.time_s, known.angle_rad - known.standing_rad))


def check_columns(truth: RecordingTruth, time_s: FloatArray, columns: dict[str, FloatArray], named: Any) -> None:
    """Every column is the truth of the joint that its name means, and of no other, nor of its mirror image."""
    assert set(named) <= set(columns)
    for name, meant in named.items():
        for joint in LEG_JOINTS:
            for sign in (1.0, -1.0):
                error_deg = columns[name] - sign * true_deg(truth, joint, time_s)
                is_meant = joint is meant and sign > 0
                assert (np.sqrt(np.mean(error_deg**2)) < 1.5) == is_meant, (name, joint, sign)


def test_angles_csv_names_each_joint(exported: Path, truth: RecordingTruth) -> None:
    rows = csv_rows(walk_folder(exported) / "angles.csv")
    columns = {name: np.array([float(row[name]) for row in rows]) for name in CSV}
    check_columns(truth, np.array([float(row["time_s"]) for row in rows]), columns, CSV)


def test_the_motion_file_names_each_joint_as_opensim_does(exported: Path, truth: RecordingTruth) -> None:
    """Flexion and dorsiflexion positive, as in Rajagopal's model; the right knee is knee_angle_r."""
    lines = (walk_folder(exported) / "angles.mot").read_text().split("endheader\n")[1].splitlines()
    names = lines[0].split("\t")
    values = np.array([[float(cell) for cell in line.split("\t")] for line in lines[1:]])
    assert names[0] == "time"
    assert sorted(names[1:]) == sorted(MOT)
    head = (walk_folder(exported) / "angles.mot").read_text()
    assert all(f"\n{name} is here, read" in head for name in MOT)
    check_columns(truth, values[:, 0], dict(zip(names[1:], values[:, 1:].T, strict=True)), MOT)


def test_the_c3d_names_each_joint_as_motion_laboratories_do(exported: Path, truth: RecordingTruth) -> None:
    read = ezc3d.c3d(str(walk_folder(exported) / "angles.c3d"))
    point = read["parameters"]["POINT"]
    start_s = truth.joints[Joint.LEFT_KNEE].time_s[0]
    frames = read["data"]["points"]
    time_s = start_s + np.arange(frames.shape[2]) / point["RATE"]["value"][0]
    labels = point["LABELS"]["value"]
    assert sorted(labels) == sorted(C3D)
    check_columns(truth, time_s, dict(zip(labels, frames[0], strict=True)), C3D)
    assert (frames[1:3] == 0.0).all()  # ab-/adduction and rotation are not measured
    assert point["TYPE_GROUPS"]["value"] == ["ANGLES"]
    status = dict(text.split(": ", 1) for text in read["parameters"]["PROCESSING"]["STATUS"]["value"])
    assert {joint: text.split(":")[0] for joint, text in status.items()} == dict.fromkeys(map(str, LEG_JOINTS), "read")
    assert point["ANGLES"]["value"] == labels
    assert point["ANGLE_UNITS"]["value"] == ["deg"]
    for label, words in zip(labels, point["DESCRIPTIONS"]["value"], strict=True):
        assert words == f"x: {'knee flexion' if 'Knee' in label else 'ankle dorsiflexion'}; y, z not measured"


@pytest.mark.parametrize("context", ["Left", "Right"])
@pytest.mark.parametrize(
    ("label", "event"),
    [
        ("Foot Strike", "initial_contact_s"),
        ("Foot Off", "toe_off_s"),
        ("Full Contact", "full_contact_s"),
        ("Heel Rise", "heel_rise_s"),
    ],
)
def test_the_events_of_the_c3d_are_those_of_the_foot_that_they_name(
    exported: Path, truth: RecordingTruth, context: str, label: str, event: str
) -> None:
    reported = ezc3d.c3d(str(walk_folder(exported) / "angles.c3d"))["parameters"]["EVENT"]
    named = zip(reported["CONTEXTS"]["value"], reported["LABELS"]["value"], reported["TIMES"]["value"].T, strict=True)
    found_s = [60.0 * minutes + seconds for side, name, (minutes, seconds) in named if (side, name) == (context, label)]
    true_s = getattr(truth.feet[Side(context.lower())].events, event) - truth.joints[Joint.LEFT_KNEE].time_s[0]
    assert len(found_s) >= 10
    nearest_s = [true_s[np.argmin(np.abs(true_s - at_s))] for at_s in found_s]
    # another event of the same foot is 0.1 s away and more, the same of the other foot half a stride
    assert np.median(np.abs(np.array(found_s) - nearest_s)) < 0.04


@pytest.mark.endurance
def test_times_over_a_minute_are_minutes_and_seconds_in_a_c3d(tmp_path: Path) -> None:
    made = simulation_of(WalkerSettings(seed=3, recordings=(Standing(), Walk(strides=12, standing_before_s=52.0))))
    export_from_folder(made.session, analysis_of(made.session), [Format.C3D], tmp_path)
    (file,) = tmp_path.glob("walk*/angles.c3d")
    reported = ezc3d.c3d(str(file))["parameters"]["EVENT"]
    minutes, seconds = reported["TIMES"]["value"]
    assert set(minutes) == {0.0, 1.0}
    assert seconds.max() < 60.0
    last_s = made.truth.recordings["walk 1"].feet[Side.LEFT].events.initial_contact_s[-1]
    is_contact = [
        pair == ("Left", "Foot Strike")
        for pair in zip(*(reported[k]["value"] for k in ("CONTEXTS", "LABELS")), strict=True)
    ]
    assert np.max((60.0 * minutes + seconds)[is_contact]) == pytest.approx(last_s, abs=0.06)


@pytest.fixture(scope="module")
def observations(exported: Path) -> list[dict[str, Any]]:
    resources = [entry["resource"] for entry in json.loads((exported / "fhir_bundle.json").read_text())["entry"]]
    return [one for one in resources if one["resourceType"] == "Observation"]


def test_sides_and_body_site_are_coded_by_snomed_ct(observations: list[dict[str, Any]]) -> None:
    sides = set()
    for one in observations:
        if "bodySite" not in one:
            continue
        (site,) = one["bodySite"]["coding"]
        parts = {part["code"]["coding"][0]["code"]: part for part in one["component"]}
        assert set(parts) >= {"side", "stride_sd", "strides_used"}
        (side,) = parts["side"]["valueCodeableConcept"]["coding"]
        assert side["system"] == SNOMED
        assert side["display"].lower() == SNOMED_SIDES[side["code"]]
        name = SNOMED_SIDES[side["code"]]
        assert one["bodySite"]["text"] == f"{name} leg"
        assert (site["system"], site["code"]) == (SNOMED, LOWER_LIMBS[name])
        of_side, of_both = one["code"]["coding"]
        assert of_side["code"] == f"{name}_{of_both['code']}"
        sides.add(side["code"])
    assert sides == set(SNOMED_SIDES)


def test_units_are_coded_by_ucum(observations: list[dict[str, Any]]) -> None:
    reported = {
        one["code"]["coding"][-1]["code"]: one["valueQuantity"] for one in observations if "valueQuantity" in one
    }
    for name, code in UCUM.items():
        assert (reported[name]["system"], reported[name]["code"]) == ("http://unitsofmeasure.org", code)


def test_what_kind_of_observation_it_is_and_that_nobody_was_measured_is_coded_by_hl7(
    observations: list[dict[str, Any]],
) -> None:
    for one in observations:
        (category,) = one["category"][0]["coding"]
        assert category["system"] == "http://terminology.hl7.org/CodeSystem/observation-category"
        assert category["code"] == "activity"
        (label,) = one["meta"]["security"]
        assert label["system"] == "http://terminology.hl7.org/CodeSystem/v3-ActReason"
        assert label["code"] == "HTEST"


def test_figures_of_a_side_are_those_of_its_strides(
    exported: Path, observations: list[dict[str, Any]], truth: RecordingTruth
) -> None:
    """Stride by stride the true angle's largest less its smallest, in FHIR and in the workbook."""
    rows = openpyxl.load_workbook(exported / "gaitwright.xlsx")["Summary"].iter_rows(values_only=True)
    header = list(next(rows))
    sheet = [dict(zip(header, row, strict=True)) for row in rows]
    for side, joint in (("left", Joint.LEFT_KNEE), ("right", Joint.RIGHT_KNEE)):
        known, contact_s = truth.joints[joint], truth.feet[Side(side)].events.initial_contact_s[2:-2]
        ranges_deg = []
        for start_s, end_s in pairwise(contact_s):
            inside = (known.time_s >= start_s) & (known.time_s <= end_s)
            ranges_deg.append(np.rad2deg(np.ptp(known.angle_rad[inside])))
        (reported,) = (
            one["valueQuantity"]["value"]
            for one in observations
            if one["code"]["coding"][0]["code"] == f"{side}_knee_range_deg" and one["bodySite"]["text"] == f"{side} leg"
        )
        assert reported == pytest.approx(np.mean(ranges_deg), abs=1.0)
        (written,) = (row["mean"] for row in sheet if (row["side"], row["parameter"]) == (side, "knee_range_deg"))
        assert reported == round(float(str(written)), 1)  # a degree is not known to more digits

"""Tests that every format holds the numbers of the CSV files, and that other programs can read it."""

import json
import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import openpyxl
import pytest
from fhir.resources.R4B.bundle import Bundle

from app.exports.c3d_angles import POINTS, write_c3d
from app.exports.fhir_bundle import bundle, write_bundle
from app.exports.opensim_motion import COORDINATES, write_motion
from app.exports.spreadsheet import write_spreadsheet
from app.summary.events import events_of
from core.results import RecordingAnalysis
from core.samples import FloatArray
from tests.app.exports.conftest import Visit
from tests.app.exports.written_tables import csv_rows


def column(path: Path, name: str) -> FloatArray:
    return np.array([float(row[name] or "nan") for row in csv_rows(path)])


def sheet_rows(path: Path, title: str) -> list[dict[str, Any]]:
    header, *rows = openpyxl.load_workbook(path)[title].iter_rows(values_only=True)
    return [dict(zip([str(name) for name in header], row, strict=True)) for row in rows]


@pytest.fixture(scope="module")
def workbook(visit: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("xlsx") / "gaitwright.xlsx"
    write_spreadsheet(*visit, path)
    return path


@pytest.mark.parametrize("name", ["strides", "cycles", "events"])
def test_a_sheet_holds_the_cells_of_its_csv_file(
    walk: RecordingAnalysis, tables: Path, workbook: Path, name: str
) -> None:
    found = [row for row in sheet_rows(workbook, name.capitalize()) if row["recording"] == walk.name]
    reported = csv_rows(tables / walk.folder / f"{name}.csv")
    assert len(found) == len(reported) > 10
    for one, other in zip(found, reported, strict=True):
        for key, cell in other.items():
            if cell == "":
                assert one[key] is None
            elif isinstance(one[key], int | float):
                assert float(one[key]) == float(cell)
            elif key.endswith("_status"):
                assert one[key] == {"read": "Good", "care": "Caution"}[cell]
            else:
                assert one[key] == cell


def test_the_summary_holds_the_means_of_summary_json_with_their_units(
    walk: RecordingAnalysis, tables: Path, workbook: Path
) -> None:
    reported = json.loads((tables / "summary.json").read_text())["walks"][walk.name]
    found = {(row["side"], row["parameter"]): row for row in sheet_rows(workbook, "Summary")}
    assert len(found) > 30
    for (side, parameter), row in found.items():
        if side == "both":
            assert row["mean"] == pytest.approx(reported["both"][parameter], rel=1e-15)
        else:
            # a workbook holds 16 digits
            assert row["mean"] == pytest.approx(reported[side][f"{parameter}_mean"], rel=1e-15)
            assert row["stride_sd"] == pytest.approx(reported[side][f"{parameter}_sd"], rel=1e-15)
            assert row["strides_used"] == reported[side]["strides_used"]
    assert found["left", "knee_range_deg"]["unit"] == "°"
    assert found["left", "stride_length_m"]["unit"] == "m"
    assert found["left", "speed_m_s"]["unit"] == "m/s"
    assert found["both", "cadence_steps_min"]["unit"] == "steps/min"
    units = {row["column"]: row["unit"] for row in sheet_rows(workbook, "Units")}
    assert (units["percent"], units["toe_off_s"]) == ("%", "s")


def test_what_was_typed_is_no_formula_and_simulated_is_stated(workbook: Path) -> None:
    book = openpyxl.load_workbook(workbook)
    condition = book["Summary"]["B2"]
    assert (condition.value, condition.data_type) == ("=barefoot", "s")
    assert book["About"]["A2"].value.startswith("SIMULATED")


def test_the_same_analysis_gives_the_same_workbook(visit: Visit, workbook: Path, tmp_path: Path) -> None:
    write_spreadsheet(*visit, tmp_path / "again.xlsx")
    assert (tmp_path / "again.xlsx").read_bytes() == workbook.read_bytes()
    assert zipfile.ZipFile(workbook).testzip() is None


@pytest.mark.endurance
@pytest.mark.skipif(shutil.which("soffice") is None, reason="LibreOffice is not installed")
def test_libreoffice_opens_the_workbook(workbook: Path, tmp_path: Path) -> None:
    profile = f"-env:UserInstallation=file://{tmp_path / 'profile'}"
    command = ["soffice", profile, "--headless", "--convert-to", "csv", "--outdir", str(tmp_path), str(workbook)]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    assert "SIMULATED" in (tmp_path / "gaitwright.csv").read_text()


def test_the_motion_file_holds_the_rows_of_the_angles(walk: RecordingAnalysis, tables: Path, tmp_path: Path) -> None:
    write_motion(walk, True, tmp_path / "angles.mot")  # its model takes no knee that is straighter than straight
    head, body = (tmp_path / "angles.mot").read_text().split("endheader\n")
    header, *lines = body.splitlines()
    assert head.startswith("Coordinates\nversion=1\n")
    assert (
        f"nRows={len(lines)}\nnColumns={len(header.split())}\ninDegrees=yes\n\nSIMULATED: nobody was measured.\n"
        in head
    )
    values = np.array([[float(cell) for cell in line.split("\t")] for line in lines])
    names = header.split("\t")
    angles = tables / walk.folder / "angles.csv"
    np.testing.assert_array_equal(values[:, 0], column(angles, "time_s"))
    for joint, name in ((joint, name) for joint, name in COORDINATES.items() if joint in walk.measured):
        reported_deg = column(angles, f"{joint}_deg")
        expected_deg = np.maximum(reported_deg, 0.0) if joint.is_knee else reported_deg
        np.testing.assert_array_equal(values[:, names.index(name)], expected_deg)


def test_the_c3d_holds_the_angles_and_the_events(walk: RecordingAnalysis, tables: Path, tmp_path: Path) -> None:
    write_c3d(walk, True, tmp_path / "angles.c3d")
    read = ezc3d.c3d(str(tmp_path / "angles.c3d"))
    point, event = read["parameters"]["POINT"], read["parameters"]["EVENT"]
    angles = tables / walk.folder / "angles.csv"
    assert read["data"]["points"].shape[2] == len(walk.time_s)
    assert point["RATE"]["value"][0] == pytest.approx(1 / np.diff(walk.time_s).mean(), rel=1e-4)
    for k, label in enumerate(point["LABELS"]["value"]):
        joint = next(joint for joint, name in POINTS.items() if name == label)
        reported_deg = column(angles, f"{joint}_deg")
        np.testing.assert_array_equal(read["data"]["points"][0, k], reported_deg.astype(np.float32))
    events = csv_rows(tables / walk.folder / "events.csv")
    events.sort(key=lambda row: (row["event"] not in ("initial_contact", "toe_off"), float(row["time_s"])))
    minutes, seconds = event["TIMES"]["value"]
    reported_s = np.array([float(row["time_s"]) for row in events]) - walk.time_s[0]
    np.testing.assert_allclose(60 * minutes + seconds, reported_s, atol=1e-4)
    strikes = sum(row["event"] == "initial_contact" for row in events)
    assert event["LABELS"]["value"].count("Foot Strike") == strikes > 20
    assert event["CONTEXTS"]["value"] == [row["side"].capitalize() for row in events]
    assert point["UNITS"]["value"] == ["deg"] * len(walk.joints)
    assert read["parameters"]["SUBJECTS"]["NOTE"]["value"][0].startswith("SIMULATED")


def test_a_gap_of_the_angles_and_a_missing_row_are_no_points(walk: RecordingAnalysis, tmp_path: Path) -> None:
    joint, angle = next(iter(walk.joints.items()))
    angle_rad = angle.angle_rad.copy()
    angle_rad[10:13] = np.nan
    kept = np.setdiff1d(np.arange(len(walk.time_s)), np.arange(50, 70))
    with_gaps = replace(
        walk, time_s=walk.time_s[kept], joints={joint: replace(angle, angle_rad=angle_rad[kept])}, gait={}
    )
    write_c3d(with_gaps, False, tmp_path / "angles.c3d")
    read = ezc3d.c3d(str(tmp_path / "angles.c3d"))
    is_missing = read["data"]["meta_points"]["residuals"][0, 0] < 0
    np.testing.assert_array_equal(np.flatnonzero(is_missing), [10, 11, 12, *range(50, 70)])
    after_deg = np.rad2deg(angle.angle_rad[70:])
    np.testing.assert_allclose(read["data"]["points"][0, 0, 70:], after_deg, atol=1e-4)


def test_many_events_are_all_there(walk: RecordingAnalysis, tmp_path: Path) -> None:
    side, gait = next(iter(walk.gait.items()))
    many = replace(walk, gait={side: replace(gait, events=gait.events * 12)})
    write_c3d(many, False, tmp_path / "angles.c3d")
    event = ezc3d.c3d(str(tmp_path / "angles.c3d"))["parameters"]["EVENT"]
    lists = [event[name]["value"] for name in event if name.startswith("LABELS")]
    assert len(lists) > 1
    assert sum(len(labels) for labels in lists) == event["USED"]["value"][0]
    reported = sorted(events_of(many), key=lambda one: (one[2] not in ("initial_contact", "toe_off"), one[0]))
    ends = ["", *(str(number) for number in range(2, len(lists) + 1))]
    sides = [side for end in ends for side in event[f"CONTEXTS{end}"]["value"]]
    times_s = np.concatenate([[60.0, 1.0] @ event[f"TIMES{end}"]["value"] for end in ends])
    assert sides == [side.capitalize() for _, side, _ in reported]
    np.testing.assert_allclose(times_s, [time_s - many.time_s[0] for time_s, _, _ in reported], atol=1e-4)


def test_another_library_takes_the_bundle(visit: Visit, walk: RecordingAnalysis, tables: Path, tmp_path: Path) -> None:
    write_bundle(*visit, tmp_path / "bundle.json")
    read = Bundle.model_validate_json((tmp_path / "bundle.json").read_bytes())
    assert read.entry is not None
    resources: list[Any] = [entry.resource for entry in read.entry]
    patient = resources[0]
    observations = [one for one in resources if one.get_resource_type() == "Observation"]
    assert (patient.gender, patient.get_resource_type()) == ("female", "Patient")
    reported = json.loads((tables / "summary.json").read_text())["walks"][walk.name]
    assert len(observations) > 30
    differing: list[Any] = []
    for one in observations:
        name, quantity = one.code.coding[-1].code, one.valueQuantity
        half = 0.51 * 10.0 ** -({"deg": 1, "%": 1, "/min": 1}.get(quantity.code, 3))  # of the last digit
        parts = {part.code.coding[0].code: part for part in one.component or ()}
        if name.endswith("_difference"):
            differing.append(one)
            continue
        if one.bodySite is None:
            assert float(quantity.value) == pytest.approx(reported["both"][name], abs=half)
            continue
        side = parts["side"].valueCodeableConcept.coding[0].display.lower()
        assert one.bodySite.text == f"{side} leg"
        assert float(quantity.value) == pytest.approx(reported[side][f"{name}_mean"], abs=half)
        if "stride_sd" in parts:
            sd = float(parts["stride_sd"].valueQuantity.value)
            assert sd == pytest.approx(reported[side][f"{name}_sd"], abs=half)
        assert parts["strides_used"].valueInteger == reported[side]["strides_used"]
        assert one.meta.security[0].code == "HTEST"
        assert any(note.text.startswith("SIMULATED") for note in one.note)
    names = [one.fullUrl for one in read.entry]
    assert len(set(names)) == len(names)
    rows = {row["parameter"]: row for row in csv_rows(tables / "sides.csv")}
    assert len(differing) > 5
    for one in differing:
        row = rows[one.code.coding[0].code.removesuffix("_difference")]
        half = 0.051 if one.valueQuantity.code in ("deg", "%") else 0.00051
        assert float(one.valueQuantity.value) == pytest.approx(float(row["difference"]), abs=half)
        parts = {part.code.coding[0].code: part for part in one.component or ()}
        for end in ("low", "high", "healthy_limit"):
            assert (end in parts) is bool(row[end])
            if row[end]:
                assert float(parts[end].valueQuantity.value) == pytest.approx(float(row[end]), abs=half)
        assert ("mark" in parts) is bool(row["mark"])
        assert "beyond_speed" not in parts  # both legs walked at one speed


def test_a_date_without_a_zone_is_reported_as_a_day(visit: Visit) -> None:
    session, analysis = visit
    for started, reported in (("2026-11-21T10:00:00", "2026-11-21"), ("2026-11-21T10:00:00+01:00", None), ("soon", "")):
        resources = [entry["resource"] for entry in bundle(replace(session, started=started), analysis)["entry"]]
        first = next(one for one in resources if one["resourceType"] == "Observation")
        assert first.get("effectiveDateTime", "") == (started if reported is None else reported)

"""What is in the workbook, the C3D and the Bundle beside the numbers: cell by cell, as it was typed."""

import csv
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezc3d
import numpy as np
import openpyxl
import pytest
from syrupy.assertion import SnapshotAssertion

from app.exports.exports import Format, export_from_folder, export_from_library
from app.exports.fhir_bundle import bundle
from app.exports.spreadsheet import write_spreadsheet
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from core.body import Side
from core.findings import Finding, Severity
from core.session import Patient
from tests.app.exports.conftest import Visit
from tests.quick_library import quick_library
from tests.simulated import analysis_of

TYPED = Patient(
    code="P 17",
    birth_year=1950,
    sex="female",
    height_m=1.68,
    mass_kg=71.5,
    device="barfuß",
    aids="one stick",
    affected_side="left",
    prosthetic_side="right",
)


@pytest.fixture(scope="module")
def typed(visit: Visit) -> Visit:
    session, analysis = visit
    session = replace(session, patient=TYPED, operator="HK", surface="corridor", notes="=2+3")
    findings = (Finding("simulated", Severity.INFO, ""), Finding("no_standing", Severity.WARNING, "session"))
    return session, replace(analysis, findings=findings)


@pytest.fixture(scope="module")
def book(typed: Visit, tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("xlsx") / "gaitwright.xlsx"
    write_spreadsheet(*typed, path)
    return openpyxl.load_workbook(path)


def test_the_first_sheet_shows_who_was_measured_and_how(book: Any, snapshot: SnapshotAssertion) -> None:
    rows = [row[:2] for row in book["About"].iter_rows(values_only=True)]
    assert book.sheetnames[0] == "About"
    assert dict(rows)["software"].startswith("gaitwright")
    assert [f"{name}: {value!r}" for name, value in rows if name != "software"] == snapshot


def test_what_was_not_typed_has_no_row(visit: Visit, tmp_path: Path) -> None:
    session, analysis = visit
    write_spreadsheet(replace(session, patient=Patient(), surface=""), analysis, tmp_path / "some.xlsx")
    rows = openpyxl.load_workbook(tmp_path / "some.xlsx")["About"].iter_rows(values_only=True)
    names = {row[0] for row in rows}
    assert names.isdisjoint({"patient", "birth year", "sex", "height, m", "weight, kg", "device", "aids", "surface"})
    assert {"session", "user", "notes", "method", "software", "use"} <= names


def test_sheets_can_be_read_on_a_screen(book: Any) -> None:
    """Their heading is bold and stays; a column is as wide as its longest text, from 12 to 42 letters."""
    for name in ("About", "Summary", "Strides", "Cycles", "Events", "Units", "Findings"):
        sheet = book[name]
        assert sheet.freeze_panes == "A2", name
        assert all(cell.font.bold and cell.font.size == sheet["A2"].font.size for cell in sheet[1]), name
        assert not any(cell.font.bold for cell in sheet[2]), name
        for column in sheet.iter_cols():
            longest = max(len(cell.value) for cell in column if isinstance(cell.value, str))
            width = min(max(longest, 10) + 2, 42)
            assert sheet.column_dimensions[column[0].column_letter].width == width, (name, column[0].value)
    assert book["About"].column_dimensions["B"].width > 12
    assert len(book["Strides"][1]) > 26  # a column AA is one of them
    shown = {"°": "0.0", "%": "0.0", "s": "0.000", "m": "0.000", "m/s": "0.000", "steps/min": "0.0"}
    rows = [row for row in book["Summary"].iter_rows(min_row=2) if row[4].value is not None]
    assert {row[6].value for row in rows} == set(shown)
    assert all(row[4].number_format == shown[row[6].value] for row in rows)
    assert all(row[7].number_format == "General" for row in rows)
    strides = {cell.value: column[1].number_format for column in book["Strides"].iter_cols() for cell in column[:1]}
    assert (strides["knee_range_deg"], strides["stance_percent"], strides["start_s"]) == ("0.0", "0.0", "0.000")


def test_columns_have_the_unit_that_their_name_ends_with(book: Any) -> None:
    units = {row[0]: row[1] for row in book["Units"].iter_rows(min_row=2, values_only=True)}
    expected = {
        "start_s": "s",
        "stride_length_m": "m",
        "speed_m_s": "m/s",
        "stance_percent": "%",
        "knee_range_deg": "°",
    }
    assert {name: units[name] for name in expected} == expected
    assert units.keys().isdisjoint({"recording", "side", "event", "used", "strides_used"})
    of_summary = {row[3]: row[6] for row in book["Summary"].iter_rows(min_row=2, values_only=True)}
    assert (of_summary["cadence_steps_min"], of_summary["knee_range_deg"]) == ("steps/min", "°")


def test_findings_are_reported_in_words_and_there_is_no_sheet_without(book: Any, typed: Visit, tmp_path: Path) -> None:
    header, *rows = book["Findings"].iter_rows(values_only=True)
    assert header == ("severity", "where", "text")
    assert [row[:2] for row in rows] == [("info", None), ("warning", "session")]
    assert all(len(row[2]) > 20 for row in rows)
    write_spreadsheet(typed[0], replace(typed[1], findings=()), tmp_path / "none.xlsx")
    assert "Findings" not in openpyxl.load_workbook(tmp_path / "none.xlsx").sheetnames


def test_the_time_of_writing_is_in_no_workbook(book: Any) -> None:
    assert (book.properties.creator, book.properties.created.year) == ("gaitwright", 1980)
    assert book.properties.modified.year == 1980


def test_a_c3d_has_residuals_of_zero_where_an_angle_is_known(exported: Path) -> None:
    files = list(exported.rglob("*.c3d"))
    assert files
    for file in files:
        read = ezc3d.c3d(str(file))
        data, parameters = read["data"], read["parameters"]
        assert (data["meta_points"]["residuals"] == 0.0).all()
        np.testing.assert_array_equal(np.diff(data["points"][3]), 0.0)
        assert parameters["SUBJECTS"]["IS_SIMULATED"]["value"][0] == 1
        assert parameters["MANUFACTURER"]["SOFTWARE"]["value"] == ["gaitwright"]
        assert parameters["EVENT"]["USED"]["value"][0] == len(parameters["EVENT"].get("LABELS", {"value": []})["value"])


@pytest.mark.parametrize("rows", [0, 1])
def test_a_recording_that_hardly_began_is_a_c3d_all_the_same(visit: Visit, tmp_path: Path, rows: int) -> None:
    session, analysis = visit
    short = [
        replace(
            recording,
            time_s=recording.time_s[:rows],
            joints={joint: replace(a, angle_rad=a.angle_rad[:rows]) for joint, a in recording.joints.items()},
            gait={},
        )
        for recording in analysis.recordings
    ]
    export_from_folder(session, replace(analysis, recordings=tuple(short)), [Format.C3D], tmp_path)
    for file in tmp_path.rglob("*.c3d"):
        read = ezc3d.c3d(str(file))
        assert read["parameters"]["POINT"]["RATE"]["value"][0] == pytest.approx(100.0)
        assert read["data"]["points"].shape[2] == 1  # there is no file without a frame
        assert np.isnan(read["data"]["points"][0]).all() == (rows == 0)
        assert read["parameters"]["EVENT"]["USED"]["value"][0] == 0


def test_zero_has_no_sign(visit: Visit, tmp_path: Path) -> None:
    session, analysis = visit
    recordings = []
    for recording in analysis.recordings:
        joints = {
            joint: replace(a, angle_rad=np.full_like(a.angle_rad, -1e-9)) for joint, a in recording.joints.items()
        }
        recordings.append(replace(recording, joints=joints))
    export_from_folder(session, replace(analysis, recordings=tuple(recordings)), [Format.MOT], tmp_path)
    for file in tmp_path.rglob("*.mot"):
        assert "-0.0" not in file.read_text()


def test_a_bundle_shows_who_where_and_what_as_it_was_typed(typed: Visit, tmp_path: Path) -> None:
    session, analysis = typed
    recordings = tuple(replace(r, condition="barfuß") for r in session.recordings)
    export_from_folder(replace(session, recordings=recordings), analysis, [Format.FHIR], tmp_path, is_identified=True)
    written = (tmp_path / "fhir_bundle.json").read_bytes()
    assert "barfuß".encode() in written
    assert written.endswith(b"}\n")
    assert b'\n  "resourceType": "Bundle"' in written
    reported = json.loads(written)
    assert reported["type"] == "transaction"
    patient = reported["entry"][0]["resource"]
    assert patient["identifier"] == [{"system": "urn:x-gaitwright:patient", "value": "P 17"}]
    assert (patient["gender"], patient["birthDate"]) == ("female", "1950")
    for entry in reported["entry"]:
        one = entry["resource"]
        assert entry["fullUrl"].startswith("urn:uuid:")
        if one["resourceType"] != "Observation":
            continue
        assert one["subject"] == {"reference": reported["entry"][0]["fullUrl"]}
        assert one["effectiveDateTime"] == "2026-11-21T10:00:00+01:00"
        assert one["code"]["coding"][0]["system"] == "urn:x-gaitwright:parameter"
        of = one["code"]["coding"][0]["code"]  # with the side, where it is of one
        is_of_legs = of.endswith("_difference")
        words = f"{of.removesuffix('_difference')}, left less right" if is_of_legs else of
        assert one["code"]["text"] == words.replace("_", " ")
        assert one["device"]["display"].startswith("gaitwright")
        texts = [note["text"] for note in one["note"]]
        assert texts[0].startswith("barfuß" if is_of_legs else "walk")
        assert texts[0].endswith("barfuß" if is_of_legs else ", barfuß")
        assert any("Not a medical device" in text for text in texts)


@pytest.mark.parametrize(("strides", "status"), [(10, "final"), (9, "preliminary")])
def test_ten_strides_are_final_and_nine_are_not(visit: Visit, tmp_path: Path, strides: int, status: str) -> None:
    """Strides are left out by hand until so many are left."""
    session, analysis = visit
    (walk,) = (recording for recording in analysis.recordings if recording.gait)
    left = walk.gait[Side.LEFT].strides
    middle_s = 0.5 * (left.start_s + left.end_s)[left.is_used]
    assert len(middle_s) >= 10
    recordings = tuple(
        replace(r, left_out_s={Side.LEFT: tuple(middle_s[strides:].tolist())}) if r.name == walk.name else r
        for r in session.recordings
    )
    session = replace(session, recordings=recordings)
    export_from_folder(session, analysis_of(session), [Format.FHIR], tmp_path)
    reported = [entry["resource"] for entry in json.loads((tmp_path / "fhir_bundle.json").read_text())["entry"]]
    (stance,) = (
        one for one in reported if one.get("code", {}).get("coding", [{}])[0].get("code") == "left_stance_percent"
    )
    counts = [part["valueInteger"] for part in stance["component"] if "valueInteger" in part]
    assert (counts, stance["status"]) == ([strides], status)


def entries_of(visit: Visit, **changes: Any) -> list[dict[str, Any]]:
    session, analysis = visit
    found: list[dict[str, Any]] = bundle(replace(session, **changes), analysis)["entry"]
    return found


def test_a_patient_of_whom_nothing_is_reported_has_neither_name_nor_sex(visit: Visit) -> None:
    for code, sex in (("", ""), (" ", "diverse")):
        reported = entries_of(visit, patient=Patient(code=code, sex=sex), started="")
        assert reported[0]["resource"].keys() <= {"resourceType", "meta", "identifier"}
        assert reported[0]["resource"]["identifier"] == [
            {"system": "urn:ietf:rfc:3986", "value": reported[0]["fullUrl"]}
        ]
        assert all("effectiveDateTime" not in entry["resource"] for entry in reported)


@pytest.mark.parametrize("sex", ["female", "male", "other"])
def test_a_sex_that_fhir_knows_is_reported(visit: Visit, sex: str) -> None:
    reported = entries_of(visit, patient=Patient(code="P 17", sex=sex, birth_year=950))[0]["resource"]
    assert (reported["gender"], reported["birthDate"]) == (sex, "0950")


def test_an_export_shows_how_far_it_is(visit: Visit, tmp_path: Path) -> None:
    folder = tmp_path / "library"
    folder.mkdir()
    opened = quick_library(folder)
    session, analysis = visit
    reported: list[tuple[float, str]] = []
    with opened:
        room = Room(start_bytes=0, kept_bytes=0)
        session_id = import_session(opened, session, lambda *_: None, code="DEMO", room=room).session_id
        export_from_library(
            opened,
            session_id,
            [Format.MOT],
            tmp_path,
            {},
            lambda share, what: reported.append((share, what)),
            analysed=lambda _: analysis,
        )
    assert reported[-2:] == [(0.5, "analysing"), (1.0, "writing")]
    assert all(isinstance(what, str) and 0.0 <= share <= 1.0 for share, what in reported)


def test_the_workbook_has_what_legs_and_conditions_differ_by_as_the_files_do(tables: Path, exported: Path) -> None:
    """Numbers are numbers, and what is not known is empty; of one condition there is nothing to compare it with."""
    book = openpyxl.load_workbook(exported / "gaitwright.xlsx")
    header, *rows = book["Left vs right"].iter_rows(values_only=True)
    with (tables / "sides.csv").open(encoding="utf-8", newline="") as file:
        written = list(csv.reader(file))
    assert list(header) == written[0]
    assert len(rows) == len(written) - 1 > 10
    for row, line in zip(rows, written[1:], strict=True):
        found = dict(zip(written[0], zip(row, line, strict=True), strict=True))
        for name in ("difference", "error", "low", "high", "healthy_limit"):
            cell, text = found[name]
            assert cell == (float(text) if text else None)
        assert (found["mark"][0] or "") == found["mark"][1]
    assert "Differences" not in book.sheetnames


def test_the_summary_has_the_interval_and_the_mark_of_the_range_of_both_legs(tables: Path) -> None:
    summary = json.loads((tables / "summary.json").read_text(encoding="utf-8"))
    found = [one for one in _dicts(summary) if "low_deg" in one]
    assert found
    for one in found:
        error = one["error_deg"]
        if error is not None:
            assert one["low_deg"] == pytest.approx(one["difference_deg"] - error, abs=1e-4)
            assert one["high_deg"] == pytest.approx(one["difference_deg"] + error, abs=1e-4)
        assert one["beyond_speed_deg"] is None  # both legs walked at one speed
        assert one["mark"] in ("", "beyond_error", "beyond_healthy")


def _dicts(part: object) -> Iterator[dict[str, Any]]:
    if isinstance(part, dict):
        yield part
    for inner in part.values() if isinstance(part, dict) else part if isinstance(part, list) else ():
        yield from _dicts(inner)

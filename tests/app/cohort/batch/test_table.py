"""The table holds what each session's summary.json holds, figure by figure with its verdict, and nobody's name."""

import json
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from app.cli.main import main
from app.cohort.batch.rows import COLUMNS, Row
from app.cohort.batch.table import write_tables
from devices.files.session_folder import write_session
from tests.app.batch_material import walked_session, write_swinging
from tests.app.exports.written_tables import csv_rows

STATED_OF_PATIENT = ("MUSTER", "Muster", "Anna", "Keller", "Bern", "limped")
VERDICTS = {"read", "care", "withheld", "not_measured"}


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A batch of a walk with both feet, whose patient stated much, and of two sessions without feet."""
    place = tmp_path_factory.mktemp("table")
    write_session(walked_session(), place / "in" / "walked")
    write_swinging(place / "in", 2)
    arguments = ["--out", str(place / "out"), "--no-report", "--no-rrd", "--workers", "1"]
    assert main(["batch", str(place / "in"), *arguments]) == 0
    return place / "out"


def rows_of(out: Path) -> list[dict[str, str]]:
    return csv_rows(out / "parameters.csv")


def test_every_figure_and_verdict_is_that_of_the_sessions_summary(out: Path) -> None:
    rows, compared = rows_of(out), 0
    for row in rows:
        walk = json.loads((out / row["session"] / "summary.json").read_bytes())["walks"][row["walk"]]
        reported = walk[row["side"]]
        for column, cell in row.items():
            if column.endswith(("_status", "_sd", "_error")):
                required = (
                    reported.get(column) if not column.startswith("walk_speed") else walk["both"]["speed_m_s_status"]
                )
            elif f"{column}_status" in row:
                name = column if row["side"] == "both" else f"{column}_mean"
                required = reported.get(name) if column != "walk_speed_m_s" else walk["both"]["speed_m_s"]
            else:
                continue
            assert cell == ("" if required is None else required if isinstance(required, str) else repr(required)), (
                column
            )
            compared += bool(cell)
    assert compared > 150
    assert [(row["session"], row["side"]) for row in rows] == [
        (session, side) for session in ("visit 000", "visit 001", "walked") for side in ("left", "right", "both")
    ]


def test_each_number_of_a_leg_has_a_verdict_beside_it_and_a_not_reported_one_is_empty(out: Path) -> None:
    for row in rows_of(out):
        for column, cell in row.items():
            if f"{column}_status" in row and cell:
                assert row[f"{column}_status"] in {"read", "care"}, column
            if column.endswith("_status") and cell:
                assert cell in VERDICTS
                assert cell in {"read", "care"} or not row[column.removesuffix("_status")]


def test_what_groups_the_rows_is_what_was_reported_of_the_patient(out: Path) -> None:
    left, right, both = rows_of(out)[-3:]
    assert (left["is_affected"], right["is_affected"], both["is_affected"]) == ("true", "false", "")
    assert (left["is_prosthetic"], right["is_prosthetic"]) == ("false", "true")
    reported = ("condition", "device", "aids", "sex", "age_years", "height_m", "mass_kg", "started", "is_simulated")
    assert [left[name] for name in reported] == [
        *("barefoot", "C-Leg 4", "cane", "female", "90", "1.62", "58.5", "2026-05-04", "true"),
    ]


def test_nobodys_name_is_in_the_table(out: Path) -> None:
    parquet = json.dumps(pq.read_table(out / "parameters.parquet").to_pylist())
    for stated in STATED_OF_PATIENT:
        assert stated not in (out / "parameters.csv").read_text(encoding="utf-8")
        assert stated not in parquet
        for record in (out / ".gaitwright-batch").rglob("*.json"):
            assert stated not in record.read_text(encoding="utf-8")
    assert not any("1930" in row.values() for row in rows_of(out))  # as a cell: digits of figures may be the same


def test_sessions_of_one_patient_have_one_number_and_those_of_another_have_another(tmp_path: Path) -> None:
    write_swinging(tmp_path / "in", 3, most_patients=2)
    arguments = ["--out", str(tmp_path / "out"), "--no-report", "--no-rrd", "--workers", "1"]
    assert main(["batch", str(tmp_path / "in"), *arguments]) == 0
    assert [row["patient"] for row in rows_of(tmp_path / "out")[::3]] == ["patient 1", "patient 2", "patient 1"]


def test_both_files_hold_the_same(out: Path) -> None:
    table = pq.read_table(out / "parameters.parquet")
    assert table.column_names == list(COLUMNS) == list(rows_of(out)[0])
    for row, cells in zip(table.to_pylist(), rows_of(out), strict=True):
        for name, value in row.items():
            required = "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
            assert cells[name] == required


def test_what_begins_as_a_formula_is_none_in_the_csv(tmp_path: Path) -> None:
    row: Row = {"session": "=1+1", "device": "@SUM(A1)", "height_m": -1.5}
    (tmp_path / "beside").mkdir()
    assert write_tables([row], tmp_path / "beside", tmp_path) == 1
    (cells,) = rows_of(tmp_path)
    assert (cells["session"], cells["device"], cells["height_m"]) == ("'=1+1", "'@SUM(A1)", "-1.5")
    assert pq.read_table(tmp_path / "parameters.parquet")["session"].to_pylist() == ["=1+1"]


def test_many_rows_leave_in_groups_that_a_database_takes_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.cohort.batch.table.GROUP_ROWS", 2048)
    (tmp_path / "beside").mkdir()
    given: Iterator[Row] = ({"session": f"visit {number}", "strides_used": number} for number in range(5000))
    assert write_tables(given, tmp_path / "beside", tmp_path) == 5000
    file = pq.ParquetFile(tmp_path / "parameters.parquet")
    assert [file.metadata.row_group(group).num_rows for group in range(file.num_row_groups)] == [2048, 2048, 904]
    assert file.read()["strides_used"].to_pylist() == list(range(5000))

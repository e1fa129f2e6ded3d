"""Tests that a program can read every table by its metadata alone.

Columns are in order, and cells are of the type that is reported.
"""

import csv
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from app.exports.csvw import METADATA
from app.exports.result_folder import TAKEN, write_results
from tests.app.exports.written_tables import csv_rows
from tests.simulated import SHORT_VISIT, analysis_of, session_of

PARSED: Mapping[str, Callable[[str], object]] = {
    "number": float,
    "integer": int,
    "boolean": {"true": True, "false": False}.__getitem__,
    "string": str,
}


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("out")
    session = session_of(SHORT_VISIT)
    write_results(session, analysis_of(session), folder)
    return folder


def tables(out: Path) -> dict[str, list[dict[str, Any]]]:
    found = json.loads((out / METADATA).read_text(encoding="utf-8"))
    assert found["@context"][0] == "http://www.w3.org/ns/csvw"
    return {table["url"]: table["tableSchema"]["columns"] for table in found["tables"]}


def test_every_table_is_in_it_with_its_columns_in_order(out: Path) -> None:
    reported = tables(out)
    assert set(reported) == {path.relative_to(out).as_posix() for path in out.rglob("*.csv")}
    for url, columns in reported.items():
        with (out / url).open(newline="", encoding="utf-8") as file:
            assert next(csv.reader(file)) == [column["titles"] for column in columns], url
    assert (METADATA,) in TAKEN


def test_every_cell_that_is_not_empty_has_the_type_that_is_reported(out: Path) -> None:
    parsed = 0
    for url, columns in tables(out).items():
        for row in csv_rows(out / url):
            for column in columns:
                if cell := row[column["titles"]]:
                    PARSED[column["datatype"]](cell)
                    parsed += column["datatype"] == "number"
    assert parsed > 1000


def test_an_excursion_has_its_unit_and_definition(out: Path) -> None:
    (column,) = [one for one in tables(out)["peaks.csv"] if one["name"] == "ankle_push_off_deg"]
    assert column["datatype"] == "number"
    assert column["schema:unitText"] == "deg"
    assert column["dc:description"] == "largest angle from 20 to 60 % less smallest angle from 50 to 80 %"

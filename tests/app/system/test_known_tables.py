"""What tables mean is kept by the places of their columns alone; a file that was damaged asks for it again."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

from app.system import kept_json
from app.system.known_tables import keep_table, known_tables
from devices.files.table_choices import NO_CHOICES, NONE, TableChoices

NAMES = ("Time", "Smith x", "Smith y", "Smith z", "gx", "gy", "gz")
STATED = TableChoices("utf-16", 3, ";", ",", NAMES[1:4], "g", NAMES[4:], "deg/s", "Time", "ms", NONE, 100.0)
KEPT = replace(STATED, acc=("2", "3", "4"), gyr=("5", "6", "7"), time="1")


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    place = tmp_path / "not there yet" / "tables.json"
    monkeypatch.setattr(kept_json, "place_of", place.with_name)
    return place


def test_tables_are_kept_by_what_they_have_in_common(place: Path) -> None:
    assert known_tables() == {}
    keep_table("one", STATED, NAMES)
    keep_table("other", TableChoices(acc=(NONE,), gyr=NAMES[1:4]), NAMES)
    assert known_tables() == {"one": KEPT, "other": TableChoices(acc=(NONE,), gyr=("2", "3", "4"))}
    assert "Smith" not in place.read_text()
    assert "Time" not in place.read_text()
    keep_table("one", NO_CHOICES, NAMES)  # nothing is stated of them any more
    assert [*known_tables()] == ["other"]


def test_a_place_that_would_name_another_column_is_not_kept(place: Path) -> None:
    keep_table("one", TableChoices(time="b"), ("a", "b"))
    keep_table("one", TableChoices(time="b"), ("2", "b"))  # "2" is the name of the first
    assert known_tables() == {}


DAMAGED: dict[str, Any] = {
    "acc": ["2", "3", "name"],
    "gyr": ["2", "3"],
    "acc_unit": "stone",
    "gyr_unit": "g",
    "time": "Time",
    "time_unit": "fortnights",
    "sensor": "-1",
    "encoding": "rot13",
    "separator": "ab",
    "decimal": ".,",
    "header_line": -1,
    "rate_hz": 0.0,
    "colour": "red",
}


@pytest.mark.parametrize("key", DAMAGED)
def test_what_this_program_never_keeps_is_left_out(place: Path, key: str) -> None:
    place.parent.mkdir()
    whole = asdict(KEPT)
    place.write_text(json.dumps({"good": whole, "bad": {**whole, key: DAMAGED[key]}, "": whole}))
    assert known_tables() == {"good": KEPT}


@pytest.mark.parametrize("damaged", ["", "[]", '{"a": 5}', '{"a": {}}', '{"a": {"acc": 5, "gyr": []}}', "{"])
def test_a_damaged_file_keeps_nothing(place: Path, damaged: str) -> None:
    place.parent.mkdir()
    place.write_text(damaged)
    assert known_tables() == {}

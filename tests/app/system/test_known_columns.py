"""What columns mean is reported once; a file that was damaged asks for it again."""

from pathlib import Path

import pytest

from app.system import kept_json
from app.system.known_columns import keep_columns, known_columns
from devices.drivers.csv_serial import Columns

COLUMNS = Columns(0, (1, 2, 3), (4, 5, 6), signs=(1, 1, -1, 1, 1, 1), count=7)


def test_columns_are_kept_by_what_is_plugged_in(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    place = tmp_path / "not there yet" / "columns.json"
    monkeypatch.setattr(kept_json, "place_of", place.with_name)
    assert known_columns() == {}
    keep_columns(["0403:6001 A1", "/dev/ttyS4"], COLUMNS)
    other = Columns(0, (4, 5, 6), (1, 2, 3))
    keep_columns(["/dev/ttyS4"], other)
    assert known_columns() == {"0403:6001 A1": COLUMNS, "/dev/ttyS4": other}


@pytest.mark.parametrize("damaged", ["", "[]", '{"a": 5}', '{"a": {"columns": {"time": 1}}}', '{"a": {"columns": []}}'])
def test_what_cannot_be_read_is_left_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, damaged: str) -> None:
    (tmp_path / "columns.json").write_text(damaged)
    monkeypatch.setattr(kept_json, "place_of", tmp_path.joinpath)
    assert known_columns() == {}

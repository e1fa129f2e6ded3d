"""What is found as CSV and on a terminal: every digit, empty cells, no formula, and no half file."""

import csv
import datetime
import math
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path

import pytest

from app.cohort.study.found_csv import MOST_ON_TERMINAL, aligned_lines, check_csv_place, csv_lines, write_csv
from app.system.tables import csv_cell
from devices.files.refusal import FileRefusedError


@pytest.mark.parametrize(
    ("value", "cell"),
    [
        (None, ""),
        (math.nan, ""),
        (-0.1 - 0.2, "-0.30000000000000004"),
        (-3, "-3"),
        (Decimal("-1.50"), "-1.50"),
        (True, "true"),
        ("=1+1", "'=1+1"),
        ("-1", "'-1"),
        (" @x", "' @x"),
        (datetime.date(2026, 3, 9), "2026-03-09"),
        ([1, 2], "[1, 2]"),
    ],
)
def test_a_number_keeps_its_digits_and_no_text_is_worked_out(value: object, cell: str) -> None:
    assert csv_cell(value) == cell


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    out = tmp_path / "new" / "a.csv"
    assert write_csv(("a", "=b"), [("x, y", 'a "word"\nand another'), (None, 2.5)], out) == 2
    with out.open(newline="", encoding="utf-8") as file:
        assert list(csv.reader(file)) == [["a", "'=b"], ["x, y", 'a "word"\nand another'], ["", "2.5"]]


def test_a_file_stays_as_it_was_when_the_answer_breaks_off(tmp_path: Path) -> None:
    def broken() -> Iterator[tuple[int]]:
        yield (1,)
        raise KeyboardInterrupt

    out = tmp_path / "a.csv"
    out.write_text("before")
    with pytest.raises(KeyboardInterrupt):
        write_csv(("a",), broken(), out)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("a.csv", "before")]


def test_only_a_csv_file_is_replaced_and_never_the_table(tmp_path: Path) -> None:
    for name in ("notes.txt", "table.csv", "old.csv"):
        (tmp_path / name).touch()
    check_csv_place(tmp_path / "old.csv", tmp_path / "table.csv")
    check_csv_place(tmp_path / "new.txt", tmp_path / "table.csv")
    for place in (tmp_path, tmp_path / "notes.txt", tmp_path / "table.csv"):
        with pytest.raises(FileRefusedError):
            check_csv_place(place, tmp_path / "table.csv")


def test_a_terminal_gets_columns_that_align() -> None:
    lines = list(aligned_lines(("name", "n", "mean"), [("a", 5, 1 / 3), ("long\tname", 12, None)]))
    assert lines == ["name        n      mean", "a           5  0.333333", "long name  12"]


def test_a_terminal_is_reported_when_rows_are_left_out() -> None:
    assert "--out" not in list(aligned_lines(("n",), ((k,) for k in range(MOST_ON_TERMINAL))))[-1]
    assert "--out" in list(aligned_lines(("n",), ((k,) for k in range(MOST_ON_TERMINAL + 1))))[-1]


def test_names_alone_are_a_table_without_rows() -> None:
    assert list(csv_lines(("a", "b"), [])) == ["a,b"]
    assert list(aligned_lines(("a", "b"), [])) == ["a  b"]

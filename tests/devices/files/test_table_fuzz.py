"""Spoilt tables that nobody knows raise nothing but refusals, end nothing, and are read as they are shown."""

import random
import time
from dataclasses import replace
from pathlib import Path

import pytest

from devices.files.limited_reader import LimitedReader
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import NO_CHOICES, TableChoices
from devices.files.table_preview import preview_of
from tests.devices.files.test_public_layouts import LEFT, lpms, rows_of, write
from tests.devices.files.test_table_preview import NAMES, STATED, table
from tests.safety.file_fuzz import fuzz
from tests.safety.table_fuzz import stated_at_random, tables

FEW = 5  # of each kind, in the default run; `python -m tests.safety.table_fuzz` reads thousands


@pytest.mark.parametrize("name", tables())
def test_a_spoilt_table_is_previewed_and_read_or_refused(name: str, shared_reader: LimitedReader) -> None:
    found = fuzz(tables()[name], FEW, 7, shared_reader)
    assert found.faults == []
    assert found.count["read"] > 0
    assert found.count["refused"] > 0


def test_what_is_stated_at_random_is_right_and_wrong() -> None:
    chance = random.Random(1)
    stated = [stated_at_random(NO_CHOICES, chance, NAMES) for _ in range(200)]
    assert NO_CHOICES in stated
    assert {one.time_unit for one in stated} > {"", "ms", "clock"}
    assert {one.header_line for one in stated} >= {None, 0, 1, 1000}


def test_a_column_is_one_quantity(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv")
    for stated in (
        replace(STATED, sensor="t"),
        replace(STATED, time="p"),
        replace(STATED, acc=("t", "q", "r")),
        replace(STATED, gyr=("p", "u", "v")),
    ):
        assert "is chosen for two quantities" in str(preview_of(path, stated).refusal)


def test_what_else_a_column_was_found_to_be_gives_way(tmp_path: Path) -> None:
    """The names of sensors are not in a quaternion, nor is a count in their place."""
    (path,) = lpms(tmp_path)
    assert "different names of sensors" in str(preview_of(path, TableChoices(sensor="FrameNumber")).refusal)
    assert preview_of(path, TableChoices(sensor="QuatW")).sensors
    assert preview_of(path, TableChoices(time="QuatW")).refusal is not None


def test_a_table_as_wide_as_none_is_refused_at_once(tmp_path: Path) -> None:
    same = write(tmp_path / "a.csv", [",".join(["x"] * 30_000), ",".join(["1"] * 30_000)])
    for path in (same, write(tmp_path / "b.csv", ["1," * 30_000] * 3)):
        assert "30000 columns" in str(preview_of(path, NO_CHOICES).refusal).replace("30001", "30000")
    wide = [",".join(NAMES + tuple(f"n{k}" for k in range(1500)))]
    rest = ",0" * 1500
    body = [row + rest for row in rows_of(LEFT.time_s[:100], LEFT.acc[:100], LEFT.gyr[:100])]
    preview = preview_of(write(tmp_path / "c.csv", wide + body), replace(STATED, gyr_unit="rad/s"))
    assert preview.refusal is None
    assert len(preview.columns) == 1507


def test_utf_16_is_stated_of_what_is_none(tmp_path: Path) -> None:
    refusal = preview_of(table(tmp_path / "a.csv"), TableChoices(encoding="utf-16")).refusal
    assert isinstance(refusal, FileRefusedError)
    unmarked = write(tmp_path / "b.csv", table(tmp_path / "a.csv").read_text().splitlines(), "utf-16-be")
    assert preview_of(unmarked, replace(STATED, encoding="utf-16")).refusal is None


LONG = {
    "digits": "9" * 100_000 + "x",
    "digits and points": "9" * 100_000 + "." + "9" * 100_000 + "..",
    "blanks": " " * 100_000 + "x",
    "a time and blanks": "12:30:00" + " " * 100_000 + "x",
    "a date and blanks": "2026-11-28" + " " * 100_000 + "x",
    "exponents": "1e" * 50_000,
    "rates": "sampl_" * 20_000,
}


@pytest.mark.endurance  # measures time, if that of the processor
@pytest.mark.parametrize("cell", LONG.values(), ids=LONG)
def test_a_long_cell_is_looked_at_once(cell: str, tmp_path: Path) -> None:
    """By the work that it takes: twenty times the cell takes about twenty times as long, not four hundred."""

    def took_s(length: int) -> float:
        body = rows_of(LEFT.time_s[:50], LEFT.acc[:50], LEFT.gyr[:50])
        lines = [
            cell[: length // 2] + cell[-length // 2 :],
            ",".join(NAMES),
            *body[:20],
            f"{cell[-length:]},1,2,3,4,5,6",
        ]
        path = write(tmp_path / "a.csv", [*lines, *body[20:]])
        began_s = time.process_time()
        preview_of(path, NO_CHOICES)
        return time.process_time() - began_s

    took_s(100)
    short_s, long_s = min(took_s(2_000) for _ in range(3)), min(took_s(40_000) for _ in range(2))
    assert long_s < 20 * max(short_s, 0.02)

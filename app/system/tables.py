"""Small tables of text as CSV files, safe to open in a spreadsheet."""

import csv
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

FORMULA = ("=", "+", "-", "@")


def write_table(header: Sequence[str], rows: Iterable[Sequence[str]], path: Path) -> None:
    """Write a small table of cells that are texts already.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with path.open("w", encoding="utf-8", errors="backslashreplace", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])


def figure_cell(value: float) -> str:
    """A figure as a table of CSV has it; empty where there is none."""
    return f"{value:.5f}" if math.isfinite(value) else ""


def typed_cell(text: str) -> str:
    """What somebody typed, as a cell that no spreadsheet works out: where it begins as a formula, ' goes before it."""
    return f"'{text}" if text.lstrip().startswith(FORMULA) or text.startswith(("\t", "\r", "\n")) else text

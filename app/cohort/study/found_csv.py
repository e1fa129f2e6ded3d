"""What a question found as CSV, in a file or line by line, and aligned for a terminal."""

import csv
import io
import math
import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path

from app.system.tables import csv_cell
from devices.files.refusal import FileRefusedError, one_line

MOST_ON_TERMINAL = 1000  # rows: who wants more wants a file
WIDEST_ON_TERMINAL = 40  # letters of a cell
DIGITS_ON_TERMINAL = 6


def csv_lines(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> Iterator[str]:
    """Give the lines of a CSV file, without their ends; a cell with a line break in it goes over two."""
    kept = io.StringIO()
    writer = csv.writer(kept, lineterminator="")
    for values in chain([columns], rows):
        writer.writerow([csv_cell(value) for value in values])
        yield kept.getvalue()
        kept.seek(0)
        kept.truncate()


def check_csv_place(out: Path, table: Path) -> None:
    """Raise FileRefusedError where anything but a CSV file, or the table itself, is at `out`."""
    if out.is_dir():
        raise FileRefusedError(str(out), "this is a folder", "Enter a file name, such as answer.csv")
    if out.exists() and (out.suffix.lower() != ".csv" or out.resolve() == table.resolve()):
        raise FileRefusedError(str(out), "this already exists and is not a CSV file", "Choose another --out")


def write_csv(columns: Sequence[str], rows: Iterable[Sequence[object]], out: Path) -> int:
    """Write a CSV file whole or not at all, and give the number of rows; raises OSError, keeping the old file."""
    out.parent.mkdir(parents=True, exist_ok=True)
    handle, beside = tempfile.mkstemp(prefix=f".{out.name}-", dir=out.parent)
    count = -1  # the names of the columns are no row
    try:
        with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace", newline="") as file:
            for line in csv_lines(columns, rows):
                file.write(line + "\n")
                count += 1
        Path(beside).replace(out)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise
    return count


def aligned_lines(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> Iterator[str]:
    """Lay out a table for a terminal, cutting long texts and, with a note, rows after `MOST_ON_TERMINAL`."""
    left = iter(rows)
    shown = [tuple(row) for row in islice(left, MOST_ON_TERMINAL)]
    cells = [[_short(name) for name in columns], *([_short(value) for value in row] for row in shown)]
    widths = [max(len(row[at]) for row in cells) for at in range(len(columns))]
    is_number = [_is_number(row[at] for row in shown) for at in range(len(columns))]
    for row in cells:
        padded = (
            cell.rjust(width) if number else cell.ljust(width)
            for cell, width, number in zip(row, widths, is_number, strict=True)
        )
        yield "  ".join(padded).rstrip()
    if next(left, None) is not None:
        yield f"The first {MOST_ON_TERMINAL} rows; --out writes all of them."


def _short(value: object) -> str:
    if isinstance(value, float) and not math.isnan(value):
        return f"{value:.{DIGITS_ON_TERMINAL}g}"
    text = one_line(value if isinstance(value, str) else csv_cell(value))
    return text if len(text) <= WIDEST_ON_TERMINAL else f"{text[: WIDEST_ON_TERMINAL - 3]}..."


def _is_number(values: Iterable[object]) -> bool:
    known = [value for value in values if value is not None]
    return bool(known) and all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in known)

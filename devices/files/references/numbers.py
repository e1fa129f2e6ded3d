"""Texts of tab or blank separated numbers under a header, as motion laboratories' programs write them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from core.samples import FloatArray
from devices.files.refusal import FileRefusedError, quoted
from devices.files.table_header import COPY_AGAIN, CORRECT_IT
from devices.files.tables import number_in
from devices.files.text_files import open_text


def lines_of(path: Path) -> list[str]:
    """Read the lines of a text; raises FileRefusedError where it is no text."""
    with open_text(path) as file:
        content = file.read()
    try:
        return content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise FileRefusedError(f"{path.name}, line {line}", "the file is not UTF-8 text", CORRECT_IT) from error


def numbers_below(
    lines: Sequence[str], first: int, columns: Sequence[int], count: int, where: str, delimiter: str | None = None
) -> FloatArray:
    """Read columns (n, len(columns)) from line `first`, empty cells NaN; raises FileRefusedError."""
    rows = []
    for number, line in enumerate(lines[first:], first + 1):
        if not line.strip():
            continue
        cells = line.split(delimiter)
        if delimiter is not None and len(cells) == count + 1 and not cells[-1].strip():
            cells.pop()  # some programs end their lines with the delimiter
        if len(cells) != count:
            raise FileRefusedError(
                f"{where}, line {number}",
                "the line has {count} columns, but the header has {whole}",
                COPY_AGAIN,
                count=len(cells),
                whole=count,
            )
        rows.append([_number(cells[k], f"{where}, line {number}") for k in columns])
    if not rows:
        raise FileRefusedError(where, "there are no rows below the header", COPY_AGAIN)
    return np.array(rows)


def check_ascending(time_s: FloatArray, where: str) -> None:
    """Refuse a clock that stops, steps back or lacks a stamp; raises FileRefusedError."""
    if not np.isfinite(time_s).all():
        row = int(np.argmin(np.isfinite(time_s))) + 1
        raise FileRefusedError(where, "row {row} has no time", CORRECT_IT, row=row)
    steps = np.diff(time_s)
    if (steps <= 0).any():
        k = int(np.argmax(steps <= 0))
        raise FileRefusedError(
            where,
            "in row {row} time does not increase: from {one} s to {other} s",
            "Export the file again with ascending times",
            one=f"{time_s[k]:g}",
            other=f"{time_s[k + 1]:g}",
            row=k + 2,
        )


def _number(cell: str, where: str) -> float:
    try:
        value = number_in(cell)
    except ValueError:
        raise FileRefusedError(where, "{cell} is not a number", CORRECT_IT, cell=quoted(cell.strip())) from None
    return value if np.isfinite(value) else np.nan

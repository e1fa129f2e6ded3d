"""Sheets of Excel files read as tables."""

import zipfile
import zlib
from collections.abc import Collection, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from devices.files.refusal import FileRefusedError, quoted
from devices.files.table_header import COPY_AGAIN, CORRECT_IT
from devices.files.tables import Table

ZIP = b"PK\x03\x04"
WORDS_OF_SHEETS = ("xl/sharedStrings.xml", "xl/worksheets/sheet1.xml")  # where an Excel file keeps what cells say
MOST_ROWS = 1_048_576  # of a sheet; a damaged file may name a row far beyond it
HEADER_WITHIN = 50  # rows; what is before the header of a measurement is short
# what the library raises of damaged files; it has no error of its own for most of them
DAMAGED = (
    zipfile.BadZipFile,
    zlib.error,
    SyntaxError,  # of which the XML parser's is one
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
    NotImplementedError,
    OSError,
    RuntimeError,
    TypeError,
    ValueError,
)


def sheet_states(path: Path, word: bytes, within: int = 65_536) -> bool:
    """Whether an Excel file holds a word near the beginning of its first sheet or of the texts of its cells."""
    try:
        with zipfile.ZipFile(path) as archive:
            for name in WORDS_OF_SHEETS:
                if name in archive.namelist():
                    with archive.open(name) as file:
                        if word in file.read(within):
                            return True
    except DAMAGED:
        pass
    return False


def read_xlsx(path: Path, where: str, numeric: Collection[str], header_names: str) -> tuple[list[list[str]], Table]:
    """Read the first sheet with the header: rows before it as texts, and the table; raises FileRefusedError."""
    if find_spec("openpyxl") is None:
        raise FileRefusedError(
            where,
            "reading the file needs {library}, which is not installed",
            "Install gaitwright[imports]",
            library="openpyxl",
        )
    import openpyxl  # an extra, and slow to import

    try:
        with path.open("rb") as file:
            book = openpyxl.load_workbook(file, read_only=True, data_only=True)
            for sheet in book.worksheets:
                sheet.reset_dimensions()  # the size that it gives may be wrong
                found = _read_sheet(sheet.iter_rows(values_only=True), where, numeric, header_names)
                if found is not None:
                    return found
    except DAMAGED as error:
        raise FileRefusedError(
            where, "the file is not a readable Excel file ({why})", COPY_AGAIN, why=quoted(error)
        ) from error
    raise FileRefusedError(where, "column {name} is missing", CORRECT_IT, name=header_names)


def _read_sheet(
    rows: Iterator[tuple[Any, ...]], where: str, numeric: Collection[str], header_names: str
) -> tuple[list[list[str]], Table] | None:
    before: list[list[str]] = []
    for row in rows:
        texts = ["" if cell is None else str(cell).strip() for cell in row]
        if header_names in texts:
            break
        before.append(texts)
        if len(before) == HEADER_WITHIN:
            return None
    else:
        return None
    places = {name: texts.index(name) for name in texts if name in numeric}
    for name in places:
        if texts.count(name) > 1:
            raise FileRefusedError(where, "column {name} appears twice", CORRECT_IT, name=name)
    first = len(before) + 2
    values: list[list[float]] = []
    numbers: list[int] = []
    for number, row in enumerate(rows, first):
        if number > MOST_ROWS:
            raise FileRefusedError(where, "the file refers to rows beyond row {most}", COPY_AGAIN, most=MOST_ROWS)
        cells = [row[place] if place < len(row) else None for place in places.values()]
        if any(cell not in (None, "") for cell in cells):
            values.append([_number(cell, f"{where}, row {number}") for cell in cells])
            numbers.append(number)
    matrix = np.array(values, dtype=float).reshape(-1, len(places))
    columns = {name: matrix[:, k] for k, name in enumerate(places)}
    return before, Table(columns, {}, len(matrix), lambda row: f"row {numbers[row]}")


def _number(cell: object, where: str) -> float:
    if cell is None or cell == "":
        return np.nan
    try:
        return float(str(cell))
    except ValueError:
        raise FileRefusedError(where, "{cell} is not a number", CORRECT_IT, cell=quoted(cell)) from None

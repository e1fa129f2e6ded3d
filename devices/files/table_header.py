"""The header of a table in a text: the names of its columns, what divides them, and where the rows begin."""

import csv
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import BinaryIO

from devices.files.refusal import FileRefusedError, quoted

LONGEST_HEADER = 100_000  # bytes; a line without end is no header
UNNAMED = "column"  # a column without a name is called by its place: "column 9"
COPY_AGAIN = "Copy the file again from where it was recorded"
CORRECT_IT = "Correct the file or export it again"
DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+(e[+-]?\d+)?", re.IGNORECASE | re.ASCII)
SEPARATOR_LINE = re.compile(rb'"?sep=(.)"?[,;\t ]*', re.IGNORECASE)  # for Excel
SEEN_ROWS = 20  # by which a decimal comma is found

Open = Callable[[], BinaryIO]
"""Opens a table's text, as UTF-8."""


@dataclass(frozen=True, slots=True)
class TableHeader:
    """`line`: the number of the last line before the rows; `start`: the rows' first byte. `decimal`: of their numbers.

    `before`: the lines above the header, as they are.
    """

    names: tuple[str, ...]
    delimiter: str
    line: int
    start: int
    decimal: str = "."
    before: tuple[str, ...] = ()


def read_header(
    file: BinaryIO,
    where: str,
    *,
    comment: str | None = None,
    delimiters: str = ",",
    header_names: str = "",
    has_units: bool = False,
) -> TableHeader:
    """Find the header; raises FileRefusedError.

    It is the first line that holds `header_names`, is not empty, and does not begin with `comment`; a line of units
    follows it if `has_units`. The delimiter is the one that divides it most.
    """
    number, before = 0, list[str]()
    while raw := file.readline(LONGEST_HEADER):
        number += 1
        if header_names.encode() not in raw:
            before.append(_shown(raw))
            continue
        text = _text(raw, number, where)
        stated = SEPARATOR_LINE.fullmatch(raw.removeprefix(b"\xef\xbb\xbf").rstrip(b"\r\n")) if number == 1 else None
        if stated or not text or (comment is not None and text.startswith(comment)):
            before.append(_shown(raw))
            delimiters = stated[1].decode("latin-1") if stated else delimiters
            continue
        delimiter = max(delimiters, key=text.count)
        names = names_of(cells_of(text, delimiter))
        refuse_twice(names, where, f"line {number}")
        number += _pass_line(file) if has_units else 0
        start = file.tell()
        rows = first_rows(file, delimiter)
        file.seek(start)
        if rows and all(len(row) == len(names) + 1 and not row[-1].strip() for row in rows):
            names.append(f"{UNNAMED} {len(names) + 1}")  # a delimiter follows the last cell of each row
        return TableHeader(tuple(names), delimiter, number, start, decimal_of(rows), tuple(before))
    raise FileRefusedError(where, "the file has no header line", COPY_AGAIN)


def names_of(cells: list[str]) -> list[str]:
    """The names that stand in a header's cells; an empty one is called by its place."""
    return [name.strip() or f"{UNNAMED} {i}" for i, name in enumerate(cells, 1)]


def decimal_of(rows: list[list[str]]) -> str:
    """The decimal sign of numbers in rows: "," in files of some countries."""
    return "," if any(DECIMAL_COMMA.fullmatch(cell.strip()) for row in rows for cell in row) else "."


def first_rows(file: BinaryIO, delimiter: str) -> list[list[str]]:
    """The cells of the next lines that are not empty; as far as they are text."""
    rows: list[list[str]] = []
    while len(rows) < SEEN_ROWS and (raw := file.readline(LONGEST_HEADER)):
        try:
            if text := raw.decode().strip("\r\n"):
                rows.append(cells_of(text, delimiter))
        except (UnicodeDecodeError, csv.Error):
            break
    return rows


def cells_of(text: str, delimiter: str) -> list[str]:
    """The cells of one line; raises csv.Error."""
    return next(csv.reader([text], delimiter=delimiter, skipinitialspace=delimiter != " "), [])


def refuse_twice(names: list[str], where: str, place: str) -> None:
    """Refuse a header that gives a name twice; raises FileRefusedError."""
    twice = next((name for name, count in Counter(names).items() if count > 1), None)
    if twice is not None:
        raise FileRefusedError(f"{where}, {place}", "column {name} appears twice", CORRECT_IT, name=quoted(twice))


def _text(raw: bytes, number: int, where: str) -> str:
    here = f"{where}, line {number}"
    try:
        text = raw.decode("utf-8-sig" if number == 1 else "utf-8").strip(" \r\n")
    except UnicodeDecodeError as error:
        raise FileRefusedError(here, "the file is not UTF-8 text", CORRECT_IT) from error
    if "\r" in text:
        raise FileRefusedError(here, "the line contains a line break (carriage return)", CORRECT_IT)
    if "\0" in text or len(raw) == LONGEST_HEADER:
        raise FileRefusedError(here, "the file is not a table but binary data", CORRECT_IT)
    return text


def _shown(raw: bytes) -> str:
    return raw.decode("utf-8-sig", "replace").strip()


def _pass_line(file: BinaryIO) -> int:
    """Pass over the next line that is not empty; how many lines that were."""
    lines = 0
    while raw := file.readline(LONGEST_HEADER):
        lines += 1
        if raw.strip():
            break
    return lines

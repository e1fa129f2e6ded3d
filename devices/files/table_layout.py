"""How the table in a text of no particular program is laid out: encoding, header, separator, decimal sign, units.

Everything is found by the first rows, where nobody states it. Lines above the header (a preamble), a line of units
below it, a separator after the last cell and a line `sep=;` are what programs add.
"""

import csv
import io
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import BinaryIO

from devices.files.column_names import Quantity, is_unit, meaning_of, unit_of, without_brackets
from devices.files.refusal import FileRefusedError, quoted
from devices.files.table_choices import NO_CHOICES, SEPARATORS, TableChoices
from devices.files.table_header import CORRECT_IT, SEPARATOR_LINE, Open, TableHeader, decimal_of, names_of
from devices.files.tables import COMMENT, NO_VALUE, is_value
from devices.files.text_files import CONTROLS, encoding_of, open_text

HEAD_BYTES = 262_144
MOST_LINES = 400  # by which a layout is found
MOST_COLUMNS = 2000  # dozens of sensors, with all that each may give
LEAST_NUMBERS = 3  # of a row: three axes
FIRST_ROWS = 20
JUDGED_LINES, JUDGED_CELLS = 20, 100  # above the first row, among which is the header
FEW_THOUSANDS = 3  # different numbers with such a sign, and as many without one
WHOLE = re.compile(r"[+-]?\d{1,3}", re.ASCII)
KEY = re.compile(r"[^\W\d][^=:]*[=:]")  # a first cell "Rate:" or "TopValue=": the line describes the file
NAMELESS = "nameless "  # begins the fingerprint of what has no header
BLANKS = re.compile(rb"[ \t]+")
RATE = re.compile(
    r"(?:sampl\w{0,9}[ _-]{0,3}(?:rate|freq\w{0,9})|(?:data|update|output)[ _-]{0,3}rate|\bfs\b|abtastrate)"
    r"[^0-9\n]{0,14}(\d+(?:[.,]\d+)?)",
    re.IGNORECASE | re.ASCII,
)
NO_TABLE = "the file format is not recognised, and the file is not a table of numbers"
EXPORT_TABLE = "Leave this file out, or export the recording as a table with one row for each sample"


@dataclass(frozen=True, slots=True)
class TableLayout:
    """`header_line`: from 1; 0 where there is none. `rows`: the first ones, as cells. `names` are all different.

    `twice`: a name that the header gives more than once, empty where there is none. `rate_hz`: of the lines above.
    """

    path: Path
    encoding: str
    header: TableHeader
    header_line: int
    units: Mapping[str, str]
    rows: tuple[tuple[str, ...], ...]
    twice: str = ""
    rate_hz: float | None = None
    most_bytes: int = 0

    @property
    def fingerprint(self) -> str:
        """What tables of one program have in common: their names and what divides them, without any of the words.

        Without names, tables of many programs have it in common.
        """
        names = [*self.names] if self.header_line else [str(len(self.names))]
        hashed = sha256("\x1f".join([self.header.delimiter, *names]).encode()).hexdigest()[:16]
        return hashed if self.header_line else f"{NAMELESS}{hashed}"

    @property
    def names(self) -> tuple[str, ...]:
        return self.header.names

    @property
    def opened(self) -> Open:
        """What opens the table's text for `tables.read_rows`."""
        return partial(_opened, self.path, self.encoding, self.header.delimiter == " ", self.most_bytes)

    @property
    def is_cut(self) -> bool:
        """Whether the text goes on behind `most_bytes`, which are of UTF-8 whatever the file's encoding."""
        with open_text(self.path, self.encoding) as file:
            return file.seek(0, io.SEEK_END) > self.most_bytes > 0

    def cells(self, name: str) -> list[str]:
        """The first cells of a column."""
        place = self.names.index(name)
        return [row[place] for row in self.rows if place < len(row)]


@dataclass(frozen=True, slots=True)
class _HeadLine:
    """A line of the head: its number from 1, where the next begins, and its text."""

    number: int
    end: int
    text: str


def layout_of(path: Path, where: str, choices: TableChoices = NO_CHOICES, most_bytes: int = 0) -> TableLayout:
    """Find how a text is laid out; raises FileRefusedError where it holds no table.

    `most_bytes`: of the beginning that its rows are read from; 0: all of it.
    """
    encoding = choices.encoding or _encoding_of(path)
    lines = _lines(path, where, encoding, is_squeezed=False)
    stated = SEPARATOR_LINE.fullmatch(lines[0].text.encode()) if lines else None
    known = choices.separator or (stated[1].decode("utf-8", "replace") if stated else "")
    delimiter = max([known] if known else SEPARATORS.values(), key=lambda one: _numbers(lines, one))
    if delimiter == " ":
        lines = _lines(path, where, encoding, is_squeezed=True)
    cells = [_cells(line.text, delimiter) for line in lines]
    first = _first_row(lines, cells, choices.header_line)
    if first is None:
        raise FileRefusedError(where, NO_TABLE, EXPORT_TABLE)
    rows = [row for line, row in zip(lines[first:], cells[first:], strict=True) if _is_content(line)]
    width = Counter(map(len, rows)).most_common(1)[0][0]
    at, units_at = _header_place(lines, cells, first, width, choices.header_line)
    names = _with_groups(cells, at)
    _refuse_divided_decimals(where, lines[first].number, delimiter, names, rows[0])
    while len(names) > width and not names[-1]:
        names.pop()  # a separator follows the last name, and no last cell
    if max(width, len(names)) > MOST_COLUMNS:
        raise FileRefusedError(
            where,
            "the table has {count} columns, more than {most}",
            "Export only the columns with times, acceleration and angular rates",
            count=max(width, len(names)),
            most=MOST_COLUMNS,
        )
    names = names_of([*names, *[""] * (width - len(names))])
    unique = _all_different(names)
    decimal = choices.decimal or decimal_of(rows[:FIRST_ROWS])
    _refuse_thousands(where, decimal, unique, rows)
    units = dict(zip(unique, cells[units_at], strict=False)) if units_at is not None else {}
    before = tuple(line.text for line in lines[: first if at is None else at])
    header = TableHeader(
        names=tuple(unique),
        delimiter=delimiter,
        line=lines[first - 1].number if first else 0,
        start=lines[first - 1].end if first else 0,
        decimal=decimal,
        before=before,
    )
    return TableLayout(
        path=path,
        encoding=encoding,
        header=header,
        header_line=lines[at].number if at is not None else 0,
        units={name: unit for name, unit in units.items() if unit},
        rows=tuple(map(tuple, rows)),
        twice=next((name for name, count in Counter(names).items() if count > 1), ""),
        rate_hz=_stated_rate(before),
        most_bytes=most_bytes,
    )


def _encoding_of(path: Path) -> str:
    with path.open("rb") as file:
        return encoding_of(file.read(HEAD_BYTES))


def _opened(path: Path, encoding: str, is_squeezed: bool, most_bytes: int = 0) -> BinaryIO:
    file = open_text(path, encoding)
    if not is_squeezed and not most_bytes:
        return file
    with file:
        content = file.read(most_bytes) if most_bytes else file.read()
        if file.read(1):
            content = content[: content.rfind(b"\n") + 1]
    if not is_squeezed:
        return io.BytesIO(content)
    return io.BytesIO(b"\n".join(BLANKS.sub(b" ", line).strip(b" ") for line in content.split(b"\n")))


def lines_of_head(path: Path, encoding: str = "") -> list[str]:
    """The first lines of a text; none of what is no text."""
    try:
        return [line.text for line in _lines(path, path.name, encoding or _encoding_of(path), is_squeezed=False)]
    except FileRefusedError:
        return []


def fingerprint_of(path: Path) -> str:
    """The fingerprint of a file's table as it is found without being stated; empty where there is none."""
    try:
        return layout_of(path, path.name).fingerprint
    except FileRefusedError:
        return ""


def _lines(path: Path, where: str, encoding: str, is_squeezed: bool) -> list[_HeadLine]:
    """The first lines that are whole; raises FileRefusedError for what is no text."""
    with _opened(path, encoding, is_squeezed, HEAD_BYTES if is_squeezed else 0) as file:
        head = file.read(HEAD_BYTES)
        is_cut = bool(file.read(1))
    if set(head) & set(CONTROLS):
        raise FileRefusedError(
            where,
            "the file format is not recognised; the file is not text but binary data",
            "Leave this file out, or export the recording as text (CSV)",
        )
    found: list[_HeadLine] = []
    end = 0
    pieces = head.split(b"\n")
    for number, raw in enumerate(pieces[:MOST_LINES], 1):
        end += len(raw) + 1
        if is_cut and number == len(pieces):
            break
        try:
            text = raw.decode("utf-8-sig" if number == 1 else "utf-8").strip("\r")
        except UnicodeDecodeError as error:
            raise FileRefusedError(f"{where}, line {number}", "the file is not UTF-8 text", CORRECT_IT) from error
        found.append(_HeadLine(number, min(end, len(head)), text))
    if any("\r" in line.text for line in found):
        raise FileRefusedError(where, "the line contains a line break (carriage return)", CORRECT_IT)
    return found


def _is_content(line: _HeadLine) -> bool:
    return bool(line.text.strip()) and not line.text.startswith(COMMENT)


def _cells(text: str, delimiter: str) -> list[str]:
    try:
        cells = next(csv.reader([text.removeprefix(COMMENT).strip(" ")], delimiter=delimiter), [])
    except csv.Error:
        return [text]
    return [cell.strip() for cell in cells]


def _is_number(cell: str) -> bool:
    """Whether a cell is a number, or a word for a missing one."""
    return is_value(cell) or cell.lower() in NO_VALUE


def _numbers(lines: Sequence[_HeadLine], delimiter: str) -> int:
    """How many numbers stand in rows, if this separator divides them."""
    found = (sum(map(_is_number, _cells(line.text, delimiter))) for line in lines if _is_content(line))
    return sum(count for count in found if count >= LEAST_NUMBERS)


def _first_row(lines: Sequence[_HeadLine], cells: Sequence[Sequence[str]], stated_line: int | None) -> int | None:
    """Index of the first row of numbers below the stated header; None where no line is one."""
    known = [
        at
        for at, line in enumerate(lines)
        if _is_content(line) and sum(map(_is_number, cells[at])) >= LEAST_NUMBERS and line.number > (stated_line or 0)
        if not KEY.fullmatch(cells[at][0])
    ]
    widths = Counter(len(cells[at]) for at in known)
    if not widths:
        return None
    usual = widths.most_common(1)[0][0]
    return next(at for at in known if abs(len(cells[at]) - usual) <= 1)


def _header_place(
    lines: Sequence[_HeadLine], cells: Sequence[Sequence[str]], first: int, width: int, stated_line: int | None
) -> tuple[int | None, int | None]:
    """Indices of the lines of names and of units, None where there is none."""
    above = [at for at in range(first) if any(cells[at])]
    if stated_line is not None:
        at = next((at for at in above if lines[at].number == stated_line), None)
        return at, next((k for k in above if at is not None and k > at and _are_units(cells[k])), None)
    wide = [at for at in above if abs(len(cells[at]) - width) <= 1 and sum(map(_is_number, cells[at])) < LEAST_NUMBERS]
    full = [at for at in wide[-JUDGED_LINES:] if 2 * sum(map(bool, cells[at])) > width]  # not the names of groups
    meant = {at: sum(meaning_of(cell) is not None for cell in cells[at][:JUDGED_CELLS]) for at in full}
    at = max(meant, key=lambda at: (meant[at], at), default=None)
    if at is not None and meant[at] >= LEAST_NUMBERS:
        return at, next((k for k in wide if k > at and _are_units(cells[k])), None)
    if len(wide) > 1 and _are_units(cells[wide[-1]]):
        return wide[-2], wide[-1]
    if wide:
        return wide[-1], None
    half = above[-1:] if above and abs(2 * len(cells[above[-1]]) - width) <= 1 else []
    return (half[0] if half else None), None


def _with_groups(cells: Sequence[Sequence[str]], at: int | None) -> list[str]:
    """The names in a header; where some are alike, with what the line above writes once for several columns."""
    names = list(cells[at]) if at is not None else []
    groups = cells[at - 1] if at else []
    if len(set(names)) == len(names) or not any(groups) or len(groups) > len(names) or any(map(is_value, groups)):
        return names
    held, grouped = "", list[str]()
    for place, name in enumerate(names):
        held = groups[place] if place < len(groups) and groups[place] else held
        grouped.append(f"{held} {name}".strip())
    return grouped if len(set(grouped)) == len(grouped) else names


def _are_units(cells: Sequence[str]) -> bool:
    return any(map(is_unit, cells)) and not any(map(is_value, cells))


def _refuse_divided_decimals(where: str, line: int, delimiter: str, names: Sequence[str], row: Sequence[str]) -> None:
    """Refuse commas that divide cells and numbers alike; raises FileRefusedError."""
    if delimiter == "," and names and len(row) > 1.5 * len(names):
        raise FileRefusedError(
            f"{where}, line {line}",
            "the line has {count} columns, but the header has {whole}; commas seem to divide numbers as well",
            "Export the file again with points as decimal signs, or with semicolons between columns",
            count=len(row),
            whole=len(names),
        )


def _refuse_thousands(where: str, decimal: str, names: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Refuse whole numbers with a sign between thousands, which would be read as decimals; raises FileRefusedError."""
    thousands = re.compile(rf"[+-]?[1-9]\d{{0,2}}(?:\{decimal}\d{{3}})+", re.ASCII)
    for place, name in enumerate(names):
        cells = [row[place] for row in rows if place < len(row)]
        signed = {cell for cell in cells if decimal in cell}
        if len(signed) < FEW_THOUSANDS or not all(map(thousands.fullmatch, signed)):
            continue
        if len(set(filter(WHOLE.fullmatch, cells))) >= FEW_THOUSANDS:
            raise FileRefusedError(
                where,
                "whole numbers in column {name} have a sign between thousands, such as {cell}",
                "Export the file again without signs between thousands",
                name=quoted(name),
                cell=quoted(min(signed)),
            )


def _all_different(names: Sequence[str]) -> list[str]:
    """Number the names that were given before: "X", "X (2)"."""
    unique: dict[str, None] = {}
    numbers: Counter[str] = Counter()
    for name in names:
        free = name
        while free in unique:
            numbers[name] += 1
            free = f"{name} ({numbers[name] + 1})"
        unique[free] = None
    return [*unique]


def _stated_rate(before: Sequence[str]) -> float | None:
    """Samples per second by the lines above the header; None where they give none, or several."""
    found = {float(rate.replace(",", ".")) for line in before for rate in RATE.findall(line)} - {0.0}
    return found.pop() if len(found) == 1 else None


def refuse_twice(layout: TableLayout, where: str) -> None:
    """Refuse a header that gives a name twice; raises FileRefusedError."""
    if layout.twice:
        here = f"{where}, line {layout.header_line}"
        if unit_of(Quantity.TIME, without_brackets(layout.twice)[1]):
            raise FileRefusedError(
                here,
                "column {name} appears twice: parts of the table have times of their own",
                "Export accelerometer and gyroscope of each sensor with one column of times",
                name=quoted(layout.twice),
            )
        raise FileRefusedError(here, "column {name} appears twice", CORRECT_IT, name=quoted(layout.twice))

"""Tables read from files: their columns, and which line is at fault.

CSV and Parquet, read by Arrow. When Arrow cannot read a text, a slow pass over its lines finds the one to name, or
those that may be left out: a header that is repeated, and incomplete rows at the end.
"""

import csv
import io
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from core.findings import Finding, Severity
from core.samples import FloatArray
from devices.files.refusal import FileRefusedError, quoted
from devices.files.table_header import (
    COPY_AGAIN,
    CORRECT_IT,
    UNNAMED,
    Open,
    TableHeader,
    cells_of,
    read_header,
    refuse_twice,
)
from devices.files.text_files import UTF_8, open_text

NUMBER = re.compile(  # what fits one part fits no other: a cell of a million digits is looked at once
    r"\s*+[+-]?((\d++(\.\d*+)?|\.\d++)(e[+-]?\d++)?|nan|inf(inity)?)?\s*+", re.IGNORECASE | re.ASCII
)
NO_VALUE = ("na", "n/a", "n.a.", "#n/a", "<na>", "nan", "nat", "null", "none", "-", "--", "1.#qnan", "-1.#ind")
EMPTY_CELLS = [" " * n for n in range(9)]  # Arrow compares whole cells, and a blank or two is still nothing
EMPTY_CELLS += [blank + cell for word in NO_VALUE for cell in (word, word.upper(), word.title()) for blank in ("", " ")]
EMPTY_CELLS.append("NaT")  # of pandas
COMMENT = "#"  # begins lines that are no rows
MOST_CUT = 8  # incomplete rows at the end; more, and the file is another


@dataclass(frozen=True, slots=True)
class Table:
    """One file's columns, all of one length: `numbers` those that were asked for as numbers, `texts` all others.

    `place` gives where a row of the table is in the file ("line 12"). `is_open` is true for a text whose last line
    has no end: its last cell may have been cut. `cut_rows`: incomplete rows at the end that were left out.
    """

    numbers: Mapping[str, FloatArray]
    texts: Mapping[str, NDArray[np.generic]]
    rows: int
    place: Callable[[int], str]
    is_open: bool = False
    cut_rows: int = 0

    def matrix(self, names: Collection[str]) -> FloatArray:
        """(rows, len(names)); infinite values are no measurement and become NaN."""
        matrix = np.column_stack([self.numbers[name] for name in names])
        matrix[np.isinf(matrix)] = np.nan
        return matrix

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is odd about its rows, without a place."""
        return _of_cut(self.cut_rows)


@dataclass(slots=True)
class CutEnd:
    """Incomplete rows: left out at the end of a file, and refused where a whole row follows.

    A file whose last line has no end was cut off while it was written or copied, and is refused as well.
    """

    refusals: list[FileRefusedError] = field(default_factory=list)

    def note_cut(self, refusal: FileRefusedError) -> None:
        """Keep an incomplete row in mind, which is to be refused so."""
        self.refusals.append(refusal)

    def note_whole(self) -> None:
        """A whole row came; raises FileRefusedError where the one before was not."""
        if self.refusals:
            raise self.refusals[0]

    def count(self, *, ends_whole: bool, most: int = MOST_CUT) -> int:
        """How many rows are left out; raises FileRefusedError where they are no end of a recording."""
        if self.refusals and (len(self.refusals) > most or not ends_whole):
            raise self.refusals[0]
        return len(self.refusals)

    def findings(self, path: Path) -> tuple[Finding, ...]:
        """What was left out of this file, without a place; raises FileRefusedError as `count`."""
        return _of_cut(self.count(ends_whole=ends_whole(path)))


def _of_cut(count: int) -> tuple[Finding, ...]:
    return (Finding("rows_cut_short", Severity.WARNING, "", {"count": count}),) if count else ()


def ends_whole(path: Path) -> bool:
    """Whether the last line of a text has an end."""
    with open_text(path) as file:
        return not _is_open(file, 0)


def read_csv(
    path: Path,
    where: str,
    numeric: Collection[str],
    *,
    comment: str | None = None,  # lines that begin with it, before the header, are passed over
    delimiters: str = ",",
    keep_others: bool = True,  # as the texts that they are
    has_units: bool = False,  # in the line after the header
    header_names: str = "",
    is_ours: bool = False,  # of a session folder: UTF-8 with points, and every row is whole
) -> Table:
    """Read a text with one header line; `numeric` columns are NaN where empty; raises FileRefusedError.
    The delimiter is the one that divides the header most; the header is the first line with `header_names`.
    """
    opened = partial(open_text, path, UTF_8 if is_ours else "")
    with opened() as file:
        header = read_header(
            file, where, comment=comment, delimiters=delimiters, header_names=header_names, has_units=has_units
        )
    if is_ours:
        header = replace(header, decimal=".")
    kept = set(header.names) - set(numeric) if keep_others else set()
    return read_rows(opened, where, header, numeric, kept=kept, is_ours=is_ours)


def read_rows(
    opened: Open,
    where: str,
    header: TableHeader,
    numeric: Collection[str],
    *,
    kept: Collection[str],
    is_ours: bool = False,
) -> Table:
    """Read the rows below a header as `read_csv` does; of other columns those that are to be `kept` as texts."""
    required = [name for name in header.names if name in kept or name in numeric]
    dropped = _Dropped(frozenset(), 0)
    with opened() as file:
        file.seek(header.start)
        arrow = _read_body(file, header, required, numeric)
        is_open = _is_open(file, header.start)
    if isinstance(arrow, Exception) or _swallows_lines(arrow, numeric):
        dropped = _dropped_lines(opened, where, header, numeric, is_ours=is_ours)
        lines = [line for _, line in _lines(opened, header, dropped.lines)]
        if not lines:
            arrow = None
        elif not dropped.lines:
            raise FileRefusedError(where, "the table cannot be read ({why})", COPY_AGAIN, why=arrow)
        else:
            arrow = _read_body(io.BytesIO(b"\n".join([*lines, b""])), header, required, numeric)
            if isinstance(arrow, Exception):
                raise FileRefusedError(where, "the table cannot be read ({why})", COPY_AGAIN, why=arrow)

    unnamed = {f"{UNNAMED} {i}" for i in range(1, len(header.names) + 1)}
    columns = {name: arrow.column(i) if arrow is not None else None for i, name in enumerate(required)}

    def place(row: int) -> str:
        for i, (line, _) in enumerate(_lines(opened, header, dropped.lines)):
            if i == row:
                return f"line {line}"
        return f"row {row + 1}"  # a file whose lines end in ways of their own

    numbers = {n: np.array(c.to_numpy()) if c is not None else np.empty(0) for n, c in columns.items() if n in numeric}
    texts = {n: _as_text(c.to_pylist() if c is not None else []) for n, c in columns.items() if n not in numeric}
    for name in [n for n in texts if n in unnamed and not np.any(texts[n] != "")]:
        del texts[name]  # delimiters at the end of every line make columns of nothing
    rows = 0 if arrow is None else arrow.num_rows
    table = Table(numbers, texts, rows, place, is_open, dropped.cut)
    return table if is_ours else _without_empty_end(table)


def read_parquet(path: Path, where: str, numeric: Collection[str]) -> Table:
    """Read Parquet as `read_csv` reads a text; other columns keep numeric types; raises FileRefusedError."""
    import pyarrow.parquet  # here, not above: the window starts without it

    try:
        with path.open("rb") as file:
            arrow = pyarrow.parquet.ParquetFile(file).read()
        names = [name.strip() for name in arrow.column_names]
        refuse_twice(names, where, "header")
        numbers, texts = {}, {}
        for name, column in zip(names, arrow.columns, strict=True):
            is_number = pyarrow.types.is_integer(column.type) or pyarrow.types.is_floating(column.type)
            if name in numeric:
                if not (is_number or pyarrow.types.is_decimal(column.type) or pyarrow.types.is_null(column.type)):
                    raise FileRefusedError(
                        where, "column {name} contains {kind}, not numbers", CORRECT_IT, name=name, kind=column.type
                    )
                numbers[name] = np.asarray(column.cast(pyarrow.float64(), safe=False).to_numpy(), dtype=float)
            elif is_number and column.null_count == 0:
                texts[name] = column.to_numpy()
            else:
                texts[name] = _as_text(["" if v is None else str(v) for v in column.to_pylist()])
    except pyarrow.ArrowMemoryError:
        raise
    except (pyarrow.ArrowException, OSError, ValueError, OverflowError) as error:
        raise FileRefusedError(
            where, "the file is not a readable Parquet file ({why})", COPY_AGAIN, why=error
        ) from error
    return Table(numbers, texts, arrow.num_rows, lambda row: f"row {row + 1}")


def _without_empty_end(table: Table) -> Table:
    """Leave out rows at the end that hold no number: spreadsheets write their delimiters."""
    filled = [np.flatnonzero(np.isfinite(column)) for column in table.numbers.values()]
    rows = max((int(found[-1]) + 1 for found in filled if len(found)), default=0)
    if not filled or rows == table.rows:
        return table
    numbers = {name: column[:rows] for name, column in table.numbers.items()}
    return replace(table, numbers=numbers, texts={name: c[:rows] for name, c in table.texts.items()}, rows=rows)


def header_of(
    path: Path, where: str, *, comment: str | None = None, delimiters: str, header_names: str = ""
) -> tuple[list[str], list[str]]:
    """Give the lines before the header, less comment marks, and the columns' names; raises FileRefusedError."""
    with open_text(path) as file:
        header = read_header(file, where, comment=comment, delimiters=delimiters, header_names=header_names)
    return [line.removeprefix(comment or "").strip() for line in header.before], list(header.names)


def _read_body(file: BinaryIO, header: TableHeader, required: list[str], numeric: Collection[str]) -> Any:
    """The rows after the header as an Arrow table, or the error that Arrow raised."""
    import pyarrow.csv  # as above

    types = {name: pyarrow.float64() if name in numeric else pyarrow.string() for name in header.names}
    try:
        return pyarrow.csv.read_csv(
            file,
            read_options=pyarrow.csv.ReadOptions(column_names=list(header.names)),
            parse_options=pyarrow.csv.ParseOptions(delimiter=header.delimiter),
            convert_options=pyarrow.csv.ConvertOptions(
                column_types=types,
                include_columns=required,
                null_values=EMPTY_CELLS,
                strings_can_be_null=False,
                decimal_point=header.decimal,
            ),
        )
    except pyarrow.ArrowMemoryError:
        raise  # which is not about the file's lines
    except pyarrow.ArrowException as error:
        return error


def _swallows_lines(arrow: Any, numeric: Collection[str]) -> bool:
    """A quotation mark that is never closed takes the lines after it into one cell."""
    import pyarrow.compute as pc  # as above

    texts = [column for name, column in zip(arrow.column_names, arrow.columns, strict=True) if name not in numeric]
    return any(pc.any(pc.match_substring(column, "\n")).as_py() for column in texts)


def _is_open(file: BinaryIO, start: int) -> bool:
    end = file.seek(0, 2)
    if end == start:
        return False
    file.seek(-1, 2)
    return file.read(1) not in (b"\n", b"\r")


def _lines(opened: Open, header: TableHeader, dropped: Collection[int] = ()) -> Iterator[tuple[int, bytes]]:
    """Number and bytes of every line after the header that is neither empty nor dropped."""
    with opened() as file:
        file.seek(header.start)
        for number, raw in enumerate(file, header.line + 1):
            if (line := raw.rstrip(b"\r\n")) and number not in dropped:
                yield number, line


@dataclass(frozen=True, slots=True)
class _Dropped:
    """Numbers of lines that are no rows, and how many of them are incomplete."""

    lines: frozenset[int]
    cut: int


def _dropped_lines(
    opened: Open, where: str, header: TableHeader, numeric: Collection[str], *, is_ours: bool
) -> _Dropped:
    """Find the lines that can be left out; raises FileRefusedError for the first that cannot be read."""
    dropped: set[int] = set()
    cut, end = set[int](), CutEnd()
    for number, line in _lines(opened, header):
        here = f"{where}, line {number}"
        try:
            text = line.decode()
        except UnicodeDecodeError as error:
            raise FileRefusedError(here, "the file is not UTF-8 text", COPY_AGAIN) from error
        if not is_ours and text.startswith(COMMENT):
            dropped.add(number)
            continue
        if text.count('"') % 2:
            raise FileRefusedError(here, "a quotation mark is not closed", CORRECT_IT)
        try:
            cells = cells_of(text, header.delimiter)
        except csv.Error as error:
            raise FileRefusedError(here, "the line cannot be read ({why})", COPY_AGAIN, why=error) from error
        if len(cells) < len(header.names):
            refusal = FileRefusedError(
                here,
                "the line ends after {count} of {whole} columns; the file may have been cut off",
                COPY_AGAIN,
                count=len(cells),
                whole=len(header.names),
            )
            end.note_cut(refusal)
            cut.add(number)
            continue
        end.note_whole()
        if not is_ours and [cell.strip() for cell in cells[: len(header.names)]] == list(header.names):
            dropped.add(number)  # each start of a recording writes it again
        else:
            _refuse_cells(cells, here, header, numeric)
    with opened() as file:
        is_whole = not _is_open(file, 0)
    return _Dropped(frozenset(dropped | cut), end.count(ends_whole=is_whole, most=0 if is_ours else MOST_CUT))


def _refuse_cells(cells: list[str], here: str, header: TableHeader, numeric: Collection[str]) -> None:
    if len(cells) > len(header.names):
        raise FileRefusedError(
            here,
            "the line has {count} columns, but the header has {whole}",
            CORRECT_IT,
            count=len(cells),
            whole=len(header.names),
        )
    for name, cell in zip(header.names, cells, strict=True):
        number = cell if header.decimal == "." else cell.replace(".", "?").replace(header.decimal, ".")
        if name in numeric and not NUMBER.fullmatch(number) and cell.strip().lower() not in NO_VALUE:
            raise FileRefusedError(
                here, "{cell} in column {name} is not a number", CORRECT_IT, cell=quoted(cell), name=name
            )


def is_value(cell: str) -> bool:
    """Whether a cell is a number, with a point or a comma."""
    text = cell.strip()
    return bool(text) and NUMBER.fullmatch(text.replace(",", ".", 1)) is not None


def number_in(cell: str) -> float:
    """The number in a cell, whose decimal sign is a point or a comma; NaN where it is empty; raises ValueError."""
    text = cell.strip()
    if not text or text.lower() in NO_VALUE:
        return float("nan")
    return float(text.replace(",", ".") if text.count(",") == 1 and "." not in text else text)


def _as_text(values: list[str]) -> NDArray[np.generic]:
    return np.array(values, dtype=np.dtypes.StringDType())

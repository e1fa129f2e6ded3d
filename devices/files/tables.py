"""Tables read from files: their columns, and which line is at fault.

CSV and Parquet, read by Arrow. When Arrow cannot read a text, a slow pass over its lines finds the one to name.
"""

import csv
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from core.samples import FloatArray
from devices.files.refusal import FileRefusedError, quoted

NUMBER = re.compile(r"\s*[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|nan|inf(inity)?)?\s*", re.IGNORECASE | re.ASCII)
DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+(e[+-]?\d+)?", re.IGNORECASE | re.ASCII)
LONGEST_HEADER = 100_000  # bytes; a line without end is no header
EMPTY_CELLS = [" " * n for n in range(9)]  # Arrow compares whole cells, and a blank or two is still nothing
UNNAMED = "column"  # a column without a name is called by its place: "column 9"
COPY_AGAIN = "Copy the file again from where it was recorded"
CORRECT_IT = "Correct the file or export it again"


@dataclass(frozen=True, slots=True)
class Table:
    """One file's columns, all of one length: `numbers` those that were asked for as numbers, `texts` all others.

    `place` gives where a row of the table is in the file ("line 12"). `is_open` is true for a text whose last line
    has no end: its last cell may have been cut.
    """

    numbers: Mapping[str, FloatArray]
    texts: Mapping[str, NDArray[np.generic]]
    rows: int
    place: Callable[[int], str]
    is_open: bool = False

    def matrix(self, names: Collection[str]) -> FloatArray:
        """(rows, len(names)); infinite values are no measurement and become NaN."""
        matrix = np.column_stack([self.numbers[name] for name in names])
        matrix[np.isinf(matrix)] = np.nan
        return matrix


@dataclass(frozen=True, slots=True)
class TextShape:
    """How a text of another program is laid out, beyond its header.

    `units`: what a line of units below the header gives for each column; empty where there is no such line.
    """

    names: tuple[str, ...]  # of the columns, in their order
    units: Mapping[str, str]
    decimal: str  # the decimal point: "," in files of some countries
    first: tuple[str, ...]  # the cells of the first row of values; empty where there is none


def shape_of(path: Path, where: str, is_unit: Callable[[str], bool], *, comment: str, delimiters: str) -> TextShape:
    """How a text is laid out; raises as `header_of` does."""
    with path.open("rb") as file:
        names, delimiter, _ = _read_header(file, where, comment, delimiters)
        units = _cells_after(file, delimiter)
        has_units = len(units) == len(names) and any(map(is_unit, units)) and not any(map(_is_value, units))
        first = _cells_after(file, delimiter) if has_units else units
    has_comma = delimiter != "," and any(DECIMAL_COMMA.fullmatch(cell) for cell in first)
    reported = {name: unit for name, unit in zip(names, units, strict=True) if unit} if has_units else {}
    return TextShape(tuple(names), reported, "," if has_comma else ".", first)


def read_csv(
    path: Path,
    where: str,
    numeric: Collection[str],
    *,
    comment: str | None = None,  # lines that begin with it, before the header, are passed over
    delimiters: str = ",",
    keep_others: bool = True,  # as the texts that they are
    has_units: bool = False,  # in the line after the header, see `shape_of`
    decimal: str = ".",
    header_names: str = "",
) -> Table:
    """Read a text with one header line; `numeric` columns are NaN where empty; raises FileRefusedError.
    The delimiter is the one that divides the header most; the header is the first line with `header_names`.
    """
    with path.open("rb") as file:
        names, delimiter, header_line = _read_header(file, where, comment, delimiters, header_names)
        header_line += _skip_line(file) if has_units else 0
        start = file.tell()
        required = [name for name in names if keep_others or name in numeric]
        arrow = _read_body(file, names, required, numeric, delimiter, decimal)
        is_open = _is_open(file, start)
        if isinstance(arrow, Exception) or _swallows_lines(arrow, numeric):
            _refuse_line(path, where, start, header_line, names, numeric, delimiter, decimal)
            if next(_lines(path, start, 0), None) is not None:
                raise FileRefusedError(where, "the table cannot be read ({why})", COPY_AGAIN, why=arrow)
            arrow = None

    unnamed = {f"{UNNAMED} {i}" for i in range(1, len(names) + 1)}
    columns = {name: arrow.column(i) if arrow is not None else None for i, name in enumerate(required)}

    def place(row: int) -> str:
        for i, (line, _) in enumerate(_lines(path, start, header_line)):
            if i == row:
                return f"line {line}"
        return f"row {row + 1}"  # a file whose lines end in ways of their own

    numbers = {n: np.array(c.to_numpy()) if c is not None else np.empty(0) for n, c in columns.items() if n in numeric}
    texts = {n: _as_text(c.to_pylist() if c is not None else []) for n, c in columns.items() if n not in numeric}
    for name in [n for n in texts if n in unnamed and not np.any(texts[n] != "")]:
        del texts[name]  # delimiters at the end of every line make columns of nothing
    return Table(numbers, texts, 0 if arrow is None else arrow.num_rows, place, is_open)


def read_parquet(path: Path, where: str, numeric: Collection[str]) -> Table:
    """Read Parquet as `read_csv` reads a text; other columns keep numeric types; raises FileRefusedError."""
    import pyarrow.parquet  # here, not above: the window starts without it

    try:
        with path.open("rb") as file:
            arrow = pyarrow.parquet.ParquetFile(file).read()
        names = [name.strip() for name in arrow.column_names]
        _refuse_twice(names, where, "header")
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


def header_of(
    path: Path, where: str, *, comment: str | None = None, delimiters: str, header_names: str = ""
) -> tuple[list[str], list[str]]:
    """Give the lines before the header, less comment marks, and the columns' names; raises FileRefusedError."""
    with path.open("rb") as file:
        names, _, header_line = _read_header(file, where, comment, delimiters, header_names)
        file.seek(0)
        before = [file.readline().decode("utf-8-sig", "replace").strip() for _ in range(header_line - 1)]
    return [line.removeprefix(comment or "").strip() for line in before], names


def _read_header(
    file: BinaryIO, where: str, comment: str | None, delimiters: str, header_names: str = ""
) -> tuple[list[str], str, int]:
    """Names, delimiter and number of the header's line; leaves `file` at the line after it."""
    number = 0
    while raw := file.readline(LONGEST_HEADER):
        number += 1
        if header_names.encode() not in raw:
            continue
        try:
            text = raw.decode("utf-8-sig" if number == 1 else "utf-8").strip(" \r\n")
        except UnicodeDecodeError as error:
            raise FileRefusedError(f"{where}, line {number}", "the file is not UTF-8 text", CORRECT_IT) from error
        if "\r" in text:
            raise FileRefusedError(
                f"{where}, line {number}", "the line contains a line break (carriage return)", CORRECT_IT
            )
        if "\0" in text or len(raw) == LONGEST_HEADER:
            raise FileRefusedError(f"{where}, line {number}", "the file is not a table but binary data", CORRECT_IT)
        if not text or (comment is not None and text.startswith(comment)):
            continue
        delimiter = max(delimiters, key=text.count)
        cells = next(csv.reader([text], delimiter=delimiter, skipinitialspace=delimiter != " "))
        names = [name.strip() or f"{UNNAMED} {i}" for i, name in enumerate(cells, 1)]
        _refuse_twice(names, where, f"line {number}")
        return names, delimiter, number
    raise FileRefusedError(where, "the file has no header line", COPY_AGAIN)


def _cells_after(file: BinaryIO, delimiter: str) -> tuple[str, ...]:
    """The cells of the next line that is not empty; none at the end, and none of a line that is no text."""
    while raw := file.readline(LONGEST_HEADER):
        if raw.strip():
            try:
                return tuple(
                    cell.strip() for cell in next(csv.reader([raw.decode().strip("\r\n")], delimiter=delimiter))
                )
            except (UnicodeDecodeError, csv.Error, StopIteration):
                return ()
    return ()


def _skip_line(file: BinaryIO) -> int:
    """Pass over the next line that is not empty; how many lines that were."""
    lines = 0
    while raw := file.readline(LONGEST_HEADER):
        lines += 1
        if raw.strip():
            break
    return lines


def _is_value(cell: str) -> bool:
    return bool(cell.strip()) and NUMBER.fullmatch(cell) is not None


def _refuse_twice(names: list[str], where: str, place: str) -> None:
    for name in names:
        if names.count(name) > 1:
            here = f"{where}, {place}"
            raise FileRefusedError(here, "column {name} appears twice", CORRECT_IT, name=quoted(name))


def _read_body(
    file: BinaryIO, names: list[str], required: list[str], numeric: Collection[str], delimiter: str, decimal: str
) -> Any:
    """The rows after the header as an Arrow table, or the error that Arrow raised."""
    import pyarrow.csv  # as above

    types = {name: pyarrow.float64() if name in numeric else pyarrow.string() for name in names}
    try:
        return pyarrow.csv.read_csv(
            file,
            read_options=pyarrow.csv.ReadOptions(column_names=names),
            parse_options=pyarrow.csv.ParseOptions(delimiter=delimiter),
            convert_options=pyarrow.csv.ConvertOptions(
                column_types=types,
                include_columns=required,
                null_values=EMPTY_CELLS,
                strings_can_be_null=False,
                decimal_point=decimal,
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


def _lines(path: Path, start: int, header_line: int) -> Iterator[tuple[int, bytes]]:
    """Number and bytes of every line after the header that is not empty."""
    with path.open("rb") as file:
        file.seek(start)
        for number, raw in enumerate(file, header_line + 1):
            if line := raw.rstrip(b"\r\n"):
                yield number, line


def _refuse_line(
    path: Path,
    where: str,
    start: int,
    header_line: int,
    names: list[str],
    numeric: Collection[str],
    delimiter: str,
    decimal: str,
) -> None:
    """Raise for the first line that cannot be read; return when there is none."""
    for number, line in _lines(path, start, header_line):
        here = f"{where}, line {number}"
        try:
            text = line.decode()
        except UnicodeDecodeError as error:
            raise FileRefusedError(here, "the file is not UTF-8 text", COPY_AGAIN) from error
        if text.count('"') % 2:
            raise FileRefusedError(here, "a quotation mark is not closed", CORRECT_IT)
        try:
            cells = next(csv.reader([text], delimiter=delimiter))
        except csv.Error as error:
            raise FileRefusedError(here, "the line cannot be read ({why})", COPY_AGAIN, why=error) from error
        if len(cells) < len(names):
            raise FileRefusedError(
                here,
                "the line ends after {count} of {whole} columns; the file may have been cut off",
                COPY_AGAIN,
                count=len(cells),
                whole=len(names),
            )
        if len(cells) > len(names):
            raise FileRefusedError(
                here,
                "the line has {count} columns, but the header has {whole}",
                CORRECT_IT,
                count=len(cells),
                whole=len(names),
            )
        for name, cell in zip(names, cells, strict=True):
            if name in numeric and not NUMBER.fullmatch(cell if decimal == "." else cell.replace(decimal, ".")):
                raise FileRefusedError(
                    here, "{cell} in column {name} is not a number", CORRECT_IT, cell=quoted(cell), name=name
                )


def _as_text(values: list[str]) -> NDArray[np.generic]:
    return np.array(values, dtype=np.dtypes.StringDType())

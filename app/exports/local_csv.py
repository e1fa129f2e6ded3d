"""Tables of results as the spreadsheets of another country take them: another separator, and a decimal comma.

The tables are those of the default form, cell by cell. A column of figures gets the comma, words stay as they are.
Where the form is another one, a file begins with the mark of UTF-8: spreadsheets take it for another code without.
"""

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from app.exports.columns import COLUMNS, unit_of
from app.exports.csvw import METADATA

POINT, COMMA, SEMICOLON, TAB = ".", ",", ";", "\t"
MARKED = "utf-8-sig"


@dataclass(frozen=True, slots=True)
class CsvForm:
    """How the tables of results separate their cells and write a fraction."""

    separator: str = COMMA
    decimal: str = POINT

    @property
    def is_default(self) -> bool:
        return self == CsvForm()


def rewrite_tables(folder: Path, form: CsvForm) -> None:
    """Give every table of results in `folder` and below another form, and say so in its metadata; raises OSError."""
    if form.is_default:
        return
    for path in sorted(folder.rglob("*.csv")):
        _rewrite(path, form)
    metadata = folder / METADATA
    if metadata.exists():
        _describe(metadata, form)


def _rewrite(path: Path, form: CsvForm) -> None:
    beside = path.with_name(f".{path.name}")
    with path.open(encoding="utf-8", newline="") as old, beside.open("w", encoding=MARKED, newline="") as new:
        rows = csv.reader(old)
        writer = csv.writer(new, delimiter=form.separator, lineterminator="\n")
        header = next(rows)
        writer.writerow(header)
        figures = _figures(path.name, header)
        for row in rows:
            for k in figures:
                row[k] = row[k].replace(POINT, form.decimal)
            writer.writerow(row)
    beside.replace(path)


def _figures(file: str, header: Sequence[str]) -> list[int]:
    """Which columns hold figures."""
    return [] if file == COLUMNS else [k for k, name in enumerate(header) if unit_of(file, name)]


def _describe(metadata: Path, form: CsvForm) -> None:
    """As CSV on the Web has it: the separator of each table, and what is before the fraction of each number."""
    found = json.loads(metadata.read_text(encoding="utf-8"))
    for table in found["tables"]:
        table["dialect"] = {"delimiter": form.separator}
        for column in table["tableSchema"]["columns"]:
            if column["datatype"] == "number":
                column["datatype"] = {"base": "number", "format": {"decimalChar": form.decimal}}
    metadata.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8", newline="\n")

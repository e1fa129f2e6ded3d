"""Description of an analysis's tables for programs. `csv-metadata.json`: CSV on the Web, every table and its columns.

W3C, Metadata Vocabulary for Tabular Data, 2015. It states what `columns.csv` states, with the type of each cell.
"""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from app.exports.columns import COLUMNS, HEADER, KNOWN, column_of, names_in, unit_of

METADATA = "csv-metadata.json"  # the name that the recommendation looks for beside a table
CONTEXT = ["http://www.w3.org/ns/csvw", {"@language": "en"}]
BOOLEANS = ("used", "unverified", "agreed_before", "chosen_before")


def write_metadata(folder: Path, recordings: Sequence[str]) -> None:
    """Write types and meanings of the columns of the tables in `folder` and its subfolders `recordings`."""
    found = {"@context": CONTEXT, "tables": list(_tables(folder, recordings))}
    text = json.dumps(found, indent=1, ensure_ascii=False)
    # a folder's name may hold bytes that are no text: what replaces them is an escape of JSON too
    path = folder / METADATA
    path.write_text(text + "\n", encoding="utf-8", errors="backslashreplace", newline="\n")


def _tables(folder: Path, recordings: Sequence[str]) -> Iterator[dict[str, Any]]:
    for file in KNOWN:
        for place in ("", *recordings):
            path = folder / place / file
            if path.is_file():
                columns = [_column(file, name) for name in names_in(path)]
                yield {"url": (Path(place) / file).as_posix(), "tableSchema": {"columns": columns}}
    columns = [{"name": name, "titles": name, "datatype": "string"} for name in HEADER]
    yield {"url": COLUMNS, "tableSchema": {"columns": columns}}


def _column(file: str, name: str) -> dict[str, Any]:
    meaning = column_of(file, name)
    stated = ", ".join(filter(None, [meaning.definition, meaning.sign]))
    found = {"name": name, "titles": name, "dc:description": stated, "datatype": _type(file, name)}
    if unit := unit_of(file, name):
        found["schema:unitText"] = unit
    return found


def _type(file: str, name: str) -> str:
    """What a cell holds where it is not empty: a column without a unit holds words, a truth or a count."""
    if name in BOOLEANS:
        return "boolean"
    if name == "n" or name.endswith(("_n", "left_out_by_hand")):
        return "integer"
    return "number" if unit_of(file, name) else "string"

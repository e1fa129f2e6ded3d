"""Answer one SQL question over one Parquet, in the limited process.

DuckDB answers, and is given the rows of one open Parquet instead of its path. A path that it may read it may write as
well: `WITH x AS (COPY ... TO 'path') SELECT 1` counts as a SELECT and leaves the file empty. So it has no path at all:
no file, no network, no extension, no other Python object, no disk for what memory cannot hold, and a locked
configuration. What its own limit of memory misses, and what never ends, the process ends.
"""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import duckdb
import numpy as np
import pyarrow as pa
import pyarrow.dataset
import pyarrow.fs

from devices.files.refusal import FileRefusedError, one_line

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection, DuckDBPyRelation

    from devices.files.answers import Array, Details

VIEW = "parameters"
NUMBERS = ("DOUBLE", "FLOAT")
ZONED_TIME = "TIMESTAMP WITH TIME ZONE"
KIND = re.compile(r"^[A-Z]\w*(?: \w+){0,2} Error: ")  # what DuckDB calls it, before what is wrong
HINTS = ("Candidate bindings", "Did you mean")  # how DuckDB's second line begins where it helps
MOST_FOUND_BYTES = 500_000_000
WITH_ZONE = "the column {name} contains times with a time zone, which have no unique text"
NO_SELECT = "{kind} is not allowed: the table is read-only"
TOO_LARGE = "this query exceeds the memory limit ({limit})"
LIST_COLUMNS = "gaitwright query --columns lists the table's columns"
ASK_FOR_LESS = "Query less data at a time"
LOCKED: Mapping[str, str | bool | int] = {
    "autoinstall_known_extensions": False,
    "autoload_known_extensions": False,
    "allow_community_extensions": False,
    "python_enable_replacements": False,
    "temp_directory": "",
    "memory_limit": "1GB",
    "threads": 2,
}


def answer(path: Path, sql: str, is_typed: bool, arrays: "list[Array]") -> "Details":
    """Answer a question into `arrays`, as Arrow; typed ones must be one SELECT; raises FileRefusedError."""
    with _opened(path) as connection:
        try:
            if is_typed:
                _refuse_other_than_one_select(connection, sql)
            asked = connection.sql(sql)
            described = [(str(name), str(kind)) for name, kind in zip(asked.columns, asked.types, strict=True)]
            for name, kind in described:
                if kind == ZONED_TIME:
                    raise FileRefusedError("SQL", WITH_ZONE, "Write the column as {name}::VARCHAR", name=name)
            arrays.append(_stream(asked))
        except (duckdb.Error, pa.ArrowException) as problem:
            raise _refused(problem) from None
    return {"columns": [name for name, _ in described]}


def _stream(asked: "DuckDBPyRelation") -> "Array":
    reader, sink = asked.to_arrow_reader(), pa.BufferOutputStream()
    assert reader is not None  # there was a question
    with pa.ipc.new_stream(sink, reader.schema) as stream:
        for batch in reader:
            stream.write_batch(batch)
            if sink.tell() > MOST_FOUND_BYTES:
                raise FileRefusedError("SQL", "this query finds more than can be shown", ASK_FOR_LESS)
    return np.frombuffer(sink.getvalue(), np.uint8)


@contextmanager
def _opened(file: Path) -> "Iterator[DuckDBPyConnection]":
    with duckdb.connect(":memory:", config=dict(LOCKED)) as connection:
        # set at the connection, it would leave files called ":memory:" in the folder of now to be written
        connection.execute("SET enable_external_access = false")
        try:
            rows = pa.dataset.dataset(str(file), format="parquet", filesystem=pa.fs.LocalFileSystem())
            connection.register("of_file", rows)
            found = connection.execute("DESCRIBE of_file").fetchall()
            shown = ", ".join(_shown(str(name), str(kind)) for name, kind, *_ in found)
            connection.execute(f"CREATE TEMP VIEW {VIEW} AS SELECT {shown} FROM of_file")
            connection.execute("SET lock_configuration = true")
        except (duckdb.Error, pa.ArrowException, OSError) as problem:
            raise FileRefusedError(
                str(file),
                "the file is not a readable Parquet file ({why})",
                "Choose the parameters.parquet written by gaitwright batch",
                why=_reason(problem),
            ) from None
        yield connection


def _refuse_other_than_one_select(connection: "DuckDBPyConnection", sql: str) -> None:
    statements = connection.extract_statements(sql)
    if len(statements) != 1:
        raise FileRefusedError(
            "SQL", "the query contains {count} statements", "Enter one query at a time", count=len(statements)
        )
    if statements[0].type != duckdb.StatementType.SELECT:
        kind = statements[0].type.name
        stated = "PIVOT without IN" if kind == "MULTI" else kind
        raise FileRefusedError("SQL", NO_SELECT, "Begin with SELECT", kind=stated)


def quoted_name(name: str) -> str:
    """A column's name as SQL takes it, whatever it holds."""
    escaped = name.replace('"', '""')
    return f'"{escaped}"'


def _shown(name: str, kind: str) -> str:
    """One column of the view: numbers that are none as empty, times with a zone as text."""
    column = quoted_name(name)
    if kind in NUMBERS:
        return f"CASE WHEN isnan({column}) THEN NULL ELSE {column} END AS {column}"
    return f"{column}::VARCHAR AS {column}" if kind == ZONED_TIME else column


def _refused(problem: Exception) -> FileRefusedError:
    if isinstance(problem, duckdb.OutOfMemoryException):
        return FileRefusedError("SQL", TOO_LARGE, ASK_FOR_LESS, limit=LOCKED["memory_limit"])
    return FileRefusedError("SQL", "this query failed: {why}", LIST_COLUMNS, why=_reason(problem))


def _reason(problem: Exception) -> str:
    """A library's message, in one line and without its mark of a mistake."""
    first, *more = str(problem).splitlines() or [type(problem).__name__]
    stated = KIND.sub("", first).rstrip("!.:")
    hint = next((line.rstrip("?!.") for line in more if line.startswith(HINTS)), "")
    return one_line(f"{stated} ({hint})" if hint else stated)

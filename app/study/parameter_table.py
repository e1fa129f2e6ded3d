"""The table of a batch, opened so that a question can read it and nothing else.

DuckDB answers, and is given the rows of one open Parquet instead of its path. A path that it may read it may write as
well: `WITH x AS (COPY ... TO 'path') SELECT 1` counts as a SELECT and leaves the file empty. So it has no path at all:
no file, no network, no extension, no other Python object, no disk for what memory cannot hold, and a locked
configuration.
"""

import re
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from devices.files.refusal import FileRefusedError, one_line

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

PARQUET = "parameters.parquet"  # in the folder of a batch
VIEW = "parameters"
NEEDED = ("session", "walk", "side")  # what a row is of
STATUS, ERROR, SD = "_status", "_error", "_sd"
ROWS_AT_ONCE = 10_000
NUMBERS = ("DOUBLE", "FLOAT")
ZONED_TIME = "TIMESTAMP WITH TIME ZONE"
KIND = re.compile(r"^[A-Z]\w*(?: \w+){0,2} Error: ")  # what DuckDB calls it, before what is wrong
HINTS = ("Candidate bindings", "Did you mean")  # how DuckDB's second line begins where it helps
LOCKED: Mapping[str, str | bool | int] = {
    "autoinstall_known_extensions": False,
    "autoload_known_extensions": False,
    "allow_community_extensions": False,
    "python_enable_replacements": False,
    "temp_directory": "",
    "memory_limit": "1GB",
    "threads": 2,
}


@dataclass(frozen=True, slots=True)
class FoundRows:
    """What a question found: the names of its columns, and its rows, which are read as they are asked for."""

    columns: tuple[str, ...]
    rows: Iterator[tuple[Any, ...]]


class ParameterTable:
    """One row per session, walk and side, as the view `parameters`.

    A number that is none (NaN) is empty there, as a withheld one is, so that no mean has to be told to pass over it.
    """

    def __init__(self, connection: "DuckDBPyConnection", where: str) -> None:
        self._connection, self.where = connection, where
        found = self._connection.execute(f"DESCRIBE {VIEW}").fetchall()
        self.columns: Mapping[str, str] = {str(name): str(kind) for name, kind, *_ in found}
        for name in NEEDED:
            if name not in self.columns:
                raise FileRefusedError(
                    where,
                    "this is no table of a batch: there is no column {name}",
                    "Choose the parameters.parquet that gaitwright batch writes",
                    name=name,
                )

    @classmethod
    @contextmanager
    def opened(cls, place: Path) -> Iterator[Self]:
        """Open a Parquet, or that in the folder of a batch, and close it again.

        Raises
        ------
        FileRefusedError
            There is none, it cannot be read, or it is no table of a batch.
        """
        import duckdb
        import pyarrow as pa
        import pyarrow.dataset
        import pyarrow.fs

        file = place / PARQUET if place.is_dir() else place
        if not file.is_file():
            raise FileRefusedError(
                str(file), "this is not there", "Choose the parameters.parquet that gaitwright batch writes"
            )
        with duckdb.connect(":memory:", config=dict(LOCKED)) as connection:
            # said at the connection, it would leave files called ":memory:" in the folder of now to be written
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
                    "this cannot be read as Parquet ({why})",
                    "Choose the parameters.parquet that gaitwright batch writes",
                    why=_reason(problem),
                ) from None
            yield cls(connection, str(file))

    @property
    def measures(self) -> tuple[str, ...]:
        """The parameters: numbers with a status beside them."""
        return tuple(
            name
            for name, kind in self.columns.items()
            if kind in NUMBERS and self.columns.get(name + STATUS) == "VARCHAR"
        )

    def ask(self, sql: str) -> FoundRows:
        """Answer one question that somebody typed.

        Raises
        ------
        FileRefusedError
            It is no question, more than one, or it cannot be answered.
        """
        import duckdb

        try:
            statements = self._connection.extract_statements(sql)
            if len(statements) != 1:
                raise FileRefusedError("SQL", f"{len(statements)} statements", "One at a time is answered")
            if statements[0].type != duckdb.StatementType.SELECT:
                what = "{kind} is not answered here, since the table is only read"
                kind = statements[0].type.name
                said = "PIVOT without IN" if kind == "MULTI" else kind
                raise FileRefusedError("SQL", what, "Begin with SELECT", kind=said)
        except duckdb.Error as problem:
            raise _refused(problem) from None
        return self.found(sql)

    def found(self, sql: str) -> FoundRows:
        """Answer a question of our own.

        Raises
        ------
        FileRefusedError
            It cannot be answered.
        """
        import duckdb

        try:
            self._waited_for(sql)
            described = self._connection.description or []
        except duckdb.Error as problem:
            raise _refused(problem) from None
        for name, kind, *_ in described:
            if str(kind) == ZONED_TIME:
                what = "the column {name} is a time with its zone, which has no one text"
                raise FileRefusedError("SQL", what, "Write it as {name}::VARCHAR", name=name)
        return FoundRows(tuple(str(name) for name, *_ in described), self._rows())

    def _rows(self) -> Iterator[tuple[Any, ...]]:
        import duckdb

        while True:
            try:
                rows = self._waited_for()
            except duckdb.Error as problem:
                raise _refused(problem) from None
            if not rows:
                return
            yield from rows

    def _waited_for(self, sql: str = "") -> list[tuple[Any, ...]]:
        """Let a thread ask (or fetch, without `sql`): DuckDB itself does not hear Ctrl C until it is done."""

        def ask() -> list[tuple[Any, ...]]:
            if not sql:
                return self._connection.fetchmany(ROWS_AT_ONCE)
            self._connection.execute(sql)
            return []

        with ThreadPoolExecutor(1) as pool:
            waited = pool.submit(ask)
            try:
                return waited.result()
            except KeyboardInterrupt:
                self._connection.interrupt()
                raise


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
    import duckdb

    if isinstance(problem, duckdb.OutOfMemoryException):
        what = "this takes more memory than a question is given ({limit})"
        return FileRefusedError("SQL", what, "Ask for less at a time", limit=LOCKED["memory_limit"])
    remedy = "gaitwright query --columns lists what the table holds"
    return FileRefusedError("SQL", "this cannot be answered: {why}", remedy, why=_reason(problem))


def _reason(problem: Exception) -> str:
    """What a library says, in one line and without its mark of a mistake."""
    first, *more = str(problem).splitlines() or [type(problem).__name__]
    said = KIND.sub("", first).rstrip("!.:")
    hint = next((line.rstrip("?!.") for line in more if line.startswith(HINTS)), "")
    return one_line(f"{said} ({hint})" if hint else said)

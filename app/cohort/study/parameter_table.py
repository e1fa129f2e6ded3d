"""The table of a batch, opened so that a question can read it and nothing else.

Each question is answered in the limited process (`devices.files.parquet_questions`), which opens this one file.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from app.importing.untrusted_files import ask_foreign_parquet
from devices.files.refusal import FileRefusedError

PARQUET = "parameters.parquet"  # in the folder of a batch
VIEW = "parameters"
NEEDED = ("session", "walk", "side")  # what a row is of
STATUS, ERROR = "_status", "_error"
NUMBERS = ("DOUBLE", "FLOAT")


@dataclass(frozen=True, slots=True)
class FoundRows:
    """What a question found: the names of its columns, and its rows."""

    columns: tuple[str, ...]
    rows: Iterator[tuple[Any, ...]]


class ParameterTable:
    """One row per session, walk and side, as the view `parameters`.

    A number that is none (NaN) is empty there, as one that is not reported is, so that no mean has to be made to skip
    it.
    """

    def __init__(self, file: Path) -> None:
        self._file, self.where = file, str(file)
        described = self.found(f"SELECT column_name, column_type FROM (DESCRIBE {VIEW})").rows
        self.columns: Mapping[str, str] = {str(name): str(kind) for name, kind in described}
        for name in NEEDED:
            if name not in self.columns:
                raise FileRefusedError(
                    self.where,
                    "this is not a batch table: column {name} is missing",
                    "Choose the parameters.parquet written by gaitwright batch",
                    name=name,
                )

    @classmethod
    @contextmanager
    def opened(cls, place: Path) -> Iterator[Self]:
        """Open a Parquet file or a batch folder's; raises FileRefusedError."""
        file = place / PARQUET if place.is_dir() else place
        if not file.is_file():
            raise FileRefusedError(str(file), "not found", "Choose the parameters.parquet written by gaitwright batch")
        yield cls(file)

    @property
    def measures(self) -> tuple[str, ...]:
        """The parameters: numbers with a status beside them."""
        return tuple(
            name
            for name, kind in self.columns.items()
            if kind in NUMBERS and self.columns.get(name + STATUS) == "VARCHAR"
        )

    def ask(self, sql: str) -> FoundRows:
        """Answer one typed SQL query; raises FileRefusedError where it is none, several or fails."""
        return self._found(sql, is_typed=True)

    def found(self, sql: str) -> FoundRows:
        """Answer an internal SQL query; raises FileRefusedError."""
        return self._found(sql, is_typed=False)

    def _found(self, sql: str, *, is_typed: bool) -> FoundRows:
        columns, batches = ask_foreign_parquet(self._file, sql, is_typed)
        return FoundRows(columns, (row for batch in batches for row in _rows(batch)))


def _rows(batch: Sequence[Sequence[Any]]) -> Iterator[tuple[Any, ...]]:
    return zip(*batch, strict=True)


def quoted_name(name: str) -> str:
    """A column's name as SQL takes it, whatever it holds."""
    escaped = name.replace('"', '""')
    return f'"{escaped}"'

"""Change rows of a clinic's server at random, as whoever has one station's login can, and work at another station.

    python -m tests.safety.hostile_rows [--changes N] [--seed N]

After each change a station opens the library, reads all of it, hands over, destroys what is overdue; then the row is
put back. A fault is anything but a sentence for the user, and any file that was made, changed or removed outside of the
station's folder and the shared place.
"""

import argparse
import json
import random
import shutil
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import psycopg
from psycopg import sql

from app.storage.bringing_home import bring_home
from app.storage.clinic.handing_over import begin_station, hand_over
from app.storage.data_key import DataKey
from app.storage.database.models import AuditRow, Base
from app.storage.exchange import session_with_samples
from app.storage.journal.header import JournalRefusedError
from app.storage.keys import KeyRefusedError
from app.storage.opened import logged_in, slots_of
from app.storage.recovery import find_interrupted
from app.storage.retention import destroy_overdue
from app.storage.stored import LibraryError
from devices.files.refusal import FileRefusedError
from tests.safety.clinic_material import PASSPHRASE, OwnServer, make_clinic, own_server, silent

SENTENCES = (LibraryError, JournalRefusedError, KeyRefusedError, FileRefusedError)
WORDS = (
    "",
    ".",
    "..",
    "../../x",
    "{outside}/planted",
    "file://{outside}/planted",
    "%s%n",
    "\u202e",
    "x" * 10_000,
    "[[",
    "{}",
)
NUMBERS = (0, -1, 1, 2**31 - 1, -(2**31))
FLOATS = (float("nan"), float("inf"), -1e300, 0.0)
BYTES = (b"", b"\0" * 60, b"\x80" * 60, b"x" * 100_000)
JSONS: tuple[object, ...] = (None, 0, "x", [], {}, [1], {"x": []}, "{outside}/planted", [{}], "NaN")
TIMES = ("0001-01-01", "9999-12-31 23:59:59+14", "infinity", "-infinity", "1970-01-01")
UUIDS = ("00000000-0000-0000-0000-000000000000", "ffffffff-ffff-ffff-ffff-ffffffffffff")


@dataclass
class Outcome:
    """What came of all changes: how many were refused by the server, how many the station put into a sentence."""

    changes: int = 0
    refused: int = 0
    sentences: int = 0
    faults: list[str] = field(default_factory=list)


def columns() -> list[tuple[str, str]]:
    """Every column that a station's login may write."""
    tables = [table for table in Base.metadata.sorted_tables if table.name not in (AuditRow.__tablename__, "readings")]
    return [(table.name, column.name) for table in tables for column in table.columns]


def hostile(kind: str, outside: Path) -> list[Any]:
    """Values of a column of this type that no program of ours writes."""
    if kind in ("json", "jsonb"):
        return [json.dumps(value).replace("{outside}", str(outside)) for value in JSONS]
    known: dict[str, tuple[Any, ...]] = {
        "integer": NUMBERS,
        "bigint": NUMBERS,
        "double precision": FLOATS,
        "boolean": (True, False),
        "bytea": BYTES,
        "timestamp with time zone": TIMES,
        "uuid": UUIDS,
    }
    words = [word.replace("{outside}", str(outside)) for word in WORDS]
    return [*known.get(kind, words), None]


def work(folder: Path, key: DataKey) -> None:
    """Do at a station what a day brings: log in, read everything, hand over, tidy up."""
    with suppress(KeyError):
        _ = slots_of(folder).codes
    with logged_in(folder, key, "hk") as opened:
        library = opened.library
        begin_station(opened)
        bring_home(opened)
        find_interrupted(opened)
        hand_over(opened)
        library.operators.list()
        library.recordings.undecided()
        for patient in (*library.patients.search(), *library.patients.search(is_deleted=True)):
            library.corrections.of_patient(patient.id)
            library.patients.everything(patient.id)
        lines = library.sessions.list()
        library.courses.find([line.id for line in lines])
        for line in lines:
            visit = library.sessions.view(line.id)
            library.results.analysed_by("x")
            session_with_samples(opened, visit, {}, silent)
        library.audit.verify()
        destroy_overdue(opened)


class Attack:
    """One clinic under attack. `outside`: a folder that nothing may touch."""

    def __init__(self, root: Path, server: OwnServer) -> None:
        self._clinic = make_clinic(root / "clinic", server)
        self._key = slots_of(self._clinic.stations[1]).open("hk", PASSPHRASE)
        self._outside, self._kept = root / "outside", root / "kept"
        self._outside.mkdir()
        (self._outside / "foreign.journal").write_bytes(b"somebody's")
        self._before = self._seen()
        self._fill()
        work(self._clinic.stations[1], self._key)
        shutil.copytree(root / "clinic", self._kept)
        with self._connection() as connection:
            connection.execute("CREATE SCHEMA kept")
            for table in Base.metadata.sorted_tables:
                connection.execute(_sql("CREATE TABLE kept.{} AS TABLE {}", table.name, table.name))

    def change(self, table: str, column: str, draw: random.Random, outcome: Outcome) -> None:
        """Change one row, work at the other station, and put the clinic back as it was."""
        outcome.changes += 1
        value = draw.choice(hostile(self._kind(table, column), self._outside))
        try:
            with self._connection() as connection:
                statement = _sql(
                    "UPDATE {} SET {} = %s WHERE ctid = (SELECT ctid FROM {} OFFSET %s LIMIT 1)", table, column, table
                )
                connection.execute(statement, (value, draw.randrange(3)))
        except psycopg.Error:
            outcome.refused += 1
            return
        what = f"{table}.{column} = {value!r:.60}"
        try:
            work(self._clinic.stations[1], self._key)
        except SENTENCES:
            outcome.sentences += 1
        except Exception as error:  # the fault that is looked for
            outcome.faults.append(f"{what}: {type(error).__name__} {error!s:.300}")
        if self._seen() != self._before:
            outcome.faults.append(f"{what}: a file outside was touched")
        self._restore()

    def _fill(self) -> None:
        """Give every table a row: a corrected patient, a deleted visit, a result, a course."""
        with logged_in(self._clinic.stations[1], self._key, "hk") as opened:
            library = opened.library
            patient = library.patients.search()[0]
            library.patients.change(patient, replace(patient.details, height_m=1.7))
            deleted, kept = (library.sessions.get(line.id) for line in library.sessions.list())
            library.sessions.delete(deleted)
        with self._connection() as connection:
            connection.execute(
                "INSERT INTO results VALUES (gen_random_uuid(), %s, 'analysis', 'k', '{}', 'a', 'f', 'x', now())",
                (kept.id,),
            )
            connection.execute("INSERT INTO courses VALUES (%s, 'k', '{}')", (kept.id,))

    def _restore(self) -> None:
        with self._connection() as connection:
            connection.execute("SET session_replication_role = replica")  # neither triggers nor references
            for table in Base.metadata.sorted_tables:
                connection.execute(_sql("DELETE FROM {}", table.name))
                connection.execute(_sql("INSERT INTO {} SELECT * FROM kept.{}", table.name, table.name))
        folder = self._clinic.place.parent
        shutil.rmtree(folder)
        shutil.copytree(self._kept, folder)

    def _kind(self, table: str, column: str) -> str:
        with self._connection() as connection:
            query = (
                "SELECT data_type FROM information_schema.columns "
                "WHERE table_schema = 'public' AND table_name = %s AND column_name = %s"
            )
            (kind,) = connection.execute(query, (table, column)).fetchone() or ("text",)
            return str(kind)

    def _connection(self) -> "psycopg.Connection[Any]":
        return psycopg.connect(self._clinic.address)

    def _seen(self) -> dict[str, bytes]:
        return {str(path): path.read_bytes() for path in self._outside.rglob("*") if path.is_file()}


@contextmanager
def attack() -> Iterator[Attack]:
    """A clinic with two stations, to be attacked."""
    # a short path: a server's socket has 107 letters at most
    with tempfile.TemporaryDirectory(prefix="hr") as name, own_server(Path(name) / "pg") as server:
        (Path(name) / "clinic").mkdir()
        yield Attack(Path(name), server)


def run(changes: int, seed: int) -> Outcome:
    """Change each column in turn, and then columns at random."""
    outcome, draw = Outcome(), random.Random(seed)
    with attack() as attacked:
        for number in range(changes):
            table, column = columns()[number] if number < len(columns()) else draw.choice(columns())
            attacked.change(table, column, draw, outcome)
    return outcome


def _sql(text: str, *names: str) -> sql.Composed:
    return sql.SQL(text).format(*map(sql.Identifier, names))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--changes", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    outcome = run(args.changes, args.seed)
    for fault, count in Counter(outcome.faults).most_common():
        print(f"{count} times {fault}")
    print(
        f"{outcome.changes} changes: {outcome.refused} refused by the server, {outcome.sentences} told in a sentence, "
        f"{len(outcome.faults)} faults"
    )


if __name__ == "__main__":
    main()

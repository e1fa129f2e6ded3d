"""Change rows of a clinic's server at random, as whoever has one station's login can, and work at another station.

    python -m tests.safety.hostile_rows [--changes N] [--seed N]

The hostile station has its own login and SQL; the honest one, before or amid whose work rows are changed, opens the
library, edits, hands over what it recorded, reads all there is and destroys what is overdue. Then all is put back.
`AT_ONCE` rows are changed together; where the honest station ends with a sentence, half of them, down to one, since the
first sentence hides what comes after it. A change that was reported before is made alone. A fault is anything but a
sentence for the user, samples of a recording that were never recorded in it, and any file that was made, changed or
removed outside of the honest station's folder and the shared place.
"""

import argparse
import json
import logging
import random
import shutil
import tempfile
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any
from uuid import UUID

import psycopg
from psycopg import sql

from app.storage.bringing_home import bring_home
from app.storage.clinic.handing_over import begin_station, hand_over
from app.storage.clinic.station import station_of
from app.storage.data_key import DataKey
from app.storage.database.models import AuditRow, Base
from app.storage.exchange import READ_BACK, session_with_samples
from app.storage.journal.header import JournalRefusedError, read_header
from app.storage.keys import KeyRefusedError
from app.storage.opened import logged_in, slots_of
from app.storage.recovery import find_interrupted
from app.storage.retention import destroy_overdue
from app.storage.stored import LibraryError, RecordingState, StoredJournal
from app.system.progress import nobody
from core.session import Recording, RecordingKind
from devices.files.refusal import FileRefusedError
from tests.driver import Found, drive
from tests.safety.clinic_material import PASSPHRASE, OwnServer, make_clinic, name_of, own_server
from tests.safety.journal_material import LineDecoder, record_some

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


REPORTED_EVERY = 500
AT_ONCE = 8
STEPS = 4  # of the honest station's work, before each of which rows may be changed


@dataclass(frozen=True)
class Change:
    """One statement of the hostile station. `what`: for who reads of a fault."""

    what: str
    statement: sql.Composed
    parameters: tuple[Any, ...]


class Read(dict[tuple[str, UUID], object]):
    """What the honest station read, by kind and id; `samples` of each recording, as digests of its sensors'."""

    def __init__(self) -> None:
        self.samples: dict[UUID, frozenset[bytes]] = {}


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


def work(folder: Path, key: DataKey, read: Read) -> Generator[None]:
    """Do at a station what a day brings, in `STEPS` steps: log in, edit, hand over, read everything, tidy up."""
    yield
    with suppress(KeyError):
        _ = slots_of(folder).codes
    with logged_in(folder, key, "hk") as opened:
        library = opened.library
        yield
        begin_station(opened)
        bring_home(opened)
        find_interrupted(opened)
        hand_over(opened)
        library.operators.list()
        library.recordings.undecided()
        yield
        for patient in (*library.patients.search(), *library.patients.search(is_deleted=True)):
            library.corrections.of_patient(patient.id)
            read["patient", patient.id] = patient.details
            if patient.deleted_at is None:
                library.patients.change(patient, replace(patient.details, mass_kg=71.5))
        lines = library.sessions.list()
        library.courses.find([line.id for line in lines])
        yield
        for line in lines:
            visit = library.sessions.view(line.id)
            library.results.analysed_by("x")
            whole = session_with_samples(opened, visit, {"lines": LineDecoder}, nobody)
            stored = [one for one in visit.recordings if one.state in READ_BACK]
            for row, recording in zip(stored, whole.recordings, strict=True):
                read.samples[row.id] = _digests(recording)
                read["recording", row.id] = [(site, block.sensor) for site, block in recording.imu.items()]
            read["session", line.id] = replace(visit.details, recordings=())
            library.sessions.change(visit, replace(visit.details, notes="walked well"))
        if library.audit.verify().faults:
            raise LibraryError("The audit", "was changed")
        destroy_overdue(opened)


def _digests(recording: Recording) -> frozenset[bytes]:
    """One for each sensor, wherever it is stated to have been worn."""
    blocks = recording.imu.values()
    return frozenset(sha256(block.gyr_rad_s.tobytes() + block.acc_m_s2.tobytes()).digest() for block in blocks)


class Attack:
    """One clinic under attack. `outside`: a folder that nothing may touch."""

    def __init__(self, root: Path, server: OwnServer) -> None:
        self._clinic = make_clinic(root / "clinic", server)
        self.reported = set[str]()  # what ended in a sentence before
        hostile_station, self._folder = self._clinic.stations
        station = station_of(hostile_station)
        assert station is not None
        self._hostile = station.database
        self._key = slots_of(self._folder).open("hk", PASSPHRASE)
        self._outside, self._kept = root / "outside", root / "kept"
        self._outside.mkdir()
        (self._outside / "foreign.journal").write_bytes(b"somebody's")
        self._before = self._files()
        self._kinds = self._types()
        self._fill()
        shutil.copytree(root / "clinic", self._kept)
        with self._connection() as connection:
            connection.execute("CREATE SCHEMA kept")
            its_name = _sql("ALTER DATABASE {} SET synchronous_commit = off", name_of(self._clinic.address))
            connection.execute(its_name)  # half of the time would be the disk's
            for table in Base.metadata.sorted_tables:
                connection.execute(_sql("CREATE TABLE kept.{} AS TABLE {}", table.name, table.name))
        self._unchanged = self._read([], 0)
        self._restore()
        statement = sql.SQL("UPDATE sessions SET deleted_at = NULL")
        self._recorded = self._read([Change("deleted visits, too", statement.format(), ())], 0).samples
        self._restore()

    def draw_change(self, table: str, column: str, draw: random.Random) -> Change:
        """A change of a row: mostly a value that is hostile or another row's; or a row that goes, or comes twice."""
        value = draw.choice(hostile(self._kinds[table, column], self._outside))
        row, other, what = draw.randrange(12), draw.randrange(12), f"{table}.{column}"
        some = "FROM {0} OFFSET mod(%s, (SELECT greatest(count(*), 1) FROM {0})) LIMIT 1"
        its_row = f" WHERE ctid = (SELECT ctid {some})"
        match draw.choices(("value", "other", "deleted", "added"), (10, 4, 1, 3))[0]:
            case "value":
                text = "UPDATE {0} SET {1} = %s" + its_row
                return Change(f"{what} = {value!r:.60}", _sql(text, table, column), (value, row))
            case "other":
                text = f"UPDATE {{0}} SET {{1}} = (SELECT {{1}} {some})" + its_row
                return Change(f"{what} as in row {other}", _sql(text, table, column), (other, row))
            case "deleted":
                return Change(f"{table} without row {row}", _sql("DELETE FROM {0}" + its_row, table), (row,))
        names = [name for its_table, name in self._kinds if its_table == table]
        copied: list[sql.Composable] = [
            sql.SQL("gen_random_uuid()") if name == "id" else sql.Identifier(name) for name in names
        ]
        copied[names.index(column)] = sql.Placeholder()
        statement = sql.SQL("INSERT INTO {0} ({1}) SELECT {2} " + some).format(
            sql.Identifier(table), sql.SQL(", ").join(map(sql.Identifier, names)), sql.SQL(", ").join(copied)
        )
        return Change(f"{what} = {value!r:.60} in a row added", statement, (value, row))

    def takes(self, change: Change, *, is_kept: bool = False) -> bool:
        """Whether the server lets the hostile station change that, and there is a row to change."""
        try:
            with psycopg.connect(self._hostile) as connection:
                is_taken = connection.execute(change.statement, change.parameters).rowcount > 0
                if not is_kept:
                    connection.rollback()
                return is_taken
        except psycopg.Error:
            return False

    def make(self, changes: Sequence[Change], at_step: int, outcome: Found) -> None:
        """Change rows before that step of the other station's work, put all back, and look closer where it stopped."""
        what = " and ".join(change.what for change in changes)
        outcome.count["days of work"] += 1
        is_reported = False
        try:
            read = self._read(changes, at_step)
        except SENTENCES:
            is_reported = True
        except Exception as error:  # the fault that is looked for
            outcome.faults.append(f"{what}: {type(error).__name__} {error!s:.300}")
        else:
            for recording, samples in read.samples.items():
                if not samples <= self._recorded.get(recording, frozenset()):
                    outcome.faults.append(f"{what}: recording {recording} has samples that are not its own")
            if read == self._unchanged:
                outcome.count["without effect"] += len(changes)
            else:
                outcome.count["shown as they stand"] += len(changes)
        if self._files() != self._before:
            outcome.faults.append(f"{what}: a file outside was touched")
        self._restore()
        if is_reported and len(changes) > 1:
            half = len(changes) // 2
            self.make(changes[:half], at_step, outcome)
            self.make(changes[half:], at_step, outcome)
        elif is_reported:
            self.reported.add(what)
            outcome.count["told in a sentence"] += 1

    def _read(self, changes: Sequence[Change], at_step: int) -> Read:
        """What the honest station reads at its work, rows being changed before that step."""
        read = Read()
        with closing(work(self._folder, self._key, read)) as day:
            for step, _ in enumerate(day):
                if step == at_step:
                    for change in changes:
                        self.takes(change, is_kept=True)
        return read

    def _fill(self) -> None:
        """Give every table a row: a corrected patient, a deleted visit, a result, a course."""
        with logged_in(self._folder, self._key, "hk") as opened:
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
        for _ in work(self._folder, self._key, Read()):
            """A first day: all journals are fetched."""
        with logged_in(self._folder, self._key, "hk") as opened:  # one is left to be handed over
            reported = Recording("walk here", RecordingKind.WALKING, "walk_here", {})
            row = opened.library.recordings.start(kept.id, reported, is_simulated=False)
            summary = record_some(opened.recordings, self._key, recording_id=row.id)
            header = read_header(summary.path)
            opened.library.recordings.add_journal(row.id, StoredJournal(row.id, header.segment, header.wrapped_key))
            opened.library.recordings.close(row.id, RecordingState.CLOSED, {header.segment: summary.sha256})

    def _restore(self) -> None:
        with self._connection() as connection:
            connection.execute("SET session_replication_role = replica")  # neither triggers nor references
            for table in Base.metadata.sorted_tables:
                connection.execute(_sql("DELETE FROM {}", table.name))
                connection.execute(_sql("INSERT INTO {} SELECT * FROM kept.{}", table.name, table.name))
        folder = self._clinic.place.parent
        shutil.rmtree(folder)
        shutil.copytree(self._kept, folder)

    def _types(self) -> dict[tuple[str, str], str]:
        with self._connection() as connection:
            query = (
                "SELECT table_name, column_name, data_type FROM information_schema.columns "
                "WHERE table_schema = 'public' ORDER BY table_name, ordinal_position"
            )
            return {(table, column): str(kind) for table, column, kind in connection.execute(query)}

    def _connection(self) -> "psycopg.Connection[Any]":
        return psycopg.connect(self._clinic.address)

    def _files(self) -> dict[str, bytes]:
        return {str(path): path.read_bytes() for path in self._outside.rglob("*") if path.is_file()}


@contextmanager
def attack() -> Iterator[Attack]:
    """A clinic with two stations, to be attacked."""
    # a short path: a server's socket has 107 letters at most
    with tempfile.TemporaryDirectory(prefix="hr") as name, own_server(Path(name) / "pg") as server:
        (Path(name) / "clinic").mkdir()
        yield Attack(Path(name), server)


def run(changes: int, seed: int) -> Found:
    """Change each column in turn, and then columns at random."""
    outcome, draw = Found(), random.Random(seed)
    waiting: list[Change] = []
    with attack() as attacked:
        for number in range(changes):
            if number and number % REPORTED_EVERY == 0:
                print(outcome, *outcome.faults[-3:], sep="\n", flush=True)
            table, column = columns()[number] if number < len(columns()) else draw.choice(columns())
            change = attacked.draw_change(table, column, draw)
            outcome.count["changes"] += 1
            if not attacked.takes(change):
                outcome.count["refused by the server or of no row"] += 1
            elif change.what in attacked.reported:
                attacked.make([change], draw.randrange(STEPS), outcome)
            else:
                waiting.append(change)
            if len(waiting) == AT_ONCE or (waiting and number + 1 == changes):
                attacked.make(waiting, draw.randrange(STEPS), outcome)
                waiting.clear()
    return outcome


def _sql(text: str, *names: str) -> sql.Composed:
    return sql.SQL(text).format(*map(sql.Identifier, names))


def run_quietly(asked: argparse.Namespace, _: Path) -> Found:
    logging.disable(logging.CRITICAL)  # each row that cannot be read is logged
    return run(asked.changes, asked.seed)


if __name__ == "__main__":
    drive(__doc__, run_quietly, changes=1000, seed=1)

"""Kill the update of a library of each earlier version, at statements and at random instants.

Check that nothing is lost.

    python -m tests.safety.migration_kills --count 40

For each earlier step of the migrations a library with patients, visits, recordings, corrections, results and courses
is brought to that step. It is then opened by a process that is killed, and once more, to the end. All rows have to be
there as they were, as they are where nobody killed anything, and every sample has to be read as it was recorded.
"""

import itertools
import os
import random
import shutil
import signal
import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine, event, inspect, text

from app.storage.data_key import DataKey
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.schema import NEWEST
from app.storage.database.steps import alembic_config, move
from app.storage.exchange import session_with_samples
from app.storage.layout import DATABASE
from app.storage.opened import logged_in, slots_of
from app.system.progress import nobody
from tests.driver import KILLED, Found, drive, end_of_child
from tests.safety.clinic_material import OPERATORS, PASSPHRASE, make_library

TIMED = ("audit", "alembic_version")  # a login is added to the one, the other reports the version
Rows = Mapping[str, tuple[tuple[str, ...], list[tuple[object, ...]]]]


def steps() -> list[str]:
    return [script.revision for script in ScriptDirectory.from_config(alembic_config()).walk_revisions()][::-1]


def make(folder: Path) -> DataKey:
    """A library in which every table has rows."""
    make_library(folder)
    key = slots_of(folder).open(OPERATORS[0], PASSPHRASE)
    with logged_in(folder, key, OPERATORS[0]) as opened:
        library = opened.library
        for patient in library.patients.search():
            for height_m in (1.7, 1.8):
                patient = library.patients.change(patient, replace(patient.details, height_m=height_m))
        for line in library.sessions.list():
            with library.database.writing() as session:
                session.execute(
                    text(
                        "INSERT INTO results "
                        "(id, session_id, kind, key, inputs, algorithm, format, content, created_at) VALUES "
                        "(:session, :session, 'analysis', 'k', '{}', 'a', 'f', x'00ff', '2026-01-01 00:00:00')"
                    ),
                    {"session": line.id.hex},
                )
                session.execute(
                    text("INSERT INTO courses VALUES (:session, 'k', '{\"a\": [1.5]}')"), {"session": line.id.hex}
                )
    return key


@contextmanager
def database_of(folder: Path, key: DataKey) -> Iterator[Database]:
    with closing(Database(sqlite_engine(folder / DATABASE, key, creates=False))) as database:
        yield database


def rows_of(folder: Path, key: DataKey, columns_of: Rows | None = None) -> tuple[str, Rows]:
    """The version and all rows, of the columns that are there or were in `columns_of`."""
    with database_of(folder, key) as database, database.reading() as session:
        connection = session.connection()
        version = connection.execute(text("SELECT version_num FROM alembic_version")).scalar_one()
        tables = columns_of if columns_of is not None else _columns(connection)
        return version, {
            table: (
                columns,
                sorted((tuple(row) for row in connection.execute(text(_select(table, columns)))), key=repr),
            )
            for table, (columns, _) in tables.items()
        }


def _columns(connection: Connection) -> Rows:
    looking = inspect(connection)
    return {
        table: (tuple(column["name"] for column in looking.get_columns(table)), [])
        for table in looking.get_table_names()
        if table not in TIMED
    }


def _select(table: str, columns: tuple[str, ...]) -> str:
    return f"SELECT {', '.join(columns)} FROM {table}"


def samples_of(folder: Path, key: DataKey) -> tuple[str, ...]:
    """Open the library, as far as it takes to read all samples, and find its own faults."""
    with logged_in(folder, key, OPERATORS[0]) as opened:
        found = [*opened.library.faults(), *(fault.what for fault in opened.library.audit.verify().faults)]
        for line in opened.library.sessions.list():
            visit = session_with_samples(opened, opened.library.sessions.view(line.id), {}, nobody)
            found += [
                f"{recording.name} {site} {sha256(block.gyr_rad_s.tobytes() + block.acc_m_s2.tobytes()).hexdigest()}"
                for recording in visit.recordings
                for site, block in recording.imu.items()
            ]
    return tuple(found)


def open_killed(folder: Path, key: DataKey, at_statement: int, after_s: float | None) -> bool:
    """Open the library in a child that is killed before its n-th statement, or after a while; whether it was."""
    seen = itertools.count(1)

    def kill(*_: object) -> None:
        if next(seen) == at_statement:
            os.kill(os.getpid(), signal.SIGKILL)

    def open_once() -> None:
        event.listen(Engine, "before_cursor_execute", kill)
        event.listen(Engine, "commit", kill)
        logged_in(folder, key, OPERATORS[0]).library.close()

    ended = end_of_child(open_once, after_s)
    assert ended in (0, KILLED), "the opening itself failed"
    return ended == KILLED


def count_statements(folder: Path, key: DataKey) -> tuple[int, float]:
    """How many statements and seconds it takes to open the library."""
    seen, begin_s = [0], time.monotonic()

    def count(*_: object) -> None:
        seen[0] += 1

    for what in ("before_cursor_execute", "commit"):
        event.listen(Engine, what, count)
    try:
        logged_in(folder, key, OPERATORS[0]).library.close()
    finally:
        for what in ("before_cursor_execute", "commit"):
            event.remove(Engine, what, count)
    return seen[0], time.monotonic() - begin_s


def update_killed(place: Path, count: int, seed: int, required: tuple[str, ...] = ()) -> Found:
    """Kill the update from each earlier version (or the `required`) `count` times, half of them at statements."""
    rng, found = random.Random(seed), Found()
    newest = place / "newest"
    key = make(newest)
    recorded = samples_of(newest, key)
    for step in required or steps()[:-1]:
        found.count["earlier versions"] += 1
        earlier, whole = place / step, place / f"{step}-whole"
        shutil.copytree(newest, earlier)
        with database_of(earlier, key) as database, database.rebuilding() as connection:
            move(connection, step)
        _, before = rows_of(earlier, key)
        shutil.copytree(earlier, whole)
        statements, whole_s = count_statements(whole, key)
        _, expected = rows_of(whole, key)
        if rows_of(whole, key, before) != (NEWEST, before):
            found.faults.append(f"{step}: the update itself changed rows")
        if samples_of(whole, key) != recorded:
            found.faults.append(f"{step}: the update itself changed samples")
        for number in range(count):
            at_statement = rng.randint(1, statements) if number % 2 == 0 else 0
            after_s = None if at_statement else rng.uniform(0.001, whole_s)
            folder = Path(shutil.copytree(earlier, place / "killed"))
            found.count["kills"] += open_killed(folder, key, at_statement, after_s)
            version, between = rows_of(folder, key, before)
            found.count["after the update was written"] += version == NEWEST
            wrong = {
                f"neither the one nor the other: {version}": version not in (step, NEWEST),
                "rows lost by the kill": between != before,
                "samples lost": samples_of(folder, key) != recorded,
                "other rows than without a kill": rows_of(folder, key) != (NEWEST, expected),
            }
            reported = f"{step}, statement {at_statement}, {after_s} s"
            found.faults += [f"{reported}: {what}" for what, is_wrong in wrong.items() if is_wrong]
            shutil.rmtree(folder)
    return found


if __name__ == "__main__":
    drive(
        __doc__,
        lambda asked, place: update_killed(place, asked.count, asked.seed),
        count=(40, "kills for each version"),
        seed=1,
    )

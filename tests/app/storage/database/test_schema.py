"""The chain of migrations makes the tables that the models report of, on both databases."""

import threading
from pathlib import Path
from typing import Any

import pytest
from alembic.autogenerate import compare_metadata
from alembic.operations import Operations
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Column, Connection, Integer, inspect, text

from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.models import Base
from app.storage.database.schema import NEWEST, bring_up_to_date
from app.storage.database.steps import alembic_config, move
from app.storage.library import Library
from app.storage.stored import LibraryError
from core.session import Patient, Session
from tests.safety.migration_kills import update_killed


def constraints(connection: Connection) -> dict[str, Any]:
    """What `compare_metadata` leaves out."""
    looking = inspect(connection)
    tables = sorted(set(looking.get_table_names()) - {"alembic_version"})
    return {
        table: sorted((c["name"] or "", c["sqltext"]) for c in looking.get_check_constraints(table)) for table in tables
    }


def columns(connection: Connection) -> set[tuple[str, str]]:
    looking = inspect(connection)
    return {(table, column["name"]) for table in looking.get_table_names() for column in looking.get_columns(table)}


def steps() -> list[str]:
    return [script.revision for script in ScriptDirectory.from_config(alembic_config()).walk_revisions()][::-1]


def test_the_chain_has_no_branches_and_ends_where_the_code_states() -> None:
    assert ScriptDirectory.from_config(alembic_config()).get_heads() == [NEWEST]
    assert steps() == sorted(steps())


def test_the_chain_makes_the_tables_of_the_models(database: Database) -> None:
    bring_up_to_date(database)
    with database.reading() as session:
        connection = session.connection()
        assert compare_metadata(MigrationContext.configure(connection), Base.metadata) == []
        made = constraints(connection)
    with database.rebuilding() as connection:
        move(connection, "base")
        Base.metadata.create_all(connection)
        assert constraints(connection) == made


def test_every_step_can_be_taken_and_taken_back(database: Database) -> None:
    made = []
    for step in steps():
        with database.rebuilding() as connection:
            before, checked = columns(connection), constraints(connection)
            move(connection, step)
            made.append(columns(connection))
            assert made[-1] >= before
            assert (made[-1], constraints(connection)) != (before, checked)
    nothing = {("alembic_version", "version_num")}
    for step, expected in zip(["base", *steps()][-2::-1], [nothing, *made][-2::-1], strict=True):
        with database.rebuilding() as connection:
            move(connection, step)
            assert columns(connection) == expected
    bring_up_to_date(database)


def test_a_library_of_the_version_before_keeps_what_it_holds(library: Library, database: Database) -> None:
    patient = library.patients.create(Patient(code="P-1"))
    visit = library.sessions.create(patient.id, Session((), notes="first"))
    with database.rebuilding() as connection:
        move(connection, "0002")
    bring_up_to_date(database)
    assert library.sessions.get(visit.id) == visit


def test_corrections_of_the_version_before_are_numbered_as_they_were_made(tmp_path: Path) -> None:
    """Also where a clock was set back between them: the second one's id sorts before the first one's."""
    database = Database(sqlite_engine(tmp_path / "library.db", None))
    with database.rebuilding() as connection:
        move(connection, "0004")
        connection.execute(text("PRAGMA defer_foreign_keys = 1"))
        for one in ("f", "a"):
            connection.execute(
                text(f"INSERT INTO corrections VALUES ('{one * 32}', 'b', NULL, '2026-01-01', 'hk', '[]', NULL)")
            )
        move(connection, "head")
        numbers = connection.execute(text("SELECT id, number FROM corrections ORDER BY number")).all()
        connection.execute(text("DELETE FROM corrections"))
    assert numbers == [("f" * 32, 1), ("a" * 32, 2)]
    database.close()


def test_a_later_version_is_left_alone(database: Database) -> None:
    bring_up_to_date(database)
    with database.writing() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(LibraryError, match="newer version"):
        bring_up_to_date(database)


def test_stations_that_open_a_new_library_at_once_make_its_tables_once(make_engine: Any) -> None:
    stations = [Database(make_engine(), busy_s=20.0) for _ in range(3)]
    failed: list[Exception] = []

    def start(station: Database) -> None:
        try:
            bring_up_to_date(station)
        except Exception as error:  # it is shown below
            failed.append(error)

    threads = [threading.Thread(target=start, args=(station,)) for station in stations]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []
    with stations[0].reading() as session:
        assert session.scalars(text("SELECT version_num FROM alembic_version")).all() == [NEWEST]


def test_an_update_that_fails_leaves_all_as_it_was(database: Database) -> None:
    def fail() -> None:
        with database.rebuilding() as connection:
            move(connection, "head")
            _ = 1 / 0

    with pytest.raises(ZeroDivisionError):
        fail()
    with database.reading() as session:
        assert inspect(session.connection()).get_table_names() == []


def test_altering_a_table_loses_nothing_that_refers_to_it(library: Library, database: Database) -> None:
    patient = library.patients.create(Patient(code="P-1"))
    visit = library.sessions.create(patient.id, Session((), notes="first"))
    with database.rebuilding() as connection:
        operations = Operations(MigrationContext.configure(connection))
        with operations.batch_alter_table("sessions", recreate="auto") as table:
            table.add_column(Column("pages", Integer()))
            table.alter_column("surface", nullable=True)  # SQLite has to copy the table for this
    found = library.sessions.get(visit.id)
    assert found == visit
    with database.reading() as session:
        assert session.scalar(text("SELECT count(*) FROM joints")) == 4


def test_an_update_that_leaves_references_to_nothing_is_not_kept(tmp_path: Path) -> None:
    database = Database(sqlite_engine(tmp_path / "library.db", None))
    bring_up_to_date(database)
    nobody = "INSERT INTO corrections VALUES ('a', 'b', NULL, '2026-01-01', 'hk', '[]', NULL, 1)"
    with pytest.raises(LibraryError, match="corrections refers to nothing"), database.rebuilding() as connection:
        connection.execute(text(nobody))
    assert database.faults() == ()
    database.close()


@pytest.mark.endurance
def test_an_update_of_an_earlier_library_that_is_killed_loses_nothing(tmp_path: Path) -> None:
    found = update_killed(tmp_path, 4, 3, ("0001", "0006", "0012"))
    assert found.faults == []
    assert found.count["kills"] > 5

"""A login on the clinic's server is in the wrong hands: what it can do to the others."""

import datetime
import re
from pathlib import Path

import pytest
from sqlalchemy import NullPool, create_engine, make_url, text

from app.storage.clinic.joining import join, new_station, prepare_server
from app.storage.clinic.journal_store import PlaceUnconfirmedError
from app.storage.clinic.moving import move_to_server
from app.storage.clinic.station import Station, driver_url
from app.storage.database.engine import PG_BUILD_LOCK, Database, postgres_engine
from app.storage.library import Library, now_utc
from app.storage.opened import OpenedLibrary
from app.storage.stored import Action, LibraryError, Operator, Role
from app.system.progress import nobody
from tests.app.storage.clinic.conftest import Login, OpenAt, change_row
from tests.safety.hostile_rows import columns, run

pytestmark = pytest.mark.endurance  # each starts with an empty server

README = Path(__file__).parents[4] / "packaging" / "clinic" / "README.md"
ENTRY = "'2026-01-01', 'x', 'view', 'library', '{}', repeat('0', 64), repeat('0', 64)"
TABLES = ("patients", "sessions", "recordings", "journals", "operators", "settings", "audit", "readings")


FORBIDDEN = (
    f"INSERT INTO audit VALUES (2147483647, {ENTRY})",
    f"SELECT append_audit(2, {ENTRY})",
    "INSERT INTO readings VALUES (gen_random_uuid(), '', '', '', '', '', '')",
    "LOCK TABLE settings IN SHARE ROW EXCLUSIVE MODE",
    "SELECT * FROM settings FOR UPDATE",
    "SELECT note_reading('x', 'view', repeat('x', 5000), '{}')",
    *(f"DELETE FROM {table}" for table in TABLES),
)


def test_a_login_that_only_looks_can_insert_lock_and_remove_nothing(moved: Station, login: Login) -> None:
    database = Database(postgres_engine(driver_url(login("gaitwright_reader", "reader_login")), is_kept=False))
    for statement in FORBIDDEN:
        with (
            pytest.raises(LibraryError, match="The clinic's server does not permit this action for this workstation"),
            database.writing() as session,
        ):
            session.execute(text(statement))


def test_nothing_that_a_login_holds_open_that_only_looks_keeps_a_station_waiting(
    moved: Station, login: Login, folder: Path, open_at: OpenAt
) -> None:
    station = open_at(folder)
    server = create_engine(driver_url(login("gaitwright_reader", "reader_login")), poolclass=NullPool)
    with server.connect() as connection:
        connection.execute(text(f"SELECT pg_advisory_lock({PG_BUILD_LOCK})"))
        connection.execute(text("SELECT note_reading('x', 'view', 'patient:1', '{}')"))
        connection.execute(text("SELECT * FROM audit, settings, patients"))
        station.library.operators.add(Operator("cd", "C. Diehl", Role.CLINICIAN))
        assert "cd" in {operator.code for operator in station.library.operators.list()}


def test_what_a_login_that_only_looks_has_viewed_is_in_the_audit_with_its_name(
    moved: Station, login: Login, folder: Path, tmp_path: Path, open_at: OpenAt
) -> None:
    join(tmp_path / "third", login("gaitwright_reader", "reader_login"), moved.journals)
    reader = open_at(tmp_path / "third")
    (line,) = reader.library.sessions.list()
    reader.library.sessions.view(line.id)
    station = open_at(folder)
    found = [one for one in station.library.audit.entries() if "reader_login" in one.details]
    assert [one.subject for one in found] == ["operator:hk", f"session:{line.id}"]
    assert {one.action for one in found} == {Action.VIEW.value}
    assert not station.library.audit.verify().faults


def test_a_stations_login_cannot_take_numbers_out_of_turn(moved: Station, login: Login) -> None:
    database = Database(postgres_engine(driver_url(login("gaitwright_app", "station_login")), is_kept=False))
    for number in (1, 500, 2**62):
        with pytest.raises(LibraryError, match="conflicts with data"), database.writing() as session:
            session.execute(text(f"SELECT append_audit({number}, {ENTRY})"))
    with (
        pytest.raises(LibraryError, match="The clinic's server does not permit this action for this workstation"),
        database.writing() as session,
    ):
        session.execute(text(f"INSERT INTO audit VALUES (2147483647, {ENTRY})"))


def test_an_audit_with_strange_entries_is_repaired_as_the_page_for_clinics_shows(
    moved: Station, folder: Path, open_at: OpenAt
) -> None:
    station = open_at(folder)
    sound = station.library.audit.verify().end.number
    change_row(moved, f"INSERT INTO audit VALUES (2147483647, {ENTRY})")
    assert station.library.audit.verify().faults
    commands = re.findall(r'-c "([^"]+)"', README.read_text(encoding="utf-8").partition("do not belong")[2])
    assert commands
    change_row(moved, ";".join(commands[1:-1]).replace("120", str(sound)))
    station.library.operators.add(Operator("cd", "C. Diehl", Role.CLINICIAN))
    assert not station.library.audit.verify().faults


def test_whatever_is_in_a_row_no_file_outside_is_touched_and_every_refusal_is_a_sentence() -> None:
    outcome = run(len(columns()), seed=3)
    assert outcome.faults == []
    assert outcome.count["changes"] - outcome.count["refused by the server or of no row"] > 40


def test_a_station_goes_by_the_servers_clock(moved: Station, folder: Path, untouched: OpenedLibrary) -> None:
    def a_year_ahead() -> datetime.datetime:
        return now_utc() + datetime.timedelta(days=365)

    with Library.open(folder, untouched.data_key, a_year_ahead) as library:
        assert abs(library.now() - now_utc()) < datetime.timedelta(minutes=1)


def test_a_server_that_names_another_place_later_is_not_followed(
    moved: Station, tmp_path: Path, open_at: OpenAt
) -> None:
    with pytest.raises(PlaceUnconfirmedError, match=re.escape(moved.journals)):
        join(tmp_path / "second", moved.database)
    join(tmp_path / "second", moved.database, moved.journals)
    change_row(moved, """UPDATE settings SET value = '"/elsewhere"' WHERE name = 'journals place'""")
    shared = open_at(tmp_path / "second").shared
    assert shared is not None
    assert shared.place == moved.journals


def test_after_a_move_the_folder_holds_a_login_of_its_own_and_not_the_owners(
    folder: Path, database_url: str, shared_place: Path, open_at: OpenAt
) -> None:
    owner = make_url(database_url).set(password="the owners")
    move_to_server(open_at(folder), new_station(owner.render_as_string(False), str(shared_place)), nobody)
    assert "the owners" not in (folder / "station.json").read_text(encoding="utf-8")
    station = open_at(folder)
    assert station.library.patients.find("DEMO-1") is not None
    with (
        pytest.raises(LibraryError, match="The clinic's server does not permit this action for this workstation"),
        station.library.database.writing() as session,
    ):
        session.execute(text("DROP TABLE patients"))


def test_a_login_that_may_make_no_others_moves_nothing(
    folder: Path, database_url: str, shared_place: Path, postgres_url: str, open_at: OpenAt
) -> None:
    prepare_server(database_url)
    server = create_engine(postgres_url, isolation_level="AUTOCOMMIT")
    with server.connect() as connection:
        connection.execute(text("DROP ROLE IF EXISTS plain_login"))
        connection.execute(text("CREATE ROLE plain_login LOGIN IN ROLE gaitwright_owner"))
    server.dispose()
    address = make_url(database_url).set(username="plain_login").render_as_string(False)
    with pytest.raises(LibraryError, match="is not permitted to create a login"):
        move_to_server(open_at(folder), new_station(address, str(shared_place)), nobody)
    assert not (folder / "station.json").exists()

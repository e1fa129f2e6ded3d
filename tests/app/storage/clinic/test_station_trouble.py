"""What goes wrong between stations, their server and their shared place, and what must not come of it."""

import errno
import os
import signal
import subprocess
import sys
import time
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO
from uuid import UUID

import psycopg
import pytest
from sqlalchemy import create_engine, make_url, text
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session as OrmSession

from app.storage.clinic import moving
from app.storage.clinic.handing_over import begin_station, count_waiting, hand_over
from app.storage.clinic.joining import new_station, prepare_server
from app.storage.clinic.journal_store import JournalStore
from app.storage.clinic.moving import bring_back, give_up_moving, move_to_server
from app.storage.clinic.station import Station, driver_url
from app.storage.database.engine import PG_SILENT_S, Database, postgres_engine
from app.storage.opened import OpenedLibrary, made_beside, slots_of
from app.storage.recovery import find_interrupted
from app.storage.retention import destroy_recording
from app.storage.stored import LibraryError, LibraryFaultError, ServerSilentError, StoredPatient
from app.system.progress import nobody
from core.findings import Finding, Severity
from core.session import Recording, RecordingKind, Session
from tests.app.storage.clinic.conftest import OpenAt
from tests.app.storage.clinic.silent_server import SilentServer
from tests.app.storage.clinic.test_stations import Stations, found, read, record

pytestmark = pytest.mark.endurance  # each starts with an empty server


def patient_of(opened: OpenedLibrary) -> StoredPatient:
    patient = opened.library.patients.find("DEMO-1")
    assert patient is not None
    return patient


def test_a_journal_that_is_not_what_was_handed_over_stays_where_it_is(stations: Stations, session_id: UUID) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2")
    hand_over(first)
    path = first.recordings / found(first, walk).journals[0].file
    with path.open("ab") as file:
        file.write(b"more")
    longer = path.read_bytes()
    begin_station(first)
    assert path.read_bytes() == longer


def test_a_journal_whose_recording_was_destroyed_elsewhere_is_destroyed_and_no_orphan(
    stations: Stations, session_id: UUID
) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 2")
    hand_over(first)
    path = first.recordings / found(first, walk).journals[0].file
    destroy_recording(second, found(second, walk))
    with second.library.database.writing() as session:
        session.execute(text("DELETE FROM recordings WHERE id = :id").bindparams(id=walk))
    begin_station(first)
    assert not path.exists()
    assert find_interrupted(first) == ()


def test_an_orphan_is_kept_though_others_were_destroyed(stations: Stations, session_id: UUID) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2", has_row=False)
    begin_station(first)
    assert [one.recording_id for one in find_interrupted(first)] == [walk]


def test_what_was_put_there_before_a_kill_is_destroyed_too(
    stations: Stations, session_id: UUID, shared_place: Path
) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2")
    assert first.shared is not None
    kept_as = first.shared.store.put(first.recordings / found(first, walk).journals[0].file)
    destroy_recording(first, found(first, walk))
    assert not (shared_place / kept_as).exists()


def test_what_was_handed_over_since_it_was_listed_is_destroyed_too(
    stations: Stations, session_id: UUID, shared_place: Path
) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2")
    listed = found(first, walk)
    hand_over(first)
    kept_as = found(first, walk).journals[0].kept_as
    destroy_recording(first, listed)
    assert not (shared_place / kept_as).exists()


def test_a_copy_that_is_damaged_is_fetched_again(stations: Stations, session_id: UUID) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 2")
    hand_over(first)
    read(second, walk)
    copy = second.folder / "cache" / found(second, walk).journals[0].file
    whole = copy.read_bytes()
    copy.write_bytes(whole[: len(whole) // 2])
    read(second, walk)
    assert copy.read_bytes() == whole


@pytest.mark.parametrize(
    ("number", "stated"),
    [(errno.ENOSPC, "is full"), (errno.EFBIG, "is full"), (errno.EROFS, "The clinic's shared storage is read-only")],
)
def test_a_full_or_locked_place_states_so_and_leaves_nothing_half_there(
    stations: Stations, session_id: UUID, shared_place: Path, monkeypatch: pytest.MonkeyPatch, number: int, stated: str
) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2")
    before = set(shared_place.iterdir())

    def refused(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    with monkeypatch.context() as patched:
        patched.setattr("app.storage.clinic.journal_store.shutil.copyfileobj", refused)
        with pytest.raises(LibraryError, match=stated):
            hand_over(first)
    assert set(shared_place.iterdir()) == before
    assert count_waiting(first) == 1
    assert hand_over(first) == {walk}


def test_a_stations_own_full_disk_is_not_blamed_on_the_shared_place(
    stations: Stations, session_id: UUID, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 2")
    hand_over(first)

    def on_full_disk(descriptor: int, mode: str) -> BinaryIO:
        os.close(descriptor)
        return Path("/dev/full").open(mode, buffering=0)  # type: ignore[return-value]  # mypy does not know of descriptors

    monkeypatch.setattr("app.storage.clinic.journal_store.os.fdopen", on_full_disk)
    with pytest.raises(OSError, match="No space left"):
        read(second, walk)


def test_what_a_killed_station_left_half_put_goes_after_a_day(tmp_path: Path) -> None:
    (tmp_path / ".putting-1").write_bytes(b"x")
    store = JournalStore(str(tmp_path))
    store.tidy()
    assert (tmp_path / ".putting-1").exists()
    store.tidy(lambda: time.time() + 90_000)
    assert not (tmp_path / ".putting-1").exists()


HOLDS = (
    "import sys, time\nfrom pathlib import Path\nfrom app.storage.database import engine\n"
    "from app.storage.opened import open_library\nengine.PG_IDLE_S = 3.0\n"  # nobody waits 20 s here
    "with open_library(Path(sys.argv[1]), 'four short words here', 'hk') as opened:\n"
    "    with opened.library.database.writing():\n        print('held', flush=True)\n        time.sleep(600)\n"
)


@pytest.mark.parametrize("sent", [signal.SIGSTOP, signal.SIGKILL])
def test_a_station_that_falls_silent_while_it_writes_holds_up_nobody_for_long(stations: Stations, sent: int) -> None:
    first, second = stations
    holder = subprocess.Popen([sys.executable, "-c", HOLDS, str(second.folder)], stdout=subprocess.PIPE)
    assert holder.stdout is not None
    try:
        assert holder.stdout.readline() == b"held\n"
        holder.send_signal(sent)
        first.library.patients.change(patient_of(first), replace(patient_of(first).details, height_m=1.8))
    finally:
        holder.kill()
        holder.wait()
        holder.stdout.close()


def test_a_save_whose_end_was_not_received_is_stated_to_be_uncertain(
    stations: Stations, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = stations
    commit = OrmSession.commit

    def lost(session: OrmSession) -> None:
        commit(session)
        gone = OperationalError("COMMIT", {}, Exception("server closed the connection"), connection_invalidated=True)
        raise gone

    monkeypatch.setattr(OrmSession, "commit", lost)
    with pytest.raises(LibraryFaultError, match="Check whether your change was saved before you repeat it"):
        first.library.patients.change(patient_of(first), replace(patient_of(first).details, height_m=1.8))
    assert patient_of(second).details.height_m == 1.8


def test_numbers_that_are_none_go_to_the_server_and_back(
    folder: Path, database_url: str, shared_place: Path, tmp_path: Path, open_at: OpenAt
) -> None:
    noticed = Finding("any", Severity.INFO, "here", {"a": float("nan"), "b": float("inf")})
    opened = open_at(folder)
    opened.library.sessions.create(patient_of(opened).id, Session((), findings=(noticed,), is_simulated=True))
    move_to_server(opened, new_station(database_url, str(shared_place)), nobody)
    station = open_at(folder)
    bring_back(station, tmp_path / "back", nobody)
    for one in (station, open_at(tmp_path / "back")):
        visits = [one.library.sessions.get(line.id) for line in one.library.sessions.list()]
        (numbers,) = [visit.details.findings[0].numbers for visit in visits if visit.details.findings]
        assert repr(dict(numbers)) == "{'a': nan, 'b': inf}"


def test_text_that_no_server_takes_is_named_before_anything_is_moved(
    folder: Path, database_url: str, shared_place: Path, open_at: OpenAt
) -> None:
    opened = open_at(folder)
    opened.library.patients.change(patient_of(opened), replace(patient_of(opened).details, aids="a\0b"))
    with pytest.raises(LibraryError, match=f"NUL.*patients.aids {patient_of(opened).id}"):
        move_to_server(opened, new_station(database_url, str(shared_place)), nobody)
    assert list(shared_place.iterdir()) == []
    opened.library.patients.change(patient_of(opened), replace(patient_of(opened).details, aids="a b"))


def test_a_station_states_what_is_wrong_with_text_that_the_server_does_not_take(stations: Stations) -> None:
    first, _ = stations
    with pytest.raises(LibraryError, match="the NUL character"):
        first.library.patients.change(patient_of(first), replace(patient_of(first).details, aids="a\0b"))


def test_a_database_that_is_not_in_utf8_is_refused(postgres_url: str) -> None:
    server = create_engine(postgres_url, isolation_level="AUTOCOMMIT")
    for encoding in ("LATIN1", "SQL_ASCII"):
        name = f"in_{encoding.lower()}"
        with server.connect() as connection:
            connection.execute(
                text(f"CREATE DATABASE {name} TEMPLATE template0 ENCODING '{encoding}' LC_COLLATE 'C' LC_CTYPE 'C'")
            )
        url = make_url(postgres_url).set(drivername="postgresql", database=name)
        with pytest.raises(LibraryError, match="UTF-8"):
            prepare_server(url.render_as_string(hide_password=False))
        with server.connect() as connection:
            connection.execute(text(f"DROP DATABASE {name} WITH (FORCE)"))
    server.dispose()


def test_a_move_that_may_have_opened_the_server_is_not_given_up(
    folder: Path, database_url: str, shared_place: Path, open_at: OpenAt, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(*_: object) -> None:
        raise KeyboardInterrupt

    station = new_station(database_url, str(shared_place))
    with monkeypatch.context() as patched:
        patched.setattr(moving, "become_station", killed)
        with pytest.raises(KeyboardInterrupt):
            move_to_server(open_at(folder), station, nobody)
    with pytest.raises(LibraryError, match="Continue the move"):
        give_up_moving(folder)
    move_to_server(open_at(folder), station, nobody)


def test_a_library_is_brought_back_into_one_folder_only(stations: Stations, tmp_path: Path) -> None:
    first, second = stations
    bring_back(first, tmp_path / "back", nobody)
    for station, folder in ((second, "back"), (second, "other"), (first, "other")):
        target = tmp_path / folder
        with pytest.raises(LibraryError, match=r"another folder|This folder is not empty"):
            bring_back(station, target, nobody)
    assert not (tmp_path / "other").exists()
    moving.give_up_bringing_back(first.library.database)
    bring_back(second, tmp_path / "other", nobody)


def test_what_was_begun_while_it_is_brought_back_is_noticed(
    stations: Stations, session_id: UUID, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = stations

    def begun_meanwhile(folder: Path) -> AbstractContextManager[Path]:
        second.library.recordings.start(session_id, Recording("walk 9", RecordingKind.WALKING, "walk_9", {}), True)
        return made_beside(folder)

    monkeypatch.setattr(moving, "made_beside", begun_meanwhile)
    with pytest.raises(LibraryError, match="recordings are running or not yet transferred from a workstation"):
        bring_back(first, tmp_path / "back", nobody)
    assert not (tmp_path / "back").exists()
    second.library.patients.change(patient_of(second), replace(patient_of(second).details, height_m=1.8))


def test_nobody_logs_in_or_changes_a_passphrase_on_a_server_that_was_left(stations: Stations, tmp_path: Path) -> None:
    first, second = stations
    bring_back(first, tmp_path / "back", nobody)
    second.library.is_to_be_moved = False  # it was opened to work with
    with pytest.raises(LibraryError, match="no longer on the clinic's server"):
        second.library.log_in("hk")
    assert second.data_key is not None
    with pytest.raises(LibraryError, match="no longer on the clinic's server"):
        slots_of(second.folder).set_passphrase(second.data_key, "hk", "other words for then")


def test_the_servers_own_trouble_in_tls_is_not_stated_to_be_a_false_name() -> None:
    stated = psycopg.OperationalError("consuming input failed: SSL error: unexpected eof while reading")
    cause = OperationalError("", {}, stated, connection_invalidated=True)
    database = Database(postgres_engine("postgresql+psycopg://nobody@/nowhere"))
    with pytest.raises(LibraryFaultError, match="does not respond"), database.reading():
        raise cause


def test_a_server_that_falls_silent_amid_a_statement_is_given_up(
    moved: Station, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = make_url(moved.database)
    server = SilentServer(f"{url.query['host']}/.s.PGSQL.5432")
    through = url.set(host="127.0.0.1", port=server.port, query={"sslmode": "disable"})
    database = Database(postgres_engine(driver_url(through.render_as_string(hide_password=False))))
    with database.reading() as session:
        assert session.scalar(text("SELECT 1")) == 1
    server.is_silent.set()
    monkeypatch.setattr("app.storage.database.engine.PG_SILENT_S", 0.3)
    began_s = time.monotonic()
    with pytest.raises(ServerSilentError), database.reading() as session:
        session.scalar(text("SELECT 1"))
    database.close()
    server.close()
    assert time.monotonic() - began_s < PG_SILENT_S <= 30.0

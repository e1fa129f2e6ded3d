"""Two stations, one library: what one recorded the other reads, once it was handed over, and neither loses anything."""

import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import numpy as np
import pytest
from sqlalchemy import text

from app.storage.clinic.handing_over import begin_station, count_waiting, hand_over
from app.storage.clinic.joining import join, prepare_server
from app.storage.clinic.shared_journals import SharedJournals
from app.storage.clinic.station import Station, driver_url, shown_address, station_of
from app.storage.data_key import DataKey
from app.storage.database.engine import Database, postgres_engine
from app.storage.database.ids import uuid7
from app.storage.exchange import recording_with_samples, session_with_samples
from app.storage.journal.header import JournalRefusedError, read_header
from app.storage.journal.payloads import Belonging, layout_of
from app.storage.journal.writer import JournalWriter
from app.storage.keys import KeyRefusedError
from app.storage.layout import DATABASE_VARIABLE
from app.storage.opened import OpenedLibrary, slots_of
from app.storage.recovery import adopt_home, find_interrupted
from app.storage.retention import destroy_recording
from app.storage.stored import ChangedMeanwhileError, LibraryError, RecordingState, StoredJournal, StoredRecording
from app.system.progress import nobody
from core.samples import ImuBlock
from core.session import Recording, RecordingKind
from devices.source import SourceInfo
from tests.app.storage.clinic.conftest import ANY_ROOM, PASSPHRASE, Login, OpenAt, change_row

pytestmark = pytest.mark.endurance  # each starts with an empty server

Stations = tuple[OpenedLibrary, OpenedLibrary]
SENSOR = "LT-1"


def samples(count: int = 300) -> ImuBlock:
    rng = np.random.default_rng(1)
    return ImuBlock(SENSOR, np.arange(count) / 100, rng.normal(size=(count, 3)), rng.normal(size=(count, 3)))


def record(opened: OpenedLibrary, session_id: UUID, name: str, *, has_row: bool = True, is_closed: bool = True) -> UUID:
    """A recording that was stopped; without a row the database did not answer while it was made."""
    recording_id, reported = uuid7(), Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {})
    recordings = opened.library.recordings
    if has_row:
        recordings.start(session_id, reported, True, recording_id)
    writer = JournalWriter.create(opened.recordings, recording_id, opened.data_key, room=ANY_ROOM)
    header, block = writer.header, samples()
    if has_row:
        recordings.add_journal(recording_id, StoredJournal(recording_id, 1, header.wrapped_key))
    else:
        writer.mark(Belonging(session_id, reported).text())
    source = writer.source(SourceInfo("walker", "1", sensors=(SENSOR,), is_simulated=True), layout_of(block))
    writer.samples(source, 0, block, waits=True)
    summary = writer.stop()
    if has_row and is_closed:
        recordings.close(recording_id, RecordingState.CLOSED, {1: summary.sha256})
    return recording_id


def found(opened: OpenedLibrary, recording_id: UUID) -> StoredRecording:
    recording = opened.library.recordings.find(recording_id)
    assert recording is not None
    return recording


def read(opened: OpenedLibrary, recording_id: UUID) -> None:
    """See that a recording can be read; where its sensor was worn nobody stated."""
    recording_with_samples(opened, found(opened, recording_id), {})


def test_what_one_station_recorded_the_other_reads_once_it_was_handed_over(
    stations: Stations, session_id: UUID, shared_place: Path
) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 2")
    assert count_waiting(first) == 1
    with pytest.raises(JournalRefusedError, match="this recording is still on the workstation that recorded it"):
        read(second, walk)
    assert hand_over(first) == {walk}
    assert (count_waiting(first), hand_over(first)) == (0, frozenset())
    read(second, walk)
    read(first, walk)
    (journal,) = found(second, walk).journals
    assert (shared_place / journal.kept_as).read_bytes() == (second.folder / "cache" / journal.file).read_bytes()
    visit = second.library.sessions.get(session_id)
    assert len(session_with_samples(second, visit, {}, nobody).recordings) == 4


def test_what_is_still_being_recorded_is_not_handed_over(stations: Stations, session_id: UUID) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 2", has_row=False)
    open_walk = Recording("walk 3", RecordingKind.WALKING, "walk_3", {})
    first.library.recordings.start(session_id, open_walk, True)
    assert hand_over(first) == frozenset()
    assert [one.recording_id for one in find_interrupted(second)] == []  # another station's
    assert walk in {one.recording_id for one in find_interrupted(first)}


def test_what_was_recorded_while_the_server_was_gone_is_handed_over_once(
    stations: Stations, session_id: UUID, shared_place: Path
) -> None:
    first, second = stations
    before = len(list(shared_place.iterdir()))
    walk = record(first, session_id, "walk 2", has_row=False)
    (orphan,) = [one for one in find_interrupted(first) if one.is_orphan]
    adopt_home(first, orphan, nobody)
    assert hand_over(first) == {walk}
    assert [one for one in find_interrupted(first) if one.is_orphan] == []
    read(second, walk)
    names = [one.details.name for one in second.library.sessions.get(session_id).recordings]
    assert names.count("walk 2") == 1
    assert len(list(shared_place.iterdir())) == before + 1


def test_killed_before_its_row_states_so_a_journal_is_not_put_twice(
    stations: Stations, session_id: UUID, shared_place: Path
) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2")
    (journal,) = found(first, walk).journals
    assert first.shared is not None
    kept_as = first.shared.store.put(first.recordings / journal.file)
    put_at = (shared_place / kept_as).stat().st_mtime_ns
    assert hand_over(first) == {walk}
    assert (shared_place / kept_as).stat().st_mtime_ns == put_at


def test_what_was_handed_over_is_a_copy_at_the_next_start(stations: Stations, session_id: UUID) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2")
    hand_over(first)
    (journal,) = found(first, walk).journals
    begin_station(first)
    assert not (first.recordings / journal.file).exists()
    assert (first.folder / "cache" / journal.file).exists()
    read(first, walk)


def test_a_recording_that_was_destroyed_at_one_station_is_gone_from_all(
    stations: Stations, session_id: UUID, shared_place: Path
) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 2")
    hand_over(first)
    read(second, walk)
    (journal,) = found(first, walk).journals
    copy = second.folder / "cache" / journal.file
    assert copy.exists()
    destroy_recording(first, found(first, walk))
    assert not (shared_place / journal.kept_as).exists()
    assert not (first.recordings / journal.file).exists()
    begin_station(second)
    assert not copy.exists()


def test_of_copies_those_go_that_were_not_used_for_longest(stations: Stations, session_id: UUID) -> None:
    first, second = stations
    walks = [record(first, session_id, f"walk {k}") for k in (2, 3)]
    hand_over(first)
    for walk in walks:
        read(second, walk)
    files = [found(second, walk).journals[0].file for walk in walks]
    kept = second.folder / "cache" / files[0]
    assert second.shared is not None
    for file in files:  # read an hour ago: within one tick of the file system's clock nobody knows which came last
        os.utime(second.folder / "cache" / file, (time.time() - 3600,) * 2)
    second.shared.path(found(second, walks[0]).journals[0])  # used last
    second.shared.tidy(second.library.recordings.readable_files(), kept.stat().st_size)
    assert [path.name for path in (second.folder / "cache").iterdir()] == [files[0]]
    read(second, walks[1])  # fetched again


def test_a_journal_that_is_damaged_in_the_shared_place_is_not_taken(
    stations: Stations, session_id: UUID, shared_place: Path
) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 2")
    hand_over(first)
    (journal,) = found(first, walk).journals
    there = shared_place / journal.kept_as
    there.write_bytes(there.read_bytes()[:-1] + b"x")
    with pytest.raises(LibraryError, match="damaged"):
        read(second, walk)
    assert not (second.folder / "cache" / journal.file).exists()
    there.unlink()
    with pytest.raises(LibraryError, match="A recording is missing from the clinic's shared storage"):
        read(second, walk)


def test_a_row_cannot_lead_out_of_the_shared_place(tmp_path: Path) -> None:
    (tmp_path / "place").mkdir()
    shared = SharedJournals(tmp_path, str(tmp_path / "place"), None)
    with pytest.raises(LibraryError, match="The library refers to an invalid recording file"):
        shared.path(StoredJournal(uuid7(), 1, None, "", "../station.json"))


def test_a_row_that_names_another_file_neither_writes_nor_removes_it(
    stations: Stations, session_id: UUID, moved: Station, tmp_path: Path
) -> None:
    first, second = stations
    walk = record(first, session_id, "walk 9")
    hand_over(first)
    other = tmp_path / "autostart"
    change_row(moved, f"UPDATE journals SET file = '{other}' WHERE recording_id = '{walk}'")
    read(second, walk)
    assert not other.exists()
    other.write_bytes(b"somebody's")
    destroy_recording(second, found(second, walk))
    assert other.read_bytes() == b"somebody's"


def test_a_row_cannot_pass_off_another_recording_as_its_own(
    stations: Stations, session_id: UUID, moved: Station
) -> None:
    first, second = stations
    walks = [record(first, session_id, name) for name in ("walk 8", "walk 9")]
    hand_over(first)
    other = found(first, walks[1]).journals[0].kept_as
    change_row(moved, f"UPDATE journals SET kept_as = '{other}' WHERE recording_id = '{walks[0]}'")
    with pytest.raises(JournalRefusedError, match="another recording"):
        read(second, walks[0])
    read(second, walks[1])


def test_an_edit_from_an_older_state_is_refused_between_stations(stations: Stations) -> None:
    first, second = stations
    seen = [one.library.patients.find("DEMO-1") for one in stations]
    assert seen[0] is not None
    assert seen[0] == seen[1]
    first.library.patients.change(seen[0], replace(seen[0].details, height_m=1.8))
    with pytest.raises(ChangedMeanwhileError):
        second.library.patients.change(seen[0], replace(seen[0].details, height_m=1.7))


def test_a_passphrase_that_was_changed_at_one_station_opens_at_the_other(stations: Stations) -> None:
    first, second = stations
    assert first.data_key is not None
    new = "other words for then"
    slots_of(first.folder).set_passphrase(first.data_key, "hk", new)
    assert slots_of(second.folder).open("hk", new) == first.data_key
    with pytest.raises(KeyRefusedError):
        slots_of(second.folder).open("hk", PASSPHRASE)


def test_without_the_server_a_station_knows_its_operators_and_changes_nothing(
    stations: Stations, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    first, second = stations
    assert second.data_key is not None
    monkeypatch.setenv(DATABASE_VARIABLE, f"postgresql://nobody@/nowhere?host={tmp_path}")
    slots = slots_of(second.folder)
    assert slots.codes == ("hk", "ab")
    assert slots.open("hk", PASSPHRASE) == second.data_key
    with pytest.raises(LibraryError, match="server does not respond"):
        slots.set_passphrase(second.data_key, "hk", "other words for then")
    monkeypatch.delenv(DATABASE_VARIABLE)
    assert slots_of(first.folder).open("hk", PASSPHRASE) == first.data_key


def test_two_stations_that_add_operators_at_once_lose_none(stations: Stations) -> None:
    add = (
        "import sys\nfrom pathlib import Path\nfrom app.storage.opened import slots_of\n"
        "slots = slots_of(Path(sys.argv[1]))\nkey = slots.open('hk', sys.argv[2])\n"
        "for k in range(3): slots.add(key, f'{sys.argv[3]}{k}', 'four short words here')\n"
    )
    commands = [
        [sys.executable, "-c", add, str(one.folder), PASSPHRASE, name] for one, name in zip(stations, "xy", strict=True)
    ]
    running = [subprocess.Popen(command) for command in commands]
    assert [one.wait(120) for one in running] == [0, 0]
    assert set(slots_of(stations[0].folder).codes) == {"hk", "ab", "x0", "x1", "x2", "y0", "y1", "y2"}


def test_a_station_shows_no_password(moved: Station) -> None:
    station = replace(moved, database="postgresql://gait:hunter2@clinic.example/gait")
    assert "hunter2" not in repr(station)
    assert "hunter2" not in shown_address(station.database)
    assert "clinic.example" in shown_address(station.database)


def test_the_file_that_names_the_server_is_its_owners_alone(moved: Station, folder: Path) -> None:
    assert (folder / "station.json").stat().st_mode & 0o077 == 0


def test_a_damaged_station_file_is_stated_to_be(moved: Station, folder: Path) -> None:
    (folder / "station.json").write_text("{")
    with pytest.raises(LibraryError, match="Connect to the clinic's library again"):
        station_of(folder)


@pytest.mark.parametrize("address", ["", "clinic.example", "mysql://a@b/c", "postgresql://clinic.example", "//"])
def test_what_is_no_address_of_a_server_is_refused(address: str, tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="This is not the address of a PostgreSQL server"):
        join(tmp_path / "station", address)
    assert not (tmp_path / "station").exists()


def test_an_empty_server_cannot_be_joined(database_url: str, tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="No library was found on the clinic's server"):
        join(tmp_path / "station", database_url)
    prepare_server(database_url)
    with pytest.raises(LibraryError, match="No library was found on the clinic's server"):
        join(tmp_path / "station", database_url)


def test_a_stations_login_works_and_cannot_touch_tables_or_audit(
    moved: Station, login: Login, tmp_path: Path, open_at: OpenAt
) -> None:
    address = login("gaitwright_app", "station_login")
    join(tmp_path / "third", address, moved.journals)
    station = open_at(tmp_path / "third")
    patient = station.library.patients.find("DEMO-1")
    assert patient is not None
    station.library.patients.change(patient, replace(patient.details, height_m=1.7))
    engine = postgres_engine(driver_url(address))
    database = Database(engine)
    for stated in ("UPDATE audit SET operator = 'x'", "DELETE FROM audit", "TRUNCATE audit", "DROP TABLE patients"):
        with (
            pytest.raises(LibraryError, match="The clinic's server does not permit this action for this workstation"),
            database.writing() as session,
        ):
            session.execute(text(stated))
    database.close()


def test_a_readers_login_reads_is_noted_and_changes_nothing(
    moved: Station, login: Login, tmp_path: Path, open_at: OpenAt
) -> None:
    join(tmp_path / "third", login("gaitwright_reader", "reader_login"), moved.journals)
    reader = open_at(tmp_path / "third")
    (line,) = reader.library.sessions.list()
    visit = reader.library.sessions.view(line.id)
    assert len(session_with_samples(reader, visit, {}, nobody).recordings) == 3
    patient = reader.library.patients.find("DEMO-1")
    assert patient is not None
    with pytest.raises(LibraryError, match="The clinic's server does not permit this action for this workstation"):
        reader.library.patients.change(patient, replace(patient.details, height_m=1.7))


def test_journals_are_of_the_librarys_own_key(stations: Stations, session_id: UUID) -> None:
    first, _ = stations
    walk = record(first, session_id, "walk 2")
    path = first.recordings / found(first, walk).journals[0].file
    with pytest.raises(JournalRefusedError):
        read_header(path).key(DataKey(bytes(32)), path.name)

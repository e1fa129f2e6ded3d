"""A library goes to a clinic's server and back, whole, and can be broken off anywhere on the way."""

import hashlib
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import Connection, text

from app.storage.clinic import moving
from app.storage.clinic.joining import join, new_station
from app.storage.clinic.moving import BEFORE, bring_back, give_up_moving, move_to_server
from app.storage.clinic.rows import copy_rows
from app.storage.clinic.station import Station
from app.storage.exchange import session_with_samples
from app.storage.layout import DATABASE, MOVING
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, open_library
from app.storage.stored import LibraryError, Operator, Role
from app.system.progress import nobody
from core.session import Session
from tests.app.storage.clinic.conftest import PASSPHRASE, OpenAt

pytestmark = pytest.mark.endurance  # each starts with an empty server

Reading = dict[str, object]


def everything_of(opened: OpenedLibrary) -> Reading:
    """What a library holds, but its audit, as its own readers give it."""
    library = opened.library
    patients = library.patients.search()
    visits = [library.sessions.get(line.id) for line in library.sessions.list()]
    return {
        "patients": patients,
        "visits": [replace(visit, recordings=()) for visit in visits],
        "recordings": [recording.details for visit in visits for recording in visit.recordings],
        "operators": library.operators.list(),
        "samples": [samples_of(session_with_samples(opened, visit, {}, nobody)) for visit in visits],
    }


def samples_of(session: Session) -> list[str]:
    return [
        hashlib.sha256(block.time_s.tobytes() + block.gyr_rad_s.tobytes() + block.acc_m_s2.tobytes()).hexdigest()
        for recording in session.recordings
        for block in recording.imu.values()
    ]


@pytest.fixture
def before(untouched: OpenedLibrary, tmp_path: Path, open_at: OpenAt) -> Reading:
    opened = open_at(Path(shutil.copytree(untouched.folder, tmp_path / "as it was")))
    return everything_of(opened)


def test_a_library_is_the_same_on_the_server_and_opens_there_with_the_same_passphrase(
    before: Reading, moved: Station, folder: Path, shared_place: Path
) -> None:
    assert len(list(shared_place.iterdir())) == 3
    assert not (folder / DATABASE).exists()
    assert not (folder / MOVING).exists()
    with open_library(folder, PASSPHRASE, "hk") as opened:
        station = opened.library.station
        assert station is not None
        assert (station.id, station.journals) == (moved.id, moved.journals)  # by a login of its own
        assert everything_of(opened) == before
        assert opened.library.audit.verify().faults == ()


def test_what_is_in_the_shared_place_is_encrypted(moved: Station, shared_place: Path) -> None:
    content = b"".join(path.read_bytes() for path in shared_place.iterdir())
    assert b"DEMO-1" not in content
    assert b"left_thigh" not in content


def test_it_comes_back_as_it_was_and_the_server_is_closed(
    before: Reading, moved: Station, folder: Path, tmp_path: Path, open_at: OpenAt
) -> None:
    station = open_at(folder)
    back = bring_back(station, tmp_path / "back", nobody)
    assert (back.journals, back.missing) == (3, 0)
    with open_library(tmp_path / "back", PASSPHRASE, "hk") as opened:
        assert opened.library.station is None
        assert everything_of(opened) == before
        assert opened.library.audit.verify().faults == ()
    with pytest.raises(LibraryError, match="no longer on the clinic's server"):
        station.library.audit.note_rollback(1, 2)
    with pytest.raises(LibraryError, match="no longer on the clinic's server"):
        open_library(folder, PASSPHRASE, "hk")
    with pytest.raises(LibraryError, match="no longer on the clinic's server"):
        join(tmp_path / "third", moved.database)


def test_a_copy_leaves_the_server_as_it_is(
    before: Reading, moved: Station, folder: Path, tmp_path: Path, open_at: OpenAt
) -> None:
    station = open_at(folder)
    bring_back(station, tmp_path / "copy", nobody, is_copy=True)
    with open_library(tmp_path / "copy", PASSPHRASE, "hk") as opened:
        assert everything_of(opened) == before
    assert station.library.patients.find("DEMO-1") is not None


def test_nothing_is_brought_back_while_something_waits_at_a_station(
    stations: tuple[OpenedLibrary, OpenedLibrary], tmp_path: Path
) -> None:
    first, second = stations
    (line,) = first.library.sessions.list()
    recording = first.library.sessions.get(line.id).recordings[0]
    second.library.recordings.start(line.id, replace(recording.details, name="walk 9"), True)
    with pytest.raises(LibraryError, match="recordings are running or not yet transferred from a workstation"):
        bring_back(first, tmp_path / "back", nobody)
    assert not (tmp_path / "back").exists()
    assert second.library.patients.find("DEMO-1") is not None


Break = Callable[[], None]


@pytest.mark.parametrize("step", ["_put_journals", "_put_rows", "_refuse_difference", "set_state", "become_station"])
@pytest.mark.parametrize("is_done", [False, True])
def test_a_move_that_is_broken_off_anywhere_goes_on(
    before: Reading,
    folder: Path,
    database_url: str,
    shared_place: Path,
    open_at: OpenAt,
    monkeypatch: pytest.MonkeyPatch,
    step: str,
    is_done: bool,
) -> None:
    real = getattr(moving, step)

    def broken(*arguments: object, **named: object) -> None:
        if is_done:
            real(*arguments, **named)
        raise KeyboardInterrupt

    station = new_station(database_url, str(shared_place))
    with monkeypatch.context() as patched:
        patched.setattr(moving, step, broken)
        with pytest.raises(KeyboardInterrupt):
            move_to_server(open_at(folder), station, nobody)
    if not (is_done and step == "become_station"):
        with pytest.raises(LibraryError, match="is being moved"):
            open_library(folder, PASSPHRASE, "hk")
        move_to_server(open_at(folder), station, nobody)
    with open_library(folder, PASSPHRASE, "hk") as opened:
        assert everything_of(opened) == before
        reported = [entry for entry in opened.library.audit.entries() if "is_moved_to_server" in entry.details]
        assert len(reported) == 1


def test_a_move_that_is_given_up_leaves_the_folder_to_work_with(
    before: Reading,
    folder: Path,
    database_url: str,
    shared_place: Path,
    open_at: OpenAt,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def broken(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(moving, "_refuse_difference", broken)
        with pytest.raises(KeyboardInterrupt):
            move_to_server(open_at(folder), new_station(database_url, str(shared_place)), nobody)
    give_up_moving(folder)
    with open_library(folder, PASSPHRASE, "hk") as opened:
        assert everything_of(opened) == before
    with pytest.raises(LibraryError, match="still being moved"):
        join(folder.with_name("second"), database_url)


def test_a_row_that_changed_on_the_way_is_noticed(
    folder: Path, database_url: str, shared_place: Path, open_at: OpenAt, monkeypatch: pytest.MonkeyPatch
) -> None:
    def spoilt(source: Connection, target: Connection) -> None:
        copy_rows(source, target)
        target.execute(text("UPDATE sessions SET notes = 'another'"))

    monkeypatch.setattr(moving, "copy_rows", spoilt)
    with pytest.raises(LibraryError, match="These tables differ: sessions"):
        move_to_server(open_at(folder), new_station(database_url, str(shared_place)), nobody)
    assert (folder / DATABASE).exists()


def test_a_server_with_another_library_is_refused(
    moved: Station, tmp_path: Path, shared_place: Path, untouched: OpenedLibrary
) -> None:
    other = Library.create(tmp_path / "other", untouched.data_key, Operator("hk", "H. Keller", Role.ADMINISTRATOR))
    opened = OpenedLibrary(other, tmp_path / "other", untouched.data_key)
    with pytest.raises(LibraryError, match="The clinic's server already holds another library"):
        move_to_server(opened, new_station(moved.database, str(shared_place)), nobody)
    other.close()


def test_the_database_before_stays_beside_the_station(moved: Station, folder: Path) -> None:
    assert (folder / BEFORE).stat().st_size > 0


def test_a_shared_place_that_is_not_there_is_not_made_up_for(
    folder: Path, database_url: str, tmp_path: Path, open_at: OpenAt
) -> None:
    with pytest.raises(LibraryError, match="place of the clinic's recordings is not there"):
        move_to_server(open_at(folder), new_station(database_url, str(tmp_path / "unmounted")), nobody)
    assert not (tmp_path / "unmounted").exists()
    with open_library(folder, PASSPHRASE, "hk"):
        pass

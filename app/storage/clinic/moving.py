"""A library goes from a folder to the clinic's server, or back from it, whole: rows and journals as they are.

Nothing is changed on the way: rows keep their ids, journals their bytes, the audit its chain, the data key is the same
one. Journals go first, each put under its hash and read back, so an interrupted move goes on where it was. Rows follow
in one transaction: all of them are there, or none. Then all tables are read at both ends and compared. Only when they
are the same is the folder made a station's; what was its database stays beside it under another name.

A folder that is being moved is not opened meanwhile, nor is a server whose library is being brought back.
"""

import json
import shutil
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import func, insert, select, update
from sqlalchemy.orm import Session as OrmSession

from app.storage.clinic.handing_over import count_waiting
from app.storage.clinic.journal_store import JournalStore
from app.storage.clinic.key_slots import SLOTS_SETTING, put_slots
from app.storage.clinic.logins import let_in, station_login
from app.storage.clinic.rows import copy_rows, differing_tables, refuse_nul
from app.storage.clinic.server_state import ServerState, close_for, set_state, state_of
from app.storage.clinic.station import JOURNALS_SETTING, Station
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.models import AuditRow, JournalRow, PatientRow, RecordingRow, SessionRow, SettingRow
from app.storage.database.schema import bring_up_to_date
from app.storage.files import replace_file, sync_folder
from app.storage.layout import CACHE, DATABASE, KEYS, MOVING, RECORDINGS, STATION, SUFFIX
from app.storage.opened import OpenedLibrary, made_beside
from app.storage.recovery import find_interrupted
from app.storage.root import ID_SETTING
from app.storage.stored import Action, LibraryError, RecordingState
from app.system.progress import Report
from app.wording.translation import tr

BEFORE = "library-before-the-server.db"  # what was the folder's database
LAST_STEP = b"last step"  # the mark of a move that nobody may give up without looking at the server
BACK_FROM = "-back-from-the-server"  # a folder beside the station's, until all of it is there
JOURNALS_SHARE = 0.8  # of the progress; the rows take the rest


@dataclass(frozen=True, slots=True)
class Moved:
    """What was moved and compared. `missing`: journals that were missing before already."""

    patients: int
    sessions: int
    recordings: int
    journals: int
    bytes: int
    missing: int


def move_to_server(opened: OpenedLibrary, station: Station, report: Report) -> Moved:
    """Move a folder's library to the clinic's server; the folder becomes a station's and `opened` is closed.
    The caller holds the folder alone and calls again after an abort; `station` has a login to make tables.
    Raises LibraryError (rows and files are as before) or OSError.
    """
    folder, library = opened.folder, opened.library
    own = station_login(station)
    if opened.shared is not None or opened.data_key is None or opened.away_from is not None:
        raise LibraryError("Only a library in a folder can be moved to a server", "Open your own library")
    if any(not one.problem for one in find_interrupted(opened)):
        raise LibraryError("A recording is running or was not completed", "Stop or review it, then move the library")
    if library.clips.known():
        raise LibraryError(
            "This library contains videos, which a clinic's shared library does not store",
            "Delete the videos, then move the library",
        )
    store = JournalStore(station.journals)
    with closing(station.database_kept()) as server:
        refuse_nul(library.database)
        store.refuse_missing()
        bring_up_to_date(server)
        let_in(server, own)
        state = _state_for(server, library.database)
        if state is not ServerState.OPEN:  # else all that is left is to make the folder a station's
            if not (folder / MOVING).exists():
                library.audit.note(Action.EDIT, "library", is_moved_to_server=True)
                replace_file(folder / MOVING, b"")
            kept, size = _put_journals(opened, store, report)
            if state is None:
                _put_rows(library.database, server, kept, station.journals, (folder / KEYS).read_bytes())
            else:
                _put_later_entries(library.database, server)
            _refuse_difference(library.database, server, "Empty the server's database, then move the library again")
            moved = _counted(server, len(kept), size)
            replace_file(folder / MOVING, LAST_STEP)  # from here on it may be open there, whether that is known or not
            with server.writing() as session:
                set_state(session, ServerState.OPEN)
        else:
            moved = _counted(server, 0, 0)
    library.close()
    become_station(folder, own)
    report(1.0, "")
    return moved


def give_up_moving(folder: Path) -> None:
    """Reopen a folder whose move was broken off; raises LibraryError if too late, OSError."""
    if (folder / STATION).exists():
        raise LibraryError("This library is already on the clinic's server", "Move the library back from the server")
    if (folder / MOVING).exists() and (folder / MOVING).read_bytes() == LAST_STEP:
        raise LibraryError("Workstations may already be using this library on the clinic's server", "Continue the move")
    (folder / MOVING).unlink(missing_ok=True)


def give_up_early(folder: Path) -> None:
    """As `give_up_moving` if the move failed before its last step; later the mark stays and the move goes on."""
    mark = folder / MOVING
    if mark.exists() and mark.read_bytes() != LAST_STEP:
        give_up_moving(folder)


def bring_back(opened: OpenedLibrary, folder: Path, report: Report, *, is_copy: bool = False) -> Moved:
    """Bring the clinic's library into `folder` and, unless `is_copy`, close the server's; may be called again.
    Raises LibraryError (not a station, recording or waiting, no answer, not empty, differs) or OSError.
    """
    shared, library = opened.shared, opened.library
    if shared is None:
        raise LibraryError("This library is already in a folder", "Use a backup to copy the library")
    server, own_id = library.database, library.station.id if library.station is not None else ""
    with server.reading() as session:
        is_open = state_of(session) is ServerState.OPEN
        _refuse_waiting(session)
    if is_open:  # else it was noted before this was interrupted
        action = Action.BACKUP if is_copy else Action.EDIT
        library.audit.note(action, "library", is_copied_to_folder=is_copy, is_brought_back=not is_copy)
    with made_beside(folder) as beside:
        if not is_copy:
            with server.writing() as session:
                _refuse_waiting(session)  # somebody may have begun to record
                close_for(session, f"{own_id} {folder.resolve()}")
        try:
            moved = _make_folder(opened, shared.store, beside, report, is_copy=is_copy)
        except BaseException:
            if not is_copy:
                give_up_bringing_back(server)
            raise
    report(1.0, "")
    return moved


def bring_back_here(opened: OpenedLibrary, report: Report) -> Moved:
    """Make the station's folder the clinic's library, close the server's and `opened`; caller holds it alone.
    Raises LibraryError as `bring_back` or for recordings in no session; OSError: the server is open again.
    """
    folder, server = opened.folder, opened.library.database
    if count_waiting(opened):
        raise LibraryError("A recording on this computer has not been transferred yet", "Try again after the transfer")
    beside = folder.with_name(f"{folder.name}{BACK_FROM}")
    shutil.rmtree(beside, ignore_errors=True)  # of one that was broken off
    moved = bring_back(opened, beside, report)
    try:
        (folder / RECORDINGS).mkdir(mode=0o700, exist_ok=True)
        for journal in (beside / RECORDINGS).iterdir():
            journal.replace(folder / RECORDINGS / journal.name)
        for name in (KEYS, DATABASE):
            (beside / name).replace(folder / name)
        sync_folder(folder / RECORDINGS)
        opened.library.close()
        (folder / STATION).unlink()
    except BaseException:
        give_up_bringing_back(server)
        raise
    sync_folder(folder)
    for rest in (beside, folder / CACHE):
        shutil.rmtree(rest, ignore_errors=True)
    return moved


def give_up_bringing_back(server: Database) -> None:
    """Open the library on the server to its stations again: nothing was brought back, or nobody works with that."""
    with server.writing() as session:
        if state_of(session) is ServerState.CLOSED:
            set_state(session, ServerState.OPEN)


def become_station(folder: Path, station: Station) -> None:
    """Make the folder of a library that is on the server now a station's; killed in between, opening it goes on."""
    station.write(folder)
    if (folder / DATABASE).exists():
        (folder / DATABASE).replace(folder / BEFORE)
    (folder / MOVING).unlink(missing_ok=True)


def _state_for(server: Database, source: Database) -> ServerState | None:
    """Give how far this library is on the server, None: not at all; raises LibraryError for another or moved."""
    with source.reading() as session:
        own = session.get_one(SettingRow, ID_SETTING).value
    with server.reading() as session:
        there, state = SettingRow.of(session, ID_SETTING), state_of(session)
    if there is None:
        return None
    if there != own:
        raise LibraryError(
            "The clinic's server already holds another library", "Use a separate database for this library"
        )
    if state is ServerState.CLOSED:
        raise LibraryError(
            "The clinic's server still holds an older copy of this library",
            "Empty the server's database, or use another database for the library",
        )
    return state


def _put_journals(opened: OpenedLibrary, store: JournalStore, report: Report) -> tuple[dict[str, str], int]:
    """What each file is kept as, and how many bytes these are; a file that is missing is not among them."""
    with opened.library.database.reading() as session:
        required = (
            select(JournalRow)
            .join(RecordingRow)
            .where(RecordingRow.state != RecordingState.DISCARDED)
            .order_by(JournalRow.recording_id, JournalRow.segment)
        )
        files = [opened.recordings / journal.file for journal in session.scalars(required)]
    here = [path for path in files if path.exists()]
    sizes = [path.stat().st_size for path in here]
    kept, done = {}, 0
    for path, size in zip(here, sizes, strict=True):
        kept[path.name] = store.put(path)
        done += size
        report(JOURNALS_SHARE * done / max(sum(sizes), 1), "")
    return kept, done


def _put_rows(source: Database, server: Database, kept: Mapping[str, str], place: str, slots: bytes) -> None:
    with source.reading() as session, server.writing() as there:
        copy_rows(session.connection(), there.connection())
        for row in there.scalars(select(JournalRow)):
            row.kept_as = kept.get(row.file, "")
        there.add(SettingRow(name=JOURNALS_SETTING, value=place))
        put_slots(there, slots)
        set_state(there, ServerState.MOVING)


def _put_later_entries(source: Database, server: Database) -> None:
    """Add to the audit on the server who logged in since, to go on with the move."""
    with source.reading() as session, server.writing() as there:
        last = there.scalar(select(func.max(AuditRow.number))) or 0
        later = session.execute(select(AuditRow.__table__).where(AuditRow.number > last)).mappings()
        there.execute(insert(AuditRow), [dict(row) for row in later])


def _make_folder(opened: OpenedLibrary, store: JournalStore, folder: Path, report: Report, *, is_copy: bool) -> Moved:
    server = opened.library.database
    (folder / RECORDINGS).mkdir(mode=0o700)
    with closing(Database(sqlite_engine(folder / DATABASE, opened.data_key))) as target:
        bring_up_to_date(target)
        kept = _take_rows(server, target)
        size = _fetch_journals(kept, store, folder, report)
        if not is_copy:  # else the server goes on changing
            _refuse_difference(server, target, "Try again")
        moved = _counted(target, len(kept), size)
    with server.reading() as session:
        slots = session.get_one(SettingRow, SLOTS_SETTING).value
    replace_file(folder / KEYS, json.dumps(slots, indent=1).encode())
    return moved


def _take_rows(server: Database, target: Database) -> dict[str, str]:
    """Copy all rows here; what each file is kept as."""
    with server.reading() as session, target.writing() as here:
        copy_rows(session.connection(), here.connection())
        kept = {row.file: row.kept_as for row in session.scalars(select(JournalRow)) if row.kept_as}
        here.execute(update(RecordingRow).values(station=""))
    return kept


def _refuse_waiting(session: OrmSession) -> None:
    """Raise LibraryError where a recording goes on or waits at a station to be handed over."""
    waiting = session.scalar(
        select(func.count())
        .select_from(RecordingRow)
        .outerjoin(JournalRow)
        .where(RecordingRow.state != RecordingState.DISCARDED)
        .where(
            (RecordingRow.state == RecordingState.OPEN)
            | ((JournalRow.kept_as == "") & JournalRow.wrapped_key.is_not(None))
        )
    )
    if waiting:
        raise LibraryError(
            tr("{count} recordings are running or not yet transferred from a workstation").format(count=waiting),
            "Start Gaitwright on each workstation, and try again after the transfer",
        )


def _fetch_journals(kept: Mapping[str, str], store: JournalStore, folder: Path, report: Report) -> int:
    size = 0
    for number, (file, kept_as) in enumerate(sorted(kept.items())):
        path = folder / RECORDINGS / file
        if path.parent != folder / RECORDINGS or not file.endswith(SUFFIX):  # a row may say anything
            raise LibraryError("The library refers to an invalid recording file", "Restore the library from a backup")
        store.fetch(kept_as, path)
        size += path.stat().st_size
        report(JOURNALS_SHARE * (number + 1) / len(kept), "")
    return size


def _refuse_difference(one: Database, other: Database, remedy: str) -> None:
    """Raise LibraryError with this remedy where the two databases differ."""
    if tables := differing_tables(one, other):
        what = tr("The copy of the library does not match the original. These tables differ: {tables}").format(
            tables=", ".join(tables)
        )
        raise LibraryError(what, remedy)


def _counted(database: Database, journals: int, size: int) -> Moved:
    with database.reading() as session:
        patients, sessions, recordings, all_journals = (
            session.scalar(select(func.count()).select_from(table)) or 0
            for table in (PatientRow, SessionRow, RecordingRow, JournalRow)
        )
    return Moved(patients, sessions, recordings, journals, size, all_journals - journals)

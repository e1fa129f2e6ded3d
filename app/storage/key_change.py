"""Give a library another data key, so that who had the old one reads nothing of what comes.

The database is copied under the new key, with the keys of all journals and videos wrapped again, then takes the place
of the old one, and the slots' file after it. Killed at any point, the library opens with the keys that it had or with
all of the new ones: `settle` (`app.storage.key_change_rest`) looks which database is there, by the salt in its first
bytes, and takes the slots' file that belongs to it. What is in the files' own headers comes last; until then the
database's copy opens them.

Backups that were made before keep their old key. So does what a disk keeps of files that were replaced.
"""

import hashlib
import json
import os
from collections.abc import Callable, Iterable
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from sqlalchemy import select

from app.storage.data_key import KEY_BYTES, DataKey, KeyMaterial
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.models import ClipRow, JournalRow, SettingRow
from app.storage.derived_keys import derived_keys, keep_derived_keys
from app.storage.files import replace_file, sync_folder
from app.storage.journal.header import HEADER_BYTES, JournalHeader, JournalRefusedError, find_segments
from app.storage.journal_headers import HEADERS_DUE, write_headers
from app.storage.key_change_rest import remove_database, salt_of
from app.storage.keys import KeySlots
from app.storage.layout import DATABASE, KEYS, NEW_DATABASE, NEW_KEYS, RECORDINGS, VIDEOS
from app.storage.opened import OpenedLibrary
from app.storage.recovery import find_interrupted
from app.storage.stored import Action, ClipState, LibraryBusyError, LibraryError
from app.system.progress import Report
from app.wording.translation import tr

PIECE_BYTES = 1 << 20
PAGES = 256  # of the database, copied between two reports
COPY_SHARE = 0.3  # of the progress; the journals take the rest


@dataclass(frozen=True, slots=True)
class ChangedKey:
    """What came of a change.

    `recovery_key`: the text of a new recovery key, where the old one opens nothing any more; else empty.
    `left_out`: operators who need a new passphrase, because they have not logged in since slots have keys of their own.
    """

    data_key: DataKey
    recovery_key: str = field(repr=False)
    left_out: tuple[str, ...]


def change_data_key(opened: OpenedLibrary, staying: Iterable[str], report: Report) -> ChangedKey:
    """Give a library a new data key for the operators `staying` only; `opened` is closed.
    Raises KeyRefusedError (changing already, nobody left), LibraryError (also as `refuse_change`), OSError;
    the former state is then kept.
    """
    refuse_change(opened)
    old = opened.data_key
    assert old is not None  # else it was refused
    opened.library.audit.note(Action.EDIT, "library", is_key_change_begun=True)
    slots, new = KeySlots(opened.folder / KEYS), DataKey(os.urandom(KEY_BYTES))
    report(0.0, "")
    opened.library.close()
    with slots.held():
        sealed = slots.sealed_again(old, new, staying)
        _replace(opened.folder, old, new, sealed.content, report)
    with closing(Database(sqlite_engine(opened.folder / DATABASE, new, creates=False))) as database:
        write_headers(database, opened.folder)
    report(1.0, "")
    return ChangedKey(new, sealed.recovery_key, sealed.left_out)


def refuse_change(opened: OpenedLibrary) -> None:
    """Raise LibraryError where the key must not change: no key, a recording that goes on, remains or is away."""
    if opened.shared is not None or opened.away_from is not None:
        raise LibraryError(
            "The key of a clinic's library cannot change while workstations share it",
            "Move the library back to a folder and change its key there. Then move it to the server again",
        )
    shelter = opened.shelter
    if shelter is None:
        raise LibraryError("The demonstration has no key", "Open your own library")
    opened.refuse_gone()
    if find_segments(shelter.folder):
        raise LibraryError(
            "Recordings made while the library was unavailable are not in the library yet. A new key "
            "could not read them",
            tr(
                "The recordings are in {shelter} and are added to the library while Gaitwright is open. A "
                "file stays there if the library has a different file of the same name. Try again once that "
                "folder is empty"
            ).format(shelter=shelter.folder),
        )
    if any(not one.problem for one in find_interrupted(opened)):
        raise LibraryError(
            "A recording is running or was not completed, so the key cannot be changed now",
            "Stop or review it, then try again",
        )
    if opened.library.clips.in_state(ClipState.OPEN):
        raise LibraryError(
            "A video is being recorded, so the key cannot be changed now", "Stop the recording, then try again"
        )


def _replace(folder: Path, old: DataKey, new: DataKey, keys: dict[str, object], report: Report) -> None:
    path, beside = folder / DATABASE, folder / NEW_DATABASE
    remove_database(beside)
    engine = sqlite_engine(path, old, creates=False)
    try:
        with closing(engine.raw_connection()) as source:
            connection = source.driver_connection
            assert connection is not None  # it is open
            _hold_alone(connection.execute)
            _copy(connection, beside, new, report)
            _wrap_again(folder, beside, old, new, report)
            salt = salt_of(beside)
            if salt is None:
                raise LibraryError("The new database was not found", "Try again, or check the disk")
            replace_file(folder / NEW_KEYS, json.dumps({**keys, "database": salt}, indent=1).encode())
            if os.name == "nt":
                source.close()  # what is open is not replaced there
            beside.replace(path)
            sync_folder(folder)
            (folder / NEW_KEYS).replace(folder / KEYS)
            sync_folder(folder)
    finally:
        engine.dispose()
        remove_database(beside)


def _hold_alone(execute: Callable[[str], object]) -> None:
    """Leave the write-ahead log, which the new database must not find beside it, and let nobody read or write."""
    try:
        execute("PRAGMA locking_mode = EXCLUSIVE")  # locks that are taken are kept until the connection ends
        execute("PRAGMA journal_mode = DELETE")
        execute("BEGIN EXCLUSIVE")
        execute("COMMIT")
    except Exception as error:
        if "locked" not in str(error):
            raise
        raise LibraryBusyError("Another program has the library open", "Close that program, then try again") from None


def _copy(connection: "object", beside: Path, new: KeyMaterial, report: Report) -> None:
    def reported(_status: int, left: int, total: int) -> None:
        report(COPY_SHARE * (1 - left / max(total, 1)), "")

    target = sqlite_engine(beside, new)
    try:
        with closing(target.raw_connection()) as writing:
            connection.backup(writing.driver_connection, pages=PAGES, progress=reported)  # type: ignore[attr-defined]  # a sqlcipher3 connection
    finally:
        target.dispose()


def _wrap_again(folder: Path, beside: Path, old: DataKey, new: DataKey, report: Report) -> None:
    with closing(Database(sqlite_engine(beside, new, creates=False))) as database:
        with database.writing() as session:
            keep_derived_keys(session, derived_keys(session, old), new)
            session.add(SettingRow(name=HEADERS_DUE, value=True))
            rows: list[tuple[Path, JournalRow | ClipRow]] = []
            rows += [(folder / RECORDINGS / row.file, row) for row in session.scalars(select(JournalRow))]
            rows += [(folder / VIDEOS / row.file, row) for row in session.scalars(select(ClipRow))]
            rows = [(path, row) for path, row in rows if row.wrapped_key]
            sizes = [_size(path) for path, _ in rows]
            whole, done = max(sum(sizes), 1), 0
            for (path, row), size in zip(rows, sizes, strict=True):
                share = COPY_SHARE + (1 - COPY_SHARE) * done / whole
                _wrap_journal(path, row, old, new)
                done += size
                report(share, "")
        if database.faults():
            raise LibraryError("The copy of the database is faulty", "Try again, or check the disk")
    with beside.open("rb") as file:
        os.fsync(file.fileno())


def _wrap_journal(path: Path, row: JournalRow | ClipRow, old: DataKey, new: DataKey) -> None:
    """Wrap a journal's key again in its row, with the hash that its file is going to have."""
    try:
        with path.open("rb") as file:
            found = file.read(HEADER_BYTES)
            header = JournalHeader.parsed(found, path.name, row.wrapped_key)
            key = header.key(old, path.name)
            assert key is not None  # its row has one
            required = header.with_key(key, new)
            before, after = hashlib.sha256(found), hashlib.sha256(required.packed())
            while row.sha256 and (piece := file.read(PIECE_BYTES)):
                before.update(piece)
                after.update(piece)
    except (JournalRefusedError, FileNotFoundError):
        return  # it was missing or damaged before, and is reported as such wherever it is read
    if row.sha256 == before.hexdigest():  # else it is not what it was when it was closed, and that stays to be seen
        row.sha256 = after.hexdigest()
    row.wrapped_key = required.wrapped_key


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0

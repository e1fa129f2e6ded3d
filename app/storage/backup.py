"""Second copy of the library, and the check that it opens.

A backup is a folder with the database, the journals and the keys' file as the library has them, encrypted as they are
there, and a list of their hashes. Videos, which are many times as large, are among them where they are asked for; in a
backup without them the database states so of each, and has no key of theirs. It is made while the library is in use.
Only when everything was read back and checked does the folder get its name; whatever happens before leaves nothing.

A clinic's own server is backed up with its own tools; this is for the library in a folder.

What is destroyed in the library stays in the backups that were made before, until they are ninety days old.
"""

import datetime
import hashlib
import json
import os
import re
import shutil
from collections.abc import Callable, Collection, Iterable
from contextlib import closing, nullcontext, suppress
from dataclasses import dataclass, replace
from errno import EIO
from pathlib import Path
from uuid import UUID

import sqlcipher3.dbapi2 as sqlite
from sqlalchemy import select, update

from app.storage.audit import end_of_audit, verify_rows
from app.storage.data_key import KeyMaterial
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.models import ClipRow, JournalRow
from app.storage.derived_keys import derived_keys
from app.storage.files import replace_file, sync_folder
from app.storage.journal.header import JournalRefusedError, read_header
from app.storage.layout import DATABASE, KEYS, RECORDINGS, SUFFIX, VIDEOS
from app.storage.library import Library, now_utc
from app.storage.opened import OpenedLibrary, made_beside
from app.storage.stored import Action, Checkpoint, ClipState, LibraryError
from app.system.progress import Report, nobody
from app.wording.translation import tr

FORMAT = "gaitwright-backup/1"
LIST = "backup.json"
NAME = "gaitwright-backup-"
KEPT = datetime.timedelta(days=90)
UNFINISHED_S = 86_400.0  # no copying takes so long
OUR_FILES = re.compile(rf"{re.escape(KEYS)}|(?:{RECORDINGS}|{VIDEOS})/[0-9a-f-]{{36}}\.\d+{re.escape(SUFFIX)}")
PIECE_BYTES = 1 << 20
SPARE_BYTES = 100_000_000  # left free on the disk of the backups
PAGES = 256  # of the database, copied between two reports


@dataclass(frozen=True, slots=True)
class Backup:
    """A copy that was checked.

    `files`, `bytes`: how much it holds.
    `faults`: what is wrong with it and was wrong with the library already: recordings that are missing or damaged.
    `has_videos`: whether the library's videos are in it.
    """

    folder: Path
    made_at: datetime.datetime
    checkpoint: Checkpoint  # where the library's audit ended
    files: int
    bytes: int
    faults: tuple[str, ...] = ()
    has_videos: bool = False


def back_up(
    opened: OpenedLibrary,
    into: Path,
    report: Report = nobody,
    now: Callable[[], datetime.datetime] = now_utc,
    *,
    with_videos: bool = False,
) -> Backup:
    """Copy the library into a new folder in `into` and check the copy; raises LibraryError."""
    if opened.shared is not None:
        raise LibraryError(
            "This library is on the clinic's server and is backed up there",
            "Back up the database with pg_dump, and copy the recordings",
        )
    made_at = now().astimezone(datetime.UTC)
    folder = into.resolve() / f"{NAME}{made_at:%Y-%m-%dT%H-%M-%SZ}"
    if folder.is_relative_to(opened.folder.resolve()):
        raise LibraryError("A backup cannot be stored inside its own library", "Choose a folder on another disk")
    if not into.is_dir():  # a disk that is not connected is not made up for by a folder of its name
        raise LibraryError("The backup folder was not found", "Connect its disk, or choose another folder")
    opened.library.audit.note(Action.BACKUP, "library")
    with made_beside(folder) as beside:
        # the database first: what it knows of is then there, and what came later is found as left over
        folders = (RECORDINGS, VIDEOS) if with_videos else (RECORDINGS,)
        work = _Work(report, opened.folder / DATABASE, [opened.folder / name for name in _files(opened, folders)])
        work.refuse_too_little_room(into)
        _copy_database(opened.folder, beside, opened.data_key, work)
        names = _files(opened, folders)
        videos = [name for name in names if name.startswith(f"{VIDEOS}/")]
        hashes = _copy_files(opened.folder, beside, names, work, may_go=videos)
        destroyed = [Path(name).name for name in videos if name not in hashes]  # meanwhile
        if destroyed or not with_videos:
            _leave_out_videos(beside, opened.data_key, destroyed if with_videos else None)
        checkpoint = _end_of_audit(beside, opened.data_key)
        size = work.database_bytes + work.bytes
        backup = Backup(folder, made_at, checkpoint, len(hashes) + 1, size, has_videos=with_videos)
        _write_list(beside, backup, hashes)
        faults = _check(beside, opened.data_key, checkpoint, hashes, work)
    counted = {"files": backup.files, "faults": len(faults), "has_videos": with_videos}
    opened.library.audit.note(Action.BACKUP, "library", is_checked=True, **counted)
    return replace(backup, faults=faults)


def find_backups(into: Path) -> tuple[Backup, ...]:
    """The backups in a folder, oldest first, as they say they are; `restore` checks what it takes."""
    found = []
    for folder in into.glob(f"{NAME}*"):
        try:
            found.append(_read_list(folder)[0])
        except LibraryError:
            continue
    return tuple(sorted(found, key=lambda backup: backup.made_at))


def remove_old_backups(into: Path, now: Callable[[], datetime.datetime] = now_utc) -> tuple[Backup, ...]:
    """Remove one backup over 90 days, never the latest (a wrong clock costs one), and old unfinished ones."""
    old = tuple(backup for backup in find_backups(into)[:-1] if now() - backup.made_at > KEPT)[:1]
    for backup in old:
        (backup.folder / LIST).unlink()  # first: half a backup is none
        shutil.rmtree(backup.folder)
    for unfinished in into.glob(f".{NAME}*"):
        if now().timestamp() - unfinished.stat().st_mtime > UNFINISHED_S:
            shutil.rmtree(unfinished)
    return old


def restore(
    backup: Path, folder: Path, data_key: KeyMaterial | None, code: str, report: Report = nobody
) -> tuple[str, ...]:
    """Make a library of a backup in `folder`, empty or missing, and give its faults; raises LibraryError.
    `data_key`: from the backup's key file; what came after the backup, deletions too, is undone.
    """
    reported, hashes = _read_list(backup)
    with made_beside(folder) as beside:
        work = _Work(report, backup / DATABASE, [backup / name for name in hashes])
        work.refuse_too_little_room(folder.resolve().parent)
        _copy(backup / DATABASE, beside / DATABASE, work)
        _copy_files(backup, beside, hashes, work)
        faults = _check(beside, data_key, reported.checkpoint, hashes, work)
        with Library.open(beside, data_key) as library:  # who may not work there restores nothing
            library.log_in(code)
            library.audit.note(Action.BACKUP, "library", is_restored=True)
    return faults


class _Work:
    """How much of the copying and checking is done; everything is written once and read back once."""

    def __init__(self, report: Report, database: Path, files: Iterable[Path]) -> None:
        self._report, self._done = report, 0
        try:
            self.database_bytes = database.stat().st_size
            self.bytes = sum(path.stat().st_size for path in files)
        except OSError as error:
            raise LibraryError(
                tr("{file} is missing").format(file=Path(error.filename).name), "Choose another backup"
            ) from error
        report(0.0, "backup")

    def refuse_too_little_room(self, into: Path) -> None:
        needed = self.database_bytes + self.bytes + SPARE_BYTES
        while not into.exists():
            into = into.parent
        if (free := shutil.disk_usage(into).free) < needed:
            raise LibraryError(
                tr("Not enough disk space: {needed_mb:.0f} MB needed, {free_mb:.0f} MB free").format(
                    needed_mb=needed / 1e6, free_mb=free / 1e6
                ),
                "Free up disk space, or choose another disk",
            )

    def add(self, count: int, what: str) -> None:
        self._done += count
        self._report(min(1.0, self._done / max(2 * (self.database_bytes + self.bytes), 1)), what)


def _copy_database(library: Path, folder: Path, data_key: KeyMaterial | None, work: _Work) -> None:
    """Copy page by page, as of this moment, while others go on writing; raises OSError."""
    source = sqlite_engine(library / DATABASE, data_key, creates=False)
    target = sqlite_engine(folder / DATABASE, data_key)
    try:
        with closing(source.raw_connection()) as reading, closing(target.raw_connection()) as writing:
            connection, copy = reading.driver_connection, writing.driver_connection
            assert connection is not None  # both are open
            assert copy is not None
            connection.execute("BEGIN")
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()  # from here on it stays the same

            def reported(_status: int, left: int, total: int) -> None:
                work.add(work.database_bytes * min(PAGES, total) // max(total, 1), "backup")

            connection.backup(copy, pages=PAGES, progress=reported)
            connection.execute("COMMIT")
    except sqlite.Error as error:
        raise OSError(EIO, str(error)) from None
    finally:
        source.dispose()
        target.dispose()  # the last one to close puts everything into the file itself


def _files(opened: OpenedLibrary, folders: Iterable[str]) -> list[str]:
    """What there is to copy besides the database, as names within the library."""
    return [
        KEYS,
        *(f"{name}/{path.name}" for name in folders for path in sorted((opened.folder / name).glob(f"*{SUFFIX}"))),
    ]


def _leave_out_videos(folder: Path, data_key: KeyMaterial | None, files: Collection[str] | None) -> None:
    """State of videos in the copied database, those of `files` or all, that this backup does not have them."""
    with (
        closing(Database(sqlite_engine(folder / DATABASE, data_key, creates=False))) as database,
        database.writing() as session,
    ):
        left_out = update(ClipRow).where(ClipRow.state != ClipState.DISCARDED)
        if files is not None:
            left_out = left_out.where(ClipRow.id.in_([UUID(file.partition(".")[0]) for file in files]))
        session.execute(left_out.values(state=ClipState.NOT_IN_BACKUP, wrapped_key=None))


def _copy_files(
    source: Path, target: Path, names: Collection[str], work: _Work, may_go: Collection[str] = ()
) -> dict[str, str]:
    """SHA-256 of each file that was copied; those of `may_go` may be destroyed before their turn comes."""
    hashes, folders = {}, {target / RECORDINGS, *((target / name).parent for name in names)} - {target}
    for folder in folders:
        folder.mkdir(mode=0o700)
    for name in names:
        with suppress(FileNotFoundError) if name in may_go else nullcontext():
            hashes[name] = _copy(source / name, target / name, work)
    for folder in folders:
        sync_folder(folder)
    return hashes


def _copy(source: Path, target: Path, work: _Work) -> str:
    """Copy as much as there is now, for a journal may grow; gives the SHA-256 of what was read."""
    digest = hashlib.sha256()
    with source.open("rb") as file, os.fdopen(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as to:
        left = os.fstat(file.fileno()).st_size
        while left and (piece := file.read(min(PIECE_BYTES, left))):
            digest.update(piece)
            to.write(piece)
            left -= len(piece)
            work.add(len(piece), "backup")
        to.flush()
        os.fsync(to.fileno())
        if hasattr(os, "posix_fadvise"):  # what is read back shall come from the disk, not from memory
            os.posix_fadvise(to.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
    return digest.hexdigest()


def _check(
    folder: Path, data_key: KeyMaterial | None, checkpoint: Checkpoint, hashes: dict[str, str], work: _Work
) -> tuple[str, ...]:
    """Open the copy and read all of it; give known faults; raises LibraryError if it differs or is damaged."""
    for name, sha256 in hashes.items():
        if _sha256(folder / name, work) != sha256:
            raise LibraryError(
                tr("The copy of {file} does not match the original").format(file=name),
                "Try again, or choose another disk",
            )
    with closing(Database(sqlite_engine(folder / DATABASE, data_key, creates=False))) as database:
        if database.faults():
            raise LibraryError("The database of this copy is damaged", "Choose an earlier backup, or another disk")
        with database.reading() as session:
            audited = verify_rows(session, derived_keys(session, data_key).audit, checkpoint)
            faults = [f"audit {fault.number} {fault.what}" for fault in audited.faults]
            for row in session.scalars(select(JournalRow).order_by(JournalRow.recording_id, JournalRow.segment)):
                faults += _journal_faults(folder / RECORDINGS, row, data_key, hashes.get(f"{RECORDINGS}/{row.file}"))
            for clip in session.scalars(select(ClipRow).order_by(ClipRow.id)):
                faults += _journal_faults(folder / VIDEOS, clip, data_key, hashes.get(f"{VIDEOS}/{clip.file}"))
    work.add(work.database_bytes, "backup")
    return tuple(faults)


def _journal_faults(
    folder: Path, row: JournalRow | ClipRow, data_key: KeyMaterial | None, sha256: str | None
) -> list[str]:
    """What is wrong with one journal or video; one whose key was destroyed has nothing to be wrong."""
    if row.wrapped_key is None and data_key is not None:
        return []
    if sha256 is None:
        return [f"{row.file} is missing"]
    if row.sha256 and row.sha256 != sha256:
        return [f"{row.file} is not what it was when it was closed"]
    try:
        read_header(folder / row.file, row.wrapped_key).key(data_key, row.file)
    except JournalRefusedError:
        return [f"{row.file} does not open"]
    return []


def _sha256(path: Path, work: _Work) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while piece := file.read(PIECE_BYTES):
            digest.update(piece)
            work.add(len(piece), "checking")
    return digest.hexdigest()


def _end_of_audit(folder: Path, data_key: KeyMaterial | None) -> Checkpoint:
    with (
        closing(Database(sqlite_engine(folder / DATABASE, data_key, creates=False))) as database,
        database.reading() as session,
    ):
        return end_of_audit(session)


def _write_list(folder: Path, backup: Backup, hashes: dict[str, str]) -> None:
    content = {
        "format": FORMAT,
        "made_at": backup.made_at.isoformat(),
        "checkpoint": str(backup.checkpoint),
        "bytes": backup.bytes,
        "files": hashes,
        "has_videos": backup.has_videos,
    }
    replace_file(folder / LIST, json.dumps(content, indent=1).encode())


def _read_list(folder: Path) -> tuple[Backup, dict[str, str]]:
    """Give a backup's own record and its files' hashes, only of names a library has; raises LibraryError."""
    try:
        reported = json.loads((folder / LIST).read_bytes())
        if reported["format"] != FORMAT or KEYS not in reported["files"]:
            raise ValueError(reported["format"])
        hashes = {name: str(sha256) for name, sha256 in reported["files"].items() if OUR_FILES.fullmatch(name)}
        made_at, checkpoint = (
            datetime.datetime.fromisoformat(reported["made_at"]),
            Checkpoint.parsed(reported["checkpoint"]),
        )
        size, has_videos = int(reported["bytes"]), bool(reported.get("has_videos", False))  # earlier ones have none
        return Backup(folder, made_at, checkpoint, len(hashes) + 1, size, has_videos=has_videos), hashes
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        remedy = tr("Choose a folder whose name starts with {name}").format(name=NAME)
        raise LibraryError("This version cannot read this folder as a backup", remedy) from None

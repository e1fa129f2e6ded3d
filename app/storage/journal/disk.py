"""Check that there is room, and that the disk takes what it is given."""

import hashlib
import os
import shutil
from dataclasses import dataclass
from enum import StrEnum
from errno import EEXIST
from pathlib import Path

from app.storage.files import hold, replace_file, replacing
from app.storage.journal.header import JournalRefusedError
from app.wording.translation import later, tr

PIECE_BYTES = 1 << 20
FULL_RATE_BYTES_S = 200_000.0  # six sensors at 200 Hz with orientation and magnetic field, sealed


class Trouble(StrEnum):
    """What went wrong while recording. `REPORTED` has the words; those of `MOVED` name the shelter.

    What is kept in spite of it the journal's status knows.
    """

    LITTLE_ROOM = "little_room"
    NO_ROOM = "no_room"
    DISK_FULL = "disk_full"
    DISK_GONE = "disk_gone"
    MOVED = "moved"
    DISK_SLOW = "disk_slow"
    DROPPED = "dropped"


REPORTED = {
    Trouble.LITTLE_ROOM: (
        later("The disk has space for less than five more minutes"),
        later("Stop the recording soon, then delete or move files you do not need"),
    ),
    Trouble.NO_ROOM: (
        later("The disk is almost full, so the recording was stopped"),
        later("Delete or move files, then try again"),
    ),
    Trouble.DISK_FULL: (
        later("The disk is full, so the recording was stopped"),
        later("Delete or move files, then try again"),
    ),
    Trouble.DISK_GONE: (
        later("The recording can no longer be written, so it was stopped"),
        later("Check the disk, then try again"),
    ),
    Trouble.MOVED: (
        later("The library folder is no longer available; recording continues"),
        later(
            "The recording is stored encrypted on this computer in {shelter}. It is added to the library "
            "automatically once the library is available again. Put the library folder back, or connect "
            "its disk"
        ),
    ),
    Trouble.DISK_SLOW: (
        later("The disk responds slowly"),
        later("Close programs that copy or download to this disk"),
    ),
    Trouble.DROPPED: (
        later("The disk did not respond for too long, so samples were lost"),
        later("Check the disk before recording again"),
    ),
}


@dataclass(frozen=True, slots=True)
class Room:
    """How much of the disk has to be free.

    `start_s`, `start_bytes`: a recording begins only where there is room for so long and so much besides.
    `kept_bytes`: a recording stops, and is closed, before less than this is free: for the database, and for other
    programs.
    """

    start_s: float = 600.0
    start_bytes: int = 500_000_000
    warn_s: float = 300.0  # less than this left is reported
    kept_bytes: int = 100_000_000

    def check(self, folder: Path, bytes_per_s: float) -> None:
        """Raise JournalRefusedError where the folder is gone or lacks room for `start_s` and `start_bytes`."""
        needed = self.start_s * bytes_per_s + self.start_bytes
        try:
            free = shutil.disk_usage(folder).free
        except OSError as error:
            what = tr("the recordings folder cannot be read ({why})").format(why=error.strerror)
            raise JournalRefusedError(str(folder), what, "Check that its disk is connected") from error
        if free < needed:
            what = tr("not enough disk space to record: {needed_mb:.0f} MB needed, {free_mb:.0f} MB free").format(
                needed_mb=needed / 1e6, free_mb=free / 1e6
            )
            raise JournalRefusedError(str(folder), what, "Delete or move files you do not need")


ROOM = Room()


class JournalFile:
    """A journal's file: made whole with its header, then only appended to; `sha256` of all that was.

    `is_held`: as long as it is open, nobody brings it home (`app.storage.bringing_home`).

    Raises
    ------
    FileExistsError
        Another program has begun the same segment.
    """

    def __init__(self, path: Path, header: bytes, *, is_held: bool = False) -> None:
        if path.exists():
            raise FileExistsError(EEXIST, "another program writes this segment", str(path))
        replace_file(path, header)  # so a journal that exists has its header, and a name that lasts
        self._folder = path.parent
        self._descriptor = os.open(path, os.O_RDWR | os.O_APPEND | getattr(os, "O_BINARY", 0))
        self._is_open = True
        if is_held:
            hold(self._descriptor)
        self._sha256 = hashlib.sha256(header)
        self.size = len(header)

    def append(self, data: bytes | bytearray) -> None:
        """Write all of `data` or, as far as the disk still lets us, nothing of it."""
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError:
            os.ftruncate(self._descriptor, self.size)
            raise
        self._sha256.update(data)
        self.size += len(data)

    def sync(self) -> None:
        sync = getattr(os, "fdatasync", os.fsync)  # Windows and macOS have the longer one only
        sync(self._descriptor)

    def free_bytes(self) -> int:
        # by the open file, where the system can: its folder may be called otherwise by now
        return shutil.disk_usage(self._folder if os.name == "nt" else self._descriptor).free

    @property
    def is_deleted(self) -> bool:
        """Whether the file has no name any more: who moves a folder to another disk copies it, then deletes it."""
        return os.fstat(self._descriptor).st_nlink == 0

    def copy_to(self, path: Path) -> None:
        """Write all that the open file holds to `path`, which is then whole, or not there."""
        os.lseek(self._descriptor, 0, os.SEEK_SET)  # it appends all the same
        with replacing(path) as to:
            while piece := os.read(self._descriptor, PIECE_BYTES):
                to.write(piece)

    def sha256(self) -> str:
        return self._sha256.hexdigest()

    def close(self) -> None:
        if self._is_open:
            self._is_open = False  # also where closing fails: the number may soon be another file's
            os.close(self._descriptor)

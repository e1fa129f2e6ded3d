"""Files that are whole or not there at all, whatever happens while they are written."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

BEYOND_ALL_BYTES = 1 << 40


def replace_file(path: Path, content: bytes) -> None:
    """Write beside `path`, sync and rename: a crash leaves the old or the new file; raises OSError."""
    with replacing(path) as file:
        file.write(content)


@contextmanager
def replacing(path: Path, beside: Path | None = None, mode: int = 0o600) -> Iterator[BinaryIO]:
    """As `replace_file`, for what is written piece by piece; whatever is raised meanwhile leaves the old file."""
    is_mine = os.O_TRUNC if beside is None else os.O_EXCL  # a place that others may write holds nothing of that name
    beside = beside or path.with_name(path.name + ".new")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | is_mine, mode), "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except BaseException:
        with suppress(OSError):  # of a disk that fails, the first word counts
            beside.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Make a file's name in `folder` last; Windows does so by itself."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextmanager
def held(path: Path) -> Iterator[None]:
    """Hold the file `path` alone, until the program ends at the latest; raises BlockingIOError or OSError."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        hold(descriptor)
        yield
    finally:
        os.close(descriptor)  # and unlocks it


def hold(descriptor: int) -> None:
    """Hold an open file alone until closed, still readable for others; raises BlockingIOError if it is held."""
    try:
        if sys.platform == "win32":
            place = os.lseek(descriptor, 0, os.SEEK_CUR)
            os.lseek(descriptor, BEYOND_ALL_BYTES, os.SEEK_SET)  # what is locked there nobody can read
            try:
                msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            finally:
                os.lseek(descriptor, place, os.SEEK_SET)
        else:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        raise BlockingIOError(error.errno, "somebody else holds this file") from error

"""Files that are whole or not there at all, whatever happens while they are written."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

BEYOND_ALL_BYTES = 1 << 40


def replace_file(path: Path, content: bytes) -> None:
    """Write `content` beside `path`, sync it and rename it over `path`: a crash leaves the old file or the new one.

    Raises
    ------
    OSError
        The folder cannot be written, or the disk is full; the old file is untouched.
    """
    with replacing(path) as file:
        file.write(content)


@contextmanager
def replacing(path: Path, beside: Path | None = None, mode: int = 0o600) -> Iterator[BinaryIO]:
    """As `replace_file`, for what is written piece by piece; whatever is raised meanwhile leaves the old file."""
    beside = beside or path.with_name(path.name + ".new")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, mode), "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except BaseException:
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
    """Be the one program that holds the file `path`, made if need be.

    The operating system lets go of it when the program ends, however it ends.

    Raises
    ------
    BlockingIOError
        Another program holds it.
    OSError
        It cannot be made.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        hold(descriptor)
        yield
    finally:
        os.close(descriptor)  # and unlocks it


def hold(descriptor: int) -> None:
    """Be the one who holds an open file, until it is closed; others can read it all the same.

    Raises
    ------
    BlockingIOError
        Somebody else holds it, be it in this program.
    """
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

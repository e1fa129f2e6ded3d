"""What was recorded while the library was gone comes home from the shelter, each segment once.

A journal is copied beside its place, synced and renamed, and only then is the shelter's made unreadable and removed.
Killed anywhere in between, the next time goes on: a copy that is not whole has no journal's name, and what is whole in
the library already is not taken again. What is being recorded in the shelter stays there until it is stopped.
"""

import filecmp
import logging
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from uuid import UUID

from app.storage.files import hold, replacing, sync_folder
from app.storage.journal.disk import PIECE_BYTES
from app.storage.journal.header import JournalRefusedError, destroy_key, find_segments, read_header
from app.storage.opened import OpenedLibrary

_one_at_a_time = Lock()
_log = logging.getLogger(__name__)


def bring_home(opened: OpenedLibrary) -> frozenset[UUID]:
    """Bring home all segments that nobody writes; give their recordings. Raises LibraryGoneError or OSError."""
    shelter = opened.shelter
    if shelter is None or not shelter.folder.is_dir():
        return frozenset()
    brought = set()
    with _one_at_a_time:
        opened.refuse_gone()
        for recording_id, segments in sorted(find_segments(shelter.folder).items()):
            for path in segments.values():
                if _bring(path, opened.recordings):
                    brought.add(recording_id)
        if not any(shelter.folder.iterdir()):
            shelter.folder.rmdir()
    return frozenset(brought)


def _bring(path: Path, recordings: Path) -> bool:
    """Bring one segment home, which is then in the library and nowhere else; whether it was not there before."""
    with _held_by_nobody(path) as is_free:
        if not is_free:
            return False
        if _is_done_with(path):
            path.unlink()  # this is all that was left to do
            return False
        target = recordings / path.name
        is_new = not target.exists() or _goes_on(path, target)
        if is_new:
            recordings.mkdir(mode=0o700, exist_ok=True)
            _copy(path, target)
        elif not filecmp.cmp(path, target, shallow=False):
            _log.error("%s is in the library with another content: the one in the shelter stays there", path.name)
            return False
        _destroy(path)
    return is_new


def _copy(source: Path, target: Path) -> None:
    with source.open("rb") as file, replacing(target) as to:
        shutil.copyfileobj(file, to)


def _goes_on(path: Path, target: Path) -> bool:
    """Whether a journal is the longer one of two that begin alike: the library was copied while it was recorded."""
    left = target.stat().st_size
    if path.stat().st_size <= left:
        return False
    with path.open("rb") as file, target.open("rb") as known:
        while left:
            piece = known.read(min(PIECE_BYTES, left))
            if not piece or file.read(len(piece)) != piece:
                return False
            left -= len(piece)
    return True


def _is_done_with(path: Path) -> bool:
    """Whether it is at home already: only what is, is made unreadable."""
    try:
        return read_header(path).is_key_destroyed
    except JournalRefusedError:  # damaged: it comes home as it is, where recovery reports it
        return False


def _destroy(path: Path) -> None:
    """Remove a segment that is at home: what is destroyed there later shall not be on this disk still."""
    try:
        destroy_key(path)
    except JournalRefusedError as refusal:  # its beginning is damaged
        _log.warning("a journal in the shelter is removed as it is: %s", refusal.what)
    path.unlink()
    sync_folder(path.parent)


@contextmanager
def _held_by_nobody(path: Path) -> Iterator[bool]:
    """Whether nobody writes the file; if so, nobody else brings it home meanwhile."""
    descriptor = os.open(path, os.O_RDWR)
    try:
        try:
            hold(descriptor)
        except BlockingIOError:
            yield False
            return
        yield True
    finally:
        os.close(descriptor)

"""Frames that can be known again wherever their bytes are, and a walk that they are of."""

import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from uuid import UUID

from app.storage.journal.disk import Room
from app.storage.journal.writer import JournalWriter
from app.storage.opened import OpenedLibrary
from app.storage.stored import RecordingState, StoredJournal, StoredRecording
from core.session import Recording, RecordingKind
from tests.safety.journal_material import LAYOUT, NAMES, WALKER, block

OPENED_NS = 1_000_000_000_000  # when the walk's journal was opened, on the host's clock
FRAME_NS = 33_333_333
START, END = b"\xff\xd8\xff\xe0\x00\x10JFIF", b"\xff\xd9"  # of a JPEG
NO_ROOM_ASKED = Room(start_s=0.0, start_bytes=0, warn_s=0.0, kept_bytes=0)


@dataclass(frozen=True, slots=True)
class Mode:
    width: int = 1280
    height: int = 720
    rate_hz: float = 30.0


@dataclass(frozen=True, slots=True)
class Frame:
    arrival_ns: int
    pts_ns: int | None
    jpeg: bytes


MODE = Mode()


@cache
def picture(number: int, seed: int = 0, size: int = 4000) -> bytes:
    """What begins and ends as a JPEG, with bytes between that come nowhere else."""
    return START + random.Random(number * 1009 + seed).randbytes(size) + END


def frame(number: int, seed: int = 0, size: int = 4000, delay_ns: int = 50_000_000) -> Frame:
    """Of 30 a second, arriving so late after it was taken, by a camera's clock that began with the walk."""
    taken_ns = number * FRAME_NS
    return Frame(OPENED_NS + taken_ns + delay_ns, taken_ns, picture(number, seed, size))


def walk(opened: OpenedLibrary, session_id: UUID, name: str = "walk 1", count: int = 20) -> StoredRecording:
    """A walk of simulated samples, closed."""
    library = opened.library
    row = library.recordings.start(
        session_id, Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {}), False
    )
    with JournalWriter.create(opened.recordings, row.id, opened.data_key, room=NO_ROOM_ASKED) as journal:
        source = journal.source(replace(WALKER, is_simulated=False), LAYOUT)
        for number in range(count):
            for k, sensor in enumerate(NAMES):
                journal.samples(source, k, block(sensor, number))
    header, summary = journal.header, journal.stop()
    library.recordings.add_journal(row.id, StoredJournal(row.id, header.segment, header.wrapped_key or None))
    return library.recordings.close(row.id, RecordingState.CLOSED, {header.segment: summary.sha256})


def plain_pieces(pictures: Iterable[bytes], folder: Path) -> Iterator[str]:
    """Files in a folder, and below it, that hold a piece of one of these pictures, or a picture's beginning."""
    sought = [one[len(START) + 16 * k :][:16] for one in pictures for k in (0, len(one) // 32)]
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            content = path.read_bytes()
            if START in content or any(piece in content for piece in sought):
                yield str(path.relative_to(folder))

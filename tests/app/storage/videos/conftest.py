"""A library on the disk with a patient who agreed to videos, a walk, and videos of known frames."""

from collections.abc import Callable, Iterator
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.journal.disk import Room
from app.storage.opened import OpenedLibrary
from app.storage.stored import StoredClip
from app.storage.videos.writer import ClipWriter
from core.session import Patient, Session
from tests.quick_library import copy_of, quick_library
from tests.videos import MODE, OPENED_NS, frame, walk

ANY_ROOM = Room(start_s=0.0, start_bytes=0, warn_s=0.0, kept_bytes=0)
MakeVideo = Callable[..., StoredClip]


@pytest.fixture(scope="session")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> OpenedLibrary:
    """Made once, closed: a patient who agreed, with a visit."""
    opened = quick_library(tmp_path_factory.mktemp("videos") / "library")
    patient = opened.library.patients.create(Patient(code="P-001"))
    opened.library.sessions.create(patient.id, Session((), started="2026-11-20T09:00:00"))
    opened.library.clips.give_consent(patient.id)
    opened.library.close()
    return opened


@pytest.fixture
def opened(untouched: OpenedLibrary, tmp_path: Path) -> Iterator[OpenedLibrary]:
    """The same library, in a folder of the test's own."""
    with copy_of(untouched, tmp_path / "library") as opened:
        yield opened


@pytest.fixture
def session_id(opened: OpenedLibrary) -> UUID:
    (line,) = opened.library.sessions.list()
    return line.id


@pytest.fixture
def patient_id(opened: OpenedLibrary) -> UUID:
    (patient,) = opened.library.patients.search()
    return patient.id


@pytest.fixture
def recording_id(opened: OpenedLibrary, session_id: UUID) -> UUID:
    return walk(opened, session_id).id


@pytest.fixture
def make_video(opened: OpenedLibrary) -> MakeVideo:
    """Make a whole video of a walk: so many frames, at 30 a second."""

    def make(recording_id: UUID, frames: int = 10, camera: int = 1, seed: int = 0) -> StoredClip:
        writer = ClipWriter.create(opened, recording_id, OPENED_NS, camera, "from the left", MODE, room=ANY_ROOM)
        for number in range(frames):
            assert writer.add(frame(number, seed), waits=True)
        stored = writer.stop()
        assert stored is not None
        return stored

    return make

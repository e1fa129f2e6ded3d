"""A library on the disk with somebody logged in, and recordings in it."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import numpy as np
import pytest

from app.storage.database.ids import uuid7
from app.storage.journal.disk import Room
from app.storage.journal.payloads import Belonging, layout_of
from app.storage.journal.writer import JournalWriter
from app.storage.opened import OpenedLibrary
from app.storage.stored import PlacedSensor, RecordingState, StoredJournal, StoredRecording
from core.body import Site
from core.samples import ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.source import SourceInfo
from tests.quick_library import copy_of, quick_library

PASSPHRASE = "four short words here"
SENSOR = "LT-1"
ANY_ROOM = Room(start_bytes=0, kept_bytes=0)

Record = Callable[..., StoredRecording]


@pytest.fixture(scope="session")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> OpenedLibrary:
    """A new library whose one operator is `hk`, closed: made once, because that takes longer than most tests."""
    opened = quick_library(tmp_path_factory.mktemp("untouched"))
    opened.library.close()
    return opened


@pytest.fixture
def opened(untouched: OpenedLibrary, tmp_path: Path) -> Iterator[OpenedLibrary]:
    """A new library, with `hk` logged in."""
    with copy_of(untouched, tmp_path / "library") as opened:
        yield opened


@pytest.fixture
def session_id(opened: OpenedLibrary) -> UUID:
    patient = opened.library.patients.create(Patient(code="P-001"))
    visit = opened.library.sessions.create(patient.id, Session((), started="2026-11-20T09:00:00"))
    opened.library.sessions.place(visit.id, {Site.LEFT_THIGH: PlacedSensor(SENSOR, SensorInfo())})
    return visit.id


def samples(count: int, seed: int = 0) -> ImuBlock:
    rng = np.random.default_rng(seed)
    time_s = np.arange(count) / 100
    gyr, noise = rng.normal(size=(count, 3)), rng.normal(size=(count, 3))
    return ImuBlock(SENSOR, time_s, gyr, np.array([0.0, 0.0, 9.81]) + noise)


@pytest.fixture
def record(opened: OpenedLibrary, session_id: UUID) -> Record:
    """Make a recording of 100 Hz: stopped as it should be, or as a kill leaves it.

    `has_row` False: the database did not answer. `is_reported` False: killed before the row knew of the journal.
    `states_session`: the journal itself reports that it is of this one.
    """

    def record(
        name: str,
        count: int = 500,
        *,
        is_stopped: bool = True,
        has_row: bool = True,
        is_reported: bool = True,
        states_session: UUID | None = None,
        is_simulated: bool = False,
    ) -> StoredRecording:
        library, recording_id = opened.library, uuid7()
        reported = Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {})
        if has_row:
            library.recordings.start(session_id, reported, False, recording_id)
        writer = JournalWriter.create(opened.recordings, recording_id, opened.data_key, room=ANY_ROOM)
        header = writer.header
        journal = StoredJournal(header.recording_id, header.segment, header.wrapped_key)
        if has_row and is_reported:
            library.recordings.add_journal(recording_id, journal)
        if states_session is not None:
            writer.mark(Belonging(states_session, replace(reported, condition="barefoot")).text())
        block = samples(count)
        source = writer.source(
            SourceInfo("walker", "1", sensors=(SENSOR,), is_simulated=is_simulated), layout_of(block)
        )
        writer.samples(source, 0, block, waits=True)
        summary = writer.stop()
        if is_stopped:
            return library.recordings.close(recording_id, RecordingState.CLOSED, {header.segment: summary.sha256})
        footer = 40  # and more: what a kill leaves has none, and most often half a record
        with summary.path.open("r+b") as file:
            file.truncate(summary.bytes - footer)
        found = library.recordings.find(recording_id)
        return found or StoredRecording(
            recording_id, 0, session_id, reported, RecordingState.OPEN, False, None, (journal,)
        )

    return record

"""What is recorded live gets into the library, whatever the database does, and is analysed as it was recorded."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import partial
from pathlib import Path
from uuid import UUID

import numpy as np
import pytest

from app.acquisition.acquisition import Acquisition
from app.acquisition.recorder import Recorder
from app.storage.exchange import session_with_samples
from app.storage.journal.disk import JournalFile, Room, Trouble
from app.storage.journal.header import JournalRefusedError
from app.storage.layout import DATABASE
from app.storage.opened import OpenedLibrary
from app.storage.recovery import find_interrupted
from app.storage.stored import LibraryBusyError, LibraryError, PlacedSensor, RecordingState
from core.analysis import analyse
from core.body import Joint, Site
from core.results import Analysis
from core.samples import ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.simulation.replay import ReplayFaults, ReplaySource
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Walk, WalkerSettings
from tests.quick_library import copy_of, quick_library
from tests.safety.live_material import Clock, numbered_session
from tests.simulated import simulation_of
from tests.waiting import wait_for

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

ANY_ROOM = Room(start_s=0.0, start_bytes=0, warn_s=0.0, kept_bytes=0)
LEFT_THIGH, LEFT_SHANK, LEFT_FOOT = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> OpenedLibrary:
    """A new library whose one operator is `hk`, closed."""
    opened = quick_library(tmp_path_factory.mktemp("untouched"))
    opened.library.close()
    return opened


@pytest.fixture
def opened(untouched: OpenedLibrary, tmp_path: Path) -> Iterator[OpenedLibrary]:
    with copy_of(untouched, tmp_path / "library") as opened:
        yield opened


def visit_of(opened: OpenedLibrary, session: Session, code: str = "DEMO-1") -> UUID:
    """A session of the library in which the sensors of `session` are worn where they were."""
    patient = opened.library.patients.create(Patient(code=code))
    visit = opened.library.sessions.create(patient.id, Session(()))
    imu = session.recordings[0].imu
    worn = {site: PlacedSensor(imu[site].sensor, session.sensors.get(site, SensorInfo())) for site in imu}
    opened.library.sessions.place(visit.id, worn)
    return visit.id


def walk(name: str = "walk 1") -> Recording:
    return Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {})


@pytest.fixture
def acquisition() -> Iterator[Acquisition]:
    acquisition = Acquisition([ReplaySource(numbered_session("a", 2))])
    acquisition.start()
    yield acquisition
    acquisition.close()


@pytest.fixture
def session_id(opened: OpenedLibrary) -> UUID:
    return visit_of(opened, numbered_session("a", 2))


Begin = Callable[..., Recorder]


@pytest.fixture
def begin(opened: OpenedLibrary, session_id: UUID, acquisition: Acquisition) -> Begin:
    """Begin a recording in this session."""
    return partial(Recorder.begin, opened, acquisition, session_id, room=ANY_ROOM)


def differences(one: object, other: object, where: str = "") -> list[str]:
    """Where two results are not the same, to the last bit."""
    if type(one) is not type(other):
        return [f"{where}: {type(one)} and {type(other)}"]
    if is_dataclass(one):
        pairs = [(field.name, getattr(one, field.name), getattr(other, field.name)) for field in fields(one)]
        return [found for name, a, b in pairs for found in differences(a, b, f"{where}.{name}")]
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        if list(one) != list(other):
            return [f"{where}: {list(one)} and {list(other)}"]
        return [found for key in one for found in differences(one[key], other[key], f"{where}[{key}]")]
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return [] if one.shape == other.shape and one.tobytes() == other.tobytes() else [f"{where}: other values"]
    if isinstance(one, Sequence) and isinstance(other, Sequence) and not isinstance(one, str):
        if len(one) != len(other):
            return [f"{where}: {len(one)} and {len(other)}"]
        return [
            found
            for k, (a, b) in enumerate(zip(one, other, strict=True))
            for found in differences(a, b, f"{where}[{k}]")
        ]
    is_same = one == other or (one != one and other != other)
    return [] if is_same else [f"{where}: {one} and {other}"]


def test_a_visit_recorded_live_gives_the_same_results_whenever_it_is_read(opened: OpenedLibrary) -> None:
    """With losses, a sensor that was silent for a while, and one whose stamps are late."""
    clock = Clock()
    required = (Standing(), FreeMotion(duration_s=9.0), Walk(strides=6))
    simulated = simulation_of(WalkerSettings(seed=2, sites=(LEFT_THIGH, LEFT_SHANK, LEFT_FOOT), recordings=required))
    session = simulated.session
    late, silent = (block.sensor for block in list(session.recordings[0].imu.values())[1:3])
    faults = ReplayFaults(loss_share=0.01, lag_s={late: 0.02}, silent_s={silent: (6.0, 6.5)}, seed=4)
    acquisition = Acquisition([ReplaySource(session, faults=faults, now_ns=clock, sleep=clock.sleep)], now_ns=clock)
    visit_id = visit_of(opened, session)
    acquisition.start()
    live: list[Recording] = []
    for played in session.recordings:
        reported = Recording(played.name, played.kind, played.folder, {})
        length_s = max(block.time_s[-1] for block in played.imu.values())
        recorder = Recorder.begin(opened, acquisition, visit_id, reported, room=ANY_ROOM)
        recorder.mark("go")
        acquisition.ask(played.kind)
        until_s = acquisition.now_s + length_s
        wait_for(lambda until_s=until_s: acquisition.now_s > until_s)  # type: ignore[misc]  # the default binds the loop's value
        stored, recording = recorder.stop(opened)
        assert stored.state is RecordingState.CLOSED
        assert [journal.sha256 for journal in stored.journals] == [recorder.summary.sha256 if recorder.summary else ""]
        live.append(recording)
    acquisition.close()
    for played, recording in zip(session.recordings, live, strict=True):
        assert list(recording.imu) == list(played.imu)
        assert all(is_part_of(recording.imu[site], played.imu[site]) for site in played.imu)

    visit = opened.library.sessions.get(visit_id)
    first = analyse(Session(tuple(live), visit.details.patient, visit.details.sensors, is_simulated=True))
    opened.library.close()
    with copy_of(opened, opened.folder.with_name("later")) as later:
        stored_visit = later.library.sessions.get(visit_id)
        again = session_with_samples(later, stored_visit, {}, lambda _share, _what: None)
    assert again.is_simulated
    assert again.findings == ()
    assert differences(tuple(live), again.recordings) == []
    assert differences(first, analyse(again)) == []
    assert rms_error_deg(simulated, live[-1], first, Joint.LEFT_KNEE) < 1.0


def rms_error_deg(simulated: SimulatedSession, recorded: Recording, found: Analysis, joint: Joint) -> float:
    """Of the walk's angle against the truth, both since standing; the walk began somewhere in what was recorded."""
    played = simulated.session.recordings[-1].imu[joint.proximal]
    block = recorded.imu[joint.proximal]
    begun_s = next(
        float(block.time_s[k[0]] - time_s)
        for row, time_s in zip(played.gyr_rad_s, played.time_s, strict=True)
        if len(k := np.flatnonzero((block.gyr_rad_s == row).all(axis=1)))
    )
    truth = simulated.truth.recordings[recorded.name].joints[joint]
    walk = found.recordings[-1]
    since_s = walk.time_s - begun_s
    expected_rad = np.interp(since_s, truth.time_s, truth.angle_rad - truth.standing_rad)
    is_known = (since_s >= 0) & (since_s <= truth.time_s[-1])
    error_rad = (walk.joints[joint].angle_rad - expected_rad)[is_known]
    assert np.mean(np.isfinite(error_rad)) > 0.8
    return float(np.rad2deg(np.sqrt(np.nanmean(error_rad**2))))


def is_part_of(block: ImuBlock, played: ImuBlock) -> bool:
    """Whether most of what was played is there, each sample as it was."""
    rows = {row.tobytes(): number for number, row in enumerate(np.hstack([played.gyr_rad_s, played.acc_m_s2]))}
    found = [rows.get(row.tobytes(), -1) for row in np.hstack([block.gyr_rad_s, block.acc_m_s2])]
    numbers = [number for number in found if number >= 0]
    return len(set(numbers)) > 0.9 * len(played)


def test_sources_that_are_closed_first_end_the_recording_too(
    opened: OpenedLibrary, acquisition: Acquisition, begin: Begin
) -> None:
    recorder = begin(walk())
    time.sleep(0.2)
    acquisition.close()
    stored, recording = recorder.stop(opened)
    assert stored.state is RecordingState.CLOSED
    assert len(recording.imu) == 2


def test_a_name_that_is_taken_is_refused_and_nothing_is_recorded(opened: OpenedLibrary, begin: Begin) -> None:
    recorder = begin(walk())
    recorder.stop(opened)
    files = list(opened.recordings.iterdir())
    with pytest.raises(LibraryError, match="already has a recording of this name"):
        begin(walk())
    assert list(opened.recordings.iterdir()) == files
    begin(walk("walk 2")).stop(opened)


def test_simulated_sensors_are_not_recorded_for_a_real_patient(opened: OpenedLibrary, acquisition: Acquisition) -> None:
    visit_id = visit_of(opened, numbered_session("a", 2), code="P-001")
    with pytest.raises(LibraryError, match="starts with DEMO"):
        Recorder.begin(opened, acquisition, visit_id, walk(), room=ANY_ROOM)


def test_without_room_nothing_begins_and_the_name_stays_free(
    opened: OpenedLibrary, session_id: UUID, begin: Begin
) -> None:
    with pytest.raises(JournalRefusedError, match="not enough disk space"):
        begin(walk(), room=Room(start_bytes=10**15))
    wait_for(lambda: opened.library.sessions.get(session_id).recordings == ())
    stored, _ = begin(walk()).stop(opened)
    assert stored.details.name == "walk 1"


class Busy:
    """A database that answers nobody who writes, until it is given to."""

    def __init__(self, opened: OpenedLibrary, monkeypatch: pytest.MonkeyPatch) -> None:
        self.refuses = False
        self.is_held = True
        recordings = opened.library.recordings
        for name in ("start", "add_journal", "close"):
            monkeypatch.setattr(recordings, name, self._held(getattr(recordings, name)))

    def _held(self, call: Callable[..., object]) -> Callable[..., object]:
        def held(*arguments: object, **named: object) -> object:
            while self.is_held and not self.refuses:
                time.sleep(0.005)
            if self.is_held:
                raise LibraryBusyError("Another program is using the library", "Wait a moment")
            return call(*arguments, **named)

        return held


@pytest.fixture
def busy(opened: OpenedLibrary, session_id: UUID, monkeypatch: pytest.MonkeyPatch) -> Busy:
    assert session_id
    monkeypatch.setattr("app.acquisition.recorder.ROW_WAIT_S", 0.1)
    return Busy(opened, monkeypatch)


def test_a_busy_database_holds_up_no_recording_and_the_row_follows(
    opened: OpenedLibrary, session_id: UUID, begin: Begin, busy: Busy
) -> None:
    begin_s = time.monotonic()
    recorder = begin(walk())
    assert time.monotonic() - begin_s < 5.0
    assert opened.library.sessions.get(session_id).recordings == ()
    time.sleep(0.2)
    busy.is_held = False
    stored, recording = recorder.stop(opened)
    assert stored.state is RecordingState.CLOSED
    assert stored.id == recorder.id
    assert len(stored.journals) == 1
    assert all(len(block) > 20 for block in recording.imu.values())
    assert len(recording.imu) == 2


def test_a_row_that_could_not_be_entered_is_entered_on_stop(opened: OpenedLibrary, begin: Begin, busy: Busy) -> None:
    busy.refuses = True
    recorder = begin(walk())
    time.sleep(0.2)
    busy.is_held = False
    stored, recording = recorder.stop(opened)
    assert stored.state is RecordingState.CLOSED
    assert recorder.summary is not None
    assert [journal.sha256 for journal in stored.journals] == [recorder.summary.sha256]
    assert len(recording.imu) == 2


def test_a_database_that_stays_busy_leaves_a_journal_that_is_found(
    opened: OpenedLibrary, begin: Begin, busy: Busy
) -> None:
    busy.refuses = True
    recorder = begin(walk())
    time.sleep(0.1)
    with pytest.raises(LibraryBusyError):
        recorder.stop(opened)
    (orphan,) = find_interrupted(opened)
    assert (orphan.recording_id, orphan.is_orphan) == (recorder.id, True)
    busy.is_held = False
    stored, _ = recorder.stop(opened)  # tried again
    assert stored.state is RecordingState.CLOSED
    assert find_interrupted(opened) == ()


def test_a_disk_that_fails_is_reported_and_what_was_written_is_kept(
    opened: OpenedLibrary, begin: Begin, monkeypatch: pytest.MonkeyPatch
) -> None:
    stated: list[Trouble] = []
    recorder = begin(walk(), stated.append)
    time.sleep(0.3)

    def fail(file: JournalFile, data: bytes) -> None:
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(JournalFile, "append", fail)
    wait_for(lambda: stated == [Trouble.DISK_GONE])
    stored, recording = recorder.stop(opened)
    assert stored.state is RecordingState.RECOVERED
    assert all(len(block) > 20 for block in recording.imu.values())
    assert len(recording.imu) == 2
    assert (opened.folder / DATABASE).exists()

"""T4, T7 and T8 of the reliability targets where samples are recorded live: small here, as endurance at CI's size.

The full size is what the scripts of `tests/safety` run. T9 is in `test_acquisition.py`, with the injected clock.
"""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest

from app.acquisition.acquisition import Acquisition
from app.acquisition.recorder import ROW_WAIT_S, Recorder
from app.review.viewer import Viewer
from app.storage.data_key import DataKey
from app.storage.journal.disk import JournalFile, Room
from app.storage.journal.writer import JournalSummary
from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.stored import Operator, PlacedSensor, RecordingState, Role
from core.results import Analysis, Method
from core.samples import ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.simulation.replay import ReplaySource
from tests.safety.journal_material import ID, KEY
from tests.safety.live_material import faults_of, numbered_session, open_journal, read_back
from tests.safety.long_recording import record_long
from tests.safety.source_vanishes import vanish_often
from tests.safety.vanishing import BACK

SENSORS = 6
BUSY = "while True: pass"
HOLD = """
import sys
import sqlcipher3.dbapi2 as sqlite
connection = sqlite.connect(sys.argv[1], isolation_level=None)
connection.execute("PRAGMA key = \\"x'" + bytes(range(32)).hex() + "'\\"")
connection.execute("BEGIN IMMEDIATE")
print("locked", flush=True)
sys.stdin.readline()
"""
VIEWER = """#!/bin/sh
test "$1" = analytics || exec sleep 60
"""

needs_proc = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="what a process holds is read from /proc")


@pytest.fixture
def acquisition() -> Iterator[Acquisition]:
    acquisition = Acquisition([ReplaySource(numbered_session(f"s{k}", 1), name=f"s{k}") for k in range(SENSORS)])
    acquisition.start()
    yield acquisition
    acquisition.close()


def check(acquisition: Acquisition, summary: JournalSummary, least_s: float) -> None:
    """Six sensors, no sample missing, and all that was measured in so many seconds."""
    decoded = read_back([summary.path])
    assert faults_of(decoded.sensors, dict.fromkeys(acquisition.sensors, 0)) == []
    assert (summary.dropped_records, decoded.dropped_records) == (0, 0)
    assert all(one.block.time_s[-1] - one.block.time_s[0] > least_s for one in decoded.sensors.values())
    assert all(one.counts.lost == 0 for one in acquisition.status().values())


# T4: a source vanishes and returns


@pytest.mark.endurance
def test_twenty_sources_that_vanish_come_back_within_three_seconds(tmp_path: Path) -> None:
    vanished = vanish_often(tmp_path, 20, seed=2)
    assert vanished.faults == []
    assert len(vanished.figures[BACK]) == 20


# T7: hours


@needs_proc
@pytest.mark.endurance
def test_ninety_seconds_lose_nothing_and_nothing_grows(tmp_path: Path) -> None:
    run = record_long(tmp_path, 1.5 / 60, show_message=lambda _: None)
    assert run.faults == []
    assert run.dropped_from_preview == 0


# T8: whoever else is held up


def block_screen(acquisition: Acquisition, seconds: float) -> None:
    """Be a screen's thread that draws, then hangs: half of the time asleep, half computing."""
    for name in acquisition.sensors:
        acquisition.latest(name, 10.0)
    time.sleep(seconds / 2)
    until_s, number = time.monotonic() + seconds / 2, 0
    while time.monotonic() < until_s:
        number += 1
    acquisition.status()


def fill_processor(acquisition: Acquisition, seconds: float) -> None:
    command = [sys.executable, "-c", BUSY]
    busy = [subprocess.Popen(command) for _ in range(2 * (os.cpu_count() or 2))]
    try:
        time.sleep(seconds)
    finally:
        for process in busy:
            process.kill()
            process.wait()


Hinder = Callable[[Acquisition, float], None]


@pytest.mark.endurance
@pytest.mark.parametrize("hinder", [block_screen, fill_processor])
def test_a_blocked_screen_and_a_full_processor_lose_nothing(
    acquisition: Acquisition, tmp_path: Path, hinder: Hinder
) -> None:
    seconds = 10.0
    acquisition.record(open_journal(tmp_path, ID))
    hinder(acquisition, seconds)
    check(acquisition, acquisition.stop_recording(), 0.9 * seconds)


class Newest:
    """A live estimator that only notes how far it has come."""

    newest_s = 0.0

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        self.newest_s = max(float(block.time_s[-1]) for block in blocks.values())


@pytest.mark.endurance
def test_a_disk_that_stalls_loses_nothing_and_holds_up_no_view(
    acquisition: Acquisition, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seconds = 4.0
    answers, append = threading.Event(), JournalFile.append
    answers.set()

    def slow_append(file: JournalFile, data: bytes | bytearray) -> None:
        assert answers.wait(60.0)
        append(file, data)

    monkeypatch.setattr(JournalFile, "append", slow_append)
    shown = Newest()
    acquisition.set_estimator(shown)
    acquisition.record(open_journal(tmp_path, ID))
    time.sleep(0.1)
    answers.clear()
    time.sleep(seconds)
    assert all(one.silent_s < 1.0 for one in acquisition.status().values())
    assert acquisition.now_s - shown.newest_s < 1.0
    answers.set()
    check(acquisition, acquisition.stop_recording(), seconds)


@pytest.mark.endurance
@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for the viewer is a script")
def test_a_viewer_that_is_killed_loses_nothing(
    acquisition: Acquisition, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is stated about it either: whose window is gone knows that."""
    seconds = 5.0
    monkeypatch.setenv("DISPLAY", ":0")
    program = tmp_path / "rerun"
    program.write_text(VIEWER)
    program.chmod(0o700)
    viewer = Viewer(tmp_path / "review", program)
    acquisition.record(open_journal(tmp_path, ID))
    viewer.open(Session(()), Analysis(Method.ROBUST, False, (), ()))
    (shown,) = viewer._shown.values()
    time.sleep(seconds)
    assert shown.poll() is None
    shown.kill()
    time.sleep(seconds)
    assert viewer.failures() == []
    assert list((tmp_path / "review").rglob("*.rrd")) == []
    check(acquisition, acquisition.stop_recording(), 1.8 * seconds)
    viewer.close()


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[OpenedLibrary]:
    folder = tmp_path / "library"
    library = Library.create(folder, KEY, Operator("hk", "H. Keller", Role.ADMINISTRATOR))
    with OpenedLibrary(library, folder, DataKey(KEY)) as opened:
        yield opened


@contextmanager
def locked(file: Path, seconds: float) -> Iterator[None]:
    """Another process holds the database for so long."""
    with subprocess.Popen([sys.executable, "-c", HOLD, file], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdin is not None
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"locked\n"
        letting_go = threading.Timer(seconds, holder.stdin.close)
        letting_go.start()
        yield
        letting_go.join()


@pytest.mark.endurance
def test_a_database_that_is_locked_loses_nothing(acquisition: Acquisition, opened: OpenedLibrary) -> None:
    seconds = 10.0
    patient = opened.library.patients.create(Patient(code="DEMO-1"))
    visit = opened.library.sessions.create(patient.id, Session(()))
    sites = numbered_session("s", SENSORS).sensors
    worn = dict(zip(sites, (PlacedSensor(name, SensorInfo()) for name in acquisition.sensors), strict=True))
    opened.library.sessions.place(visit.id, worn)
    reported = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
    room = Room(start_s=0.0, start_bytes=0, warn_s=0.0, kept_bytes=0)
    with locked(opened.folder / DATABASE, seconds):
        begin_s = time.monotonic()
        recorder = Recorder.begin(opened, acquisition, visit.id, reported, room=room)
        assert time.monotonic() - begin_s < ROW_WAIT_S + 1.0
        time.sleep(seconds - ROW_WAIT_S)
    stored, recording = recorder.stop(opened)
    assert stored.state is RecordingState.CLOSED
    assert len(recording.imu) == SENSORS
    assert recorder.summary is not None
    check(acquisition, recorder.summary, 0.8 * (seconds - ROW_WAIT_S))

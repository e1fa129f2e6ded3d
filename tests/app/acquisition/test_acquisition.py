"""Every source is read by itself, journal first; whatever fails, the others and the recording go on."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.acquisition.acquisition import Acquisition
from app.acquisition.reader import REOPEN_S
from app.storage.journal.decoding import decode
from core.samples import ImuBlock
from core.session import RecordingKind
from devices.live import Keep, SensorDetails, SourceLostError, SourceRefusedError
from devices.simulation.replay import ReplayFaults, ReplaySource
from devices.source import SourceInfo
from tests.safety.journal_material import ID, KEY, LINES, LineDecoder, line
from tests.safety.live_material import (
    RATE_HZ,
    Clock,
    faults_of,
    gaps_of,
    numbered_session,
    open_journal,
    read_back,
)
from tests.waiting import wait_for

PATIENCE_S = 20.0

Start = Callable[..., Acquisition]


def played(name: str = "a", sensors: int = 2, **settings: object) -> ReplaySource:
    return ReplaySource(numbered_session(name, sensors), name=name, **settings)  # type: ignore[arg-type]  # each test names its own


@pytest.fixture
def start() -> Iterator[Start]:
    started: list[Acquisition] = []

    def start(*sources: object, **settings: object) -> Acquisition:
        acquisition = Acquisition(sources, **settings)  # type: ignore[arg-type]  # each test names its own
        started.append(acquisition)
        acquisition.start()
        return acquisition

    before = set(threading.enumerate())
    yield start
    for acquisition in started:
        acquisition.close()
    assert set(threading.enumerate()) <= before


class Counting:
    """Notes what it is given, and fails where it is given to."""

    def __init__(self) -> None:
        self.times_s: dict[str, list[float]] = {}
        self.calls = 0
        self.fails = False
        self.pause_s = 0.0
        self.threads: set[int] = set()

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        self.calls += 1
        self.threads.add(threading.get_ident())
        for name, block in blocks.items():
            assert name == block.sensor
            assert len(block)
            self.times_s.setdefault(name, []).extend(block.time_s.tolist())
        time.sleep(self.pause_s)
        if self.fails:
            raise ValueError("an odd block")


def test_sensors_are_received_shown_and_reported(start: Start) -> None:
    acquisition = start(played("a", 2), played("b", 1))
    assert acquisition.sensors == ("a-left_thigh", "a-left_shank", "b-left_thigh")
    assert acquisition.is_simulated
    wait_for(lambda: acquisition.now_s > 0.5)
    status = acquisition.status()
    assert [status[name].source for name in acquisition.sensors] == [0, 0, 1]
    for name, one in status.items():
        assert one.sensor == name
        assert one.details.serial == name
        assert one.silent_s < PATIENCE_S
        assert one.counts.received > 20
        assert one.lost_share == 0.0
    wait_for(lambda: len(acquisition.latest("a-left_shank", 0.4)) > 10)
    asked_s = acquisition.now_s
    block = acquisition.latest("a-left_shank", 0.4)
    assert asked_s - 0.4 <= block.time_s[0] < block.time_s[-1] <= acquisition.now_s
    assert np.allclose(np.diff(block.time_s), 1 / RATE_HZ)
    assert len(acquisition.latest("nobody", 1.0)) == 0
    assert acquisition.identify("a-left_thigh")
    assert not acquisition.identify("nobody")


@pytest.mark.endurance
def test_a_recording_begins_with_the_press_and_ends_with_the_stop(start: Start, tmp_path: Path) -> None:
    acquisition = start(played("a", 2), played("b", 1))
    wait_for(lambda: acquisition.now_s > 0.3)
    pressed_s = time.monotonic()
    writer = open_journal(tmp_path, ID)
    time.sleep(0.2)  # the journal is there; what is measured meanwhile belongs to the recording
    acquisition.record(writer)
    with pytest.raises(RuntimeError):
        acquisition.record(writer)
    time.sleep(0.3)
    stopped_s = time.monotonic()
    summary = acquisition.stop_recording()
    length_s, most_s = stopped_s - pressed_s, time.monotonic() - pressed_s
    decoded = read_back([summary.path])
    assert decoded.is_simulated
    assert set(decoded.sensors) == set(acquisition.sensors)
    assert faults_of(decoded.sensors, dict.fromkeys(acquisition.sensors, 0)) == []
    for one in decoded.sensors.values():
        assert 0 <= one.block.time_s[0] < 0.006 + 0.01  # one sample, and what lies between press and opening
        assert length_s - 0.02 < one.block.time_s[-1] < most_s + 0.02
    assert [source.sensors for source in decoded.sources] == [(name,) for name in acquisition.sensors]
    with pytest.raises(RuntimeError):
        acquisition.stop_recording()


def test_one_recording_follows_another(start: Start, tmp_path: Path) -> None:
    acquisition = start(played("a", 1))
    ends = []
    for _ in range(2):
        acquisition.record(open_journal(tmp_path, ID))
        time.sleep(0.1)
        decoded = read_back([acquisition.stop_recording().path])
        assert faults_of(decoded.sensors, {"a-left_thigh": 0}) == []
        ends.append(decoded.sensors["a-left_thigh"].block.gyr_rad_s[[0, -1], 0])
    assert ends[1][0] > ends[0][1]


def test_closing_ends_the_recording_too(start: Start, tmp_path: Path) -> None:
    acquisition = start(played("a", 1))
    writer = open_journal(tmp_path, ID)
    acquisition.record(writer)
    time.sleep(0.1)
    acquisition.close()
    assert read_back([writer.path]).reports[0].is_whole


def test_a_source_that_vanishes_costs_the_others_nothing_and_comes_back(start: Start, tmp_path: Path) -> None:
    source = played("a", 2)
    acquisition = start(source, played("b", 2))
    acquisition.record(open_journal(tmp_path, ID))
    time.sleep(0.2)
    source.vanish()
    wait_for(lambda: acquisition.status()["a-left_thigh"].silent_s > 0.3)
    silent_s = acquisition.silent_s()
    assert silent_s["a-left_thigh"] > max(0.3, silent_s["b-left_thigh"])
    assert acquisition.status()["b-left_thigh"].silent_s < 0.3
    back_s = time.monotonic()
    source.come_back()
    wait_for(lambda: acquisition.status()["a-left_thigh"].silent_s < 0.1)
    assert time.monotonic() - back_s < REOPEN_S + 1.0
    time.sleep(0.2)
    live = acquisition.status()
    decoded = read_back([acquisition.stop_recording().path])
    required = {name: int(name.startswith("a")) for name in acquisition.sensors}
    assert faults_of(decoded.sensors, required) == []
    (gap,) = gaps_of(decoded.sensors["a-left_shank"])
    assert live["a-left_shank"].counts.lost == gap


class Scripted:
    """A source that gives what it is given to."""

    has_bytes = False
    sent: Sequence[bytes] = ()

    def __init__(self, info: SourceInfo, blocks: Sequence[Sequence[ImuBlock] | Exception]) -> None:
        self.info = info
        self.blocks = list(blocks)
        self.rate_hz: float | None = 100.0
        self.openings = self.closings = 0
        self.refusal: Exception | None = None
        self.asked: list[RecordingKind | None] = []

    def open(self) -> None:
        self.openings += 1
        if self.refusal:
            raise self.refusal

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        time.sleep(0.002)
        reported = self.blocks.pop(0) if self.blocks else []
        if isinstance(reported, Exception):
            raise reported
        return reported

    def close(self) -> None:
        self.closings += 1

    def details(self) -> Mapping[str, SensorDetails]:
        return {name: SensorDetails(rate_hz=self.rate_hz) for name in self.info.sensors}

    def identify(self, sensor: str) -> bool:
        return True

    def ask(self, kind: RecordingKind | None) -> None:
        self.asked.append(kind)


def block(clock: Clock, sensor: str, first: int, count: int = 5, **more: object) -> ImuBlock:
    time_s = clock() / 1e9 + np.arange(first, first + count) / 100
    return ImuBlock(sensor, time_s, np.ones((count, 3)), np.ones((count, 3)), **more)  # type: ignore[arg-type]  # orientation or field, as the test wants


def test_two_sensors_of_one_name_are_refused_and_all_is_closed() -> None:
    sources = [Scripted(SourceInfo("one", "1", sensors=("left",)), []) for _ in range(2)]
    acquisition = Acquisition(sources)
    with pytest.raises(SourceRefusedError, match="Two sensors have the name left"):
        acquisition.start()
    assert [source.closings for source in sources] == [1, 1]


def test_a_source_that_does_not_open_is_refused_and_the_others_are_closed() -> None:
    first, second = (Scripted(SourceInfo("one", "1", sensors=(name,)), []) for name in ("left", "right"))
    second.refusal = SourceRefusedError("It is not there", "Plug it in")
    with pytest.raises(SourceRefusedError, match="Plug it in"):
        Acquisition([first, second]).start()
    assert first.closings == 1


def test_any_exception_of_a_driver_is_a_loss_and_reported_once(
    start: Start, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("app.acquisition.reader.REOPEN_S", 0.01)
    clock = Clock()
    blocks: list[list[ImuBlock] | Exception]
    blocks = [[block(clock, "left", 0)], ZeroDivisionError(), [block(clock, "left", 5)], SourceLostError("unplugged")]
    source = Scripted(SourceInfo("one", "1", sensors=("left",)), blocks)
    acquisition = start(source, now_ns=clock)
    wait_for(lambda: source.openings >= 3)
    source.refusal = OSError("no such port")
    source.blocks.append(SourceLostError("again"))
    wait_for(lambda: source.openings >= 10)
    source.refusal = None
    wait_for(lambda: not source.blocks)
    assert acquisition.status()["left"].counts.received == 10
    assert [record.getMessage() for record in caplog.records if record.levelname == "WARNING"] == ["one was lost"] * 3


def test_a_sensor_may_come_later_with_other_columns_and_another_rate(
    start: Start, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.acquisition.reader.REOPEN_S", 0.01)
    clock = Clock()
    source = Scripted(SourceInfo("one", "1"), [])
    acquisition = start(source, now_ns=clock)
    writer = open_journal(tmp_path, ID, now_ns=clock)
    acquisition.record(writer)
    four, three = np.full((5, 4), 0.5), np.full((5, 3), 0.5)
    source.blocks = [
        [block(clock, "left", 0)],
        [block(clock, "left", 5, mag=three), block(clock, "right", 0, q_earth_from_sensor=four)],
        SourceLostError("unplugged"),
        [block(clock, "left", 10, mag=three), block(clock, "right", 20, q_earth_from_sensor=four)],
    ]
    wait_for(lambda: not source.blocks and source.openings == 2)
    assert acquisition.sensors == ("left", "right")
    assert acquisition.identify("right")
    sensors = read_back([acquisition.stop_recording().path]).sensors
    left, right = sensors["left"].block, sensors["right"].block
    assert (len(left), len(right)) == (15, 10)
    assert left.mag is not None
    assert np.isnan(left.mag[:5]).all()
    assert (left.mag[5:] == 0.5).all()
    assert right.q_earth_from_sensor is not None
    assert left.time_s.tolist() == pytest.approx((np.arange(15) / 100).tolist())


def test_samples_from_before_the_recording_are_not_in_it_and_late_ones_are(start: Start, tmp_path: Path) -> None:
    clock = Clock()
    source = Scripted(SourceInfo("one", "1", sensors=("left",)), [])
    acquisition = start(source, now_ns=clock)
    acquisition.record(open_journal(tmp_path, ID, now_ns=clock))
    early = block(clock, "left", -3, 6)
    untimed = replace(block(clock, "left", 8, 1), time_s=np.array([np.nan]))
    source.blocks = [[early], [block(clock, "left", 4, 2)], [block(clock, "left", 3, 1)], [untimed]]
    wait_for(lambda: not source.blocks)
    decoded = read_back([acquisition.stop_recording().path]).sensors["left"]
    assert decoded.block.time_s.tolist() == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04, 0.05])
    assert (decoded.counts.late, decoded.counts.damaged) == (1, 1)


def test_bytes_are_kept_before_they_are_decoded_and_decoded_again(
    start: Start, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.acquisition.reader.REOPEN_S", 0.01)
    clock, is_recording = Clock(), threading.Event()

    class Port(Scripted):
        has_bytes = True
        number = 0

        def read(self, keep: Keep) -> Sequence[ImuBlock]:
            time.sleep(0.002)
            if self.number == 10 and not is_recording.is_set():
                return []
            if self.number in (20, 40):
                self.number += 1
                keep(b"half a li")
                raise SourceLostError("unplugged")
            keep(line(self.number))
            self.number += 1
            if self.number == 30:
                raise ValueError("this driver fails at what it has read")
            return [block(clock, "line", self.number - 1, 1)]

    source = Port(LINES, [])
    acquisition = start(source, now_ns=clock)
    wait_for(lambda: source.number >= 3)
    acquisition.record(open_journal(tmp_path, ID, now_ns=clock))
    is_recording.set()
    wait_for(lambda: source.number >= 50)
    summary = acquisition.stop_recording()
    decoded = decode([summary.path], KEY, {"lines": LineDecoder})
    (sensor,) = decoded.sensors.values()
    numbers = np.round(sensor.block.time_s * RATE_HZ).astype(int).tolist()
    assert numbers[-1] >= 49
    assert numbers == [k for k in range(numbers[0], numbers[-1] + 1) if k not in (20, 40)]
    assert sensor.counts.damaged == 2
    assert len(decoded.sources) == 1


@pytest.mark.endurance
def test_the_live_work_gets_every_sample_once(start: Start) -> None:
    acquisition = start(played("a", 2), played("b", 1))
    wait_for(lambda: acquisition.now_s > 0.2)
    estimator = Counting()
    acquisition.set_estimator(estimator)
    began_s = acquisition.now_s
    wait_for(lambda: acquisition.now_s > began_s + 0.5)
    acquisition.set_estimator(None)
    time.sleep(0.1)
    calls = estimator.calls
    time.sleep(0.1)
    assert estimator.calls == calls
    assert len(estimator.threads) == 1
    assert set(estimator.times_s) == set(acquisition.sensors)
    for times_s in estimator.times_s.values():
        assert np.allclose(np.diff(times_s), 1 / RATE_HZ)
        assert times_s[0] > began_s - 0.1  # nothing from before it was set
    assert acquisition.dropped_from_preview == 0


def test_live_work_that_fails_is_reported_once_and_ends_nothing(
    start: Start, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    acquisition = start(played("a", 1))
    acquisition.record(open_journal(tmp_path, ID))
    estimator = Counting()
    estimator.fails = True
    acquisition.set_estimator(estimator)
    wait_for(lambda: estimator.calls > 3)
    assert isinstance(acquisition.trouble, ValueError)
    assert len([record for record in caplog.records if record.levelname == "ERROR"]) == 1
    acquisition.set_estimator(Counting())
    assert not acquisition.trouble
    decoded = read_back([acquisition.stop_recording().path])
    assert faults_of(decoded.sensors, {"a-left_thigh": 0}) == []


def test_live_work_that_falls_behind_loses_the_oldest_and_the_recording_nothing(
    start: Start, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.acquisition.preview.MOST_BEHIND_S", 0.1)
    acquisition = start(played("a", 1))
    acquisition.record(open_journal(tmp_path, ID))
    estimator = Counting()
    estimator.pause_s = 0.3
    acquisition.set_estimator(estimator)
    wait_for(lambda: estimator.calls > 2)
    acquisition.set_estimator(None)
    assert acquisition.dropped_from_preview > 20
    (times_s,) = estimator.times_s.values()
    assert len(times_s) <= (estimator.calls) * 0.1 * RATE_HZ + 1
    decoded = read_back([acquisition.stop_recording().path])
    assert faults_of(decoded.sensors, {"a-left_thigh": 0}) == []


def test_patients_are_asked_all_at_once(start: Start) -> None:
    sources = [Scripted(SourceInfo("one", "1", sensors=(name,)), []) for name in ("left", "right")]
    acquisition = start(*sources)
    acquisition.ask(RecordingKind.WALKING)
    acquisition.ask(None)
    assert [source.asked for source in sources] == [[RecordingKind.WALKING, None]] * 2


# T9: the clock is set, the machine sleeps


def test_a_clock_that_is_set_by_a_day_changes_nothing(
    start: Start, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    acquisition = start(played("a", 1))
    wall_s = time.time()
    acquisition.record(open_journal(tmp_path, ID))
    for set_by_s in (86_400.0, -86_400.0, 3600.0, -3600.0):
        monkeypatch.setattr(time, "time", lambda by=set_by_s: wall_s + by)
        monkeypatch.setattr(time, "time_ns", lambda by=set_by_s: round((wall_s + by) * 1e9))
        time.sleep(0.1)
        assert acquisition.status()["a-left_thigh"].silent_s < 5.0
    decoded = read_back([acquisition.stop_recording().path])
    assert faults_of(decoded.sensors, {"a-left_thigh": 0}) == []
    assert decoded.sensors["a-left_thigh"].block.time_s[-1] < 30.0


@pytest.mark.endurance
@pytest.mark.parametrize("slept_s", [20.0, 8 * 3600.0])
@pytest.mark.parametrize("is_lost", [False, True])
def test_a_machine_that_slept_leaves_one_gap(
    start: Start, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, slept_s: float, is_lost: bool
) -> None:
    monkeypatch.setattr("app.acquisition.reader.REOPEN_S", 0.01)
    clock = Clock()
    source = ReplaySource(
        numbered_session("a", 2), faults=ReplayFaults(lag_s={"a-left_shank": 0.02}), now_ns=clock, sleep=clock.sleep
    )
    acquisition = start(source, now_ns=clock)
    acquisition.record(open_journal(tmp_path, ID, now_ns=clock))
    wait_for(lambda: acquisition.now_s > 1.0)
    if is_lost:
        source.vanish()
        wait_for(lambda: not source.is_open)
    clock.time_ns += round(slept_s * 1e9)
    source.come_back()
    woken_s = acquisition.now_s
    wait_for(lambda: acquisition.now_s > woken_s + 2.0)
    status = acquisition.status()
    decoded = read_back([acquisition.stop_recording().path])
    for name, one in decoded.sensors.items():
        time_s = one.block.time_s
        steps = np.round(np.diff(time_s) * RATE_HZ).astype(int)
        assert time_s[0] >= 0
        assert np.all(steps > 0)
        (gap,) = steps[steps != 1] - 1
        assert gap == pytest.approx(slept_s * RATE_HZ, abs=6 * RATE_HZ)
        assert one.counts.lost == gap
        assert np.diff(one.block.gyr_rad_s[:, 0])[0] == 1
        assert status[name].counts.lost == gap
        assert status[name].silent_s >= 0
        shown_s = acquisition.latest(name, 30.0).time_s
        assert np.all(np.diff(shown_s) > 0)

"""Tests that streams of Lab Streaming Layer are received, understood and stamped right, and missed without harm."""

import builtins
import sys
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from core.samples import FloatArray
from devices.clocks.host_clock import host_time_ns
from devices.drivers.lsl import LslSensor, LslSource, LslStream, ask_in, find_streams, sensors_of
from devices.live import SourceLostError, SourceRefusedError
from devices.search import search_streams
from devices.transport.networks import THIS_COMPUTER

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

AXES = ("x", "y", "z")
SHIMMER = tuple(
    f"Shimmer_{number}_{quantity}_{axis.upper()}_CAL"
    for number in ("5E3A", "5E3B")
    for quantity in ("Accel_LN", "Accel_WR", "Gyro")
    for axis in AXES
)
SHIMMER_UNITS = (*["m/(s^2)"] * 6, *["deg/s"] * 3) * 2
PLAIN = tuple(f"{quantity}_{axis}" for quantity in ("gyr", "acc") for axis in AXES)
RATE_HZ = 200.0


# labels and units


def test_two_sensors_in_one_stream_are_reported_apart_and_the_wide_range_is_taken() -> None:
    first, second = sensors_of("Consensys", SHIMMER, SHIMMER_UNITS)
    assert (first.name, second.name) == ("Shimmer_5E3A", "Shimmer_5E3B")
    assert (first.force, first.rate) == ((3, 4, 5), (6, 7, 8))
    assert second.rate == (15, 16, 17)
    assert (first.rate_scale, first.force_scale) == (np.pi / 180, 1.0)


@pytest.mark.parametrize("labels", [("GyroX", "GyroY", "GyroZ", "AccX", "AccY", "AccZ"), PLAIN])
def test_a_stream_of_one_sensor_has_its_name(labels: tuple[str, ...]) -> None:
    (sensor,) = sensors_of("left shank", labels, ["rad/s"] * 3 + ["g"] * 3)
    assert sensor == LslSensor("left shank", (0, 1, 2), (3, 4, 5), 1.0, 9.80665)


@pytest.mark.parametrize("units", [[], ["", "", "", "g", "g", "g"], ["deg/s"] * 2 + ["rad/s"] + ["g"] * 3])
def test_units_that_are_not_reported_are_not_guessed(units: list[str]) -> None:
    with pytest.raises(SourceRefusedError, match="gives no units"):
        sensors_of("s", PLAIN, units)


@pytest.mark.parametrize("labels", [(), ("EEG1", "EEG2"), PLAIN[:3], ("gyr_x", "gyr_y", "acc_x", "acc_y", "acc_z")])
def test_streams_of_something_else_are_refused(labels: tuple[str, ...]) -> None:
    with pytest.raises(SourceRefusedError, match="has no channels labelled as angular rate and acceleration"):
        sensors_of("s", labels, ["deg/s"] * len(labels))


def test_without_the_library_there_are_no_streams_and_the_refusal_states_what_to_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = builtins.__import__

    def importing(name: str, *arguments: Any, **more: Any) -> Any:
        if name.startswith("pylsl"):
            raise ImportError(name)
        return found(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", importing)
    monkeypatch.delitem(sys.modules, "pylsl", raising=False)
    with pytest.raises(SourceRefusedError, match="Install gaitwright"):
        find_streams(THIS_COMPUTER, 0.0)
    with pytest.raises(SourceRefusedError, match="Install gaitwright"):
        LslSource(LslStream("s", "IMU", "", "", None)).open()


# real outlets on this machine


class Outlet:
    """Sends a sample every 5 ms, in a thread, stamped by a clock that is `offset_s` wrong and `skew` too fast.

    The rate about x reports the sample's number, so that whoever receives it knows when it was taken: when the thread
    had its turn, for a busy machine's sensors are no better.
    """

    def __init__(self, offset_s: float = 0.0, skew: float = 0.0, per_chunk: int = 1) -> None:
        pylsl = pytest.importorskip("pylsl", reason="Lab Streaming Layer is an extra")
        ask_in(THIS_COMPUTER)  # before its first stream is made
        self.name = f"gaitwright test {uuid.uuid4()}"
        info = pylsl.StreamInfo(self.name, "IMU", 6, RATE_HZ, pylsl.cf_double64, self.name)
        info.set_channel_labels(list(PLAIN))
        info.set_channel_units(["rad/s"] * 3 + ["m/s^2"] * 3)
        self._clock = pylsl.local_clock
        self._offset_s, self._skew, self._per_chunk = offset_s, skew, per_chunk
        self._outlet = pylsl.StreamOutlet(info, chunk_size=per_chunk)
        self._begin_s, self._ahead_s = self._clock(), host_ahead_s(self._clock)
        self._taken_s: list[float] = []
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        if not pylsl.resolve_byprop("source_id", self.name, timeout=5.0):
            self._is_closing.set()
            pytest.fail("a stream is not heard on its own computer")

    def taken_s(self, number: FloatArray) -> FloatArray:
        """When samples (n,) were taken, by the host's clock."""
        taken_s: FloatArray = np.array(self._taken_s)[number.astype(int)] + self._ahead_s
        return taken_s

    def close(self) -> None:
        self._is_closing.set()
        self._thread.join()
        del self._outlet

    def _run(self) -> None:
        number = 0
        while not self._is_closing.is_set():
            while number / RATE_HZ <= self._clock() - self._begin_s:
                taken_s = self._clock()
                self._taken_s.append(taken_s)
                stamp_s = self._begin_s + self._offset_s + (taken_s - self._begin_s) * (1 + self._skew)
                self._outlet.push_sample([float(number), 0.0, 0.0, 0.0, 0.0, 9.81], stamp_s)
                number += 1
            time.sleep(0.002)


def host_ahead_s(clock: Callable[[], float]) -> float:
    """How much more the host's clock shows than another one, by the narrowest of many looks at both."""
    looks = [(host_time_ns(), clock(), host_time_ns()) for _ in range(100)]
    before_ns, shown_s, after_ns = min(looks, key=lambda look: look[2] - look[0])
    return (before_ns + after_ns) / 2e9 - shown_s


@pytest.fixture
def outlets() -> Iterator[list[Outlet]]:
    made: list[Outlet] = []
    yield made
    for one in made:
        one.close()


def opened(outlet: Outlet) -> LslSource:
    (stream,) = [one for one in find_streams(THIS_COMPUTER) if one.name == outlet.name]
    source = LslSource(stream)
    source.open()
    return source


def received(sources: list[LslSource], seconds: float) -> list[tuple[FloatArray, FloatArray]]:
    """Numbers and stamps of what each source gave."""
    got: list[list[tuple[FloatArray, FloatArray]]] = [[] for _ in sources]
    until_s = time.monotonic() + seconds
    while time.monotonic() < until_s:
        for source, pieces in zip(sources, got, strict=True):
            for block in source.read(lambda _: None):
                pieces.append((block.gyr_rad_s[:, 0], block.time_s))
    return [
        (np.concatenate([number for number, _ in pieces]), np.concatenate([time_s for _, time_s in pieces]))
        for pieces in got
    ]


class Simulated:
    """An inlet, its library and the host's clock: every 5 ms a sample comes, 0.2 ms after it was taken.

    Every 15 ms three of them are there, the last one for a while already. Whenever the library's clock is looked at the
    thread has no turn for 3 ms, by turns before it and after.
    """

    def __init__(self, offset_s: float) -> None:
        self.util = pytest.importorskip("pylsl").util
        self.now_s, self.number, self.looks, self._offset_s = 50.0, 0, 0, offset_s

    def local_clock(self) -> float:
        self.looks += 1
        shown_s = self.now_s + 0.003 * (self.looks % 2)
        self.now_s += 0.003
        return shown_s

    def time_correction(self, timeout: float) -> float:
        return 0.0

    def pull_sample(self, timeout: float) -> tuple[list[float], float]:
        self.number += 1
        taken_s = 50.0 + self.number / RATE_HZ + 0.004
        self.now_s = max(self.now_s, taken_s + 0.0002)
        return [taken_s, 0.0, 0.0, 0.0, 0.0, 9.81], taken_s + self._offset_s

    def pull_chunk(self, timeout: float, max_samples: int) -> tuple[list[list[float]], list[float]]:
        end_s, pulled = self.now_s + timeout, []
        while 50.0 + (self.number + 1) / RATE_HZ + 0.0042 < end_s:
            pulled.append(self.pull_sample(0.0))
        self.now_s = end_s
        return [row for row, _ in pulled], [stamp_s for _, stamp_s in pulled]


@pytest.mark.parametrize("offset_s", [0.0, 3.0])
def test_how_long_a_sample_waits_to_be_read_does_not_count_for_its_way(
    offset_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    simulated = Simulated(offset_s)
    monkeypatch.setattr("devices.drivers.lsl._library", lambda: simulated)
    source = LslSource(LslStream("s", "IMU", "", "", RATE_HZ), now_ns=lambda: round(simulated.now_s * 1e9))
    source.sensors, source._inlet = (LslSensor("s", (0, 1, 2), (3, 4, 5), 1.0, 1.0),), simulated
    blocks = [block for _ in range(50) for block in source.read(lambda _: None)]
    wrong_s = np.concatenate([block.time_s - block.gyr_rad_s[:, 0] for block in blocks])
    assert np.abs(wrong_s[50:]).max() < 0.0007


def assert_stamped(outlets: list[Outlet], seconds: float) -> None:
    sources = [opened(outlet) for outlet in outlets]
    try:
        for outlet, source, (number, time_s) in zip(outlets, sources, received(sources, seconds), strict=True):
            assert np.array_equal(np.diff(number), np.ones(len(number) - 1))  # none lost, none twice
            assert len(number) > 0.5 * seconds * RATE_HZ
            wrong_s = (time_s - outlet.taken_s(number))[int(RATE_HZ / 2) :]
            assert np.sqrt(np.mean(wrong_s**2)) < 0.002
            reported = source.details()[outlet.name]
            assert (reported.model, reported.rate_hz) == ("IMU", RATE_HZ)
            assert source.info.sensors == (outlet.name,)
    finally:
        for source in sources:
            source.close()


def test_a_stream_by_the_common_clock_and_one_three_seconds_wrong_are_stamped_alike(outlets: list[Outlet]) -> None:
    outlets += [Outlet(), Outlet(offset_s=3.0, skew=200e-6, per_chunk=4)]
    assert_stamped(outlets, 2.5)


@pytest.mark.endurance
def test_a_clock_that_drifts_is_followed(outlets: list[Outlet]) -> None:
    outlets += [Outlet(), Outlet(offset_s=3.0, skew=200e-6), Outlet(offset_s=-3.0, skew=-200e-6, per_chunk=8)]
    assert_stamped(outlets, 25.0)


def test_a_stream_is_found_by_the_search_and_its_sensors_are_counted(outlets: list[Outlet]) -> None:
    outlets.append(Outlet())
    (found,) = [one for one in search_streams(THIS_COMPUTER).of("lsl") if one.name == outlets[0].name]
    assert found.count == 1
    source = found.make()
    source.open()
    assert source.info.sensors == (outlets[0].name,)
    source.close()


def test_who_was_asked_on_this_computer_is_asked_nowhere_else(outlets: list[Outlet]) -> None:
    outlets.append(Outlet())
    with pytest.raises(SourceRefusedError, match=f"already searches the network of {THIS_COMPUTER}"):
        find_streams("192.0.2.9")


def test_a_stream_that_ends_is_lost_and_then_not_there(outlets: list[Outlet], monkeypatch: pytest.MonkeyPatch) -> None:
    outlets.append(Outlet())
    source = opened(outlets[0])
    received([source], 0.3)
    outlets.pop().close()
    with pytest.raises(SourceLostError):
        received([source], 10.0)
    source.close()
    monkeypatch.setattr("devices.drivers.lsl.OPEN_S", 0.5)
    with pytest.raises(SourceRefusedError, match="was not found"):
        source.open()

"""Tests that each maker's sensor is recognised by what it sends and answers, without waiting for real ports."""

import time
from collections.abc import Callable
from functools import partial

import pytest

from devices.emulators.csv_lines import LineVoice
from devices.emulators.shimmer3 import Shimmer3Voice
from devices.emulators.transports import Voice
from devices.emulators.witmotion import WitVoice
from devices.emulators.ximu3 import Ximu3Voice
from devices.emulators.xsens_mti import MtiVoice
from devices.live import SourceLostError, SourceRefusedError
from devices.search import SearchResult, search
from devices.transport.ports import PortInfo
from tests.devices.scripted import SilentVoice


def motion(number: int) -> tuple[float, ...]:
    return (number % 100, 0.0, 0.0, 0.0, 0.0, 1.0)


class TickingClock:
    """Every look at it takes two milliseconds, of the emulated sensors and of the search alike."""

    def __init__(self) -> None:
        self.time_ns = 10**12

    def __call__(self) -> int:
        self.time_ns += 2_000_000
        return self.time_ns

    def monotonic(self) -> float:
        return self() / 1e9


class ScriptedPort:
    """What `devices.search.SerialPort` is, with a voice behind it; understood at its baud only."""

    serial = ""

    def __init__(self, make: Callable[[], Voice | None], port: PortInfo, baud: int = 115200) -> None:
        self._voice, self.place, self.baud, self._answer = make(), port.device, baud, b""

    def open(self) -> None:
        if self._voice is None:
            raise SourceRefusedError("{place} was not found", "Plug it in", place=self.place)

    def read(self) -> bytes:
        assert self._voice is not None
        stated, self._answer = self._answer + self._voice.say(), b""
        return stated

    def write(self, data: bytes) -> None:
        assert self._voice is not None
        self._answer += self._voice.hear(data)

    def close(self) -> None:
        """It is scripted."""


class Noise:
    def say(self) -> bytes:
        return bytes(range(256)) * 4

    def hear(self, data: bytes) -> bytes:
        return b""


class Lost(SilentVoice):
    def say(self) -> bytes:
        raise SourceLostError("it went away")


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> TickingClock:
    one = TickingClock()
    monkeypatch.setattr(time, "monotonic", one.monotonic)
    monkeypatch.setattr("devices.search._announced", lambda at_port: [])
    return one


def found_at(make: Callable[[], Voice | None], monkeypatch: pytest.MonkeyPatch) -> SearchResult:
    monkeypatch.setattr("devices.search.SerialPort", partial(ScriptedPort, make))
    return search([PortInfo("script", is_named=True)])


def silent_mti(clock: TickingClock) -> MtiVoice:
    voice = MtiVoice(now_ns=clock)
    voice.is_measuring = False
    return voice


@pytest.mark.parametrize(
    ("make", "driver", "name"),
    [
        (lambda clock: Ximu3Voice("0000000A", motion, now_ns=clock), "ximu3", "0000000A"),
        (lambda clock: Ximu3Voice("0000000B", motion, is_binary=False, now_ns=clock), "ximu3", "0000000B"),
        (lambda clock: WitVoice("000C", motion, now_ns=clock), "witmotion", "EMULATED000C"),
        (lambda clock: MtiVoice(now_ns=clock), "xsens-mti", "MTi 0280A1B2"),
        (silent_mti, "xsens-mti", "MTi 0280A1B2"),
        (lambda clock: Shimmer3Voice(now_ns=clock), "shimmer3", "emulated Shimmer3"),
    ],
    ids=["x-IMU3, binary", "x-IMU3, text", "WitMotion", "MTi", "MTi, silent", "Shimmer3"],
)
def test_a_sensor_is_known_by_what_it_sends_or_answers(
    make: Callable[[TickingClock], Voice], driver: str, name: str, clock: TickingClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = found_at(lambda: make(clock), monkeypatch)
    assert [(one.driver, one.name, one.place, one.is_simulated) for one in found.sensors] == [
        (driver, name, "script", True)
    ]
    assert (found.passed, found.lines) == ((), ())


def test_lines_of_numbers_are_lines_until_their_columns_are_reported(
    clock: TickingClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = found_at(lambda: LineVoice(motion, now_ns=clock), monkeypatch)
    assert found.sensors == ()
    (lines,) = found.lines
    assert (lines.port.device, lines.columns, lines.count) == ("script", None, 7)


@pytest.mark.parametrize("make", [Noise, SilentVoice, Lost])
def test_who_is_not_understood_is_no_sensor(
    make: Callable[[], Voice], clock: TickingClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = found_at(make, monkeypatch)
    assert found.sensors == ()
    (passed,) = found.passed
    assert "No signal from a sensor at script" in str(passed.refusal)


def test_a_port_that_cannot_be_opened_states_why(clock: TickingClock, monkeypatch: pytest.MonkeyPatch) -> None:
    (passed,) = found_at(lambda: None, monkeypatch).passed
    assert "script was not found" in str(passed.refusal)

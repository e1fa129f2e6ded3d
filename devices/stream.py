"""Decoding of one sensor's byte stream, live and once more from a journal.

A driver is a `SensorProtocol`: how to greet the sensor, and the `Framer` that finds messages in its bytes. All else is
the same for all of them and is here. A framer uses nothing but the bytes and what `SourceInfo` holds, and what it
finds does not depend on how the bytes were cut.
"""

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from core.samples import FloatArray, ImuBlock
from core.session import RecordingKind
from devices.clocks.clock import Ordered, put_in_order
from devices.clocks.host_clock import host_time_ns
from devices.clocks.live_clock import LiveClock
from devices.live import Keep, SensorDetails
from devices.source import DecodedSensor, SharedClock, SourceInfo
from devices.transport.channels import Channel

Row = tuple[float, ...]
"""Seconds of the sensor's clock, then angular rate in rad/s (3) and specific force in m/s2 (3)."""

_Clock = tuple[tuple[str, float] | None, int]
"""The clock that a sensor runs by: its name and turn where it is shared, and how often its own has begun again."""

COLUMNS = 7
WAITS_S = 0.02


@dataclass(slots=True)
class Received:
    """What a framer found, taken from it piece by piece.

    Attributes
    ----------
    rows
        One per sample.
    orientations
        Seconds of the sensor's clock, then the sensor's own orientation, scalar first.
    damaged
        Messages that were cut, failed their check, or say what cannot be.
    skipped
        Whole messages that mean nothing here.
    battery
        0 to 1, as it was reported last.
    replies
        What the sensor answered.
    """

    rows: list[Row] = field(default_factory=list)
    orientations: list[Row] = field(default_factory=list)
    damaged: int = 0
    skipped: int = 0
    battery: float | None = None
    replies: list[bytes] = field(default_factory=list)


class Framer(Protocol):
    """Finds messages in bytes. Holds a bounded number of them back, and raises nothing, whatever they are."""

    received: Received

    def feed(self, data: bytes, host_s: float) -> None:
        """Take the next bytes, in pieces of any size."""

    def flush(self) -> None:
        """Nothing follows: take what was held back for what might follow."""


class Framing(Protocol):
    """What makes samples of one maker's bytes."""

    @property
    def driver(self) -> str: ...

    @property
    def version(self) -> str: ...

    def framer(self, info: SourceInfo) -> Framer:
        """A new framer for what is sent under `info`."""


class SensorProtocol(Framing, Protocol):
    """What is particular about one maker's sensors that are spoken with through a channel."""

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        """Find out who is there, and set it up as required.

        Raises
        ------
        SourceRefusedError
            It is something else, or does not answer.
        """

    def identifying(self) -> bytes:
        """What lights the sensor's LED; empty where nothing does."""


def decoded(
    sensor: str,
    received: Received,
    host_s: Sequence[float],
    step_s: float | None = None,
    begins: Sequence[int] = (),
    clock: tuple[str, float] | None = None,  # shared with others: its name, and after how many seconds it begins again
    again: Collection[int] = (),
) -> DecodedSensor:
    """Order what was received of one sensor (rows arrived at `host_s`); SI, sensor axes, host stamps."""
    rows = np.array(received.rows, dtype=float).reshape(-1, COLUMNS)
    arrived_s = np.array(host_s, dtype=float)
    ordered = put_in_order(rows[:, 0], arrived_s, step_s, begins, again)
    block = ImuBlock(
        sensor=sensor,
        time_s=ordered.time_s,
        gyr_rad_s=rows[ordered.rows, 1:4],
        acc_m_s2=rows[ordered.rows, 4:7],
        q_earth_from_sensor=_orientation(received.orientations, ordered),
    )
    shared = SharedClock(clock[0], ordered.device_s, arrived_s[ordered.rows], clock[1]) if clock else None
    return DecodedSensor(block, replace(ordered.counts, damaged=ordered.counts.damaged + received.damaged), shared)


class Decoder:
    """The `StreamDecoder` of every protocol: all samples in order, each once, stamped by the host's clock."""

    def __init__(self, protocol: Framing) -> None:
        self._protocol = protocol
        self._framer: Framer | None = None
        self._info = SourceInfo(protocol.driver, protocol.version)
        self._received = Received()
        self._host_s: list[float] = []
        self._begins: list[int] = []
        self._again: list[int] = []
        self._clocks: list[_Clock] = []

    def begin(self, source: SourceInfo) -> None:
        self._end()
        self._begins.append(len(self._host_s))
        clock = _clock(source)
        if clock != (self._clocks or [clock])[-1]:
            self._again.append(len(self._host_s))
        self._clocks.append(clock)
        self._info, self._framer = source, self._protocol.framer(source)

    def feed(self, data: bytes, host_time_s: float) -> None:
        if self._framer is not None:
            self._framer.feed(data, host_time_s)
            self._take(host_time_s)

    def finish(self) -> Mapping[str, DecodedSensor]:
        self._end()
        if not self._info.sensors:
            return {}
        shared = None if self._again else self._clocks[-1][0]  # it was another after it was lost: its own
        step_s = _step_s(self._info)
        one = decoded(self._info.sensors[0], self._received, self._host_s, step_s, self._begins, shared, self._again)
        return {one.block.sensor: one}

    def _take(self, host_time_s: float) -> None:
        assert self._framer is not None
        found = self._framer.received
        self._host_s += [host_time_s] * len(found.rows)
        self._received.rows += found.rows
        self._received.orientations += found.orientations
        self._received.damaged += found.damaged
        self._framer.received = Received(battery=found.battery)

    def _end(self) -> None:
        if self._framer is not None:
            self._framer.flush()
            self._take(self._host_s[-1] if self._host_s else 0.0)
            self._framer = None


class _Noting:
    """A `Channel` that remembers what was written since it was opened."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self.sent: list[bytes] = []

    @property
    def place(self) -> str:
        return self._channel.place

    @property
    def serial(self) -> str:
        return self._channel.serial

    def open(self) -> None:
        self.sent = []
        self._channel.open()

    def read(self) -> bytes:
        return self._channel.read()

    def write(self, data: bytes) -> None:
        self._channel.write(data)
        self.sent.append(data)

    def close(self) -> None:
        self._channel.close()


class ByteSource:
    """The `LiveSource` of every protocol: journal first, then messages, then stamps. One sensor."""

    has_bytes = True

    def __init__(self, protocol: SensorProtocol, channel: Channel, now_ns: Callable[[], int] = host_time_ns) -> None:
        self._protocol, self._channel, self._now_ns = protocol, _Noting(channel), now_ns
        self.info = SourceInfo(protocol.driver, protocol.version)
        self._details = SensorDetails()
        self._framer: Framer | None = None
        self._clock = LiveClock()
        self.damaged = 0
        """Messages that could not be understood since the source was made."""
        self._is_open = False

    @property
    def sent(self) -> Sequence[bytes]:
        return tuple(self._channel.sent)

    def open(self) -> None:
        self._channel.open()
        try:
            info, details = self._protocol.greet(self._channel)
        except BaseException:
            self._channel.close()
            raise
        if self.info.sensors:  # it keeps its name, whatever it reports about itself after it was lost
            info = replace(info, sensors=self.info.sensors)
        self.info, self._details = info, details
        self._framer, self._is_open = self._protocol.framer(info), True
        self._clock.begin()

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        data = self._channel.read()
        if not data or self._framer is None:
            return ()
        keep(data)
        now_s = self._now_ns() / 1e9
        framer = self._framer
        framer.feed(data, now_s)
        received, framer.received = framer.received, Received(battery=framer.received.battery)
        self.damaged += received.damaged
        if received.battery is not None and received.battery != self._details.battery:
            self._details = replace(self._details, battery=received.battery)
        if not received.rows:
            return ()
        rows = np.array(received.rows, dtype=float)
        stamps_s = self._clock.stamp(rows[:, 0], now_s)
        return (ImuBlock(self.info.sensors[0], stamps_s, rows[:, 1:4], rows[:, 4:7]),)

    def close(self) -> None:
        self._is_open = False
        self._channel.close()

    def details(self) -> Mapping[str, SensorDetails]:
        return dict.fromkeys(self.info.sensors, self._details)

    def identify(self, sensor: str) -> bool:
        command = self._protocol.identifying()
        if not command or not self._is_open or sensor not in self.info.sensors:
            return False
        with suppress(Exception):  # what is lost is noticed by whoever reads
            self._channel.write(command)
            return True
        return False

    def ask(self, kind: RecordingKind | None) -> None:
        """Only simulated patients listen."""


def ask(channel: Channel, framer: Framer, command: bytes, is_answer: Callable[[bytes], bool], within_s: float) -> bytes:
    """Send a command and await its answer, empty on timeout; other bytes stay with the framer."""
    channel.write(command)
    return listen(channel, framer, lambda received: next(filter(is_answer, received.replies), b""), within_s)


def listen(channel: Channel, framer: Framer, found: Callable[[Received], bytes], within_s: float) -> bytes:
    """Read until `found` finds something in what was received, empty on timeout."""
    until_s = time.monotonic() + within_s
    while time.monotonic() < until_s:
        framer.feed(channel.read(), time.monotonic())
        if answer := found(framer.received):
            return answer
    return b""


def _step_s(info: SourceInfo) -> float | None:
    rate_hz = info.settings.get("rate_hz")
    return 1.0 / rate_hz if isinstance(rate_hz, int | float) and rate_hz > 0 else None


def _clock(info: SourceInfo) -> _Clock:
    name, turn_s = info.settings.get("clock"), info.settings.get("turn_s", 0.0)
    begun = info.settings.get("clock_begun", 0)
    shared = (name, float(turn_s)) if isinstance(name, str) and isinstance(turn_s, int | float) else None
    return shared, begun if isinstance(begun, int) else 0


def _orientation(rows: Sequence[Row], ordered: Ordered) -> FloatArray | None:
    """The orientation (n, 4) that was sent for the same instant as each sample; NaN where none was."""
    if not rows:
        return None
    details = np.array(rows, dtype=float)
    details = details[np.argsort(details[:, 0], kind="stable")]
    place = np.minimum(details[:, 0].searchsorted(ordered.device_s), len(details) - 1)
    is_known = details[place, 0] == ordered.device_s
    return np.where(is_known[:, None], details[place, 1:], np.nan)

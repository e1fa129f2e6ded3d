"""Streams of Lab Streaming Layer: which can be received, and what their samples hold.

Many programs send through it: Consensys (Shimmer), BrainVision, OpenViBE, a lab's own. A stream names the labels and
units of its channels; what is a rate or a force is found by these and asked for where it is not given. Stamps are
the sending machine's. Where Lab Streaming Layer's own measurement of that machine's clock agrees with what arrives it
is taken; a stream that stamps by a clock of its own is put right by its arrivals (`devices.clocks.clock`).

The library is an extra (`lsl`): without it there are no streams, and all else goes on. Left to itself it asks every
network that the computer is in, by broadcast and multicast, who sends. Here it asks nobody until somebody has chosen a
network, and then that one only (`ask_in`).
"""

import re
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from core.samples import G_M_S2, ImuBlock
from core.session import RecordingKind
from devices.clocks.host_clock import host_time_ns
from devices.clocks.live_clock import LiveClock
from devices.live import Keep, SensorDetails, SourceLostError, SourceRefusedError
from devices.source import SourceInfo
from devices.transport.networks import THIS_COMPUTER

DRIVER, VERSION = "lsl", "1"
SEARCH_S, OPEN_S, READ_S = 1.0, 2.0, 0.015
MOST_SAMPLES = 4096
BUFFER_S = 30
PLAUSIBLE_S = 0.5  # so late a sample may be that is stamped by Lab Streaming Layer's clock
EARLY_S = 0.005  # and so early, for no measurement of a clock is exact
RATE_UNITS = {
    **dict.fromkeys(("deg/s", "deg/sec", "degree/s", "degrees/s", "degree/second", "dps", "°/s"), np.pi / 180),
    **dict.fromkeys(("rad/s", "rad/sec", "radian/s", "radians/s"), 1.0),
}
FORCE_UNITS = {
    **dict.fromkeys(("m/s^2", "m/s2", "m/s²", "m/s/s", "m/s**2", "ms-2", "m/sec^2"), 1.0),
    "g": G_M_S2,
    "mg": G_M_S2 / 1000,
}
RATE_WORDS, FORCE_WORDS = ("gyr", "rate", "angvel", "angular"), ("acc",)
GROUP, PORT = "224.0.0.183", 16571  # of the addresses that senders listen to the one that no router passes on
ON_THIS_COMPUTER = """\
[ports]
IPv6 = disable
[multicast]
ResolveScope = machine
AddressesOverride = {{{address}}}
Interfaces = {{{address}}}
[lab]
KnownPeers = {{{address}}}
"""
IN_A_NETWORK = """\
[ports]
IPv6 = disable
[multicast]
ResolveScope = link
AddressesOverride = {{{group}}}
TTLOverride = 1
Interfaces = {{{address}}}
ListenAddress = {address}
"""
WIDE = "wr"  # of a Shimmer's two accelerometers the one with the wide range


class OtherStreamError(SourceRefusedError):
    """A stream of something else than motion."""


@dataclass(frozen=True, slots=True)
class LslSensor:
    """Which channels of a stream are one sensor's: columns of rate and force, and what makes SI units of them."""

    name: str
    rate: tuple[int, int, int]
    force: tuple[int, int, int]
    rate_scale: float
    force_scale: float


@dataclass(frozen=True, slots=True)
class LslStream:
    """A stream that is being sent. `source` names its sender for good, where it does."""

    name: str
    kind: str
    source: str
    host: str
    rate_hz: float | None


class _QueriedNetwork:
    """Where this process asks for streams: the library reads its settings once, before it does anything."""

    changing = threading.Lock()
    address = ""


def library_for(address: str) -> ModuleType:
    """Give the library, once it works in the network of this address alone; raises SourceRefusedError."""
    ask_in(address)
    return _imported()


def ask_in(address: str) -> None:
    """Ask in the network of this address of ours, or on this computer alone; raises SourceRefusedError."""
    pylsl = _imported()
    with _QueriedNetwork.changing:
        if not _QueriedNetwork.address:
            settings = ON_THIS_COMPUTER if address == THIS_COMPUTER else IN_A_NETWORK
            pylsl.set_config_content(settings.format(address=address, group=GROUP))
            _QueriedNetwork.address = address
        elif _QueriedNetwork.address != address:
            raise SourceRefusedError(
                "Lab Streaming Layer already searches the network of {other}, until the program is closed",
                "To search elsewhere, close Gaitwright and start it again",
                other=_QueriedNetwork.address,
            )


def find_streams(address: str, wait_s: float = SEARCH_S) -> tuple[LslStream, ...]:
    """Find streams of numbers, see `ask_in`; raises SourceRefusedError."""
    ask_in(address)
    pylsl = _library()
    found = [one for one in pylsl.resolve_streams(wait_s) if one.channel_format() != pylsl.cf_string]
    return tuple(sorted((_stream(one) for one in found), key=lambda one: (one.name, one.host)))


def announced_sensors(stream: LslStream) -> tuple[LslSensor, ...]:
    """Ask a stream what its channels are; raises SourceRefusedError without an answer or known sensors."""
    source = LslSource(stream)
    try:
        source.open()
        return source.sensors
    finally:
        source.close()


def sensors_of(stream: str, labels: Sequence[str], units: Sequence[str]) -> tuple[LslSensor, ...]:
    """Give the sensors by channel labels (`Shimmer_5E3A_Gyro_X_CAL`, `accZ`); raises SourceRefusedError."""
    places: dict[tuple[str, str], dict[str, int]] = {}
    for column, label in enumerate(labels):
        if (found := _parsed(label)) is not None:
            who, quantity, axis = found
            places.setdefault((who, quantity), {}).setdefault(axis, column)
    whole = {key: tuple(axes[axis] for axis in "xyz") for key, axes in places.items() if len(axes) == 3}
    names = dict.fromkeys(who for who, _ in whole)
    sensors = []
    for who in names:
        rate = whole.get((who, "rate"))
        force = whole.get((who, "wide force")) or whole.get((who, "force"))
        if rate and force:
            sensors.append(
                LslSensor(
                    who or stream,
                    (rate[0], rate[1], rate[2]),
                    (force[0], force[1], force[2]),
                    _scale(stream, units, rate, RATE_UNITS),
                    _scale(stream, units, force, FORCE_UNITS),
                )
            )
    if not sensors:
        raise OtherStreamError(
            "The stream {name} has no channels labelled as angular rate and acceleration",
            "In the sending program, label the channels gyr_x to gyr_z and acc_x to acc_z, or send both quantities",
            name=stream,
        )
    return tuple(sensors)


def _parsed(label: str) -> tuple[str, str, str] | None:
    """Sensor, quantity and axis of a label; None where it is something else."""
    words = re.findall(r"[A-Za-z0-9]+", label)
    for at, word in enumerate(words):
        start = word.lower()
        quantity = "rate" if start.startswith(RATE_WORDS) else "force" if start.startswith(FORCE_WORDS) else ""
        if not quantity:
            continue
        rest = [one.lower() for one in words[at + 1 :]]
        axis = next((one for one in rest if one in ("x", "y", "z")), start[-1] if start[-1] in "xyz" else "")
        if not axis:
            return None
        return "_".join(words[:at]), "wide force" if quantity == "force" and WIDE in rest else quantity, axis
    return None


def _scale(stream: str, units: Sequence[str], columns: Sequence[int], known: Mapping[str, float]) -> float:
    unit_words = {re.sub(r"[\s()]", "", units[column] if column < len(units) else "").lower() for column in columns}
    if len(unit_words) == 1 and (scale := known.get(unit_words.pop())) is not None:
        return scale
    raise SourceRefusedError(
        "The stream {name} gives no units", "Set the units in the sending program, such as deg/s and m/s^2", name=stream
    )


class LslSource:
    """A stream as a `LiveSource`: gives samples, not bytes.

    Parameters
    ----------
    sensors
        What its channels are, where their labels do not show it.
    """

    has_bytes = False
    sent: Sequence[bytes] = ()

    def __init__(
        self,
        stream: LslStream,
        sensors: Sequence[LslSensor] | None = None,
        now_ns: Callable[[], int] = host_time_ns,
    ) -> None:
        self._stream, self._given, self._now_ns = stream, sensors, now_ns
        self.sensors: tuple[LslSensor, ...] = ()
        """Known once it is open."""
        self._inlet: Any = None
        self._clock = LiveClock()

    @property
    def info(self) -> SourceInfo:
        names = tuple(sensor.name for sensor in self.sensors)
        settings = {"stream": self._stream.name, "host": self._stream.host, "rate_hz": self._stream.rate_hz}
        return SourceInfo(DRIVER, VERSION, self._stream.source, names, settings)

    def open(self) -> None:
        pylsl = _library()
        found = [one for one in pylsl.resolve_byprop(*self._key(), timeout=OPEN_S) if self._is_same(one)]
        if not found:
            raise SourceRefusedError(
                "The stream {name} was not found", "Start it in the sending program", name=self._stream.name
            )
        inlet = pylsl.StreamInlet(found[0], max_buflen=BUFFER_S, recover=False)
        try:
            info = inlet.info(timeout=OPEN_S)
            sensors = self._given or sensors_of(
                self._stream.name, _texts(info.get_channel_labels()), _texts(info.get_channel_units())
            )
            inlet.open_stream(timeout=OPEN_S)
            with suppress(pylsl.util.TimeoutError):  # arrivals are used until it is known
                inlet.time_correction(timeout=OPEN_S)
        except (pylsl.util.LostError, pylsl.util.TimeoutError) as problem:
            raise SourceRefusedError(
                "The stream {name} does not respond",
                "Restart it in the sending program",
                name=self._stream.name,
            ) from problem
        self.sensors, self._inlet = tuple(sensors), inlet

    def read(self, keep: Keep) -> Sequence[ImuBlock]:
        if self._inlet is None:
            raise SourceLostError(f"the stream {self._stream.name} is closed")
        pylsl = _library()
        try:
            samples, stamps = self._inlet.pull_chunk(timeout=READ_S, max_samples=MOST_SAMPLES)
            # a chunk is waited for until the time is over, however long its last sample has been there: the next one is
            # given at the moment when it comes
            newest, stamp = self._inlet.pull_sample(timeout=READ_S)
        except pylsl.util.LostError as problem:
            raise SourceLostError(f"the stream {self._stream.name} has ended") from problem
        if stamp is not None:
            samples, stamps = [*samples, newest], [*stamps, stamp]
        if not stamps:
            return ()
        rows, sent_s = np.array(samples, dtype=float), np.array(stamps, dtype=float)
        time_s = self._clock.stamp(sent_s, self._host_s(float(sent_s.max()), pylsl))
        return [
            ImuBlock(
                sensor.name,
                time_s,
                rows[:, sensor.rate] * sensor.rate_scale,
                rows[:, sensor.force] * sensor.force_scale,
            )
            for sensor in self.sensors
        ]

    def close(self) -> None:
        inlet, self._inlet = self._inlet, None
        if inlet is not None:
            inlet.close_stream()

    def details(self) -> Mapping[str, SensorDetails]:
        one = SensorDetails(model=self._stream.kind, serial=self._stream.source, rate_hz=self._stream.rate_hz)
        return {sensor.name: one for sensor in self.sensors}

    def identify(self, sensor: str) -> bool:
        return False

    def ask(self, kind: RecordingKind | None) -> None:
        """Only simulated patients listen."""

    def _host_s(self, newest_s: float, pylsl: ModuleType) -> float:
        """When the newest sample was sent, by the host's clock: as Lab Streaming Layer knows it, or when it came."""
        came_s = self._now_ns() / 1e9
        try:
            sent_s = newest_s + self._inlet.time_correction(timeout=0.0)
        except (pylsl.util.LostError, pylsl.util.TimeoutError):
            return came_s
        late_s = pylsl.local_clock() - sent_s
        now_s = self._now_ns() / 1e9  # looked at last: what comes between the two looks is a delay, never the reverse
        return now_s - late_s if -EARLY_S < late_s < PLAUSIBLE_S else came_s

    def _key(self) -> tuple[str, str]:
        return ("source_id", self._stream.source) if self._stream.source else ("name", self._stream.name)

    def _is_same(self, found: Any) -> bool:
        return bool(
            found.name() == self._stream.name and (self._stream.source or found.hostname() == self._stream.host)
        )


def _stream(found: Any) -> LslStream:
    rate_hz = found.nominal_srate()
    return LslStream(found.name(), found.type(), found.source_id(), found.hostname(), rate_hz if rate_hz > 0 else None)


def _texts(texts: Sequence[str | None] | None) -> list[str]:
    return [text or "" for text in texts or ()]


def _library() -> ModuleType:
    """The library, which asks this computer only where nobody has chosen."""
    if not _QueriedNetwork.address:
        ask_in(THIS_COMPUTER)
    return _imported()


def _imported() -> ModuleType:
    try:
        import pylsl.util  # an extra
    except (ImportError, RuntimeError, OSError) as problem:  # RuntimeError: its own library is not there
        raise SourceRefusedError("Lab Streaming Layer is not installed", "Install gaitwright[lsl]") from problem
    library: ModuleType = pylsl
    return library

"""Emulated DOTs that are worn, read and kept as the application does it."""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from core.samples import FloatArray
from devices.clocks.shared_clock import tied
from devices.dot.decoder import DotDecoder
from devices.dot.sensor import DotSensor
from devices.dot.source import DotGroup, DotSource
from devices.emulators.bluetooth import Air
from devices.emulators.dot import EmulatedDot
from devices.emulators.dot_faults import DotFaults
from devices.live import SourceLostError, SourceRefusedError
from devices.source import DecodedSensor
from devices.transport.bluetooth import Announced
from tests.devices.dot.virtual_time import VirtualRadio, worn

RAD = np.pi / 180


class DotsInReach(Protocol):
    """Who announces itself, and how a link is lost."""

    def announced(self) -> Sequence[Announced]: ...

    def drop(self, sensor: EmulatedDot) -> None: ...


Through = Callable[[VirtualRadio, Sequence[DotFaults]], tuple[DotsInReach, list[EmulatedDot]]]
"""What links go through: sensors with these faults, in the radio's reach."""


def behind_bleak(radio: VirtualRadio, faults: Sequence[DotFaults]) -> tuple[Air, list[EmulatedDot]]:
    """Links that are nothing but the interface of the Bluetooth library."""
    return worn(radio, faults)


class WornDots:
    """Sensors, their sources, and a journal of each kept as an application would."""

    def __init__(
        self,
        radio: VirtualRadio,
        faults: Sequence[DotFaults],
        rate_hz: int = 60,
        record_hz: int = 120,
        through: Through = behind_bleak,
    ) -> None:
        self.radio = radio
        self.air: DotsInReach
        self.dots: list[EmulatedDot]
        self.air, self.dots = through(radio, faults)
        sensors = [DotSensor(radio, one) for one in self.air.announced()]
        self.group = DotGroup(radio, sensors, rate_hz, record_hz=record_hz)
        self.sources = self.group.sources()
        self.begin_s = 0.0
        self.decoders = [DotDecoder() for _ in self.sources]
        self.is_open = [False] * len(self.sources)
        self.live: list[list[FloatArray]] = [[] for _ in self.sources]
        self.began: list[int] = []

    def open(self) -> None:
        for source in self.sources:
            source.open()
        for source in self.sources:
            source.read(_nobody_keeps)  # what came while others were opened is before the recording
        self.began = [len(dot.sent) for dot in self.dots]
        self.begin_s = self.radio.now_ns() / 1e9
        for number, (source, decoder) in enumerate(zip(self.sources, self.decoders, strict=True)):
            decoder.begin(source.info)
            self.is_open[number] = True

    def measure(self, seconds: float) -> None:
        until_s = self.radio.loop.time() + seconds
        while self.radio.loop.time() < until_s:
            self.radio.pass_s(0.02)
            for number, source in enumerate(self.sources):
                self._read(number, source)

    def _read(self, number: int, source: DotSource) -> None:
        decoder = self.decoders[number]
        try:
            if not self.is_open[number]:
                source.open()
                self.is_open[number] = True
                decoder.begin(source.info)
            blocks = source.read(lambda data: decoder.feed(data, self.radio.now_ns() / 1e9 - self.begin_s))
            self.live[number] += [block.time_s for block in blocks]
        except (SourceLostError, SourceRefusedError):
            source.close()
            self.is_open[number] = False

    def decoded(self) -> list[DecodedSensor]:
        found = [piece for decoder in self.decoders for piece in decoder.finish().items()]
        return [one for _, one in tied(found)]

    def truth(self, number: int) -> tuple[FloatArray, FloatArray]:
        """Rate and force (n, 6) and instants (n,) of all that a sensor took."""
        sent = self.dots[number].sent
        values = np.array([one[1] for one in sent])
        return np.hstack([values[:, 7:] * RAD, values[:, 4:7]]), np.array([one[2] for one in sent]) / 1e9 - self.begin_s

    def rows(self, number: int, one: DecodedSensor) -> list[int]:
        """Which of them each decoded sample is, by what its clock showed."""
        assert one.clock is not None
        at = {sample[0] % 2**32: row for row, sample in enumerate(self.dots[number].sent)}
        return [at[round(device_s * 1e6) % 2**32] for device_s in one.clock.device_s]

    def has_every_float(self, number: int, one: DecodedSensor) -> bool:
        values, _ = self.truth(number)
        rows = self.rows(number, one)
        return np.array_equal(np.hstack([one.block.gyr_rad_s, one.block.acc_m_s2]), values[rows])


def _nobody_keeps(_data: bytes) -> None:
    """It is not recorded yet."""


def not_there(rows: list[int]) -> int:
    """How many are missing between the first and the last."""
    return rows[-1] - rows[0] + 1 - len(rows)


def opened(
    radio: VirtualRadio,
    faults: Sequence[DotFaults],
    *,
    measured_s: float = 0.0,
    rate_hz: int = 60,
    record_hz: int = 120,
) -> WornDots:
    """Sensors that are open, and have measured for a while."""
    wearing = WornDots(radio, faults, rate_hz, record_hz)
    wearing.open()
    if measured_s:
        wearing.measure(measured_s)
    return wearing

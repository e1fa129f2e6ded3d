"""Samples of a Movella DOT: what its modes send, and how both its streams and its files lie in a journal.

Everything that arrives is kept as it came (`transport/notifications.py`). Stamps are the sensor's own microseconds,
which begin again every 71 minutes; there is no counter, so that loss shows in the stamps.
"""

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass

from devices.clocks.clock import Unwrapping
from devices.dot.messages import Characteristic, DotMessage, DotMessageError, DotNotice
from devices.source import SourceInfo
from devices.stream import Received, Row
from devices.transport.notifications import NotificationFrames

DRIVER, VERSION = "movella-dot", "1"
KNOWN = frozenset(Characteristic)
TICK_HZ, TIME_BITS = 1e6, 32
TURN_S = 2**TIME_BITS / TICK_HZ
HALF_TURN = 1 << (TIME_BITS - 1)
RAD = math.pi / 180.0
PIECES = {0: "I", 1: "4f", 7: "3f", 8: "3f", 10: "H"}  # of a recorded sample, by the numbers that choose them
CHOSEN = tuple(PIECES)
RECORDED = struct.Struct("<" + "".join(PIECES.values()))
NUMBER = struct.Struct("<I")
MOST_SAMPLES = 4_000_000  # three times what a sensor of the second kind holds: 362 min at 60 Hz (revision C)
WORN_M_S2 = (5.0, 20.0)  # median of a leg's specific force; outside it is no force in m/s2


@dataclass(frozen=True, slots=True)
class StreamMode:
    """A mode that a sensor streams in: where it is notified, and in how many bytes."""

    number: int
    characteristic: Characteristic
    shape: struct.Struct
    has_orientation: bool

    def sample(self, payload: bytes) -> "DotSample | None":
        """What a notification contains; None where it is cut or contains what cannot be."""
        if len(payload) < self.shape.size:
            return None
        ticks, *values = self.shape.unpack_from(payload)
        return _sample(ticks, values, self.has_orientation)


@dataclass(frozen=True, slots=True)
class DotSample:
    """Microseconds, angular rate in rad/s (3), specific force in m/s2 (3), orientation, scalar first (4), or none."""

    ticks: int
    rate: tuple[float, ...]
    force: tuple[float, ...]
    orientation: tuple[float, ...]


def _sample(ticks: int, values: Sequence[float], has_orientation: bool) -> DotSample | None:
    if not all(map(math.isfinite, values)):
        return None
    orientation, motion = (values[:4], values[4:]) if has_orientation else ((), values)
    rate = tuple(value * RAD for value in motion[3:6])
    return DotSample(ticks, rate, tuple(motion[:3]), tuple(orientation))


# orientation, acceleration and rate: in Movella's revision C, not in revision F; a sensor that does not know it has 21
FULL = StreamMode(26, Characteristic.LONG, struct.Struct("<I10f"), has_orientation=True)
PLAIN = StreamMode(21, Characteristic.MEDIUM, struct.Struct("<I6f"), has_orientation=False)
MODES = {mode.number: mode for mode in (FULL, PLAIN)}


@dataclass(frozen=True, slots=True)
class RecordedSample:
    """A sample of a file, and its number, counted from 0."""

    number: int
    sample: DotSample

    @classmethod
    def parsed(cls, data: bytes) -> "RecordedSample | None":
        """Of a notice DATA, without its first byte; None where it is not what was chosen or contains what cannot be."""
        if len(data) != NUMBER.size + RECORDED.size:
            return None
        (number,) = NUMBER.unpack_from(data)
        ticks, *values, _status = RECORDED.unpack_from(data, NUMBER.size)
        sample = _sample(ticks, values, has_orientation=True)
        return None if sample is None or number >= MOST_SAMPLES else cls(number, sample)


class DotFramer:
    """See `devices.stream.Framer`: what one sensor streams."""

    def __init__(self, info: SourceInfo) -> None:
        self.received = Received()
        self._frames = NotificationFrames(KNOWN)
        mode = info.settings.get("mode")
        self._mode = MODES.get(mode) if isinstance(mode, int) else None
        self._unwrapping, self._before_s = Unwrapping(TIME_BITS, TICK_HZ), 0.0
        self._is_first = True

    def feed(self, data: bytes, host_s: float) -> None:
        for characteristic, payload in self._frames.feed(data):
            if characteristic == Characteristic.BATTERY and payload:
                self.received.battery = min(payload[0], 100) / 100
            elif self._mode is not None and characteristic == self._mode.characteristic:
                self._take(self._mode.sample(payload), host_s)
            else:
                self.received.skipped += 1
        self.received.damaged += self._frames.newly_damaged()

    def flush(self) -> None:
        self._frames.flush()
        self.received.damaged += self._frames.newly_damaged()

    def _take(self, sample: DotSample | None, host_s: float) -> None:
        if sample is None:
            self.received.damaged += 1
            return
        device_s = self._unwrapping.ticks(sample.ticks, host_s) / TICK_HZ
        if self._is_first:  # so that the clock goes on after a cut, although it may have begun again
            self._is_first, self._before_s = False, round((host_s - device_s) / TURN_S) * TURN_S
        device_s += self._before_s
        self.received.rows.append((device_s, *sample.rate, *sample.force))
        if sample.orientation:
            self.received.orientations.append((device_s, *sample.orientation))


class FileFramer:
    """Samples of a file as they are fetched, some of them again. The first of each number is kept.

    `next`: the number after the highest that was received.
    """

    def __init__(self) -> None:
        self.samples: dict[int, RecordedSample] = {}
        self.next = 0
        self.damaged = 0
        self._frames = NotificationFrames(KNOWN)

    def feed(self, data: bytes) -> None:
        for characteristic, payload in self._frames.feed(data):
            if characteristic == Characteristic.NOTICE:
                self._take(payload)

    def _take(self, payload: bytes) -> None:
        try:
            message = DotMessage.parsed(payload)
        except DotMessageError:
            self.damaged += 1
            return
        if not message.data or message.data[0] != DotNotice.DATA:
            return
        if (one := RecordedSample.parsed(message.data[1:])) is None:
            self.damaged += 1
        else:
            self.samples.setdefault(one.number, one)
            self.next = max(self.next, one.number + 1)

    def cut(self) -> None:
        """What follows does not join what came before."""
        self._frames = NotificationFrames(KNOWN)

    def missing(self) -> tuple[range, ...]:
        """Numbers that were not received, below the highest that was."""
        gaps, expected = [], 0
        for number in sorted(self.samples):
            if number > expected:
                gaps.append(range(expected, number))
            expected = number + 1
        return tuple(gaps)

    def has_forces(self) -> bool:
        """Whether what is named specific force can be a leg's: the maker's printed example changes two names."""
        forces = sorted(math.hypot(*one.sample.force) for one in self.samples.values())
        return not forces or WORN_M_S2[0] < forces[len(forces) // 2] < WORN_M_S2[1]

    def rows(self) -> tuple[list[Row], list[Row]]:
        """Rows and orientations in order, as `Received` has them, the clock going on where it begins again."""
        rows: list[Row] = []
        orientations: list[Row] = []
        ticks, last = 0, None
        for number in sorted(self.samples):
            sample = self.samples[number].sample
            ticks += sample.ticks if last is None else (sample.ticks - last + HALF_TURN) % (2 * HALF_TURN) - HALF_TURN
            last = sample.ticks
            rows.append((ticks / TICK_HZ, *sample.rate, *sample.force))
            orientations.append((ticks / TICK_HZ, *sample.orientation))
        return rows, orientations

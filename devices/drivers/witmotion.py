"""WitMotion's standard protocol: frames of eleven bytes, each with a checksum of one byte.

Source: WIT Standard Communication Protocol, WitMotion. Rate and acceleration come in frames of their own and are paired
by the frame of time before them. There is no counter, so losses show in that time only: it is switched on when the
sensor is opened, until it is switched off. One changed frame of 256 has the right sum all the same.
"""

import math
from collections.abc import Sequence
from datetime import date
from struct import Struct

from core.samples import G_M_S2
from devices.live import SensorDetails, SourceRefusedError
from devices.source import SourceInfo
from devices.stream import Framer, Received, ask, listen
from devices.transport.channels import Channel

DRIVER, VERSION, MODEL = "witmotion", "1", "WitMotion"
EMULATED = "EMULATED"  # how the numbers of our own emulator begin
HEAD, SIZE, KNOWN_AFTER = 0x55, 11, 13
TIME, FORCE, RATE, ANGLES, FIELD, ORIENTATION, REGISTERS = 0x50, 0x51, 0x52, 0x53, 0x54, 0x59, 0x5F
FRAMES = range(0x50, 0x60)
CLOCK, AXES = Struct("<6BH"), Struct("<4h")
FORCE_UNIT, RATE_UNIT, ORIENTATION_UNIT = 16 * G_M_S2 / 32768, math.radians(2000) / 32768, 1 / 32768
UNLOCK = bytes.fromhex("FF AA 69 88 B5")
CONTENT_AT, RATE_AT, READ_AT, NUMBER_AT = 0x02, 0x03, 0x27, 0x7F
CONTENT = 0b1111  # time, force, rate; and angles, since a frame is sure once the next one begins
RATES = {0x03: 1.0, 0x04: 2.0, 0x05: 5.0, 0x06: 10.0, 0x07: 20.0, 0x08: 50.0, 0x09: 100.0, 0x0B: 200.0}
MOST_REPLIES = 16
ANSWERS_S, STATES_S = 0.3, 1.5
ENOUGH_ROWS = 3


def frame(kind: int, payload: bytes) -> bytes:
    """A frame as it is sent; `payload` has eight bytes."""
    stated = bytes([HEAD, kind]) + payload
    return stated + bytes([sum(stated) & 0xFF])


def writing(register: int, value: int) -> bytes:
    """The command that sets a register, or that asks for what begins at `value` (`READ_AT`)."""
    return bytes([0xFF, 0xAA, register, value & 0xFF, value >> 8])


class WitFramer:
    """The `Framer` of a stream of frames.

    What has a right sum by chance, across the beginning of the next frame, gives way to that. So a frame is taken once
    the head of the next one has been seen.
    """

    def __init__(self) -> None:
        self.received = Received()
        self._rest = b""
        self._is_in_step = False
        self._time_s: float | None = None
        self._is_sent = False
        self._force: tuple[float, ...] | None = None
        self._rate: tuple[float, ...] | None = None

    def feed(self, data: bytes, host_s: float) -> None:
        self._rest += data
        self._scan(is_last=False)

    def flush(self) -> None:
        self._scan(is_last=True)
        self._rest = b""

    def _scan(self, is_last: bool) -> None:
        rest, at = self._rest, 0
        while True:
            begin = rest.find(HEAD, at)
            begin = len(rest) if begin < 0 else begin
            self._pass_over(begin - at)
            at = begin
            if len(rest) - at < SIZE:
                break
            if not _is_frame(rest, at):
                self._pass_over(1)
                at += 1
                continue
            if not is_last and len(rest) - at < KNOWN_AFTER:
                break
            if not _is_head(rest, at + SIZE) and (not is_last or len(rest) - at >= KNOWN_AFTER):
                if not is_last and len(rest) - at < KNOWN_AFTER + SIZE:
                    break
                inside = range(at + 1, at + SIZE)
                better = next((k for k in inside if _is_frame(rest, k) and _is_head(rest, k + SIZE)), None)
                if better is not None:
                    self._pass_over(better - at)
                    at = better
                    continue
            self._is_in_step = True
            self._take(rest[at + 1], rest[at + 2 : at + SIZE - 1])
            at += SIZE
        self._rest = rest[at:]

    def _pass_over(self, count: int) -> None:
        if count and self._is_in_step:
            self.received.damaged += 1
            self._is_in_step = False

    def _take(self, kind: int, payload: bytes) -> None:
        match kind:
            case 0x50:
                self._begin(payload)
            case 0x51:
                if self._force is not None or self._is_sent:
                    self._time_s = None  # the frame of time between the two was lost
                self._force = scaled(AXES.unpack(payload)[:3], FORCE_UNIT)
                self._pair()
            case 0x52:
                if self._rate is not None or self._is_sent:
                    self._time_s = None
                self._rate = scaled(AXES.unpack(payload)[:3], RATE_UNIT)
                self._pair()
            case 0x59:
                w, x, y, z = (number * ORIENTATION_UNIT for number in AXES.unpack(payload))
                if self._time_s is not None:
                    self.received.orientations.append((self._time_s, w, x, y, z))
            case 0x5F:
                if len(self.received.replies) < MOST_REPLIES:
                    self.received.replies.append(payload)
            case _:
                self.received.skipped += 1

    def _begin(self, payload: bytes) -> None:
        year, month, day, hour, minute, second, ms = CLOCK.unpack(payload)
        try:
            days = date(2000 + year, month or 1, day or 1).toordinal()
        except ValueError:
            days = -1
        if days < 0 or hour > 23 or minute > 59 or second > 59 or ms > 999:
            self.received.damaged += 1
            self._time_s = None
            return
        self._time_s = days * 86400.0 + hour * 3600 + minute * 60 + second + ms / 1000
        self._is_sent = False
        self._force = self._rate = None

    def _pair(self) -> None:
        if self._time_s is None:
            self.received.skipped += 1  # without a time it is no sample
        elif self._force is not None and self._rate is not None:
            self.received.rows.append((self._time_s, *self._rate, *self._force))
            self._force = self._rate = None
            self._is_sent = True


def _is_frame(rest: bytes, at: int) -> bool:
    return (
        rest[at] == HEAD
        and len(rest) - at >= SIZE
        and rest[at + 1] in FRAMES
        and sum(rest[at : at + SIZE - 1]) & 0xFF == rest[at + SIZE - 1]
    )


def _is_head(rest: bytes, at: int) -> bool:
    return len(rest) - at >= 2 and rest[at] == HEAD and rest[at + 1] in FRAMES


def scaled(numbers: Sequence[int], unit: float) -> tuple[float, ...]:
    """Scale three axes to SI by `FORCE_UNIT` or `RATE_UNIT` (m/s2 or rad/s), by cable and by air alike."""
    return tuple(number * unit for number in numbers)


class WitMotion:
    """The `SensorProtocol` of a WitMotion sensor. What it was set to is forgotten when it is switched off.

    Parameters
    ----------
    rate_hz
        One of `RATES`; None: as its owner set it. A sample takes 44 bytes: 9600 baud carry 20 Hz, 115200 carry 200.

    Raises
    ------
    ValueError
        There is no such rate.
    """

    driver, version = DRIVER, VERSION

    def __init__(self, rate_hz: float | None = None) -> None:
        if rate_hz is not None and rate_hz not in RATES.values():
            raise ValueError(f"rate_hz is {rate_hz}, expected one of {sorted(RATES.values())}")
        self._required_hz = rate_hz

    def framer(self, info: SourceInfo) -> Framer:
        return WitFramer()

    def identifying(self) -> bytes:
        return b""

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        framer = WitFramer()
        channel.write(UNLOCK)
        channel.write(writing(CONTENT_AT, CONTENT))
        if self._required_hz is not None:
            channel.write(writing(RATE_AT, next(code for code, hz in RATES.items() if hz == self._required_hz)))
        number = (_registers(channel, framer, NUMBER_AT) + _registers(channel, framer, NUMBER_AT + 4)[:4]).strip(b"\0 ")
        code = _registers(channel, framer, RATE_AT)[:1]
        rate_hz = RATES.get(code[0]) if code else None
        listen(channel, framer, lambda received: b"enough" if len(received.rows) >= ENOUGH_ROWS else b"", STATES_S)
        if not framer.received.rows:
            raise _refusal(channel.place, is_received=framer.received.skipped > 0)
        serial = number.decode("ascii", "replace") if number.isalnum() else ""
        sensor = serial or channel.serial or channel.place
        settings = {"rate_hz": rate_hz} if rate_hz else {}
        info = SourceInfo(DRIVER, VERSION, serial, (sensor,), settings, is_simulated=serial.startswith(EMULATED))
        return info, SensorDetails(MODEL, serial, "", rate_hz)


def _registers(channel: Channel, framer: WitFramer, first: int) -> bytes:
    """Eight bytes of four registers from `first` on; empty where the sensor does not answer."""
    framer.received.replies.clear()
    return ask(channel, framer, writing(READ_AT, first), lambda _reply: True, ANSWERS_S)


def _refusal(place: str, is_received: bool) -> SourceRefusedError:
    if is_received:
        return SourceRefusedError(
            "The sensor at {place} sends no timestamps, so lost samples would go unnoticed",
            "Switch on its time output with the manufacturer's program",
            place=place,
        )
    return SourceRefusedError(
        "No signal from a WitMotion sensor at {place}",
        "Check that it is switched on, and check its baud rate",
        place=place,
    )

"""Driver of Shimmer3 sensors (LogAndStream firmware, Bluetooth serial): commands, and what their packets hold.

    00 time (3 bytes, 32768 Hz) channels in the order that an inquiry reports [checksum (2 bytes)]

Raw numbers become units by the calibration that each sensor carries: C = R^-1 K^-1 (U - B), alignment R, sensitivity K,
offset B (Ferraris, Grimaldi & Parvis 1995, Procedure for effortless in-field calibration of three-axial rate gyro and
accelerometers, Sensors and Materials 7:311-330). Packets carry a checksum from LogAndStream 0.15 on. Before, the time
must lie on the sampling clock's grid: a changed value within such a packet is not noticed, and one packet in a thousand
beside damaged ones is given up with them.
"""

import struct
import time
from binascii import crc_hqx
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from core.samples import FloatArray, RateKind
from devices.clocks.clock import Unwrapping
from devices.live import SensorDetails, SourceRefusedError
from devices.source import SourceInfo
from devices.stream import Received
from devices.transport.channels import Channel

DRIVER, VERSION = "shimmer3", "1"
EMULATED = "emulated Shimmer3"  # how the names of our own emulators begin
TICK_HZ, TIME_BITS = 32768, 24
TURN = 1 << TIME_BITS
# 102.4 and 204.8 Hz: of the rates that Consensys offers, those next to 100 and 200; between them its owner's is kept
SLOWEST_PERIOD, FASTEST_PERIOD = 320, 160
ANSWERS_S = 1.0  # a Bluetooth link may wake up first
QUIET_S, STOPS_S = 0.15, 2.0


class Command:
    """What is sent, and the first byte of what is answered."""

    PACKET = 0x00
    INQUIRY, INQUIRY_ANSWER = 0x01, 0x02
    RATE, RATE_ANSWER = 0x03, 0x04
    SET_RATE = 0x05
    TOGGLE_LED = 0x06
    START = 0x07
    SET_SENSORS = 0x08
    SET_ACC_RANGE = 0x09
    STOP = 0x20
    CALIBRATION, CALIBRATION_ANSWER = 0x2C, 0x2D
    FIRMWARE, FIRMWARE_ANSWER = 0x2E, 0x2F
    SET_ACC_RATE = 0x40
    SET_ACC_LOW_POWER = 0x43
    SET_ACC_FINE = 0x46
    SET_GYR_RANGE = 0x49
    SET_GYR_RATE = 0x4C
    NAME_ANSWER, NAME = 0x7A, 0x7B
    SET_CHECKSUM = 0x8B
    REFUSED, DONE = 0xFE, 0xFF


# it is silent until it is asked to stream; this asks for its firmware, and is answered so where that is LogAndStream
KNOCK = bytes([Command.FIRMWARE]), bytes([Command.DONE, Command.FIRMWARE_ANSWER, 3, 0])
# wide-range accelerometer, angular rate, battery, as three bytes of switches
SENSORS = bytes([0x40, 0x30, 0x00])
ACC_RANGE = 3  # 16 g on boards of the first generations, 8 g on later ones: a landing foot brings more than 4 g
GYR_RANGE = 3  # 2000 deg/s
ACC_RATE = 7  # 400 Hz or more, on either board
GYR_BASE_HZ = 8000
BATTERY, ACC, GYR = 0x03, (0x04, 0x05, 0x06), (0x0A, 0x0B, 0x0C)
SIZES = {  # bytes of a channel
    **dict.fromkeys(range(0x29), 2),
    **dict.fromkeys((0x1B, 0x1E, 0x1F, 0x21, 0x22), 3),
    **dict.fromkeys((0x1D, 0x20), 1),
}
CALIBRATION_SIZE = 21  # of one of four: low-noise accelerometer, rate, field, wide-range accelerometer
CALIBRATION_SHAPE = struct.Struct(">6h9b")
GYR_CALIBRATION, ACC_CALIBRATION = 1, 3
HEAD = 4  # a packet's first byte, and its time
CHECKSUM_SINCE = (0, 15, 0)
CHECKSUM_SEED = 0xB0CA
BATTERY_STEP = 7  # a hundredth of a volt
CUT_STEPS = 8  # so many packets may be damaged in a row
MOST_STEPS_S = 2.0  # so long a packet without a checksum is known by the last one's time; then by two together
VOLTS, CHARGE = (3.3, 3.6, 3.7, 3.8, 3.95, 4.15), (0.0, 0.1, 0.3, 0.5, 0.75, 1.0)  # of a lithium cell at rest, about


def checksum(data: bytes) -> bytes:
    """Of a whole packet, as the firmware computes it: CCITT over an even number of bytes, low byte first."""
    return crc_hqx(data + bytes(len(data) % 2), CHECKSUM_SEED).to_bytes(2, "little")


def calibrating(block: bytes, scale: float) -> tuple[FloatArray, FloatArray]:
    """Give offset (3,) and matrix (3, 3) of `matrix @ (raw - offset)`; ValueError without a calibration."""
    numbers = np.array(CALIBRATION_SHAPE.unpack(block), dtype=float)
    offset, sensitivity, alignment = numbers[:3], numbers[3:6] / scale, numbers[6:].reshape(3, 3) / 100
    if not sensitivity.all() or abs(np.linalg.det(alignment)) < 0.1:
        raise ValueError("no calibration is stored")
    return offset, np.linalg.inv(alignment) @ np.diag(1 / sensitivity)


class Shimmer3Framer:
    """See `devices.stream.Framer`. Without what an inquiry reports, nothing is understood."""

    def __init__(self, info: SourceInfo) -> None:
        self.received = Received()
        self._held = b""
        self._host_s = 0.0
        self._is_lost = False
        self._unwrapping, self._before = Unwrapping(TIME_BITS, TICK_HZ), 0
        self._shape = _Shape(info.settings) if "channels" in info.settings else None
        self._last: int | None = None
        self._battery_raw = 0

    def feed(self, data: bytes, host_s: float) -> None:
        self._host_s = host_s
        if self._shape is not None:
            self._cut(self._shape, self._held + data, is_end=False)

    def flush(self) -> None:
        if self._shape is not None:
            self._cut(self._shape, self._held, is_end=True)
        self._held = b""

    def _cut(self, shape: "_Shape", held: bytes, is_end: bool) -> None:
        at, size = 0, shape.size
        while len(held) - at >= size:
            is_packet = self._is_packet(shape, held, at, is_end)
            if is_packet is None:
                break  # the next one shows it
            if is_packet:
                self._take(shape, held, at)
                at += size
            else:
                self._pass_over(held[at])
                at += 1
        if is_end:
            for byte in held[at:]:
                self._pass_over(byte)
        self._held = held[at:]

    def _is_packet(self, shape: "_Shape", held: bytes, at: int, is_end: bool) -> bool | None:
        """None: that cannot be known yet."""
        if held[at] != Command.PACKET:
            return False
        if shape.has_checksum:
            return shape.is_whole(held, at) and self._is_meant(shape, held, at, is_end)
        following = at + shape.size
        ticks = _ticks(held, at)
        is_due = self._last is not None and shape.is_step(ticks - self._last, round(MOST_STEPS_S * TICK_HZ))
        if len(held) < following + HEAD:
            return is_due if is_end else None
        if held[following] == Command.PACKET and shape.is_step(_ticks(held, following) - ticks, shape.period):
            return True
        return is_due and shape.find_due(held, at, ticks) < 0

    def _is_meant(self, shape: "_Shape", held: bytes, at: int, is_end: bool) -> bool | None:
        """Whether a checksum is right not just by chance, as one in 65 536 beside damage; None: not known yet."""
        if self._last is None:
            return True
        inner = shape.find_due(held, at, self._last)
        if inner < 0:
            is_due = shape.is_step(_ticks(held, at) - self._last, round(MOST_STEPS_S * TICK_HZ))
            if is_due or not self._is_lost:
                return True
            inner = at + shape.size  # after a long loss any time may be right: the next packet shows it
        if len(held) < inner + shape.size:
            return True if is_end else None
        return shape.is_whole(held, inner) == (inner == at + shape.size)

    def _take(self, shape: "_Shape", held: bytes, at: int) -> None:
        counter = _ticks(held, at)
        ticks = self._unwrapping.ticks(counter, self._host_s)
        if self._last is None:  # so that the clock goes on after a cut, although it begins again every 512 s
            self._before = round((self._host_s * TICK_HZ - ticks) / TURN) * TURN
        self._last, self._is_lost = counter, False
        self.received.rows.append(((self._before + ticks) / TICK_HZ, *shape.gyr(held, at), *shape.acc(held, at)))
        if not shape.battery_at:
            return
        raw = held[at + shape.battery_at] | held[at + shape.battery_at + 1] << 8
        if abs(raw - self._battery_raw) > BATTERY_STEP:
            self._battery_raw = raw  # half its voltage as a share of 3 V
            self.received.battery = float(np.interp(raw / 4095 * 3.0 * 1.988, VOLTS, CHARGE))

    def _pass_over(self, byte: int) -> None:
        if not self._is_lost and byte != Command.DONE:  # the answer to a command is between packets
            self.received.damaged += 1
        self._is_lost = True


class _Shape:
    """Where things are in a packet, and what they mean."""

    def __init__(self, settings: Mapping[str, object]) -> None:
        channels, period = settings.get("channels"), settings.get("period_ticks")
        blocks = settings.get("gyr_calibration"), settings.get("acc_calibration")
        if not isinstance(channels, Sequence) or not isinstance(period, int):
            raise ValueError(f"a {DRIVER} stream cannot be read without its channels and its rate")
        self.has_checksum = bool(settings.get("has_checksum"))
        self.period = period
        places, at = {}, HEAD
        for channel in channels:
            places[channel] = at
            at += SIZES[channel]
        self.size = at + 2 * self.has_checksum
        self.padding = bytes(at % 2)
        self.battery_at = places.get(BATTERY, 0)
        self.gyr = _vector(">3h", places[GYR[0]], *calibrating(bytes.fromhex(str(blocks[0])), 100.0 * np.pi / 180))
        self.acc = _vector("<3h", places[ACC[0]], *calibrating(bytes.fromhex(str(blocks[1])), 1.0))
        self._slack = max(period // 16, 2)  # ticks

    def is_step(self, ticks: int, most: int) -> bool:
        """Whether two times are whole sampling intervals apart, but no more than `most` ticks."""
        ticks %= TURN
        steps = (ticks + self._slack) // self.period
        return steps > 0 and ticks <= most + self._slack and ticks - steps * self.period <= self._slack

    def is_whole(self, held: bytes, at: int) -> bool:
        """Whether the checksum of what is at `at` is right, in full length."""
        end = at + self.size
        checksum = held[end - 2] | held[end - 1] << 8
        return held[at] == Command.PACKET and crc_hqx(held[at : end - 2] + self.padding, CHECKSUM_SEED) == checksum

    def find_due(self, held: bytes, at: int, last: int) -> int:
        """Where within the packet at `at` one begins that is due after one of the time `last`; -1 if none does."""
        end = min(at + self.size, len(held) - HEAD + 1)
        start = held.find(Command.PACKET, at + 1, end)
        while start >= 0:
            if self.is_step(_ticks(held, start) - last, CUT_STEPS * self.period):
                return start
            start = held.find(Command.PACKET, start + 1, end)
        return -1


def _vector(
    shape: str, place: int, offset: FloatArray, matrix: FloatArray
) -> Callable[[bytes, int], tuple[float, float, float]]:
    """What takes three numbers out of a packet and calibrates them: nine products are done sooner than NumPy begins."""
    unpack = struct.Struct(shape).unpack_from
    (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()
    x0, y0, z0 = offset.tolist()

    def taken(held: bytes, at: int) -> tuple[float, float, float]:
        x, y, z = unpack(held, at + place)
        x, y, z = x - x0, y - y0, z - z0
        return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z

    return taken


def _ticks(held: bytes, at: int) -> int:
    return held[at + 1] | held[at + 2] << 8 | held[at + 3] << 16


class Shimmer3:
    """A Shimmer3 with wide-range accelerometer and gyroscope, paired with this computer.

    Parameters
    ----------
    rate_hz
        The nearest that its clock can be divided to is set; None: as its owner set it, but 102.4 Hz at least and 204.8
        at most.
    """

    driver, version = DRIVER, VERSION

    def __init__(self, rate_hz: float | None = None) -> None:
        self._required_period = round(TICK_HZ / rate_hz) if rate_hz else 0

    def framer(self, info: SourceInfo) -> Shimmer3Framer:
        return Shimmer3Framer(info)

    def greet(self, channel: Channel) -> tuple[SourceInfo, SensorDetails]:
        talk = _Talk(channel)
        talk.quieten()
        firmware = talk.asked(Command.FIRMWARE, Command.FIRMWARE_ANSWER, lambda _: 6)
        if not firmware:
            raise SourceRefusedError(
                "No Shimmer3 responds at {place}",
                "Check that it is switched on, paired and not in its dock",
                place=channel.place,
            )
        name = talk.asked(Command.NAME, Command.NAME_ANSWER, lambda stated: 1 + stated[0])[1:].decode(
            "ascii", "replace"
        )
        kind, major, minor, internal = struct.unpack("<HHBB", firmware)
        period = self._required_period or _owned_period(talk)
        if not name or not all(talk.commanded(bytes(wish)) for wish in _wishes(period)):
            raise _unwilling(channel)
        calibration = talk.asked(Command.CALIBRATION, Command.CALIBRATION_ANSWER, lambda _: 4 * CALIBRATION_SIZE)
        inquiry = talk.asked(Command.INQUIRY, Command.INQUIRY_ANSWER, lambda stated: 8 + stated[6])
        if not calibration or not inquiry:
            raise _unwilling(channel)
        blocks = [calibration[k * CALIBRATION_SIZE :][:CALIBRATION_SIZE] for k in (GYR_CALIBRATION, ACC_CALIBRATION)]
        has_checksum = kind == 3 and (major, minor, internal) >= CHECKSUM_SINCE
        settings: dict[str, object] = {
            "rate_hz": TICK_HZ / period,
            "period_ticks": period,
            "channels": list(inquiry[8:]),
            "has_checksum": has_checksum,
            "gyr_calibration": blocks[0].hex(),
            "acc_calibration": blocks[1].hex(),
        }
        try:
            _Shape(settings)
        except KeyError as problem:  # channels that were not asked for
            raise _unwilling(channel) from problem
        except (ValueError, struct.error) as problem:
            raise SourceRefusedError(
                "The Shimmer3 at {place} has no calibration",
                "Calibrate it in Consensys, then search again",
                place=channel.place,
            ) from problem
        if has_checksum:
            talk.commanded(bytes([Command.SET_CHECKSUM, 2]))
        channel.write(bytes([Command.START]))
        version = f"LogAndStream {major}.{minor}.{internal}" if kind == 3 else f"{major}.{minor}.{internal}"
        info = SourceInfo(DRIVER, VERSION, name, (name,), settings, is_simulated=name.startswith(EMULATED))
        return info, SensorDetails("Shimmer3", name, version, TICK_HZ / period, RateKind.INSTANTANEOUS)

    def identifying(self) -> bytes:
        return bytes([Command.TOGGLE_LED])


def _owned_period(talk: "_Talk") -> int:
    """How far apart its owner let it sample, in ticks, where that is of use; else the nearest that is."""
    period = int.from_bytes(talk.asked(Command.RATE, Command.RATE_ANSWER, lambda _: 2), "little")
    return min(max(period or SLOWEST_PERIOD, FASTEST_PERIOD), SLOWEST_PERIOD)


def _wishes(period: int) -> Sequence[tuple[int, ...]]:
    return (
        (Command.SET_RATE, *period.to_bytes(2, "little")),
        (Command.SET_GYR_RANGE, GYR_RANGE),
        (Command.SET_GYR_RATE, max(GYR_BASE_HZ * period // TICK_HZ - 1, 0)),
        (Command.SET_ACC_RANGE, ACC_RANGE),
        (Command.SET_ACC_RATE, ACC_RATE),
        (Command.SET_ACC_LOW_POWER, 0),
        (Command.SET_ACC_FINE, 1),
        (Command.SET_SENSORS, *SENSORS),
    )


class _Talk:
    """Commands and answers, while it does not stream."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel

    def quieten(self) -> None:
        """Stop what an earlier program left running, and hear it out."""
        for command in ([Command.STOP], [Command.SET_CHECKSUM, 0]):
            self._channel.write(bytes(command))
            until_s = time.monotonic() + STOPS_S
            quiet_s = time.monotonic() + QUIET_S
            while time.monotonic() < min(until_s, quiet_s):
                if self._channel.read():
                    quiet_s = time.monotonic() + QUIET_S

    def commanded(self, command: bytes) -> bool:
        """Whether it did as it was asked."""
        self._channel.write(command)
        return self._received(lambda stated: stated[:1])[:1] == bytes([Command.DONE])

    def asked(self, command: int, answer: int, size: Callable[[bytes], int]) -> bytes:
        """What it answers, behind the answer's first byte, `size` telling how long; empty where it does not."""
        self._channel.write(bytes([command]))
        begin = bytes([Command.DONE, answer])

        def whole(stated: bytes) -> bytes:
            start = stated.find(begin)
            rest = stated[start + 2 :] if start >= 0 else b""
            try:
                return rest[: size(rest)] if rest and len(rest) >= size(rest) else b""
            except IndexError:
                return b""

        return self._received(whole)

    def _received(self, found: Callable[[bytes], bytes]) -> bytes:
        stated, until_s = b"", time.monotonic() + ANSWERS_S
        while time.monotonic() < until_s:
            stated += self._channel.read()
            if answer := found(stated):
                return answer
        return b""


def _unwilling(channel: Channel) -> SourceRefusedError:
    return SourceRefusedError(
        "The Shimmer3 at {place} did not accept its settings",
        "Put it into its dock and take it out, then search again",
        place=channel.place,
    )

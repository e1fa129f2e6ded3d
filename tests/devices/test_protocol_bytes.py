"""Tests that bytes written by hand, as in the makers' documents, become the right numbers in the right order.

Nothing of what is expected comes from the drivers or from our emulators, which share their tables: commands, frames and
calibrations are literal bytes, and no two axes of a sample are alike.
"""

import struct
from collections.abc import Sequence

import numpy as np
import pytest

from core.samples import RateKind
from devices.drivers.shimmer3 import Shimmer3, Shimmer3Framer
from devices.drivers.witmotion import WitFramer, WitMotion
from devices.drivers.xbus import values
from devices.drivers.ximu3 import Ximu3, Ximu3Framer
from devices.drivers.xsens_mti import MtiFramer, XsensMti
from devices.live import SensorDetails, SourceRefusedError
from devices.source import SourceInfo
from devices.stream import Framer
from tests.devices.scripted import ScriptedChannel

DEG = 0.017453292519943295  # rad
G_M_S2 = 9.80665


def row_of(framer: Framer, data: bytes) -> Sequence[float]:
    """The only sample in `data`: time, rate (3), force (3)."""
    framer.feed(data, 0.0)
    framer.flush()
    (row,) = framer.received.rows
    return row


# Shimmer3: LogAndStream for Shimmer3, Firmware User Manual; Shimmer3 9DoF Calibration User Manual

# big-endian offset (3), sensitivity (3), then alignment (9) in hundredths, row by row
SHIMMER_RATE_CALIBRATION = struct.pack(
    ">6h9b",
    10,
    -20,
    30,
    1640,
    820,
    3280,
    *(0, 100, 0),
    *(0, 0, 100),
    *(100, 0, 0),  # 16.4, 8.2, 32.8 per deg/s
)
SHIMMER_FORCE_CALIBRATION = struct.pack(
    ">6h9b",
    7,
    -8,
    9,
    400,
    200,
    100,
    *(0, -100, 0),
    *(100, 0, 0),
    *(0, 50, 100),  # per m/s2
)
SHIMMER_CHANNELS = bytes.fromhex("0A 0B 0C 03 04 05 06")  # rate, battery, wide-range accelerometer


class ScriptedShimmer:
    """Answers the commands of LogAndStream 0.15.0 by literal bytes; notes what it is set to."""

    def __init__(self) -> None:
        other = struct.pack(">6h9b", 1, 2, 3, 100, 100, 100, 100, 0, 0, 0, 100, 0, 0, 0, 100)
        blocks = other + SHIMMER_RATE_CALIBRATION + other + SHIMMER_FORCE_CALIBRATION
        self.answers = {
            0x2E: bytes.fromhex("FF 2F 03 00 00 00 0F 00"),
            0x7B: bytes.fromhex("FF 7A 02 53 31"),
            0x03: bytes.fromhex("FF 04 40 01"),
            0x2C: bytes.fromhex("FF 2D") + blocks,
            0x01: bytes.fromhex("FF 02 40 01 00 00 00 00 07 01") + SHIMMER_CHANNELS,
        }
        self.commands: list[bytes] = []

    def __call__(self, data: bytes) -> bytes:
        self.commands.append(data)
        return self.answers.get(data[0], b"\xff") if data[0] != 0x20 else b""


@pytest.fixture
def shimmer(monkeypatch: pytest.MonkeyPatch) -> tuple[ScriptedShimmer, SourceInfo, SensorDetails]:
    monkeypatch.setattr("devices.drivers.shimmer3.QUIET_S", 0.001)
    stated = ScriptedShimmer()
    return stated, *Shimmer3().greet(ScriptedChannel(answers=stated))


def test_a_shimmer_is_set_to_the_ranges_that_a_walk_needs(
    shimmer: tuple[ScriptedShimmer, SourceInfo, SensorDetails],
) -> None:
    stated, info, reported = shimmer
    required = [
        "05 40 01",  # sampling rate: 32768 / 320 = 102.4 Hz
        "49 03",  # gyroscope: 2000 deg/s
        "4C 4D",  # gyroscope: 8000 / 78 = 102.6 Hz, the least that is not slower
        "09 03",  # wide-range accelerometer: 16 g, or 8 g on later boards
        "40 07",  # wide-range accelerometer: 400 Hz
        "43 00",  # no low power
        "46 01",  # high resolution
        "08 40 30 00",  # gyroscope; battery and wide-range accelerometer
        "8B 02",  # checksums of two bytes
    ]
    for command in required:
        assert bytes.fromhex(command) in stated.commands, command
    assert stated.commands[-1] == b"\x07"  # start
    assert info.sensors == ("S1",)
    assert (reported.rate_hz, reported.rate_kind, reported.firmware) == (
        102.4,
        RateKind.INSTANTANEOUS,
        "LogAndStream 0.15.0",
    )
    assert not info.is_simulated


def test_a_shimmers_alignment_is_undone_and_not_applied_again(
    shimmer: tuple[ScriptedShimmer, SourceInfo, SensorDetails],
) -> None:
    """Raw = K R C + B of true rates C = (30, 10, 20) deg/s and forces (3, -2, 10) m/s2.

    R of the rate moves x to y, y to z and z to x: R C = (10, 20, 30); of the force it is (2, 3, 9).
    """
    _, info, _ = shimmer
    rate = struct.pack(">3h", 10 + 164, -20 + 164, 30 + 984)
    force = struct.pack("<3h", 7 + 800, -8 + 600, 9 + 900)
    packet = bytes.fromhex("00 00 80 00") + rate + struct.pack("<H", 2600) + force  # 32768 ticks: a second
    row = row_of(Shimmer3Framer(info), packet + crc_of(packet))
    assert row[0] == pytest.approx(1.0)
    assert row[1:4] == pytest.approx((30 * DEG, 10 * DEG, 20 * DEG))
    assert row[4:] == pytest.approx((3.0, -2.0, 10.0))


def crc_of(packet: bytes) -> bytes:
    """CCITT, seed 0xB0CA, of an even number of bytes, low byte first; bit by bit."""
    crc = 0xB0CA
    for byte in packet + bytes(len(packet) % 2):
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ (0x1021 if crc & 0x8000 else 0)
            crc &= 0xFFFF
    return crc.to_bytes(2, "little")


# WitMotion: WIT Standard Communication Protocol


def wit(kind: int, payload: str) -> bytes:
    body = bytes([0x55, kind]) + bytes.fromhex(payload)
    return body + bytes([sum(body) % 256])


WIT_TIME = wit(0x50, "1A 01 02 03 04 05 A6 02")  # 2026-01-02 03:04:05.678


def test_witmotions_axes_stand_in_their_order_in_its_units() -> None:
    """Full scale is 16 g and 2000 deg/s: 0x1000 of 0x8000 an eighth of it."""
    force, rate = wit(0x51, "00 10 00 E0 00 30 00 00"), wit(0x52, "00 08 00 F0 00 18 00 00")
    row = row_of(WitFramer(), WIT_TIME + force + rate)
    assert row[1:4] == pytest.approx((125 * DEG, -250 * DEG, 375 * DEG))
    assert row[4:] == pytest.approx((2 * G_M_S2, -4 * G_M_S2, 6 * G_M_S2))


def test_witmotions_orientation_is_scalar_first() -> None:
    framer = WitFramer()
    framer.feed(WIT_TIME + wit(0x59, "00 40 00 C0 00 20 00 60"), 0.0)
    framer.flush()
    ((_, *q),) = framer.received.orientations
    assert q == pytest.approx((0.5, -0.5, 0.25, 0.75))


@pytest.mark.parametrize(
    ("rate_hz", "code"),
    [(1, "03"), (2, "04"), (5, "05"), (10, "06"), (20, "07"), (50, "08"), (100, "09"), (200, "0B")],
)
def test_a_witmotion_is_reported_its_rate_and_what_to_send(
    rate_hz: float, code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("devices.drivers.witmotion.ANSWERS_S", 0.0)
    monkeypatch.setattr("devices.drivers.witmotion.STATES_S", 0.0)
    channel = ScriptedChannel()
    with pytest.raises(SourceRefusedError):
        WitMotion(rate_hz=rate_hz).greet(channel)
    unlock, content, rate = channel.written[:3]
    assert unlock == bytes.fromhex("FF AA 69 88 B5")
    assert content == bytes.fromhex("FF AA 02 0F 00")  # time, force, rate, angles
    assert rate == bytes.fromhex(f"FF AA 03 {code} 00")


# x-IMU3: x-IMU3 User Manual


def test_ximu3s_axes_stand_in_their_order_in_si_units() -> None:
    numbers = (1.5, -2.5, 3.5, 0.25, -0.5, 0.75)
    text = b"I,1500000,1.5,-2.5,3.5,0.25,-0.5,0.75\r\n"
    binary = b"\xc9" + struct.pack("<Q6f", 1_500_000, *numbers) + b"\n"
    for stated in (text, binary):
        row = row_of(Ximu3Framer(), stated)
        assert row[0] == 1.5
        assert row[1:4] == pytest.approx((1.5 * DEG, -2.5 * DEG, 3.5 * DEG))
        assert row[4:] == pytest.approx((0.25 * G_M_S2, -0.5 * G_M_S2, 0.75 * G_M_S2))


def test_ximu3s_orientation_is_scalar_first() -> None:
    framer = Ximu3Framer()
    framer.feed(b"Q,1500000,0.1,0.3,-0.5,0.8062\r\n", 0.0)
    assert framer.received.orientations == [(1.5, 0.1, 0.3, -0.5, 0.8062)]


@pytest.mark.parametrize("axis", range(6))
def test_what_an_ximu3_can_measure_is_received_and_more_is_damage(axis: int) -> None:
    """2000 deg/s and 16 g, and a fifth more that its calibration may add."""
    within, beyond = (2390.0, 2410.0) if axis < 3 else (19.9, 20.1)
    for sign in (1, -1):
        for value, count in ((within, 1), (beyond, 0)):
            numbers = [0.0] * 6
            numbers[axis] = sign * value
            framer = Ximu3Framer()
            framer.feed(b"\nI,1," + ",".join(map(str, numbers)).encode() + b"\r\n", 0.0)
            assert (len(framer.received.rows), framer.received.damaged) == (count, 1 - count)


def test_an_ximu3s_battery_is_a_share() -> None:
    for percent, share in ((0.0, 0.0), (84.0, 0.84), (100.0, 1.0), (101.0, 1.0)):
        framer = Ximu3Framer()
        framer.feed(f"B,1,{percent},3.9,0\r\n".encode(), 0.0)
        assert framer.received.battery == pytest.approx(share)


@pytest.mark.parametrize(("rate_hz", "divisor"), [(400, 1), (200, 2), (100, 4), (50, 8)])
def test_an_ximu3_is_reported_a_divisor_of_400_hz(rate_hz: float, divisor: int) -> None:
    def answers(data: bytes) -> bytes:
        if b"ping" in data:
            return b'{"ping":{"interface":"USB","name":"x-IMU3","sn":"655782F7"}}\r\n'
        return data[:-1].replace(b"null", f"{divisor}".encode()) + b"\r\n"

    channel = ScriptedChannel(answers=answers)
    info, reported = Ximu3(rate_hz=rate_hz).greet(channel)
    assert f'{{"inertial_message_rate_divisor":{divisor}}}\n'.encode() in channel.written
    assert (info.sensors, info.is_simulated, reported.rate_hz) == (("655782F7",), False, rate_hz)


# Xsens: MT Low Level Communication Protocol Documentation

MTI = SourceInfo("xsens-mti", "1", "0123", ("MTi 0123",), {"rate_hz": 100.0})
# counter 7; fine time 25000 x 100 us; quaternion (0.5, -0.5, 0.1, 0.7); acceleration (1.5, -2.5, 9.75) m/s2;
# rate of turn (0.25, -0.5, 0.75) rad/s
MT_DATA2 = bytes.fromhex(
    "FA FF 36 3D 10 20 02 00 07 10 60 04 00 00 61 A8 20 10 10 3F 00 00 00 BF 00 00 00 3D CC CC CD 3F 33 33 33"
    "40 20 0C 3F C0 00 00 C0 20 00 00 41 1C 00 00 80 20 0C 3E 80 00 00 BF 00 00 00 3F 40 00 00 D0"
)


def test_an_xsens_message_states_rate_and_acceleration_in_their_order() -> None:
    framer = MtiFramer(MTI)
    row = row_of(framer, MT_DATA2)
    assert row[0] == pytest.approx(2.5)
    assert row[1:4] == (0.25, -0.5, 0.75)
    assert row[4:] == (1.5, -2.5, 9.75)
    ((time_s, *q),) = framer.received.orientations
    assert time_s == pytest.approx(2.5)
    assert q == pytest.approx((0.5, -0.5, 0.1, 0.7))


@pytest.mark.parametrize(
    ("bits", "numbers"),
    [
        (0, "3E 80 00 00 BF 00 00 00 3F 40 00 00"),  # 32 bits, floating
        (1, "00 04 00 00 FF F8 00 00 00 0C 00 00"),  # fixed point 12.20
        (2, "40 00 00 00 00 00 80 00 00 00 FF FF C0 00 00 00 00 00"),  # fixed point 16.32, the fraction first
        (3, "3F D0 00 00 00 00 00 00 BF E0 00 00 00 00 00 00 3F E8 00 00 00 00 00 00"),  # 64 bits, floating
    ],
)
def test_every_format_of_xsens_numbers_is_understood(bits: int, numbers: str) -> None:
    rate, force = bytes.fromhex(numbers), struct.pack(">3f", 1.0, 2.0, 3.0)
    data = bytes.fromhex("10 60 04 00 00 00 0A 40 20 0C") + force + bytes([0x80, 0x20 | bits, len(rate)]) + rate
    body = bytes([0xFF, 0x36, len(data)]) + data
    row = row_of(MtiFramer(MTI), b"\xfa" + body + bytes([-sum(body) % 256]))
    assert row == pytest.approx((0.001, 0.25, -0.5, 0.75, 1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("identifier", "count"),
    [
        (0x0810, 1),  # temperature
        (0x2010, 4),  # quaternion
        (0x2020, 9),  # rotation matrix
        (0x2030, 3),  # Euler angles
        (0x4010, 3),  # velocity change
        (0x4020, 3),  # acceleration
        (0x4030, 3),  # free acceleration
        (0x5020, 1),  # altitude
        (0x5030, 3),  # position
        (0x5040, 2),  # latitude and longitude
        (0x8020, 3),  # rate of turn
        (0x8030, 4),  # orientation change
        (0xC020, 3),  # magnetic field
        (0xD010, 3),  # velocity
    ],
)
def test_every_item_of_real_numbers_has_its_many(identifier: int, count: int) -> None:
    numbers = tuple(0.5 * k for k in range(count))
    data = struct.pack(f">{count}f", *numbers)
    assert values(identifier, data) == numbers
    assert values(identifier | 3, struct.pack(f">{count}d", *numbers)) == numbers
    assert values(identifier, data + bytes(4)) == values(identifier, data[:-1]) == ()


@pytest.mark.parametrize(
    ("identifier", "data", "numbers"),
    [
        (0x1020, "01 02", (258,)),
        (0x1060, "00 01 00 00", (65536,)),
        (0x1070, "00 00 00 07", (7,)),
        (0x3010, "00 01 8B CD", (101325,)),
        (0xE010, "05", (5,)),
        (0xE020, "00 40 00 03", (0x400003,)),
        (0x1010, "00 00 03 E8 07 EA 0B 16 0E 24 05 07", (1000, 2026, 11, 22, 14, 36, 5, 7)),
        (0x7020, "00 00 00 2A 02 00 00 00 00 05 1E 03 00 07 28 01", (42, 2, 0, 0, 0, 0, 5, 30, 3, 0, 7, 40, 1)),
        (0xFFF0, "00 00 00 01", ()),
    ],
)
def test_items_of_whole_numbers_are_understood(identifier: int, data: str, numbers: tuple[int, ...]) -> None:
    assert values(identifier, bytes.fromhex(data)) == numbers


def test_an_xsens_sensor_is_asked_for_rate_acceleration_and_orientation() -> None:
    """0x8020 and 0x4020 at 100 Hz (0x64) with 0x2010, every message with counter 0x1020 and fine time 0x1060."""
    required = bytes.fromhex("10 20 FF FF 10 60 FF FF 40 20 00 64 80 20 00 64 20 10 00 64")
    written: list[bytes] = []

    def answers(data: bytes) -> bytes:
        written.append(data)
        mid, payload = data[2], data[4:-1]
        reported = {0x00: bytes.fromhex("02 80 A1 B2"), 0x1C: b"MTi-630", 0x12: bytes.fromhex("01 08 02 00")}.get(
            mid, payload
        )
        body = bytes([0xFF, mid + 1, len(reported)]) + reported
        return b"\xfa" + body + bytes([-sum(body) % 256])

    info, reported = XsensMti(rate_hz=100.0).greet(ScriptedChannel(answers=answers))
    assert [data[2] for data in written] == [0x30, 0x00, 0x1C, 0x12, 0xC0, 0x10]
    assert written[4][4:-1] == required
    assert (info.serial, info.is_simulated) == ("0280A1B2", False)
    assert (reported.model, reported.firmware, reported.rate_hz, reported.rate_kind) == (
        "MTi-630",
        "1.8.2",
        100.0,
        RateKind.AVERAGED,
    )


def test_an_xsens_orientation_to_north_east_and_down_is_brought_to_an_earth_with_z_up() -> None:
    """A sensor that lies level, its x axis north, z down: in an earth of east, north and up its x axis is y."""
    quaternion = struct.pack(">4f", 1.0, 0.0, 0.0, 0.0)
    data = bytes.fromhex("10 60 04 00 00 00 0A 40 20 0C") + struct.pack(">3f", 0.0, 0.0, -9.81)
    data += bytes.fromhex("80 20 0C") + bytes(12) + bytes.fromhex("20 14 10") + quaternion
    body = bytes([0xFF, 0x36, len(data)]) + data
    framer = MtiFramer(MTI)
    row_of(framer, b"\xfa" + body + bytes([-sum(body) % 256]))
    ((_, w, x, y, z),) = framer.received.orientations
    turned = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    np.testing.assert_allclose(turned, [[0, 1, 0], [1, 0, 0], [0, 0, -1]], atol=1e-9)

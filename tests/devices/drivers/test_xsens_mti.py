"""Tests of reading what an Xsens MTi sends.

The streams are recorded (to the last digit), damaged, or from an emulated sensor.
"""

import math
import random
import re
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.samples import RateKind
from devices.drivers import xbus
from devices.drivers.xbus import REQUESTS, Item, Mid, XbusFramer, item, message, values
from devices.drivers.xsens_mti import DRIVER, EMULATED, VERSION, MtiFramer, XsensMti
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.emulators.xsens_mti import MtiVoice
from devices.source import DecodedSensor, SourceInfo
from devices.stream import ByteSource, Decoder
from devices.transport.ports import PortInfo, SerialPort
from tests.devices.scripted import ScriptedChannel, received_for

CAPTURES = range(1, 6)
KINDS = {
    "PacketCounter": Item.COUNTER,
    "SampleTimeFine": Item.FINE_TIME,
    "SampleTimeCoarse": 0x1070,
    "UTCTime": 0x1010,
    "StatusWord": Item.STATUS,
    "StatusByte": 0xE010,
    "Temperature": 0x0810,
    "EulerAngles": 0x2030,
    "RotationMatrix": 0x2020,
    "Quaternion": Item.QUATERNION,
    "Acceleration": Item.ACCELERATION,
    "FreeAcceleration": 0x4030,
    "DeltaV": Item.VELOCITY_CHANGE,
    "RateOfTurn": Item.RATE,
    "DeltaQ": Item.ROTATION_CHANGE,
    "MagneticField": Item.MAGNETIC_FIELD,
    "BaroPressure": 0x3010,
    "AltitudeEllipsoid": 0x5020,
    "PositionECEF": 0x5030,
    "LatLon": 0x5040,
    "VelocityXYZ": 0xD010,
    "GNSSPVTData": 0x7010,
    "GNSSSatInfo": 0x7020,
}
FORMATS = {"Float32": 0, "FP1220": 1, "FP1632": 2, "Float64": 3}
INFO = SourceInfo(DRIVER, VERSION, "0123", ("MTi 0123",), {"rate_hz": 100.0})

Find = Callable[[str], Path]


def capture(test_data: Find, number: int) -> bytes:
    return test_data(f"vendor_streams/xsens_mti/einride_{number}_output.bin").read_bytes()


def golden_items(text: str) -> Iterator[list[tuple[str, list[str]]]]:
    """What another program understood: messages of names and values."""
    items: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if not line.startswith(" ") and line.endswith(":"):
            name = line[:-1]
            if name.split("(")[0] in ("PacketCounter",) and any(one == name for one, _ in items):
                yield items
                items = []
            items.append((name, []))
        elif line.startswith(" "):
            items[-1][1].append(line.strip())
        elif not line and items:
            yield items
            items = []
    if items:
        yield items


def golden_numbers(name: str, reported: list[str]) -> list[float]:
    if name == "UTCTime":
        year, month, day, hour, minute, second, fraction = re.fullmatch(
            r"(\d+)-(\d+)-(\d+)T(\d+):(\d+):(\d+)\.?(\d*)Z", reported[0]
        ).groups()  # type: ignore[union-attr]  # a text of another form fails the test all the same
        return [int(fraction.ljust(9, "0")), *map(int, (year, month, day, hour, minute, second))]
    if name.startswith("Status"):
        return [int(reported[0], 2)]
    return [float(one.split(":")[-1]) for one in reported]


@pytest.mark.parametrize("number", CAPTURES)
def test_a_recorded_stream_states_what_another_program_read_in_it(test_data: Find, number: int) -> None:
    golden = test_data(f"vendor_streams/xsens_mti/einride_{number}_output.golden").read_text(encoding="utf-8")
    framer = XbusFramer()
    messages = framer.feed(capture(test_data, number))
    expected = list(golden_items(golden))
    assert len(messages) == len(expected) == 100
    assert framer.damaged == 0
    for one, reported in zip(messages, expected, strict=True):
        assert len(one.items) == len(reported)
        for (identifier, data), (name, texts) in zip(one.items.items(), reported, strict=True):
            plain = name.split("(")[0]
            assert identifier & xbus.ITEM_MASK == KINDS[plain], name
            if number_format := re.search(r"(Float32|FP1220|FP1632|Float64)\)", name):
                assert identifier & xbus.FORMAT_MASK == FORMATS[number_format[1]]
            required = golden_numbers(plain, texts)
            got = values(identifier, data)[: len(required)]  # it leaves out the flags of the time and the satellites
            assert list(got) == required, name


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_samples_of_a_recorded_stream_are_ten_milliseconds_apart_whatever_the_satellites_show(
    test_data: Find, number: int
) -> None:
    sensor = decoded(capture(test_data, number))
    assert sensor.counts.received == len(sensor.block) == 96
    assert (sensor.counts.lost, sensor.counts.late, sensor.counts.damaged) == (0, 0, 0)
    assert np.diff(sensor.block.time_s) == pytest.approx(0.01, abs=1e-5)  # the skew is of a second's arrivals
    # it lay still, so that the length of what it felt is gravity's once its filter has settled
    assert np.linalg.norm(sensor.block.acc_m_s2[5:], axis=1) == pytest.approx(9.81, abs=0.1)


def test_a_rate_is_the_mean_over_the_interval_before_its_stamp(test_data: Find) -> None:
    for one in XbusFramer().feed(capture(test_data, 1)):
        found = {identifier & xbus.ITEM_MASK: values(identifier, data) for identifier, data in one.items.items()}
        if Item.RATE in found:
            w, x, y, z = found[Item.ROTATION_CHANGE]
            turned = Rotation.from_quat([x, y, z, w]).as_rotvec()
            assert turned / 0.01 == pytest.approx(np.array(found[Item.RATE]), abs=2e-6)


@pytest.mark.parametrize("number", CAPTURES)
def test_pieces_of_any_size_give_the_same_messages(test_data: Find, number: int) -> None:
    data, chance = capture(test_data, number), random.Random(number)
    framer, found, at = XbusFramer(), [], 0
    while at < len(data):
        size = chance.randrange(1, 200)
        found += framer.feed(data[at : at + size])
        at += size
    assert found == XbusFramer().feed(data)


def test_orientation_is_to_an_earth_with_z_up_whichever_axes_it_has() -> None:
    q_up = Rotation.from_euler("xyz", [0.4, -0.3, 1.1])
    down_from_up = Rotation.from_matrix([[0, 1, 0], [1, 0, 0], [0, 0, -1]])  # north, east, down of east, north, up
    reported = []
    for axes, q in ((0x0, q_up), (0x4, down_from_up * q_up)):
        x, y, z, w = q.as_quat()
        data = b"".join(
            [
                item(Item.FINE_TIME, struct.pack(">I", 1)),
                item(Item.ACCELERATION, struct.pack(">3f", 0, 0, 9.81)),
                item(Item.RATE, struct.pack(">3f", 0, 0, 0)),
                item(Item.QUATERNION | axes | 3, struct.pack(">4d", w, x, y, z)),
            ]
        )
        framer = MtiFramer(INFO)
        framer.feed(message(Mid.MT_DATA2, data), 0.0)
        ((_, w, x, y, z),) = framer.received.orientations
        reported.append(Rotation.from_quat([x, y, z, w]))
    assert (reported[0].inv() * reported[1]).magnitude() < 1e-9
    assert (reported[0].inv() * q_up).magnitude() < 1e-9


def test_without_a_fine_time_the_counter_shows_it_even_where_it_begins_again() -> None:
    framer = MtiFramer(INFO)
    for number in range(65530, 65545):
        data = item(Item.COUNTER, struct.pack(">H", number % 65536))
        data += item(Item.ACCELERATION, bytes(12)) + item(Item.RATE, bytes(12))
        framer.feed(message(Mid.MT_DATA2, data), number / 100.0)
    assert np.diff([row[0] for row in framer.received.rows]) == pytest.approx(0.01)


@pytest.mark.parametrize("wild", [math.nan, math.inf, -1e38, 200.0])
def test_a_rate_that_nobody_turns_at_is_damage_whatever_its_checksum_states(wild: float) -> None:
    framer = MtiFramer(INFO)
    for number, rate_rad_s in enumerate([1.0, wild, 1.0]):
        data = item(Item.COUNTER, struct.pack(">H", number)) + item(Item.ACCELERATION, bytes(12))
        framer.feed(message(Mid.MT_DATA2, data + item(Item.RATE, struct.pack(">3f", 0, 0, rate_rad_s))), 0.0)
    assert [row[3] for row in framer.received.rows] == [1.0, 1.0]
    assert framer.received.damaged == 1


def decoded(data: bytes) -> DecodedSensor:
    """Decode a recorded stream that came as evenly as it was sent."""
    decoding = Decoder(XsensMti())
    decoding.begin(INFO)
    for number, one in enumerate(XbusFramer().feed(data)):
        decoding.feed(message(one.mid, one.data), 100.0 + 0.01 * number)
    return decoding.finish()[INFO.sensors[0]]


def test_a_sensor_that_counts_on_after_a_gap_has_lost_what_is_missing() -> None:
    voice = MtiVoice("0123")
    numbers = [number for number in range(300) if not 100 <= number < 130 and number != 200]
    one = Decoder(XsensMti())
    one.begin(INFO)
    for number in numbers:
        one.feed(voice.sample(number), number / 100.0)
    sensor = one.finish()[INFO.sensors[0]]
    assert (sensor.counts.received, sensor.counts.lost) == (269, 31)
    assert np.diff(sensor.block.time_s).max() == pytest.approx(0.31, abs=1e-3)
    assert sensor.block.q_earth_from_sensor is not None


def test_noise_alone_gives_nothing_and_holds_little() -> None:
    chance, framer = random.Random(3), MtiFramer(INFO)
    for _ in range(200):
        framer.feed(chance.randbytes(1000), 0.0)
    framer.flush()
    assert framer.received.rows == []
    assert framer.received.damaged > 0


@pytest.mark.parametrize("is_restarted", [True, False])
def test_a_gap_is_right_to_a_sample_whether_the_sensors_clock_went_on_or_began_again(is_restarted: bool) -> None:
    voice, one = MtiVoice("0123"), Decoder(XsensMti())
    for begin, first in ((0, 0), (1300, 0 if is_restarted else 1300)):
        one.begin(INFO)
        for number in range(1000):
            one.feed(voice.sample(first + number), 50.0 + (begin + number) / 100.0)
    sensor = one.finish()[INFO.sensors[0]]
    assert (sensor.counts.received, sensor.counts.lost, sensor.counts.damaged) == (2000, 300, 0)
    assert np.diff(sensor.block.time_s).max() == pytest.approx(3.01, abs=1e-6)


# through a real port


@pytest.fixture
def voice() -> MtiVoice:
    return MtiVoice("0280A1B2")


@pytest.fixture
def emulation(voice: MtiVoice, port: Path) -> Iterator[Emulation]:
    one = Emulation(voice, lambda: PseudoTerminal(port))
    yield one
    one.close()


def test_a_sensor_is_set_up_through_a_port_and_its_bytes_are_read_again_alike(
    emulation: Emulation, voice: MtiVoice
) -> None:
    source = ByteSource(XsensMti(rate_hz=200.0), SerialPort(PortInfo(emulation.place)))
    source.open()
    try:
        blocks, kept = received_for(source, 0.6)
    finally:
        source.close()
    assert voice.rate_hz == 200
    assert source.info.is_simulated
    reported = source.details()["MTi 0280A1B2"]
    assert (reported.model, reported.firmware, reported.rate_hz) == (EMULATED, "1.8.2", 200.0)
    assert reported.rate_kind is RateKind.AVERAGED
    live = np.concatenate([block.gyr_rad_s for block in blocks])
    again = Decoder(XsensMti())
    again.begin(source.info)
    for number, data in enumerate(kept):
        again.feed(data, number * 0.015)
    sensor = again.finish()["MTi 0280A1B2"]
    assert len(live) > 50
    assert np.array_equal(sensor.block.gyr_rad_s, live)
    assert (sensor.counts.lost, sensor.counts.damaged) == (0, 0)
    assert not source.identify("MTi 0280A1B2")  # it has no light


def test_a_sensor_without_orientation_is_taken_without(port: Path) -> None:
    voice = MtiVoice(has_orientation=False)
    emulation = Emulation(voice, lambda: PseudoTerminal(port))
    source = ByteSource(XsensMti(), SerialPort(PortInfo(emulation.place)))
    try:
        source.open()
        assert Item.QUATERNION not in voice.settings
        assert source.details()["MTi 0280A1B2"].rate_hz == 100.0
    finally:
        source.close()
        emulation.close()


@pytest.mark.parametrize(
    ("owned_hz", "hz", "has_orientation"), [(50, 100, True), (100, 100, True), (200, 200, False), (400, 200, False)]
)
def test_its_owners_rate_is_kept_where_it_is_of_use(owned_hz: int, hz: int, has_orientation: bool) -> None:
    """115200 baud carry the orientation at 100 Hz, but not at 200."""
    voice = MtiVoice(rate_hz=owned_hz)
    for _ in range(2):  # what was set is its owner's next time
        _, reported = XsensMti().greet(ScriptedChannel(answers=voice.hear))
        assert (voice.rate_hz, reported.rate_hz) == (hz, hz)
        assert (Item.QUATERNION in voice.settings) == has_orientation


def test_a_sensor_that_refuses_its_owners_rate_is_set_to_the_usual_one() -> None:
    voice = MtiVoice(rate_hz=200)

    def answer(data: bytes) -> bytes:
        is_refused = any(one.mid == Mid.OUTPUT and b"\x00\xc8" in one.data for one in XbusFramer(REQUESTS).feed(data))
        return message(Mid.ERROR, b"\x03") if is_refused else voice.hear(data)

    _, reported = XsensMti().greet(ScriptedChannel(answers=answer))
    assert (voice.rate_hz, reported.rate_hz) == (100, 100)

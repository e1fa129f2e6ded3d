"""Tests of reading what a Shimmer3 sends: with and without checksums, damaged or not, through a real port."""

import random
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from devices.drivers.shimmer3 import DRIVER, EMULATED, VERSION, Shimmer3, Shimmer3Framer, calibrating, checksum
from devices.emulators.shimmer3 import ACC_CALIBRATION, CHANNELS, GYR_CALIBRATION, Shimmer3Voice
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.source import SourceInfo
from devices.stream import ByteSource, Decoder
from devices.transport.ports import PortInfo, SerialPort
from tests.devices.scripted import ScriptedChannel, received_for

PERIOD = 320
OLD = (0, 11, 0)


def info(has_checksum: bool) -> SourceInfo:
    settings = {
        "rate_hz": 32768 / PERIOD,
        "period_ticks": PERIOD,
        "channels": list(CHANNELS),
        "has_checksum": has_checksum,
        "gyr_calibration": GYR_CALIBRATION.hex(),
        "acc_calibration": ACC_CALIBRATION.hex(),
    }
    return SourceInfo(DRIVER, VERSION, "S", ("S",), settings)


def streaming(has_checksum: bool) -> Shimmer3Voice:
    voice = Shimmer3Voice()
    voice.period, voice.has_checksum = PERIOD, has_checksum
    return voice


@pytest.mark.parametrize(
    ("count", "reported"),
    [(8, b"\xaa\x48"), (9, b"\x5d\x2a"), (10, b"\x17\x8b"), (11, b"\x4e\x79")],
)
def test_checksums_are_those_that_the_firmware_tests_itself_with(count: int, reported: bytes) -> None:
    assert checksum(bytes(range(1, count + 1))) == reported


def test_raw_numbers_become_units_by_the_sensors_own_calibration() -> None:
    framer = Shimmer3Framer(info(has_checksum=True))
    framer.feed(streaming(True).sample(100), 0.0)
    ((_, *row),) = framer.received.rows
    # alignment, then sensitivity: x and y of the rate change places and turn around
    assert row[:3] == pytest.approx(np.deg2rad([0.0, -(100 - 12) / 16.40, 0.0]))
    assert row[3:] == pytest.approx([0.0, 0.0, 4100 / 419], abs=1e-12)
    assert framer.received.battery == pytest.approx(0.48, abs=0.02)


def test_a_calibration_that_was_never_stored_is_none() -> None:
    for empty in (bytes(21), b"\xff" * 21):
        with pytest.raises(ValueError, match="no calibration"):
            calibrating(empty, 1.0)


@pytest.mark.parametrize("has_checksum", [True, False])
@pytest.mark.parametrize("size", [1, 5, 17, 1000])
def test_pieces_of_any_size_give_the_same_samples(has_checksum: bool, size: int) -> None:
    voice = streaming(has_checksum)
    data = b"".join(voice.sample(number) for number in range(200))
    framer = Shimmer3Framer(info(has_checksum))
    for at in range(0, len(data), size):
        framer.feed(data[at : at + size], 0.0)
    framer.flush()
    assert len(framer.received.rows) == 200
    assert np.diff([row[0] for row in framer.received.rows]) == pytest.approx(PERIOD / 32768)
    assert framer.received.damaged == 0


def test_answers_between_packets_are_no_damage() -> None:
    voice = streaming(True)
    framer = Shimmer3Framer(info(has_checksum=True))
    framer.feed(voice.sample(0) + voice.hear(b"\x06") + voice.sample(1), 0.0)
    assert (len(framer.received.rows), framer.received.damaged, voice.toggled) == (2, 0, 1)


@pytest.mark.parametrize("seconds", [3.0, 700.0])
def test_what_is_missing_is_counted_by_the_clock_even_where_it_begins_again(seconds: float) -> None:
    voice, decoding = streaming(True), Decoder(Shimmer3())
    missing = round(seconds * 32768 / PERIOD)
    decoding.begin(info(has_checksum=True))
    for number in [*range(500), *range(500 + missing, 1000 + missing)]:
        if number == 500 + missing:
            decoding.begin(info(has_checksum=True))
        decoding.feed(voice.sample(number), 1000.0 + number * PERIOD / 32768)
    sensor = decoding.finish()["S"]
    assert (sensor.counts.received, sensor.counts.lost, sensor.counts.damaged) == (1000, missing, 0)


@pytest.mark.parametrize("has_checksum", [True, False])
def test_noise_alone_gives_next_to_nothing(has_checksum: bool) -> None:
    chance, framer = random.Random(5), Shimmer3Framer(info(has_checksum))
    for _ in range(200):
        framer.feed(chance.randbytes(1000), 0.0)
    framer.flush()
    assert len(framer.received.rows) <= 1


def test_a_stream_whose_channels_nobody_reported_is_not_understood() -> None:
    framer = Shimmer3Framer(SourceInfo(DRIVER, VERSION))
    framer.feed(streaming(True).sample(0), 0.0)
    framer.flush()
    assert framer.received.rows == []


# through a real port


@pytest.fixture(params=[(0, 16, 6), OLD])
def emulation(request: pytest.FixtureRequest, port: Path) -> Iterator[Emulation]:
    one = Emulation(Shimmer3Voice(firmware=request.param), lambda: PseudoTerminal(port))
    yield one
    one.close()


@pytest.mark.endurance
def test_a_sensor_is_set_up_through_a_port_and_its_bytes_are_read_again_alike(emulation: Emulation) -> None:
    voice = emulation.voice
    assert isinstance(voice, Shimmer3Voice)
    source = ByteSource(Shimmer3(rate_hz=204.8), SerialPort(PortInfo(emulation.place)))
    source.open()
    try:
        blocks, kept = received_for(source, 0.4)
        assert source.identify(EMULATED)
        more, kept_more = received_for(source, 0.2)
    finally:
        source.close()
    assert (voice.period, voice.toggled) == (160, 1)
    assert source.info.is_simulated
    reported = source.details()[EMULATED]
    assert (reported.model, reported.rate_hz) == ("Shimmer3", 204.8)
    assert reported.battery == pytest.approx(0.48, abs=0.02)
    live = np.concatenate([block.gyr_rad_s for block in blocks + more])
    again = Decoder(Shimmer3())
    again.begin(source.info)
    for number, data in enumerate(kept + kept_more):
        again.feed(data, number * 0.015)
    sensor = again.finish()[EMULATED]
    assert len(live) > 60
    assert np.array_equal(sensor.block.gyr_rad_s[: len(live)], live)
    assert (sensor.counts.lost, sensor.counts.damaged) == (0, 0)


@pytest.mark.parametrize(("owned", "period"), [(640, 320), (200, 200), (160, 160), (64, 160)])
def test_its_owners_rate_is_kept_where_it_is_of_use(owned: int, period: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """51.2 Hz is too slow for a walk, and 512 more than is used."""
    monkeypatch.setattr("devices.drivers.shimmer3.QUIET_S", 0.01)
    voice = Shimmer3Voice(period=owned)
    info, reported = Shimmer3().greet(ScriptedChannel(answers=voice.hear))
    assert voice.period == info.settings["period_ticks"] == period
    assert reported.rate_hz == 32768 / period

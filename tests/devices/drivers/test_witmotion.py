"""WitMotion's frames: paired by their time, resynchronised, and a sensor that is set up through its registers."""

import time
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from devices.drivers.witmotion import CLOCK, DRIVER, FORCE, RATE, TIME, VERSION, WitFramer, WitMotion, frame, writing
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.emulators.witmotion import SWITCHED_ON, WitVoice
from devices.source import SourceInfo
from devices.stream import ByteSource, Decoder
from devices.transport.ports import PortInfo, SerialPort
from tests.devices.scripted import ScriptedChannel

G = 9.80665
ALL = 0b1111


def motion(number: int) -> tuple[float, ...]:
    return (number % 1000, -500.0, 250.0, 8.0, -4.0, 1.0)


def bursts(count: int, content: int = ALL, **settings: float) -> list[bytes]:
    voice = WitVoice("1", motion, content=content, **settings)  # type: ignore[arg-type]  # the rate alone
    return [voice.sample(number) for number in range(count)]


def arrived(*stated: bytes) -> WitFramer:
    framer = WitFramer()
    for piece in stated:
        framer.feed(piece, 0.0)
    framer.flush()
    return framer


def test_the_frames_of_the_protocol() -> None:
    # by hand, as the protocol has them: 16 g, 2000 deg/s, 2026-01-02 03:04:05.678
    stated = bytes.fromhex("55 50 1A 01 02 03 04 05 A6 02 76")
    assert frame(TIME, CLOCK.pack(26, 1, 2, 3, 4, 5, 678)) == stated
    force = frame(FORCE, bytes.fromhex("00 08 00 F8 00 40 C4 09"))
    rate = frame(RATE, bytes.fromhex("00 40 00 C0 00 00 C4 09"))
    (row,) = arrived(stated + force + rate).received.rows
    day = datetime(2026, 1, 2, 3, 4, 5, 678_000)
    assert row[0] == pytest.approx(day.toordinal() * 86400 + 3 * 3600 + 4 * 60 + 5.678, abs=1e-6)
    assert row[1:4] == pytest.approx((np.radians(1000), -np.radians(1000), 0.0))
    assert row[4:] == pytest.approx((G, -G, 8 * G))
    assert writing(0x03, 0x09) == bytes.fromhex("FF AA 03 09 00")


@given(st.lists(st.integers(1, 60)))
def test_it_does_not_matter_how_bytes_are_cut(cuts: list[int]) -> None:
    stated = b"".join(bursts(20))
    stated = stated[:300] + b"\x55\x51\x55" + stated[307:]
    pieces = [stated[a:b] for a, b in zip([0, *np.cumsum(cuts)], [*np.cumsum(cuts), len(stated)], strict=True)]
    whole, cut = arrived(stated).received, arrived(*pieces).received
    assert (whole.rows, whole.damaged, whole.skipped) == (cut.rows, cut.damaged, cut.skipped)
    assert len(whole.rows) >= 18
    assert whole.damaged == 1


def test_a_lost_frame_costs_its_own_sample_only() -> None:
    for lost in range(4):
        stated = bursts(5)
        stated[2] = stated[2][: 11 * lost] + stated[2][11 * (lost + 1) :]
        rows = arrived(*stated).received.rows
        assert len(rows) == (5 if lost == 3 else 4)
        assert np.allclose(
            [row[1] for row in rows], [np.radians(k) for k in range(5) if k != 2 or lost == 3], atol=2e-3
        )


def test_a_right_sum_by_chance_gives_way_to_the_frame_that_follows() -> None:
    clean = bursts(3)
    (at,) = (k for k in range(256) if sum(bytes([0x55, 0x51, k]) + clean[1][:7]) & 0xFF == clean[1][7])
    stated = clean[0] + bytes([0x55, 0x51, at]) + clean[1] + clean[2]
    assert len(arrived(stated).received.rows) == 3


def test_frames_without_a_time_are_no_samples() -> None:
    found = arrived(*bursts(5, content=0b1110)).received
    assert found.rows == []
    assert found.skipped > 5


def test_losses_are_counted_by_the_time() -> None:
    decoder = Decoder(WitMotion())
    decoder.begin(SourceInfo(DRIVER, VERSION, sensors=("W",), settings={"rate_hz": 200.0}))
    for number, stated in enumerate(bursts(400, rate_hz=200.0)):
        if number not in (7, 8, 100):
            decoder.feed(stated, 5.0 + number / 200)
    one = decoder.finish()["W"]
    assert (one.counts.received, one.counts.lost, one.counts.doubled) == (397, 3, 0)
    assert np.ptp(one.block.time_s) == pytest.approx(399 / 200, abs=1e-3)


def test_it_is_set_up_and_known_by_its_number() -> None:
    voice = WitVoice("0042", motion)
    later = iter(bursts(60))
    channel = ScriptedChannel(answers=lambda data: voice.hear(data) + next(later))
    source = ByteSource(WitMotion(rate_hz=200.0), channel)
    source.open()
    assert source.info.sensors == ("EMULATED0042",)
    assert source.info.settings == {"rate_hz": 200.0}
    assert source.info.is_simulated
    assert voice.registers[0x02] == ALL
    assert voice.rate_hz == 200.0
    assert not source.identify("EMULATED0042")
    with pytest.raises(ValueError, match="rate_hz is 60"):
        WitMotion(rate_hz=60)


@pytest.mark.endurance
def test_it_is_received_through_a_port(tmp_path: Path) -> None:
    voice = WitVoice("1", motion, rate_hz=200.0)
    emulation = Emulation(voice, lambda: PseudoTerminal(tmp_path / "port"))
    source = ByteSource(WitMotion(), SerialPort(PortInfo(emulation.place)))
    try:
        source.open()
        numbers: list[float] = []
        stamps: list[float] = []
        until_s = time.monotonic() + 1.0
        while time.monotonic() < until_s:
            for block in source.read(lambda _data: None):
                numbers += np.degrees(block.gyr_rad_s[:, 0]).round().tolist()
                stamps += block.time_s.tolist()
    finally:
        source.close()
        emulation.close()
    assert len(numbers) > 150
    assert np.all(np.diff(numbers) == 1)
    assert np.allclose(np.diff(stamps), 0.005, atol=0.0015)
    assert source.damaged == 0
    assert SWITCHED_ON.year == 2026

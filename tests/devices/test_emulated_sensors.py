"""Tests that the emulated sensors send, byte by byte, what the makers' documents have.

Drivers are tested with them, and share some of their tables: here their bytes are written out.
"""

import json
import struct

import numpy as np
import pytest

from devices.emulators.csv_lines import LineVoice
from devices.emulators.shimmer3 import Shimmer3Voice
from devices.emulators.witmotion import WitVoice
from devices.emulators.ximu3 import Ximu3Voice
from devices.emulators.xsens_mti import MtiVoice
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import Standing, WalkerSettings
from tests.simulated import session_of


def motion(number: int) -> tuple[float, ...]:
    return (125.0 + number, -250.0, 375.0, 2.0, -4.0, 6.0)


class StandingClock:
    """Is until it is put forward."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> int:
        return round(self.now_s * 1e9)


def xbus(mid: int, data: str = "") -> bytes:
    body = bytes([0xFF, mid, len(bytes.fromhex(data))]) + bytes.fromhex(data)
    return b"\xfa" + body + bytes([-sum(body) % 256])


def test_a_shimmer_answers_with_literal_bytes() -> None:
    voice = Shimmer3Voice(name="S1", firmware=(0, 15, 0))
    rate = "00 0C FF F9 00 03 06 68 06 6A 06 66 00 9C 00 9C 00 00 00 00 9C"
    force = "00 05 FF FD 00 08 01 A2 01 A1 01 A3 00 9C 00 64 01 00 00 00 9C"
    assert voice.hear(b"\x2c") == bytes.fromhex("FF 2D" + "00" * 21 + rate + "00" * 21 + force)
    assert voice.hear(b"\x2e") == bytes.fromhex("FF 2F 03 00 00 00 0F 00")
    assert voice.hear(b"\x7b") == b"\xff\x7a\x02S1"
    assert voice.hear(bytes.fromhex("05 40 01 03")) == bytes.fromhex("FF FF 04 40 01")
    assert voice.hear(b"\x01") == bytes.fromhex("FF 02 40 01 00 00 00 00 07 01 03 04 05 06 0A 0B 0C")
    assert voice.hear(b"\x06") == b"\xff"
    assert voice.hear(b"\x99") == b"\xfe"
    assert voice.toggled == 1


def test_a_shimmer_streams_from_its_first_sample_at_its_rate() -> None:
    clock = StandingClock()
    voice = Shimmer3Voice(lambda number: (1, 2, 3, 4, 5, 6), period=320, now_ns=clock)
    assert voice.say() == b""
    voice.hear(b"\x07")
    clock.now_s = 0.02  # two intervals of 9.77 ms
    # time 2^24 - 4096, battery 2600, force little-endian, rate big-endian; then 320 ticks later
    first = "00 00 F0 FF 28 0A 04 00 05 00 06 00 00 01 00 02 00 03"
    assert voice.say() == bytes.fromhex(first + first.replace("00 00 F0 FF", "00 40 F1 FF"))
    assert voice.rate_hz == 102.4
    assert voice.sampled_ns(1) == pytest.approx(2e9 / 102.4)
    voice.hear(b"\x20")
    clock.now_s = 1.0
    assert voice.say() == b""


def test_a_witmotion_states_a_burst_and_answers_of_registers() -> None:
    clock = StandingClock()
    voice = WitVoice("7", motion, rate_hz=100.0, content=0b1111, now_ns=clock)
    clock.now_s = 0.015
    # 2026-01-01 0:00; an eighth, a quarter, three eighths of full scale; 25 degrees Celsius; lying level
    expected = [
        "55 50 1A 01 01 00 00 00 00 00",
        "55 51 00 10 00 E0 00 30 C4 09",
        "55 52 00 08 00 F0 00 18 C4 09",
        "55 53 00 00 00 00 00 00 00 00",
    ]
    frames = [bytes.fromhex(text) for text in expected]
    assert voice.say() == b"".join(frame + bytes([sum(frame) % 256]) for frame in frames)
    voice.hear(bytes.fromhex("FF AA 03 0B 00"))
    assert voice.rate_hz == 100.0  # it is locked
    voice.hear(bytes.fromhex("FF AA 69 88 B5 FF AA 03 0B 00"))
    assert voice.rate_hz == 200.0
    reported = voice.hear(bytes.fromhex("FF AA 27 03 00"))
    assert reported[:10] == bytes.fromhex("55 5F 0B 00 00 00 00 00 00 00")
    assert voice.hear(bytes.fromhex("FF AA 27 7F 00"))[2:10] == b"EMULATED"
    assert voice.hear(bytes.fromhex("FF AA 27 83 00"))[2:4] == b"7\0"


def test_an_ximu3_states_samples_in_text_and_binary() -> None:
    clock = StandingClock()
    text = Ximu3Voice("1", motion, rate_hz=100, is_binary=False, now_ns=clock)
    binary = Ximu3Voice("1", motion, rate_hz=100, now_ns=clock)
    clock.now_s = 0.025
    lines = text.say().split(b"\r\n")
    assert lines[0] == b"I,1000000,125.0000,-250.0000,375.0000,2.0000,-4.0000,6.0000"
    assert lines[1] == b"B,1000000,84.0000,3.9000,0.0000"
    assert lines[2].startswith(b"I,1010000,126.0000,")
    stated = binary.say()
    first = b"\xc9" + struct.pack("<Q6f", 1_000_000, 125.0, -250.0, 375.0, 2.0, -4.0, 6.0)
    assert stated.startswith(first.replace(b"\xdb", b"\xdb\xdd").replace(b"\n", b"\xdb\xdc") + b"\n")


def test_an_ximu3_answers_what_it_is_set_to() -> None:
    voice = Ximu3Voice("655782F7", motion, rate_hz=100)
    assert json.loads(voice.hear(b'{"ping":null}\n')) == {
        "ping": {"interface": "USB", "name": "emulated x-IMU3", "sn": "655782F7"}
    }
    assert voice.hear(b'{"inertial_message_rate_divisor":null}\n') == b'{"inertial_message_rate_divisor":4}\r\n'
    assert voice.hear(b'{"inertial_message_rate_divisor":2}\n') == b'{"inertial_message_rate_divisor":2}\r\n'
    assert voice.hear(b'{"apply":null}\n') == b'{"apply":null}\r\n'
    assert b"error" in voice.hear(b'{"nothing":null}\n')
    assert voice.hear(b"no JSON\n[]\n") == b""
    assert (voice.rate_hz, voice.serial, voice.sampled_ns(0) - voice.sampled_ns(-1)) == (200.0, "655782F7", 5e6)


def test_an_mti_answers_and_measures_from_its_first_sample() -> None:
    clock = StandingClock()
    voice = MtiVoice("0280A1B2", now_ns=clock)
    assert voice.hear(xbus(0xC0)) == xbus(0x42, "03")  # not while it measures
    assert voice.hear(xbus(0x30)) == xbus(0x31)
    assert voice.hear(xbus(0x00)) == xbus(0x01, "02 80 A1 B2")
    assert voice.hear(xbus(0x12)) == xbus(0x13, "01 08 02" + "00" * 8)
    product = voice.hear(xbus(0x1C))
    assert (product[2], product[3], product[4:24].rstrip()) == (0x1D, 20, b"emulated MTi")
    clock.now_s = 5.0
    settings = "10 20 FF FF 10 60 FF FF 40 20 00 C8 80 20 00 C8"
    assert voice.hear(xbus(0xC0, settings)) == xbus(0xC1, settings)
    assert voice.hear(xbus(0x10)) == xbus(0x11)
    clock.now_s = 5.011
    stated = voice.say()
    # counter 0, fine time 1024 ticks before it begins again, 9.81 m/s2 upwards, no rate; then 50 ticks later
    first = "10 20 02 00 00 10 60 04 FF FF FC 00 40 20 0C 00 00 00 00 00 00 00 00 41 1C F5 C3 80 20 0C" + "00" * 12
    assert stated.startswith(xbus(0x36, first))
    assert stated[len(stated) // 2 :][4:16] == bytes.fromhex("10 20 02 00 01 10 60 04 FF FF FC 32")
    assert voice.sampled_ns(0) == 5.005e9


def test_lines_of_numbers_are_milliseconds_rates_and_forces() -> None:
    clock = StandingClock()
    voice = LineVoice(motion, rate_hz=50.0, now_ns=clock)
    clock.now_s = 0.041
    assert voice.say() == (
        b"0,125.000,-250.000,375.000,2.0000,-4.0000,6.0000\r\n20,126.000,-250.000,375.000,2.0000,-4.0000,6.0000\r\n"
    )
    assert voice.hear(b"anything") == b""
    assert voice.sampled_ns(1) == 4e7


def test_a_sensor_that_is_played_again_is_reported_and_shaken() -> None:
    clock = StandingClock()

    def sleep(seconds: float) -> None:
        clock.now_s += seconds

    session = session_of(WalkerSettings(recordings=(Standing(),)))
    source = ReplaySource(session, now_ns=clock, sleep=sleep)
    source.open()
    reported = source.details()
    first = source.info.sensors[0]
    assert len(reported) == len(source.info.sensors) == 6
    assert all(one.rate_hz == 100.0 for one in reported.values())
    fastest_rad_s = []
    for is_shaken in (False, True):
        if is_shaken:
            assert source.identify(first)
        blocks = [block for _ in range(20) for block in source.read(lambda _: None) if block.sensor == first]
        fastest_rad_s.append(max(np.abs(block.gyr_rad_s).max() for block in blocks))
    assert fastest_rad_s[0] < 0.1
    assert fastest_rad_s[1] > 1.0
    assert source.info.is_simulated
    source.close()

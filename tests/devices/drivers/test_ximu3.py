"""The x-IMU3's messages, as text and binary, cut and damaged; its commands; its bytes live and from a journal."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from devices.drivers.ximu3 import DRIVER, MOST_MESSAGE, VERSION, Ximu3, Ximu3Framer, read_file, stuffed, unstuffed
from devices.emulators.transports import Emulation, PseudoTerminal, TcpServer, Transport, UdpSender
from devices.emulators.ximu3 import Ximu3Voice, message, text_message
from devices.source import SourceInfo
from devices.stream import ByteSource, Decoder, Row
from devices.transport.channels import Channel, TcpChannel, UdpChannel
from devices.transport.ports import PortInfo, SerialPort
from tests.devices.scripted import ScriptedChannel, free_port

G = 9.80665
INFO = SourceInfo(DRIVER, VERSION, sensors=("A",), settings={"rate_hz": 100.0})


def motion(number: int) -> tuple[float, ...]:
    return (number % 1000, -2.5, 3.25, 0.5, -0.25, 1.0)


def arrived(*stated: bytes) -> Ximu3Framer:
    framer = Ximu3Framer()
    for piece in stated:
        framer.feed(piece, 0.0)
    framer.flush()
    return framer


def test_text_and_binary_say_the_same_in_si_units() -> None:
    stated = [message("I", 2_500_000, motion(180), is_binary) for is_binary in (False, True)]
    for one in stated:
        (row,) = arrived(one).received.rows
        assert row[0] == 2.5
        assert row[1] == pytest.approx(np.pi)
        assert row[4:] == pytest.approx((0.5 * G, -0.25 * G, G))


@given(st.binary(max_size=60))
def test_stuffing_is_undone(data: bytes) -> None:
    sent = stuffed(data)
    assert sent.count(b"\n") == 1
    assert unstuffed(sent[:-1]) == data


@given(st.lists(st.integers(1, 40)), st.booleans())
def test_it_does_not_matter_how_bytes_are_cut(cuts: list[int], is_binary: bool) -> None:
    stated = b"tail\n" + b"".join(message("I", k * 10_000, motion(k), is_binary) for k in range(20))
    stated = stated[:200] + b"\x07" * 3 + stated[205:] + text_message("N", 7, "hello", is_binary)
    pieces = [stated[a:b] for a, b in zip([0, *np.cumsum(cuts)], [*np.cumsum(cuts), len(stated)], strict=True)]
    whole, cut = arrived(stated).received, arrived(*pieces).received
    assert (whole.rows, whole.damaged, whole.skipped) == (cut.rows, cut.damaged, cut.skipped)
    assert len(whole.rows) >= 18


@pytest.mark.parametrize(
    "bad",
    [
        b"I,12,1,2,3\n",
        b"I,12,1,2,3,4,5,6,7\n",
        b"I,x,1,2,3,4,5,6\n",
        b"I,12,nan,2,3,0,0,1\n",
        b"I," + b"9" * 400 + b",1,2,3,0,0,1\n",
        b"I,-12,1,2,3,0,0,1\n",
        b"I,12,9000,2,3,0,0,1\n",
        b"I,12,1,2,3,0,0,1e9\n",
        b"\xc9short\n",
        b"\xc9\xdb\x00345678901234567890123456789012\n",
        b'{"ping":\n',
        b"\n",
        b"\x00\n",
        b"hello\n",
        b"Q,1,9,9,9,9\n",
        b"B,1,5000,3,0\n",
        b"x" * (MOST_MESSAGE + 9) + b"\n",
    ],
)
def test_damage_is_counted_and_the_next_message_received(bad: bytes) -> None:
    good = message("I", 10, motion(1), True)
    found = arrived(good + bad + good).received
    assert len(found.rows) == 2
    assert found.damaged == 1


def test_whoever_joins_in_the_middle_sees_no_damage() -> None:
    good = message("I", 10, motion(1), False)
    assert arrived(good[7:], good).received.damaged == 0
    assert len(arrived(good, good).received.rows) == 2


def test_what_never_ends_is_not_kept() -> None:
    framer = Ximu3Framer()
    for _ in range(100):
        framer.feed(b"x" * 1000, 0.0)
        assert len(framer._rest) <= MOST_MESSAGE + 1000
    framer.feed(b"\n" + message("I", 10, motion(1), True), 0.0)
    assert len(framer.received.rows) == 1


def test_other_messages_are_understood_or_skipped() -> None:
    found = arrived(
        message("B", 1, (84.0, 3.9, 0.0), True)
        + message("T", 1, (25.0,), False)
        + message("M", 1, (1.0, 2.0, 3.0), True)
        + text_message("N", 1, "Button pressed", False)
        + text_message("F", 1, "overload", True)
        + b'{"strobe":null}\r\n'
        + b"^A\xc9\n"
    ).received
    assert found.battery == 0.84
    assert found.skipped == 5
    assert found.replies == [b'{"strobe":null}']
    assert found.damaged == 0


def test_the_decoder_pairs_orientation_and_counts_what_is_missing() -> None:
    decoder = Decoder(Ximu3())
    decoder.begin(INFO)
    for number in range(300):
        if number in (50, 51, 200):
            continue
        us = 1_000_000 + number * 10_000
        data = message("I", us, motion(number), True)
        if number % 2:
            data += message("Q", us, (1.0, 0.0, 0.0, 0.0), True)
        decoder.feed(data, 3.0 + number / 100 + (0.01 if number % 3 else 0.0))
    decoder.feed(message("I", 1_000_000 + 2_990_000, motion(299), True), 6.1)
    one = decoder.finish()["A"]
    assert (one.counts.received, one.counts.lost, one.counts.doubled, one.counts.damaged) == (297, 3, 1, 0)
    assert one.block.time_s[0] == pytest.approx(3.0, abs=1e-6)
    assert np.diff(one.block.time_s).max() == pytest.approx(0.03, abs=1e-4)
    orientation = one.block.q_earth_from_sensor
    assert orientation is not None
    assert np.isnan(orientation[0]).all()
    assert orientation[1].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_bytes_after_a_loss_do_not_join_those_before() -> None:
    decoder = Decoder(Ximu3())
    decoder.begin(INFO)
    stated = [message("I", k * 10_000, motion(k), True) for k in range(100)]
    decoder.feed(b"".join(stated[:40]) + stated[40][:9], 0.4)
    decoder.begin(INFO)
    decoder.feed(stated[60][5:] + b"".join(stated[61:]), 1.0)
    one = decoder.finish()["A"]
    assert (one.counts.received, one.counts.lost, one.counts.damaged) == (79, 21, 0)


def test_a_journal_without_a_sample_holds_an_empty_block() -> None:
    decoder = Decoder(Ximu3())
    assert decoder.finish() == {}
    decoder.begin(INFO)
    assert len(decoder.finish()["A"].block) == 0


# greeting


def test_it_is_greeted_set_up_and_known_by_its_number() -> None:
    voice = Ximu3Voice("655782F7", motion, rate_hz=400, is_binary=False)
    channel = ScriptedChannel(answers=voice.hear)
    source = ByteSource(Ximu3(rate_hz=100), channel)
    source.open()
    assert source.info.sensors == ("655782F7",)
    assert source.info.settings == {"rate_hz": 100.0}
    assert source.info.is_simulated
    reported = source.details()["655782F7"]
    assert (reported.model, reported.serial, reported.firmware, reported.rate_hz) == (
        "x-IMU3",
        "655782F7",
        "v1.0.0",
        100.0,
    )
    assert voice.settings["inertial_message_rate_divisor"] == 4
    assert voice.settings["binary_mode_enabled"] is True
    assert source.identify("655782F7")
    assert not source.identify("another")
    assert voice.strobed == 1
    source.close()
    assert not source.identify("655782F7")
    assert not channel.is_open


def test_it_is_left_as_it_is_unless_a_rate_is_required() -> None:
    voice = Ximu3Voice("1", motion, rate_hz=200, is_binary=False)
    channel = ScriptedChannel(answers=voice.hear)
    ByteSource(Ximu3(), channel).open()
    assert all(b":null" in command for command in channel.written)


# live, through real ports and sockets


def play(source: ByteSource, seconds: float) -> tuple[list[Row], bytes]:
    rows, kept = [], bytearray()
    until_s = time.monotonic() + seconds
    while time.monotonic() < until_s:
        for block in source.read(kept.extend):
            rows += list(zip(block.time_s.tolist(), *block.gyr_rad_s.T.tolist(), strict=True))
    return rows, bytes(kept)


@pytest.fixture(params=["serial", "tcp", "udp"])
def emulated(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Ximu3Voice, Channel]]:
    voice = Ximu3Voice("655782F7", motion, rate_hz=200)
    made: list[Transport] = []

    def make() -> Transport:
        match request.param:
            case "serial":
                made.append(PseudoTerminal(tmp_path / "port"))
            case "tcp":
                made.append(TcpServer())
            case "udp":
                made.append(UdpSender(free_port()))
        return made[-1]

    emulation = Emulation(voice, make)
    transport = made[0]
    if isinstance(transport, TcpServer):
        yield voice, TcpChannel(transport.address, transport.port)
    elif isinstance(transport, UdpSender):
        yield voice, UdpChannel(transport.address, transport.port, transport.to_port)
    else:
        yield voice, SerialPort(PortInfo(emulation.place))
    emulation.close()


@pytest.mark.endurance
def test_it_is_received_live_and_its_bytes_say_the_same_again(emulated: tuple[Ximu3Voice, Channel]) -> None:
    _, channel = emulated
    source = ByteSource(Ximu3(), channel)
    source.open()
    begin_s = time.monotonic()
    rows, kept = play(source, 1.0)
    assert source.identify("655782F7")
    source.close()
    assert 150 < len(rows) < 260
    stamps_s = np.array([row[0] for row in rows])
    assert np.allclose(np.diff(stamps_s), 0.005, atol=0.0005)
    numbers = np.array([row[1] for row in rows]) * 180 / np.pi
    assert np.allclose(np.diff(numbers), 1.0)
    assert source.damaged == 0
    framer = arrived(kept)
    assert len(framer.received.rows) == len(rows)
    assert stamps_s[0] > begin_s - 1.0


def test_a_file_is_read_by_the_sensors_clock(tmp_path: Path) -> None:
    path = tmp_path / "655782F7.ximu3"
    voice = Ximu3Voice("655782F7", motion)
    stated = [voice.sample(number) for number in range(300)]
    path.write_bytes(b"".join(stated[:100] + stated[110:]) + b"half a mess")
    one = read_file(path)
    assert one.block.sensor == "655782F7"
    assert (one.counts.received, one.counts.lost, one.counts.damaged) == (290, 10, 0)
    assert one.block.time_s[[0, -1]] == pytest.approx([1.0, 3.99])

"""Tests that WitMotion's frames by air are read as laid out.

Their samples lie where they were taken, as far as known.
"""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from devices.clocks.arrival_clock import ArrivalClock
from devices.drivers.witmotion_ble import DRIVER, WitBle, WitBleFramer, WitBleSource, is_wit
from devices.emulators.bluetooth import Air
from devices.live import SourceLostError, SourceRefusedError
from devices.search import search
from devices.source import SourceInfo
from devices.stream import Decoder
from devices.transport.bluetooth import Announced
from devices.transport.notifications import framed
from tests.devices.bumble_air import ReachedByBumble
from tests.devices.dot.virtual_time import VirtualRadio
from tests.devices.drivers.emulated_wit_ble import EmulatedWitBle

G = 9.80665
FRAME = bytes.fromhex("5561 0008 00F8 0040 0040 00C0 0000 0000 0000 0000")  # 1 g, -1 g, 8 g; 1000, -1000, 0 deg/s


def framer() -> WitBleFramer:
    return WitBleFramer(SourceInfo(DRIVER, "1", settings={"rate_hz": 100.0}))


def test_a_frame_is_acceleration_rate_and_angles_scaled_as_by_cable() -> None:
    one = framer()
    one.feed(framed(0xFFE4, FRAME), 5.0)
    (row,) = one.received.rows
    assert row[0] == 5.0
    assert row[1:4] == pytest.approx((np.radians(1000), -np.radians(1000), 0.0))
    assert row[4:] == pytest.approx((G, -G, 8 * G))


def test_several_frames_of_one_notification_follow_one_another_and_what_is_cut_or_another_kind_is_counted() -> None:
    one = framer()
    one.feed(framed(0xFFE4, FRAME * 3) + framed(0xFFE4, FRAME[:19]) + framed(0xFFE4, b"\x55\x71" + bytes(18)), 5.0)
    assert (len(one.received.rows), one.received.damaged, one.received.skipped) == (3, 1, 1)
    assert np.all(np.diff([row[0] for row in one.received.rows]) > 0)


@pytest.mark.parametrize("size", [1, 7, 60])
def test_what_is_read_does_not_hang_on_the_pieces(size: int) -> None:
    stated = b"".join(framed(0xFFE4, FRAME) for _ in range(9))
    one = framer()
    for at in range(0, len(stated), size):
        one.feed(stated[at : at + size], 5.0)
    one.flush()
    assert (len(one.received.rows), one.received.damaged) == (9, 0)


@pytest.mark.parametrize(
    ("name", "is_one"),
    [
        ("WT901BLE68", True),
        ("WT9011DCL-BT50", True),
        ("BWT901BLE5.0", True),
        ("WT-Watch", False),
        ("Movella DOT", False),
    ],
)
def test_they_are_reported_by_their_name(name: str, is_one: bool) -> None:
    assert is_wit(Announced(name, "")) is is_one


# when samples were taken


@pytest.mark.parametrize("faster", [-0.015, 0.0, 0.015])
def test_samples_that_come_in_bursts_are_where_they_were_taken(faster: float) -> None:
    chance, step_s = np.random.default_rng(3), 0.01 / (1 + faster)
    taken_s = np.arange(3000) * step_s
    arrived_s = np.ceil((taken_s + 0.004 + chance.exponential(0.002, len(taken_s))) / 0.03) * 0.03  # at its intervals
    clock = ArrivalClock(100.0)
    stamps_s = np.array([clock.take(float(one)) for one in np.maximum.accumulate(arrived_s)])
    late_s = (stamps_s - taken_s)[500:]
    assert np.all(np.diff(stamps_s) > 0)
    assert np.ptp(late_s) < 0.02
    assert 0.004 < np.median(late_s) < 0.03


def test_after_a_pause_samples_are_where_they_are_and_not_where_they_would_be() -> None:
    clock = ArrivalClock(100.0)
    before = [clock.take(k * 0.01) for k in range(200)]
    after = [clock.take(5.0 + k * 0.01) for k in range(200)]
    assert before[-1] < 2.0
    assert after[0] == 5.0


def test_a_sample_that_is_lost_singly_is_not_seen() -> None:
    """Which is why it is stated about every recording."""
    decoder = Decoder(WitBle())
    decoder.begin(SourceInfo(DRIVER, "1", sensors=("WT",), settings={"rate_hz": 100.0}))
    for number in range(1000):
        if number != 500:
            decoder.feed(framed(0xFFE4, FRAME), number * 0.01)
    assert decoder.finish()["WT"].counts.lost == 0


# in the air


def turning(at_ns: float) -> Sequence[float]:
    second = at_ns / 1e9
    return (second * 37 % 300, -second * 91 % 200, 3.5, 0.25, second * 3 % 7, 1.0)


Reach = Callable[[VirtualRadio, Sequence[EmulatedWitBle]], Sequence[Announced]]


def behind_bleak(radio: VirtualRadio, wits: Sequence[EmulatedWitBle]) -> Sequence[Announced]:
    air = Air(wits)
    radio.reach(air)
    return air.announced()


def by_bumble(radio: VirtualRadio, wits: Sequence[EmulatedWitBle]) -> Sequence[Announced]:
    return ReachedByBumble(radio, wits).announced()


@pytest.mark.parametrize("reach", [behind_bleak, by_bumble])
def test_each_sample_comes_through_at_the_rate_that_was_asked_for(radio: VirtualRadio, reach: Reach) -> None:
    wit = EmulatedWitBle(0, turning, radio.now_ns, skew=0.01)
    source = WitBleSource(radio, reach(radio, [wit])[0])
    source.open()
    first, decoder, begin_s = len(wit.sent), Decoder(WitBle()), radio.now_ns() / 1e9
    decoder.begin(source.info)
    live = 0
    for _ in range(250):
        radio.pass_s(0.02)
        for block in source.read(lambda data: decoder.feed(data, radio.now_ns() / 1e9 - begin_s)):
            live += len(block)
    source.close()
    one = decoder.finish()["WT 0101"]
    sent = [values for values, _ in wit.sent]
    values = np.array(sent)
    required = np.hstack([np.radians(values[:, :3]), values[:, 3:] * 16 * G / 32768])
    got = np.hstack([one.block.gyr_rad_s, one.block.acc_m_s2])
    begins = next(k for k in range(first - 60, len(required)) if np.allclose(required[k : k + 5], got[:5], atol=1e-9))
    assert np.allclose(required[begins : begins + len(got)], got, atol=1e-9)
    assert 490 < len(got) == live
    taken_s = np.array([at_ns for _, at_ns in wit.sent[begins : begins + len(got)]]) / 1e9 - begin_s
    assert np.abs(one.block.time_s - taken_s).max() < 0.05
    assert source.info.is_simulated
    details = source.details()["WT 0101"]
    assert not details.is_loss_seen
    assert "losses not seen" in details.model
    assert wit.received == [bytes.fromhex("FFAA6988B5"), bytes.fromhex("FFAA030900")]
    assert not wit.is_up


def test_a_link_that_is_lost_is_found_again_and_the_gap_is_counted(radio: VirtualRadio) -> None:
    wit = EmulatedWitBle(0, turning, radio.now_ns)
    air = Air([wit])
    radio.reach(air)
    source = WitBleSource(radio, air.announced()[0])
    decoder, begin_s = Decoder(WitBle()), radio.now_ns() / 1e9

    def measure(seconds: float) -> None:
        for _ in range(round(seconds / 0.02)):
            radio.pass_s(0.02)
            source.read(lambda data: decoder.feed(data, radio.now_ns() / 1e9 - begin_s))

    source.open()
    decoder.begin(source.info)
    measure(3.0)
    wit.is_away = True
    air.drop(wit)
    with pytest.raises(SourceLostError):
        measure(1.0)
    source.close()
    radio.pass_s(2.0)
    with pytest.raises(SourceRefusedError, match="does not respond"):
        source.open()
    wit.is_away = False
    source.open()
    decoder.begin(source.info)
    measure(3.0)
    one = decoder.finish()["WT 0101"]
    gap_s = float(np.diff(one.block.time_s).max())
    assert gap_s > 2.0
    assert one.counts.lost == pytest.approx(gap_s * 100, abs=8)


def test_one_that_sends_nothing_is_refused(radio: VirtualRadio) -> None:
    wit = EmulatedWitBle(0, turning, radio.now_ns, loss=1.0)
    air = Air([wit])
    radio.reach(air)
    with pytest.raises(SourceRefusedError, match="sends no measurements"):
        WitBleSource(radio, air.announced()[0]).open()
    assert not wit.is_up


@pytest.mark.endurance
def test_the_search_finds_them_beside_dots(radio: VirtualRadio) -> None:
    radio.reach(Air([EmulatedWitBle(number, turning, radio.now_ns, states_so=False) for number in range(2)]))
    received = [Announced("WT901BLE68", f"E2:10:00:00:01:{k:02X}") for k in (1, 2)]
    radio.received = lambda: [*received, Announced("Movella DOT", "D4:22:CD:00:00:01", (0x0886,))]
    found = search((), 0, radio=radio)
    assert [(one.driver, one.name) for one in found.sensors] == [
        ("movella-dot", "DOT 0001"),
        (DRIVER, "WT 0101"),
        (DRIVER, "WT 0102"),
    ]

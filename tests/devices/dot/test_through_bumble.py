"""Tests of DOTs through two whole Bluetooth stacks: advertisements, ATT, subscriptions and an MTU that cuts."""

from pathlib import Path

import numpy as np
import pytest

from app.acquisition.sensor_memory import MemoryRecording
from app.storage.journal.decoding import decode
from app.storage.journal.writer import JournalWriter
from devices.decoders import DECODERS
from devices.dot.memory import list_files, record, stop
from devices.dot.sensor import DotRefusedError, is_dot
from devices.dot.source import NotSynchronisedError
from devices.emulators.bluetooth import MTU
from devices.emulators.dot_faults import DotFaults
from tests.devices.dot.by_bumble import by_bumble, through
from tests.devices.dot.virtual_time import VirtualRadio
from tests.devices.dot.worn_dots import RAD, WornDots, not_there
from tests.safety.journal_material import ID, KEY, NO_ROOM_ASKED

LIVE_MTU = 66  # as much as a sample takes
UTC_S = 1_600_000_000


def test_what_they_advertise_shows_that_they_are_dots(radio: VirtualRadio) -> None:
    air, _ = by_bumble(radio, [DotFaults(), DotFaults()])
    found = air.announced()
    assert [(one.name, one.address, one.companies) for one in found] == [
        ("Movella DOT", "D4:22:CD:00:00:01", (0x0886,)),
        ("Movella DOT", "D4:22:CD:00:00:02", (0x0886,)),
    ]
    assert all(map(is_dot, found))
    assert all(one.rssi_dbm is not None and one.rssi_dbm < 0 for one in found)


@pytest.mark.endurance
@pytest.mark.parametrize("mtu", [MTU, LIVE_MTU])
def test_they_are_synchronised_and_each_float_comes_through(radio: VirtualRadio, mtu: int) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults(loss=0.05)], through=through(mtu))
    wearing.open()
    wearing.measure(5.0)
    whole, lossy = wearing.decoded()
    assert (whole.counts.lost, whole.counts.damaged) == (0, 0)
    assert len(whole.block) > 290
    assert lossy.counts.lost == not_there(wearing.rows(1, lossy)) > 5
    assert wearing.has_every_float(0, whole)
    assert wearing.has_every_float(1, lossy)
    for source in wearing.sources:
        source.close()
    assert not any(dot.is_up or dot.is_synchronised for dot in wearing.dots)


@pytest.mark.endurance
def test_a_link_that_is_lost_is_found_again_and_streams_on(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults()], through=through())
    wearing.open()
    wearing.measure(2.0)
    wearing.dots[1].stay_away(2.0)
    wearing.air.drop(wearing.dots[1])
    wearing.measure(6.0)
    kept, lost = wearing.decoded()
    assert kept.counts.lost == 0
    assert lost.counts.lost == not_there(wearing.rows(1, lost)) > 100
    assert wearing.has_every_float(1, lost)
    assert lost.clock is not None, "it is on the common clock still"


@pytest.mark.endurance
def test_a_link_that_carries_too_little_for_samples_states_so_and_gives_none(radio: VirtualRadio) -> None:
    """bleak, and its backends, do not say how little: it shows in what arrives."""
    wearing = WornDots(radio, [DotFaults(), DotFaults()], through=through(40))
    with pytest.raises(NotSynchronisedError) as refused:
        wearing.open()
    assert set(refused.value.failed.values()) == {"what it sends arrives cut"}


def test_a_link_that_carries_too_little_for_lists_is_the_adapters_fault(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults()], through=through(LIVE_MTU))
    wearing.group.make_ready_to_record()
    sensor = wearing.group.sensors[0]
    radio.run(record([sensor], UTC_S, 120))
    radio.pass_s(1.0)
    radio.run(stop(sensor))
    with pytest.raises(DotRefusedError, match=r"arrive incomplete\. Use another Bluetooth adapter"):
        radio.run(list_files(sensor))


@pytest.mark.endurance
def test_six_record_and_are_fetched_through_three_lost_links_each_and_damage(
    radio: VirtualRadio, tmp_path: Path
) -> None:
    faults = [DotFaults(drops_export_after=[100, 400, 50], damaged=0.005) for _ in range(6)]
    wearing = WornDots(radio, faults, through=through())
    wearing.group.make_ready_to_record()
    memory = MemoryRecording(wearing.group)
    memory.begin(UTC_S)
    radio.pass_s(10.0)
    assert memory.end() == {}
    writer = JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED, now_ns=radio.now_ns)
    fetching = memory.fetching
    assert fetching is not None
    assert fetching.fetch(writer, lambda *_: None) == {}
    path = writer.stop().path
    assert all(fetching.look_into((path,), KEY).values())
    sensors = decode((path,), KEY, DECODERS).sensors
    for dot, sensor in zip(wearing.dots, wearing.group.sensors, strict=True):
        assert not dot.faults.drops_export_after, "its link was lost three times"
        assert fetching.results[sensor.name].is_complete
        values = np.array(dot.memory.files[0].values)
        assert np.array_equal(sensors[sensor.name].block.gyr_rad_s, values[:, 7:] * RAD)


@pytest.mark.endurance
def test_stamps_of_six_differ_by_less_than_2_ms(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults() for _ in range(6)], through=through())
    wearing.open()
    wearing.measure(20.0)
    off_s = []
    for number, one in enumerate(wearing.decoded()):
        assert wearing.has_every_float(number, one)
        assert one.counts.lost == 0
        off_s.append(one.block.time_s - wearing.truth(number)[1][wearing.rows(number, one)])
    medians_s = [float(np.median(one)) for one in off_s]
    assert np.ptp(medians_s) < 0.002

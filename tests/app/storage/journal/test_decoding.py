"""What a journal holds becomes the Recording that was made: bit for bit, with its gaps, by one road."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.storage.journal.decoding import DecodedJournal, decode
from app.storage.journal.header import find_segments
from app.storage.journal.payloads import SampleLayout, layout_of
from app.storage.journal.reader import JournalReader
from app.storage.journal.writer import JournalWriter
from core.body import Site
from core.samples import ImuBlock
from core.session import Recording, RecordingKind
from devices.simulation.walker import DEMONSTRATION
from devices.source import SensorCounts, SourceInfo
from tests.safety.journal_material import (
    ID,
    KEY,
    LAYOUT,
    LINES,
    NAMES,
    NO_ROOM_ASKED,
    RATE_HZ,
    WALKER,
    LineDecoder,
    block,
    line,
    record_some,
)
from tests.simulated import session_of

DECODERS = {"lines": LineDecoder}


class Clock:
    """The machine's two clocks, set by hand: `wall` may be set to anything, `host` never goes back but restarts."""

    def __init__(self) -> None:
        self.host_ns, self.wall_ns = 90_000_000_000, 1_800_000_000_000_000_000

    def pass_s(self, seconds: float) -> None:
        self.host_ns += round(seconds * 1e9)
        self.wall_ns += round(seconds * 1e9)

    def create(self, folder: Path) -> JournalWriter:
        return JournalWriter.create(
            folder, ID, KEY, room=NO_ROOM_ASKED, now_ns=lambda: self.host_ns, wall_ns=lambda: self.wall_ns
        )


def decoded(folder: Path, key: bytes | None = KEY) -> DecodedJournal:
    return decode(list(find_segments(folder)[ID].values()), key, DECODERS)


def pieces(whole: ImuBlock, length: int) -> list[ImuBlock]:
    return [whole.select(slice(k, k + length)) for k in range(0, len(whole), length)]


def assert_same_block(one: ImuBlock, other: ImuBlock) -> None:
    assert (one.sensor, one.is_rate_derived, set(one.unknown)) == (
        other.sensor,
        other.is_rate_derived,
        set(other.unknown),
    )
    for name in ("time_s", "gyr_rad_s", "acc_m_s2", "q_earth_from_sensor", "mag"):
        a, b = getattr(one, name), getattr(other, name)
        assert (a is None) == (b is None)
        if a is not None:
            assert a.tobytes() == b.tobytes()
    for name, column in one.unknown.items():
        np.testing.assert_array_equal(column, other.unknown[name])


def test_the_walkers_recording_comes_back_bit_for_bit(tmp_path: Path) -> None:
    walk = next(r for r in session_of(DEMONSTRATION).recordings if r.kind is RecordingKind.FREE_MOTION)
    sites = list(walk.imu)
    blocks = [replace(walk.imu[site], sensor=f"w-{k}") for k, site in enumerate(sites)]
    info = SourceInfo("walker", "1", sensors=tuple(one.sensor for one in blocks), is_simulated=True)
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        source = journal.source(info, layout_of(blocks[0]))
        for k, whole in enumerate(blocks):
            assert all(journal.samples(source, k, piece) for piece in pieces(whole, 4))
    got = decoded(tmp_path)
    recording = got.recording(
        replace(walk, imu={}), {one.sensor: site for one, site in zip(blocks, sites, strict=True)}
    )
    assert (recording.name, recording.kind, recording.folder) == (walk.name, walk.kind, walk.folder)
    assert list(recording.imu) == sites
    for one, site in zip(blocks, sites, strict=True):
        assert_same_block(recording.imu[site], one)
        missing = int(np.isnan(one.acc_m_s2).all(axis=1).sum())
        assert got.sensors[one.sensor].counts.received == len(one) - missing
    assert got.is_simulated
    assert got.reports[0].is_whole


def test_columns_that_mean_nothing_to_us_come_back_as_they_were(tmp_path: Path) -> None:
    texts = np.array(["", "turn", "=1+1", "Grüße"], dtype=np.dtypes.StringDType())
    whole = replace(
        block("imported", 0, 4),
        q_earth_from_sensor=np.full((4, 4), 0.5),
        mag=np.array([[1.0, np.nan, -0.0]] * 4),
        is_rate_derived=True,
        unknown={"remark": texts, "temperature": np.array([20.0, np.nan, 21.5, 0.1])},
    )
    info = SourceInfo("session_folder", "1", sensors=("imported",))
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        source = journal.source(info, layout_of(whole))
        for piece in pieces(whole, 3):
            journal.samples(source, 0, piece)
        with pytest.raises(ValueError, match="other columns"):
            journal.samples(source, 0, replace(whole, mag=None))
    assert_same_block(decoded(tmp_path).sensors["imported"].block, whole)


def test_a_stray_quarter_of_a_quaternion_stays_an_unknown_column(tmp_path: Path) -> None:
    whole = replace(block("imported", 0, 4), unknown={"quat_w": np.ones(4), "quat_z": np.ones(4)})
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        journal.samples(journal.source(SourceInfo("f", "1", sensors=("imported",)), layout_of(whole)), 0, whole)
    assert_same_block(decoded(tmp_path).sensors["imported"].block, whole)


def test_an_import_longer_than_a_record_comes_back_whole(tmp_path: Path) -> None:
    whole = block("imported", 0, 60_000)
    whole = replace(whole, unknown={"n": np.array([str(k) for k in range(60_000)], dtype=np.dtypes.StringDType())})
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        journal.samples(journal.source(SourceInfo("f", "1", sensors=("imported",)), layout_of(whole)), 0, whole)
    assert_same_block(decoded(tmp_path).sensors["imported"].block, whole)


def test_bytes_are_decoded_by_the_drivers_own_decoder(tmp_path: Path) -> None:
    record_some(tmp_path, KEY, rounds=30)
    got = decoded(tmp_path)
    assert set(got.sensors) == {*NAMES, "line"}
    assert got.sensors["line"].counts == SensorCounts(received=30)
    np.testing.assert_allclose(got.sensors["line"].block.acc_m_s2, block("line", 0, 30).acc_m_s2, atol=1e-6)
    assert_same_block(got.sensors[NAMES[3]].block, block(NAMES[3], 0, 30))
    assert [mark.text for mark in got.marks] == ["round 0", "round 10", "round 20"]
    assert got.sources == (WALKER, LINES)


def test_a_source_whose_driver_is_not_known_costs_the_others_nothing(tmp_path: Path) -> None:
    record_some(tmp_path, KEY, rounds=3)
    got = decode(list(find_segments(tmp_path)[ID].values()), KEY, {})
    assert set(got.sensors) == set(NAMES)
    assert got.undecoded == ("lines",)


def test_received_lost_doubled_and_late_samples_are_counted(tmp_path: Path) -> None:
    order = [0, 1, 2, 2, 3, 6, 5, 7, 8, 12, 12, 11, 13]  # 4, 9, 10 lost; 2, 12 doubled; 5, 11 late
    empty = replace(block(NAMES[0], 14), gyr_rad_s=np.full((1, 3), np.nan), acc_m_s2=np.full((1, 3), np.nan))
    timeless = replace(block(NAMES[0], 15), time_s=np.array([np.nan]))
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        walker, lines = journal.source(WALKER, LAYOUT), journal.source(LINES)
        for number in order:
            journal.samples(walker, 0, block(NAMES[0], number))
            journal.received(lines, line(number))
        journal.samples(walker, 0, empty)
        journal.samples(walker, 0, timeless)
        journal.received(lines, b"14,1.0,oops\n")
    got = decoded(tmp_path)
    assert got.sensors[NAMES[0]].counts == SensorCounts(received=11, lost=4, damaged=1, doubled=2, late=2)
    assert got.sensors["line"].counts == SensorCounts(received=11, lost=3, damaged=1, doubled=2, late=2)
    expected = [0, 1, 2, 3, 5, 6, 7, 8, 11, 12, 13, 14]
    np.testing.assert_array_equal(got.sensors[NAMES[0]].block.time_s, np.array(expected) / RATE_HZ)


def test_losses_are_reported_by_the_usual_interval_where_no_rate_is_reported(tmp_path: Path) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        walker = journal.source(WALKER, SampleLayout(LAYOUT.columns))
        for number in [*range(50), *range(57, 100)]:
            journal.samples(walker, 0, block(NAMES[0], number))
    assert decoded(tmp_path).sensors[NAMES[0]].counts == SensorCounts(received=93, lost=7)


def test_a_line_torn_by_damage_joins_no_other_and_only_its_sensor_loses(tmp_path: Path) -> None:
    with JournalWriter.create(tmp_path, ID, None, room=NO_ROOM_ASKED) as journal:
        lines, walker = journal.source(LINES), journal.source(WALKER, LAYOUT)
        for number in range(40):
            journal.samples(walker, 0, block(NAMES[0], number))
            journal.received(lines, line(number)[:20])
            journal.received(lines, line(number)[20:])
    content = bytearray(journal.path.read_bytes())
    content[content.index(line(17)[20:])] ^= 1  # the second half of line 17
    journal.path.write_bytes(content)
    got = decoded(tmp_path, None)
    assert got.sensors["line"].counts == SensorCounts(received=39, lost=1, damaged=1)
    assert got.sensors[NAMES[0]].counts == SensorCounts(received=40)
    assert (got.reports[0].damaged_stretches, got.reports[0].missing_records) == (1, 1)


def test_after_a_change_of_settings_the_stream_is_read_by_the_new_ones(tmp_path: Path) -> None:
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        lines = journal.source(LINES)
        journal.received(lines, line(0) + line(1)[:9])
        journal.change(lines, replace(LINES, settings={"rate_hz": 50.0}))
        journal.received(lines, line(2))
    got = decoded(tmp_path)
    np.testing.assert_array_equal(got.sensors["line"].block.time_s, [0.0, 2 / 50.0])
    assert got.sensors["line"].counts == SensorCounts(received=2, lost=1, damaged=1)
    assert got.sources[0].settings == {"rate_hz": 50.0}


def test_a_sensor_that_comes_back_with_other_columns_stays_one_sensor(tmp_path: Path) -> None:
    rich = replace(block(NAMES[0], 10, 5), q_earth_from_sensor=np.full((5, 4), 0.5), unknown={"t": np.ones(5)})
    with JournalWriter.create(tmp_path, ID, KEY, room=NO_ROOM_ASKED) as journal:
        walker = journal.source(WALKER, LAYOUT)
        journal.samples(walker, 0, block(NAMES[0], 0, 5))
        journal.change(walker, WALKER, layout_of(rich, RATE_HZ))
        journal.samples(walker, 0, rich)
    sensor = decoded(tmp_path).sensors[NAMES[0]]
    numbers = np.array([*range(5), *range(10, 15)])
    np.testing.assert_array_equal(sensor.block.time_s, numbers / RATE_HZ)
    assert sensor.block.q_earth_from_sensor is not None
    assert np.isnan(sensor.block.q_earth_from_sensor[:5]).all()
    assert (sensor.block.q_earth_from_sensor[5:] == 0.5).all()
    np.testing.assert_array_equal(sensor.block.unknown["t"], [np.nan] * 5 + [1.0] * 5)
    assert sensor.counts.received == 10


def test_recovery_and_a_clean_stop_come_to_the_same(tmp_path: Path) -> None:
    path = record_some(tmp_path, KEY, rounds=30).path
    clean = decoded(tmp_path)
    records = list(JournalReader(path, KEY).records())
    content = path.read_bytes()
    path.write_bytes(content[: content.rindex(b"\xa7GWr")])  # as a kill leaves it: all but the footer
    recovered = decoded(tmp_path)
    assert len(records) == clean.reports[0].records == recovered.reports[0].records + 1
    for name in clean.sensors:
        assert_same_block(clean.sensors[name].block, recovered.sensors[name].block)
        assert clean.sensors[name].counts == recovered.sensors[name].counts
    assert recovered.reports[0].footer is None


# T9: clocks


def record_with(journal: JournalWriter, clock: Clock, begin_host_ns: int, seconds: float) -> None:
    """Samples, lines and marks at 200 Hz, stamped by the host's clock since the journal was opened."""
    walker, lines = journal.source(WALKER, LAYOUT), journal.source(LINES)
    for _ in range(round(seconds * RATE_HZ)):
        passed_s = (clock.host_ns - begin_host_ns) / 1e9
        journal.samples(walker, 0, replace(block(NAMES[0], 0), time_s=np.array([passed_s])))
        journal.received(lines, line(round(passed_s * RATE_HZ)))
        clock.pass_s(1 / RATE_HZ)
    journal.mark("done")


def gaps_s(block: ImuBlock) -> list[float]:
    steps = np.diff(block.time_s)
    assert (steps > 0).all()
    return [float(step) for step in steps[steps > 1.5 / RATE_HZ]]


@pytest.mark.parametrize("set_by_s", [86_400.0, -86_400.0, 3600.0, -3600.0])
def test_a_clock_that_is_set_while_recording_moves_nothing(tmp_path: Path, set_by_s: float) -> None:
    clock = Clock()
    begin_ns = clock.host_ns
    with clock.create(tmp_path) as journal:
        record_with(journal, clock, begin_ns, 0.5)
        clock.wall_ns += round(set_by_s * 1e9)
        record_with(journal, clock, begin_ns, 0.5)
    got = decoded(tmp_path)
    assert gaps_s(got.sensors[NAMES[0]].block) == []
    assert got.sensors[NAMES[0]].counts == SensorCounts(received=200)
    assert [mark.time_s for mark in got.marks] == pytest.approx([0.5, 1.0])


def test_a_suspended_machine_leaves_one_gap(tmp_path: Path) -> None:
    clock = Clock()
    begin_ns = clock.host_ns
    with clock.create(tmp_path) as journal:
        record_with(journal, clock, begin_ns, 0.5)
        clock.pass_s(3600.0)
        record_with(journal, clock, begin_ns, 0.5)
    got = decoded(tmp_path)
    assert gaps_s(got.sensors[NAMES[0]].block) == pytest.approx([3600.0 + 1 / RATE_HZ])
    assert got.sensors[NAMES[0]].counts == SensorCounts(received=200, lost=round(3600 * RATE_HZ))
    assert gaps_s(got.sensors["line"].block) == pytest.approx([3600.0 + 1 / RATE_HZ])


def test_a_clock_that_steps_back_all_the_same_gives_no_negative_time(tmp_path: Path) -> None:
    clock = Clock()
    with clock.create(tmp_path) as journal:
        journal.mark("before")
        clock.host_ns -= 5_000_000_000
        journal.mark("after")
    assert [mark.time_s for mark in decoded(tmp_path).marks] == [0.0, 0.0]


@pytest.mark.parametrize("set_by_s", [0.0, 86_400.0, -86_400.0])
@pytest.mark.parametrize("is_restarted", [False, True])
def test_a_resumed_recording_has_one_gap_of_the_time_between(
    tmp_path: Path, set_by_s: float, is_restarted: bool
) -> None:
    clock = Clock()
    with clock.create(tmp_path) as journal:
        record_with(journal, clock, clock.host_ns, 0.5)
    clock.pass_s(60.0)
    clock.wall_ns += round(set_by_s * 1e9)
    if is_restarted:
        clock.host_ns = 20_000_000_000  # the machine was switched on twenty seconds ago
    with clock.create(tmp_path) as journal:
        record_with(journal, clock, clock.host_ns, 0.5)
    got = decoded(tmp_path)
    # after a restart only the wall clock reports, and one that was set back gives nothing but that it went on
    between_s = max(60.0 + set_by_s, 0.0) if is_restarted else 60.0
    sensor = got.sensors[NAMES[0]]
    if between_s:
        assert gaps_s(sensor.block) == pytest.approx([between_s + 1 / RATE_HZ])
    else:
        assert gaps_s(sensor.block) == []
    assert sensor.counts == SensorCounts(received=200)
    assert [mark.time_s for mark in got.marks] == pytest.approx([0.5, 1.0 + between_s])
    assert len(got.reports) == 2


def test_sensors_that_nobody_wore_are_left_out_of_the_recording(tmp_path: Path) -> None:
    record_some(tmp_path, KEY, rounds=3)
    reported = Recording("walk 1", RecordingKind.WALKING, "walk_1", {}, condition="barefoot")
    recording = decoded(tmp_path).recording(reported, {NAMES[0]: Site.LEFT_THIGH, "absent": Site.LEFT_FOOT})
    assert list(recording.imu) == [Site.LEFT_THIGH]
    assert recording.condition == "barefoot"

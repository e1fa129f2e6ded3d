"""Tests of six emulated DOTs behind bleak's own interface. They are synchronised, streamed, lost and found correctly.

Their seconds pass at once. The oracle is what each took, and when: sample for sample, float for float.
"""

from collections.abc import Sequence

import numpy as np
import pytest

from core.samples import FloatArray
from devices.dot.source import DotSource, NotSynchronisedError
from devices.dot.synchronising import SyncStage
from devices.emulators.dot_faults import DotFaults
from devices.live import SourceRefusedError
from devices.source import DecodedSensor
from tests.devices.dot.virtual_time import VirtualRadio
from tests.devices.dot.worn_dots import WornDots, not_there, opened


def stamps_off_s(wearing: WornDots, every: Sequence[DecodedSensor]) -> list[FloatArray]:
    """How far each stamp is from when it was taken; the line that is common to all is nobody's to see."""
    taken, off = [], []
    for number, one in enumerate(every):
        _, truth_s = wearing.truth(number)
        taken.append(truth_s[wearing.rows(number, one)])
        off.append(one.block.time_s - taken[-1])
    common = np.polynomial.Polynomial.fit(np.concatenate(taken), np.concatenate(off), 1)
    return [each - common(at_s) for at_s, each in zip(taken, off, strict=True)]


# synchronised, and measured


def test_six_are_synchronised_and_what_they_took_is_there_float_for_float(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(loss=0.01 * number, doubles=0.02) for number in range(6)], measured_s=15.0)
    every = wearing.decoded()
    off_s = stamps_off_s(wearing, every)
    for number, one in enumerate(every):
        rows = wearing.rows(number, one)
        assert len(set(rows)) == len(one.block) > 800
        assert wearing.has_every_float(number, one)
        assert one.counts.lost == not_there(rows), "between the first and the last that came"
        assert (one.counts.lost == 0) == (number == 0)
        assert one.counts.doubled > 5
        assert np.abs(off_s[number]).max() < 0.002


@pytest.mark.endurance
def test_stamped_alone_their_links_would_part_them(radio: VirtualRadio) -> None:
    """So that the limit above means something."""
    wearing = opened(radio, [DotFaults() for _ in range(6)], measured_s=20.0)
    alone = [next(iter(decoder.finish().values())) for decoder in wearing.decoders]
    assert max(np.abs(each).max() for each in stamps_off_s(wearing, alone)) > 0.004


@pytest.mark.endurance
def test_live_stamps_are_of_one_clock_too(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults() for _ in range(6)], measured_s=20.0)
    ends_s = []
    for number, blocks in enumerate(wearing.live):
        truth_s = wearing.truth(number)[1][wearing.began[number] :]
        stamps_s = np.concatenate(blocks) - wearing.begin_s
        near = np.abs(truth_s[:, None] - stamps_s[-100:][None, :] + 0.02).argmin(axis=0)
        ends_s.append(float(np.median(stamps_s[-100:] - truth_s[near])))
    off_ms = 1e3 * (np.array(ends_s) - np.median(ends_s)) % 16.667
    assert np.minimum(off_ms, 16.667 - off_ms).max() < 2.0


def test_what_is_cut_is_damaged_and_lost_and_no_more(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(cut=0.02), DotFaults()], measured_s=10.0)
    cut, whole = wearing.decoded()
    assert cut.counts.damaged > 5
    assert abs(cut.counts.lost - cut.counts.damaged) <= 1, "but for one at an end"
    assert (whole.counts.lost, whole.counts.damaged) == (0, 0)


def test_a_clock_that_begins_again_while_it_measures_loses_nothing(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults()])
    wearing.dots[0].begin_clock_at(2**32 - 40_000_000)  # about ten seconds after it was synchronised
    wearing.open()
    wearing.measure(25.0)
    every = wearing.decoded()
    assert wearing.dots[0].sent[-1][0] > 2**32
    assert [one.counts.lost for one in every] == [0, 0]
    assert max(np.abs(off_s).max() for off_s in stamps_off_s(wearing, every)) < 0.002


def test_a_sensor_that_does_not_know_the_full_mode_streams_the_plain_one(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(has_26=False), DotFaults()], measured_s=5.0)
    plain, full = wearing.decoded()
    assert wearing.sources[0].info.settings["mode"] == 21
    assert plain.block.q_earth_from_sensor is None
    assert full.block.q_earth_from_sensor is not None
    assert wearing.has_every_float(0, plain)


def test_at_30_hz_loss_is_counted_by_that_rate(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(loss=0.05), DotFaults()], rate_hz=30, measured_s=10.0)
    lossy, whole = wearing.decoded()
    assert lossy.counts.lost == not_there(wearing.rows(0, lossy)) > 5
    assert whole.counts.lost == 0
    assert np.median(np.diff(whole.block.time_s)) == pytest.approx(1 / 30, abs=1e-4)


# synchronising, and what goes wrong with it


def test_the_steps_are_reported_with_their_waits(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults() for _ in range(3)])
    reported: list[tuple[float, SyncStage]] = []
    wearing.group.synchronise(lambda stage, _sensor, _left_s: reported.append((radio.loop.time(), stage)))
    stages = list(dict.fromkeys(stage for _, stage in reported))
    assert stages == [SyncStage.PREPARING, SyncStage.WAITING, SyncStage.CONNECTING, SyncStage.LISTENING]
    waits_s = next(at for at, stage in reported if stage == SyncStage.CONNECTING) - next(
        at for at, stage in reported if stage == SyncStage.WAITING
    )
    assert waits_s > 13.0
    assert all(dot.is_synchronised for dot in wearing.dots)


@pytest.mark.parametrize("result", [5, 7, 8, 9])
def test_one_of_five_that_fails_once_is_tried_again_with_all(radio: VirtualRadio, result: int) -> None:
    faults = [DotFaults() for _ in range(5)]
    faults[3].sync_results = [result]
    wearing = opened(radio, faults)
    assert all(dot.is_synchronised for dot in wearing.dots)
    assert len({source.info.settings["clock"] for source in wearing.sources}) == 1


@pytest.mark.parametrize(("result", "stated"), [(5, "few samples"), (7, "skew too large"), (8, "start failed")])
def test_one_that_fails_twice_is_named_and_all_may_be_tried_again(
    radio: VirtualRadio, result: int, stated: str
) -> None:
    faults = [DotFaults() for _ in range(5)]
    faults[3].sync_results = [result, result]
    wearing = WornDots(radio, faults)
    with pytest.raises(NotSynchronisedError, match=r"^DOT 0004 could not") as refused:
        wearing.open()
    assert refused.value.failed == {"DOT 0004": stated}
    assert not any(dot.is_synchronised or dot.is_streaming for dot in wearing.dots)
    wearing.open()
    assert all(dot.is_synchronised for dot in wearing.dots)


def test_one_that_calls_a_stale_clock_synchronised_is_found_out(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults(), DotFaults(stale_s=3.0)])
    with pytest.raises(NotSynchronisedError) as refused:
        wearing.open()
    assert refused.value.failed == {"DOT 0003": "its clock differs"}


def test_one_that_stays_away_is_named(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults(), DotFaults()])
    wearing.dots[2].faults.unreachable_until_ns = 2**62
    with pytest.raises(NotSynchronisedError) as refused:
        wearing.open()
    assert refused.value.failed == {"DOT 0003": "it was lost"}


@pytest.mark.endurance
def test_sensors_that_were_synchronised_before_are_first_parted(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults()])
    wearing.group.synchronise()
    first = wearing.group.clock_of("DOT 0001")
    for dot in wearing.dots:
        dot.is_streaming = False  # half an hour of samples is nobody's use
    radio.pass_s(1801.0)
    due_s = wearing.group.renewal_due_s()
    assert due_s is not None
    assert due_s < 0
    wearing.group.synchronise()
    due_s = wearing.group.renewal_due_s()
    assert due_s is not None
    assert due_s > 1790
    assert wearing.group.clock_of("DOT 0001") != first


def test_renewing_between_recordings_gives_sources_the_new_clock_and_keeps_them_streaming(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(), DotFaults()], measured_s=2.0)
    first = wearing.sources[0].info.settings["clock"]
    wearing.group.synchronise()
    wearing.measure(2.0)
    assert wearing.sources[0].info.settings["clock"] == wearing.group.clock_of("DOT 0001") != first
    assert all(dot.is_streaming for dot in wearing.dots)


def test_ending_lets_each_have_its_own_clock(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults()])
    wearing.group.synchronise()
    wearing.group.end()
    assert not any(dot.is_synchronised or dot.is_streaming for dot in wearing.dots)
    assert wearing.group.renewal_due_s() is None


def test_one_alone_is_not_synchronised_and_measures(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults()], measured_s=5.0)
    assert "clock" not in wearing.sources[0].info.settings
    assert not wearing.dots[0].is_synchronised
    assert len(wearing.decoded()[0].block) > 280


# lost and found


def test_a_lost_link_costs_what_was_sent_meanwhile_and_starts_nothing_again(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults() for _ in range(3)], measured_s=5.0)
    clock = wearing.sources[1].info.settings["clock"]
    wearing.air.drop(wearing.dots[1])
    wearing.dots[1].faults.unreachable_until_ns = radio.now_ns() + 3_000_000_000
    wearing.measure(10.0)
    assert wearing.dots[1].is_streaming
    assert not any(frame[:2] == b"\x01\x20" for frame in wearing.sources[1].sent), "no new start"
    one, lost, other = wearing.decoded()
    assert (one.counts.lost, other.counts.lost) == (0, 0)
    assert lost.counts.lost == not_there(wearing.rows(1, lost)) > 170
    assert wearing.has_every_float(1, lost)
    assert wearing.sources[1].info.settings["clock"] == clock
    assert np.abs(stamps_off_s(wearing, [one, lost, other])[1]).max() < 0.002


def test_one_that_was_switched_off_comes_back_on_its_own_clock(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults() for _ in range(3)], measured_s=5.0)
    wearing.air.drop(wearing.dots[1])
    wearing.dots[1].restart()
    wearing.measure(10.0)
    assert "clock" not in wearing.sources[1].info.settings
    assert "clock" in wearing.sources[0].info.settings
    one, off, other = wearing.decoded()
    assert off.clock is None
    assert len(off.block) > 600
    assert (one.counts.lost, other.counts.lost) == (0, 0)


@pytest.mark.endurance
@pytest.mark.parametrize("drops_after", [[], [9], [11], [12]], ids=["never", "asked", "starting", "started"])
@pytest.mark.parametrize("count", [1, 2], ids=["alone", "synchronised"])
def test_one_that_was_switched_off_twice_is_stamped_when_it_measured(
    radio: VirtualRadio, count: int, drops_after: list[int]
) -> None:
    """Its clock, begun again, shows what it showed when it was lost: the stamps alone say that no time passed."""
    wearing = WornDots(radio, [DotFaults() for _ in range(count)])
    dot = wearing.dots[-1]
    wearing.open()
    wearing.measure(1.0)
    wearing.air.drop(dot)
    dot.restart()
    wearing.measure(2.0)
    wearing.air.drop(dot)
    dot.stay_away(5.0)
    radio.pass_s(4.0)
    dot.restart()
    dot.faults.drops_after = drops_after
    wearing.measure(4.0)
    assert not dot.faults.drops_after
    one = wearing.decoded()[-1]
    values, truth_s = wearing.truth(count - 1)
    at = {value.tobytes(): row for row, value in enumerate(values)}
    rows = [at[value.tobytes()] for value in np.hstack([one.block.gyr_rad_s, one.block.acc_m_s2])]
    assert np.abs(one.block.time_s - truth_s[rows]).max() < 0.03
    assert one.clock is None
    away_s = np.diff(one.block.time_s).max()
    assert away_s > 4.0
    assert one.counts.lost >= round(away_s * 60) - 1


def test_one_that_streams_already_is_joined_where_its_rate_is_right(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults()])
    again = DotSource(wearing.group.sensors[0], wearing.group)
    wearing.air.drop(wearing.dots[0])
    again.open()
    assert not any(frame[:2] in (b"\x01\x20", b"\x02\x10") for frame in again.sent), "neither a mode nor a rate"
    wearing.dots[0].settings[24] = 20
    wearing.air.drop(wearing.dots[0])
    third = DotSource(wearing.group.sensors[0], wearing.group)
    third.open()
    assert wearing.dots[0].rate_hz == 60
    assert wearing.dots[0].is_streaming


@pytest.mark.endurance
@pytest.mark.parametrize("after", range(1, 16))
def test_a_link_that_is_lost_at_any_step_of_opening_is_a_refusal_and_no_dead_end(
    radio: VirtualRadio, after: int
) -> None:
    wearing = WornDots(radio, [DotFaults(drops_after=[after])])
    wearing.measure(8.0)  # as a reader does: it opens until it is open
    assert wearing.is_open == [True]
    wearing.open()
    wearing.measure(2.0)
    assert len(wearing.live[0]) > 10


def test_one_that_records_in_its_memory_is_only_asked_for_its_state(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults()])
    dot = wearing.dots[0]
    dot.write(0x1002, bytes.fromhex("10" + "00" * 23 + "7800" + "00" * 6))
    dot.write(0x7001, bytes.fromhex("010740DF503B5BFFFFF5"))
    with pytest.raises(SourceRefusedError, match="is recording to its memory"):
        wearing.open()
    assert dot.memory.state == 0x40
    assert dot.memory.files == []


# what it is to the application


def test_its_light_and_its_battery(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults()])
    assert not wearing.sources[0].identify("DOT 0001"), "not connected yet"
    wearing.open()
    assert wearing.sources[0].identify("DOT 0001")
    assert not wearing.sources[0].identify("DOT 0002")
    assert [dot.blinked for dot in wearing.dots] == [1, 0]
    details = wearing.sources[1].details()["DOT 0002"]
    assert (details.battery, details.rate_hz, details.firmware) == (0.85, 60, "2.4.0")
    assert wearing.sources[0].info.is_simulated


def test_closing_stops_the_stream_and_leaves(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(), DotFaults()])
    for source in wearing.sources:
        source.close()
        source.close()
    assert not any(dot.is_streaming or dot.is_up for dot in wearing.dots)

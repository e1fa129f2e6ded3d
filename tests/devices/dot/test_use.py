"""Tests that sensors go from streams to memories and back as their maker allows.

The rate is set before they are synchronised.
"""

import pytest

from devices.dot.memory import OwnClockError, list_files, record, stop
from devices.dot.messages import SYNC_GROUP, DotMessage
from devices.dot.sensor import DotRefusedError
from devices.dot.source import DotUse
from devices.dot.synchronising import SyncStage
from devices.emulators.bluetooth import Notification
from devices.emulators.dot_faults import DotFaults
from devices.live import SourceRestartedError
from devices.quiet import Quiet
from tests.devices.dot.virtual_time import VirtualRadio
from tests.devices.dot.worn_dots import WornDots, opened

UTC_S = 1_600_000_000


def kept(_data: bytes) -> None:
    """It is not recorded."""


def test_a_rate_is_not_changed_after_synchronising_and_a_recording_at_another_is_refused(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(), DotFaults()])
    for dot in wearing.dots:
        dot.write(0x1002, bytes.fromhex("10" + "00" * 23 + "7800" + "00" * 6))
    assert [dot.rate_hz for dot in wearing.dots] == [60, 60]
    with pytest.raises(DotRefusedError, match="is not set to the recording rate"):
        radio.run(record(wearing.group.sensors, UTC_S, 120))


def test_one_that_states_too_little_of_its_rate_is_a_refusal_and_nobody_records(
    radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch
) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults()])
    wearing.group.make_ready_to_record()
    cut = wearing.dots[1]
    whole = cut.read
    monkeypatch.setattr(cut, "read", lambda which: whole(which)[:4] if which == 0x1002 else whole(which))
    with pytest.raises(DotRefusedError, match="DOT 0002 is out of range"):
        radio.run(record(wearing.group.sensors, UTC_S, 120))
    assert [dot.memory.files for dot in wearing.dots] == [[], []]


def test_a_late_notice_about_synchronising_is_no_part_of_a_list_of_files(
    radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That it is not synchronised begins with the same byte as a list."""
    wearing = WornDots(radio, [DotFaults()])
    wearing.group.make_ready_to_record()
    (sensor,), (dot,) = wearing.group.sensors, wearing.dots
    radio.run(record([sensor], UTC_S, 120))
    radio.pass_s(1.0)
    radio.run(stop(sensor))
    late, due = (0x7003, DotMessage(SYNC_GROUP, b"\x51\x09").packed()), dot.notifications

    def notifications() -> list[Notification]:
        stated = due()
        is_list = any(which == 0x7003 and (notice[0], notice[2]) == (1, 0x51) for which, notice in stated)
        return [late, *stated] if is_list else stated

    monkeypatch.setattr(dot, "notifications", notifications)
    (file,) = radio.run(list_files(sensor))
    assert file.started_utc_s == UTC_S


def test_an_order_to_a_busy_sensor_is_given_again(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults()])
    wearing.group.make_ready_to_record()
    (sensor,), (dot,) = wearing.group.sensors, wearing.dots
    radio.run(record([sensor], UTC_S, 120))
    radio.pass_s(1.0)
    radio.run(stop(sensor))
    dot.faults.busy = 4  # more than a list is asked for again
    (file,) = radio.run(list_files(sensor))
    assert file.started_utc_s == UTC_S


def test_asking_how_long_clocks_hold_is_answered_while_they_are_ended(
    radio: VirtualRadio, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The screen asks while another thread ends them."""
    wearing = opened(radio, [DotFaults(), DotFaults()])
    now_ns = radio.now_ns()

    def ended_meanwhile() -> int:
        for sensor in wearing.group.sensors:
            wearing.group.leave(sensor.name)
        return now_ns

    monkeypatch.setattr(radio, "now_ns", ended_meanwhile)
    left_s = wearing.group.renewal_due_s()
    assert left_s is not None
    assert left_s > 0
    assert wearing.group.renewal_due_s() is None


def test_ready_to_record_they_are_on_one_clock_at_that_rate_and_send_nothing(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(), DotFaults()])
    first = wearing.group.clock_of("DOT 0001")
    reported: list[SyncStage] = []
    wearing.group.make_ready_to_record(lambda stage, _sensor, _left_s: reported.append(stage))
    assert SyncStage.WAITING in reported
    assert SyncStage.LISTENING not in reported, "nobody streams at this rate"
    assert wearing.group.use is DotUse.RECORDING
    assert [(dot.rate_hz, dot.is_synchronised, dot.is_streaming) for dot in wearing.dots] == [(120, True, False)] * 2
    assert wearing.group.clock_of("DOT 0001") != first
    assert wearing.sources[0].read(kept) == ()
    details = wearing.sources[0].details()["DOT 0001"]
    assert (details.quiet, details.rate_hz) == (Quiet.IN_MEMORY, 120)
    reported.clear()
    wearing.group.make_ready_to_record(lambda stage, _sensor, _left_s: reported.append(stage))
    assert reported == [], "they are ready still"


def test_back_to_streams_they_are_synchronised_at_theirs_and_what_lies_between_is_no_loss(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(), DotFaults()])
    wearing.group.make_ready_to_record()
    wearing.group.stream_again()
    assert [(dot.rate_hz, dot.is_synchronised, dot.is_streaming) for dot in wearing.dots] == [(60, True, True)] * 2
    with pytest.raises(SourceRestartedError):
        wearing.sources[0].read(kept)
    wearing.sources[0].close()
    assert wearing.dots[0].is_streaming, "its link is kept"
    wearing.sources[0].open()
    assert wearing.sources[0].details()["DOT 0001"].quiet is None


def test_where_memories_record_at_the_rate_of_streams_one_clock_serves_both(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(), DotFaults()], record_hz=60)
    clock, reported = wearing.group.clock_of("DOT 0001"), list[SyncStage]()
    wearing.group.make_ready_to_record(lambda stage, _sensor, _left_s: reported.append(stage))
    assert not any(dot.is_streaming for dot in wearing.dots)
    wearing.group.stream_again(lambda stage, _sensor, _left_s: reported.append(stage))
    assert all(dot.is_streaming for dot in wearing.dots)
    assert reported == []
    assert wearing.group.clock_of("DOT 0001") == clock


def test_where_one_was_switched_off_its_own_clock_is_found_out_and_all_are_synchronised_again(
    radio: VirtualRadio,
) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults()])
    group = wearing.group
    group.make_ready_to_record()
    wearing.air.drop(wearing.dots[1])
    wearing.dots[1].restart()
    names = [sensor.name for sensor in group.sensors]
    with pytest.raises(OwnClockError, match=r"^DOT 0002 was switched off") as refused:
        radio.run(record(group.sensors, UTC_S, 120, names))
    assert [dot.memory.state for dot in wearing.dots] == [0x06, 0x06]
    group.leave(refused.value.sensor)
    group.make_ready_to_record()
    assert all(dot.is_synchronised for dot in wearing.dots)


@pytest.mark.parametrize("at", [SyncStage.PREPARING, SyncStage.WAITING, SyncStage.CONNECTING])
def test_synchronising_that_is_left_off_leaves_nobody_synchronised(radio: VirtualRadio, at: SyncStage) -> None:
    wearing = WornDots(radio, [DotFaults(), DotFaults(), DotFaults()])

    def show_message(stage: SyncStage, sensor: str, _left_s: float) -> None:
        if stage is at and sensor in ("", "DOT 0002"):
            raise InterruptedError

    with pytest.raises(InterruptedError):
        wearing.group.synchronise(show_message)
    radio.pass_s(1.0)
    assert not any(dot.is_synchronised or dot.is_streaming for dot in wearing.dots)
    assert not wearing.group.is_synchronising
    wearing.open()
    assert all(dot.is_synchronised for dot in wearing.dots)


def test_the_seconds_that_are_left_are_reported_and_become_fewer(radio: VirtualRadio) -> None:
    wearing = WornDots(radio, [DotFaults() for _ in range(3)])
    reported: list[tuple[float, float]] = []
    wearing.group.synchronise(lambda _stage, _sensor, left_s: reported.append((radio.loop.time(), left_s)))
    assert len(reported) > 20, "also while all are left alone"
    left_s = [one[1] for one in reported]
    assert left_s == sorted(left_s, reverse=True)
    assert left_s[0] == pytest.approx(reported[-1][0] - reported[0][0], abs=12.0)


def test_closed_they_are_not_left_synchronised(radio: VirtualRadio) -> None:
    wearing = opened(radio, [DotFaults(), DotFaults()])
    for source in wearing.sources:
        source.close()
    assert not any(dot.is_synchronised or dot.is_streaming or dot.is_up for dot in wearing.dots)
    wearing.open()
    assert all(dot.is_synchronised for dot in wearing.dots)


@pytest.mark.parametrize("echoes", [False, True])
def test_the_result_of_synchronising_is_understood_with_and_without_what_it_answers(
    radio: VirtualRadio, echoes: bool
) -> None:
    wearing = WornDots(radio, [DotFaults(echoes=echoes), DotFaults(echoes=echoes)])
    wearing.group.synchronise()
    assert all(dot.is_synchronised for dot in wearing.dots)

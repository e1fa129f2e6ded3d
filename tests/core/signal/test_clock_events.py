"""Tests of what befell the clocks of a recording: each event where it is, and none where nothing happened."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.samples import FloatArray, ImuBlock
from core.signal.clock_events import MOST_PARTS, ClockBreak, ClockEventKind, ClockView, clock_view
from core.signal.reception import pauses_among
from core.verdicts.gates import LIMITS
from devices.files.formats import read_trial
from devices.files.gathering import gather
from devices.files.refusal import FileRefusedError
from tests.clock_files import ALL, TIME_S, jumped, restarted, without

RATE_HZ = 100.0


def block(time_s: FloatArray, is_there: np.ndarray = ALL) -> ImuBlock:
    rate = np.sin(TIME_S * 6.0)[:, None] * np.ones(3)
    return ImuBlock("a", time_s[is_there], rate[is_there], np.tile([0.0, 0.0, 9.81], (int(is_there.sum()), 1)))


def view_of(
    *blocks: ImuBlock, restarts: Sequence[Sequence[ClockBreak]] = (), rate_hz: float | None = None
) -> ClockView:
    every = restarts or [()] * len(blocks)
    return clock_view(blocks, every, [rate_hz] * len(blocks))


def kinds(view: ClockView) -> list[str]:
    return [str(one.kind) for one in view.events]


def test_even_clocks_have_no_events() -> None:
    view = view_of(block(TIME_S), block(TIME_S + 0.003), rate_hz=RATE_HZ)
    assert view.events == ()
    assert view.length_s == pytest.approx(19.993)


@given(st.floats(0.0, 0.02), st.integers(0, 2**31))
def test_jitter_and_single_lost_samples_are_no_events(jitter_s: float, seed: int) -> None:
    """Gaps of a few samples are bridged, wherever they are."""
    rng = np.random.default_rng(seed)
    is_there = rng.random(len(TIME_S)) > 0.03
    is_there[1:-1] |= ~is_there[:-2] | ~is_there[2:]
    late_s = np.sort(TIME_S + rng.uniform(0.0, jitter_s, len(TIME_S)))
    assert view_of(block(late_s, is_there), block(TIME_S)).events == ()


def test_a_jump_of_one_clock_is_closed_on_the_time_line() -> None:
    view = view_of(block(TIME_S), block(jumped(9.0, 3600.0)))
    (event,) = view.events
    assert (event.kind, event.sensors) == (ClockEventKind.JUMP, (1,))
    assert event.at_s == pytest.approx(8.995)
    assert event.length_s == pytest.approx(3600.01)
    assert view.length_s == pytest.approx(19.99, abs=0.02)


def test_two_jumps_of_one_clock_are_both_found() -> None:
    twice_s = np.where(TIME_S >= 15.0 - 1e-9, jumped(9.0, 3600.0) + 500.0, jumped(9.0, 3600.0))
    view = view_of(block(TIME_S), block(twice_s))
    assert [round(one.at_s, 3) for one in view.events] == [8.995, 14.995]


def test_what_all_sensors_miss_is_a_pause_and_no_jump() -> None:
    paused = without((6.0, 11.0))
    view = view_of(block(TIME_S, paused), block(TIME_S, paused))
    (event,) = view.events
    assert (event.kind, event.sensors) == (ClockEventKind.PAUSE, (0, 1))
    assert event.at_s == pytest.approx(5.99)
    assert event.length_s == pytest.approx(5.02)


def test_what_one_sensor_misses_is_a_loss_and_no_pause() -> None:
    view = view_of(block(TIME_S), block(TIME_S, without((6.0, 11.0), (14.0, 14.4))))
    (event,) = view.events
    assert (event.kind, event.sensors, event.count) == (ClockEventKind.LOSS, (1,), 2)
    assert event.longest_s == pytest.approx(5.02)
    assert event.length_s == pytest.approx(5.02 + 0.42)
    assert [round(begin_s, 2) for begin_s, _ in event.parts_s] == [5.99, 13.99]


def test_a_loss_beside_a_pause_is_stated_without_it() -> None:
    view = view_of(block(TIME_S, without((6.0, 11.0))), block(TIME_S, without((5.0, 11.0))))
    pause, loss = view.events
    assert (pause.kind, loss.kind) == (ClockEventKind.PAUSE, ClockEventKind.LOSS)
    assert loss.length_s == pytest.approx(1.0, abs=0.02)


def test_many_losses_are_one_event_and_few_parts() -> None:
    time_s = np.arange(0.0, 600.0, 0.01)
    is_there = (time_s % 0.5) > 0.1
    zeros = np.zeros((int(is_there.sum()), 3))
    lossy = ImuBlock("a", time_s[is_there], zeros + np.sin(time_s[is_there])[:, None], zeros + 9.81)
    (event,) = view_of(
        lossy, ImuBlock("b", time_s, np.sin(time_s)[:, None] * np.ones(3), 9.81 * np.ones((60_000, 3)))
    ).events
    assert event.count > 1000
    assert len(event.parts_s) <= MOST_PARTS


def test_what_pauses_all_the_time_loses_samples() -> None:
    """As quickly as anything else: two hundred thousand gaps of two sensors, each longer than a pause."""
    steps_s = np.where(np.arange(600_000) % 3 == 2, 3.0, 0.1)
    time_s = np.cumsum(steps_s)
    rate = np.sin(time_s)[:, None] * np.ones(3)
    blocks = [ImuBlock(name, time_s, rate, np.full((len(time_s), 3), 5.0)) for name in ("a", "b")]
    view = clock_view(blocks, [(), ()], [None, None])
    assert [(str(one.kind), one.count) for one in view.events] == [("loss", 200_000)] * 2


@given(
    st.lists(st.lists(st.tuples(st.integers(0, 60), st.integers(1, 20)), max_size=6), min_size=1, max_size=3),
)
def test_pauses_are_where_all_sensors_miss_samples(gaps: list[list[tuple[int, int]]]) -> None:
    """Held against each instant of a grid."""
    grid = np.arange(0.0, 100.0, 0.1)
    masks = [np.ones(len(grid), dtype=bool) for _ in gaps]
    for mask, own in zip(masks, gaps, strict=True):
        for begin_s, length_s in own:
            mask[(grid > begin_s + 0.05) & (grid < begin_s + length_s + 0.05)] = False
        mask[[0, -1]] = True
    missing = ~np.any(masks, axis=0)
    edges = np.flatnonzero(np.diff(missing.astype(int), prepend=0, append=0))
    expected = [(b - a + 1) / 10 for a, b in edges.reshape(-1, 2).tolist() if (b - a + 1) / 10 >= 2.0]
    found = pauses_among([grid[mask] for mask in masks])
    assert [b - a for a, b in found] == pytest.approx(expected)


def test_every_second_sample_missing_shows_against_the_rate_that_was_set_alone() -> None:
    half = np.arange(len(TIME_S)) % 2 == 0
    (event,) = view_of(block(TIME_S, half), rate_hz=RATE_HZ).events
    assert event.kind is ClockEventKind.SPARSE
    came_hz, set_hz = event.rates_hz
    assert came_hz == pytest.approx(50.0, abs=0.1)
    assert set_hz == RATE_HZ
    assert view_of(block(TIME_S, half)).events == ()
    assert view_of(block(TIME_S * 1.05), rate_hz=RATE_HZ).events == ()  # as clocks and settings are off


def test_samples_are_sparse_where_the_verdicts_report_no_angle(monkeypatch: pytest.MonkeyPatch) -> None:
    slow = block(TIME_S * 1.15)  # 87 % of the rate that was set
    assert kinds(view_of(slow, rate_hz=RATE_HZ)) == ["sparse"]
    monkeypatch.setattr("core.signal.clock_events.LIMITS", replace(LIMITS, rate_percent=(2.0, 15.0)))
    assert view_of(slow, rate_hz=RATE_HZ).events == ()


def restart_at(at: int, by_s: float = 8.5) -> ClockBreak:
    return ClockBreak(ClockEventKind.RESTART, at, by_s, -by_s)


def test_clocks_that_restart_together_are_one_event_and_others_are_not() -> None:
    assert restarted(9.0)[900] == 0.5
    together = view_of(block(TIME_S), block(TIME_S), restarts=[[restart_at(900)], [restart_at(920)]])
    assert [(one.kind, one.sensors) for one in together.events] == [(ClockEventKind.RESTART, (0, 1))]
    apart = view_of(block(TIME_S), block(TIME_S), restarts=[[restart_at(900)], [restart_at(1300)]])
    assert [(one.sensors, round(one.at_s, 3)) for one in apart.events] == [((0,), 8.995), ((1,), 12.995)]
    assert apart.events[0].length_s == pytest.approx(8.5)


def test_no_samples_are_no_events() -> None:
    empty = ImuBlock("a", np.empty(0), np.empty((0, 3)), np.empty((0, 3)))
    assert view_of(empty).events == ()
    assert view_of().length_s == 0.0
    assert view_of(empty, block(TIME_S)).events == ()


@pytest.mark.parametrize(
    "folder", ["vendor_exports/apdm", "vendor_exports/xsens_mtmanager", "vendor_streams/xsens_mti"]
)
def test_no_real_recording_has_an_event_that_did_not_happen(test_data: Callable[[str], Path], folder: str) -> None:
    """None of them restarts, jumps or pauses; files of a trial are read together, so that they can contradict."""
    read = 0
    for files in gather([test_data(folder)]).trials:
        try:
            trial = read_trial(files.format, [Path(file) for file in files.files], 100.0, splits=True)
        except FileRefusedError:
            continue  # of another reason, which its own tests state
        read += 1
        blocks = [sensor.block for sensor in trial.sensors]
        assert not any(sensor.restarts for sensor in trial.sensors)
        view = clock_view(blocks, [()] * len(blocks), [sensor.info.rate_hz for sensor in trial.sensors])
        assert kinds(view) == [], files.name
    assert read


@pytest.mark.parametrize("case", ["xdf-block-jumps/r.xdf", "csv-stamps-in-batches/lt.csv"])
def test_wrong_stamps_that_were_mended_are_no_event(test_data: Callable[[str], Path], case: str) -> None:
    trial = read_trial("", [test_data("cases") / case], None, splits=True)
    blocks = [sensor.block for sensor in trial.sensors]
    assert clock_view(blocks, [()] * len(blocks), [None] * len(blocks)).events == ()
    assert not any(sensor.restarts for sensor in trial.sensors)

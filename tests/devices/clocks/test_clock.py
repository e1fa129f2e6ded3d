"""A sensor's clock drifts, its messages are late, overtaken and doubled: stamps are right, and so are the counts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.samples import FloatArray, IntArray
from devices.clocks.clock import AGREEING, ClockRuns, Unwrapping, fit_clock, put_in_order
from devices.clocks.live_clock import LiveClock

RATE_HZ, SKEW, OFFSET_S = 100.0, 200e-6, 4321.0


def taken(seed: int, skew: float = SKEW, count: int = 12_000) -> tuple[FloatArray, FloatArray, int]:
    """When samples were taken by the sensor's clock and by the host's; one in a hundred was lost, how many in all."""
    chance = np.random.default_rng(seed)
    number = np.delete(np.arange(count), chance.choice(np.arange(1, count - 1), count // 100, replace=False))
    device_s = 77.0 + number / RATE_HZ
    return device_s, device_s * (1 + skew) + OFFSET_S, count // 100


def in_bursts(taken_s: FloatArray, seed: int) -> FloatArray:
    """When samples arrive that a radio or a driver holds for up to 50 ms, and then lets through together."""
    chance = np.random.default_rng(seed)
    passes_s = taken_s[0] + np.cumsum(chance.uniform(0.0, 0.05, 4 * round(np.ptp(taken_s) / 0.05)))
    return passes_s[passes_s.searchsorted(taken_s)] + 0.0002


def disturbed(seed: int, count: int) -> tuple[IntArray, int, int]:
    """The order of arrival with 5 % overtaken by the next, 2 % doubled; how many were each."""
    chance = np.random.default_rng(seed)
    order = list(range(count))
    places = chance.choice(np.arange(1, count // 2), count // 20, replace=False) * 2  # none touches another
    for k in places.tolist():
        order[k - 1], order[k] = order[k], order[k - 1]
    again = set(chance.choice(count, count // 50, replace=False).tolist())
    rows = [row for number in order for row in ([number, number] if number in again else [number])]
    return np.array(rows), len(places), len(again)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("skew", [SKEW, -SKEW])
def test_drift_jitter_disorder_and_doubles_leave_two_milliseconds_and_exact_counts(seed: int, skew: float) -> None:
    device_s, taken_s, lost = taken(seed, skew)
    rows, late, doubled = disturbed(seed, len(device_s))
    arrived_s = np.maximum.accumulate(in_bursts(taken_s, seed)[rows])
    ordered = put_in_order(device_s[rows], arrived_s, None)
    assert np.array_equal(ordered.device_s, device_s)
    counts = ordered.counts
    assert (counts.received, counts.lost, counts.late) == (len(device_s), lost, late)
    assert (counts.doubled, counts.damaged) == (doubled, 0)
    assert np.sqrt(np.mean((ordered.time_s - taken_s) ** 2)) < 0.002
    assert ordered.residual_s < 0.002


@pytest.mark.parametrize("seed", range(5))
def test_messages_that_go_each_its_own_way_are_stamped_as_well(seed: int) -> None:
    device_s, taken_s, lost = taken(seed)
    arrived_s = taken_s + np.abs(np.random.default_rng(seed).normal(0.0, 0.05, len(taken_s)))
    rows = np.argsort(arrived_s)
    ordered = put_in_order(device_s[rows], arrived_s[rows], None)
    assert np.array_equal(ordered.device_s, device_s)
    assert (ordered.counts.received, ordered.counts.lost) == (len(device_s), lost)
    assert ordered.counts.late == sum(rows[k] < rows[:k].max() for k in range(1, len(rows)))
    assert np.sqrt(np.mean((ordered.time_s - taken_s) ** 2)) < 0.002


def test_what_is_held_up_and_may_not_be_passed_is_mostly_stamped_within_two_milliseconds() -> None:
    """The worst that a link does: of 12 000 arrivals some fifty come within ten milliseconds."""
    wrong_s = []
    for seed in range(12):
        device_s, taken_s, _ = taken(seed)
        delay_s = np.abs(np.random.default_rng(seed + 1000).normal(0.0, 0.05, len(taken_s)))
        fit = fit_clock(device_s, np.maximum.accumulate(taken_s + delay_s))
        wrong_s.append(float(np.sqrt(np.mean((fit.host_s(device_s) - taken_s) ** 2))))
    assert np.median(wrong_s) < 0.001
    assert np.mean(np.array(wrong_s) < 0.002) > 0.8


@pytest.mark.parametrize("seed", range(3))
def test_live_stamps_come_near_and_no_interval_looks_like_a_loss(seed: int) -> None:
    device_s, taken_s, _ = taken(seed)
    clock = LiveClock()
    read_s = np.ceil(in_bursts(taken_s, seed) / 0.015) * 0.015  # as a reader looks
    stamps_s = np.concatenate([clock.stamp(device_s[read_s == at_s], at_s) for at_s in np.unique(read_s)])
    steps = np.diff(stamps_s) / np.diff(device_s)
    assert steps.min() > 0.9
    assert steps.max() < 1.1
    settled_s = (stamps_s - taken_s)[1000:]
    assert np.sqrt(np.mean(settled_s**2)) < 0.002


def test_a_burst_that_was_held_up_moves_nothing() -> None:
    device_s = np.arange(12_000) / RATE_HZ
    taken_s = device_s + OFFSET_S
    arrived_s = taken_s + 0.001
    arrived_s[3000:3300] = taken_s[3300]
    ordered = put_in_order(device_s, arrived_s, 1 / RATE_HZ)
    assert np.abs(ordered.time_s - taken_s).max() < 0.0015
    assert ordered.counts.lost == 0


def test_a_wild_stamp_is_damage_and_a_restart_a_new_run() -> None:
    device_s = np.arange(800) / RATE_HZ
    host_s = device_s + 10.0
    device_s[50] = 9e9
    device_s[51] = -4.0
    device_s[520:] -= device_s[520] - 0.5
    host_s[520:] += 3.0
    ordered = put_in_order(device_s, host_s, 1 / RATE_HZ)
    assert ordered.counts.damaged == 2 + AGREEING - 1
    assert (np.diff(ordered.time_s) > 0).all()
    assert ordered.counts.lost == 2 + 300 + AGREEING - 1


def test_samples_whose_instants_an_earlier_run_took_are_counted() -> None:
    """The run before was held up by more than a second: nothing is left out that no count reports."""
    device_s = 10.0 + np.arange(400) / RATE_HZ
    host_s = device_s + 100.0
    host_s[:150] = host_s[150]
    device_s[:20] += 500.0
    ordered = put_in_order(device_s, host_s, 1 / RATE_HZ)
    counts = ordered.counts
    assert (np.diff(ordered.time_s) > 0).all()
    assert counts.received + counts.damaged == 400
    assert counts.damaged > 100


def test_a_wild_sample_at_the_beginning_takes_no_others_along() -> None:
    device_s = 10.0 + np.arange(400) / RATE_HZ
    host_s = device_s + 100.0
    host_s[:150] = host_s[150]
    device_s[0] = 9e9
    ordered = put_in_order(device_s, host_s, 1 / RATE_HZ)
    assert ordered.rows.tolist() == list(range(AGREEING, 400))
    assert (ordered.counts.damaged, ordered.counts.lost) == (AGREEING, 0)


def test_a_run_all_of_whose_instants_are_taken_is_counted_and_leaves_the_others_as_they_are() -> None:
    """It was held up, together with the run before it, which lasted longer."""
    true_s = 110.0 + np.arange(600) / RATE_HZ
    device_s, host_s = true_s.copy(), true_s.copy()
    device_s[300:350] -= 50.0
    device_s[350:360] -= 90.0
    host_s[300:360] = host_s[359]
    ordered = put_in_order(device_s, host_s, 1 / RATE_HZ, begins=[300, 350, 360])
    assert ordered.rows.tolist() == [*range(350), *range(360, 600)]
    true_s[300:350] += 0.1  # so long that run was held up
    assert np.abs(ordered.time_s - true_s[ordered.rows]).max() < 1e-6
    assert (ordered.counts.received, ordered.counts.damaged, ordered.counts.lost) == (590, 10, 10)


@pytest.mark.parametrize("ahead_s", [0.4, 2.0971, 4.9])
def test_a_stamp_that_is_a_little_ahead_moves_no_other(ahead_s: float) -> None:
    """As a changed bit among the microseconds of a message without a checksum makes it."""
    device_s = 10.0 + np.arange(2000) / RATE_HZ
    true_s = device_s + 100.0
    device_s[1000] += ahead_s
    ordered = put_in_order(device_s, true_s + 0.001, 1 / RATE_HZ)
    assert ordered.rows.tolist() == [*range(1000), *range(1001, 2000)]
    assert np.abs(ordered.time_s - true_s[ordered.rows]).max() < 0.002
    counts = ordered.counts
    assert (counts.damaged, counts.lost, counts.late, counts.doubled) == (1, 1, 0, 0)
    clock = LiveClock()
    live_s = np.concatenate([clock.stamp(device_s[k : k + 2], float(true_s[k + 1])) for k in range(0, 2000, 2)])
    assert np.flatnonzero(np.isnan(live_s)).tolist() == [1000]
    assert np.nanmax(np.abs(live_s - true_s)) < 0.001


def test_a_sample_that_came_in_time_before_all_were_held_up_is_kept() -> None:
    device_s = 10.0 + np.arange(400) / RATE_HZ
    host_s = device_s + 100.0
    host_s[1:100] = host_s[100]
    ordered = put_in_order(device_s, host_s, 1 / RATE_HZ)
    assert (ordered.counts.received, ordered.counts.damaged, ordered.counts.lost) == (400, 0, 0)


def test_live_a_start_that_was_held_up_is_left_behind_once_samples_come_in_time() -> None:
    device_s = 10.0 + np.arange(600) / RATE_HZ
    true_s = device_s + 100.0
    clock = LiveClock()
    late_s = np.where(np.arange(600) < 200, 1.5, 0.0)
    live_s = np.concatenate(
        [clock.stamp(device_s[k : k + 2], float(true_s[k + 1] + late_s[k])) for k in range(0, 600, 2)]
    )
    assert np.count_nonzero(np.isnan(live_s)) <= 6
    assert np.nanmax(np.abs(live_s - true_s)[210:]) < 0.002


@pytest.mark.parametrize("wild_s", [np.nan, np.inf, -np.inf, 1e308, -1e308])
def test_times_that_no_clock_shows_are_damage_live_and_afterwards(wild_s: float) -> None:
    device_s = 10.0 + np.arange(400) / RATE_HZ
    true_s = device_s + 100.0
    wild = [*range(7), 200, 399]
    device_s[wild] = wild_s
    ordered = put_in_order(device_s, true_s, 1 / RATE_HZ)
    assert (ordered.counts.received, ordered.counts.damaged) == (391, 9)
    assert np.abs(ordered.time_s - true_s[ordered.rows]).max() < 1e-6
    clock = LiveClock()
    live_s = [clock.stamp(device_s[k : k + 10], float(true_s[k + 9])) for k in range(0, 400, 10)]
    assert np.flatnonzero(np.isnan(np.concatenate(live_s))).tolist() == wild


def test_runs_do_not_depend_on_how_the_bytes_were_cut() -> None:
    device_s = np.concatenate([np.arange(100) / 50, np.arange(100) / 50])
    device_s[[7, 150]] = 1e6
    host_s = np.arange(200) / 50
    whole = ClockRuns().take(device_s, host_s)
    runs = ClockRuns()
    single = np.concatenate([runs.take(device_s[k : k + 1], host_s[k : k + 1]) for k in range(200)])
    assert np.array_equal(whole, single)
    assert set(whole.tolist()) == {-1, 0, 1}


@given(st.sampled_from([16, 24, 32]), st.lists(st.floats(0.001, 100.0), min_size=1, max_size=50))
def test_a_counter_goes_on_however_often_it_began_again(bits: int, pauses_s: list[float]) -> None:
    unwrapping, tick_hz = Unwrapping(bits, 32768.0), 32768.0
    host_s = np.cumsum(pauses_s)
    true = np.round(host_s * tick_hz).astype(int).tolist()
    counted = [unwrapping.ticks(tick % (1 << bits), at_s) for tick, at_s in zip(true, host_s.tolist(), strict=True)]
    assert np.array_equal(np.diff(counted), np.diff(true))


def test_one_arrival_is_a_clock_too() -> None:
    fit = fit_clock(np.array([5.0]), np.array([7.0]))
    assert fit.host_s(np.array([6.0]))[0] == 8.0
    ordered = put_in_order(np.empty(0), np.empty(0), None)
    assert ordered.counts.received == 0
    assert len(ordered.time_s) == 0


@pytest.mark.parametrize("once_more", [(), (100,)])
def test_a_clock_that_shows_what_it_showed_before_is_another_only_where_that_is_known(
    once_more: tuple[int, ...],
) -> None:
    device_s = np.concatenate([np.arange(100), np.arange(100, 200)]) / RATE_HZ
    taken_s = device_s + np.where(np.arange(200) < 100, 0.0, 4.0)
    ordered = put_in_order(device_s, taken_s + 0.002, None, (0, 100), once_more)
    if once_more:
        assert np.abs(ordered.time_s - taken_s).max() < 0.005
        assert ordered.counts.lost == 400
    else:  # they may have been held up on their way
        assert np.diff(ordered.time_s).max() < 0.011
        assert ordered.counts.lost == 0

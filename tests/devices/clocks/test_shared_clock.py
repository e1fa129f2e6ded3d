"""Tests that sensors sharing a clock are stamped by one line. Those that only claim to share one are left alone."""

import numpy as np

from core.samples import ImuBlock
from devices.clocks.shared_clock import tied
from devices.source import DecodedSensor, SensorCounts, SharedClock

STEP_S = 0.016667
TURN_S = 2.0**32 / 1e6


def sensor(name: str, late_s: float, *, clock: str = "one", moved_s: float = 0.0, seed: int = 0) -> DecodedSensor:
    """Samples of a grid, that arrive at least `late_s` late; each stamped as if it were alone."""
    taken_s = np.arange(1200) * STEP_S
    arrived_s = taken_s + late_s + np.random.default_rng(seed).exponential(0.004, len(taken_s))
    nothing = np.zeros((len(taken_s), 3))
    block = ImuBlock(name, taken_s + late_s, nothing, nothing)
    shared = SharedClock(clock, taken_s + moved_s, arrived_s, TURN_S)
    return DecodedSensor(block, SensorCounts(received=len(taken_s)), shared)


def starts_s(*sensors: DecodedSensor) -> list[float]:
    return [float(one.block.time_s[0]) for _, one in tied([(one.block.sensor, one) for one in sensors])]


def test_links_of_different_latency_do_not_part_what_one_clock_has_stamped() -> None:
    quick, slow = starts_s(sensor("a", 0.004), sensor("b", 0.019, seed=1))
    assert abs(slow - quick) < 1e-9
    assert abs(quick - 0.004) < 0.002, "the quickest link tells most"


def test_clocks_of_their_own_stay_apart() -> None:
    assert starts_s(sensor("a", 0.004, clock="one"), sensor("b", 0.019, clock="two")) == [0.004, 0.019]


def test_a_sensor_whose_clock_is_another_is_not_believed_and_draws_nobody_away() -> None:
    three = [sensor("a", 0.004), sensor("b", 0.006, seed=1), sensor("c", 0.005, moved_s=-0.4, seed=2)]
    found = tied([(one.block.sensor, one) for one in three])
    assert found[2][1].clock is None
    assert found[2][1].block.time_s[0] == 0.005
    assert abs(found[0][1].block.time_s[0] - found[1][1].block.time_s[0]) < 1e-9
    assert abs(found[0][1].block.time_s[0] - 0.004) < 0.002


def test_a_clock_that_began_again_between_two_first_samples_is_one_clock() -> None:
    quick, slow = starts_s(sensor("a", 0.004), sensor("b", 0.012, moved_s=TURN_S, seed=1))
    assert abs(slow - quick) < 1e-6


def test_one_alone_has_nobody_to_share_with() -> None:
    assert starts_s(sensor("a", 0.004)) == [0.004]

"""Shaking one sensor after the other, or moving the legs, gives where each is dressed."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from app.wizard.sensors.estimator import PlacingEstimator, PlacingState
from core.body import Side
from core.samples import ImuBlock
from tests.app.wizard.dressed_patient import BEGIN_S, Worn, in_blocks
from tests.core.cut_blocks import part_of

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

NAMES = tuple("ABCDEF")
RATE_HZ = 100.0


def lying(seconds: float) -> dict[str, ImuBlock]:
    """Six sensors on a table."""
    rng, time_s = np.random.default_rng(1), np.arange(0.0, seconds, 1 / RATE_HZ)
    gravity = np.array([0.0, 0.0, 9.81])
    return {
        name: ImuBlock(
            name, time_s, rng.normal(0.0, 0.01, (len(time_s), 3)), gravity + rng.normal(0.0, 0.05, (len(time_s), 3))
        )
        for name in NAMES
    }


def moved(block: ImuBlock, from_s: float, to_s: float, hz: float, rad_s: float, m_s2: float) -> ImuBlock:
    """Turned and pushed to and fro between two instants."""
    is_inside = (block.time_s >= from_s) & (block.time_s < to_s)
    to_and_fro = np.where(is_inside, np.sin(2 * np.pi * hz * (block.time_s - from_s)), 0.0)[:, None]
    along = np.array([0.8, 0.5, 0.33])
    gyr_rad_s = block.gyr_rad_s + rad_s * to_and_fro * along
    return replace(block, gyr_rad_s=gyr_rad_s, acc_m_s2=block.acc_m_s2 + m_s2 * to_and_fro * along)


def shaken(block: ImuBlock, from_s: float, to_s: float, hz: float = 3.0) -> ImuBlock:
    return moved(block, from_s, to_s, hz, rad_s=7.0, m_s2=12.0)


def states(blocks: Iterator[dict[str, ImuBlock]]) -> list[PlacingState]:
    estimator, reported = PlacingEstimator(NAMES), []
    for block in blocks:
        estimator.update(block)
        reported.append(estimator.state)
    return reported


def runs(values: list[object]) -> list[object]:
    """The values without repetitions."""
    return [value for k, value in enumerate(values) if k == 0 or value != values[k - 1]]


@pytest.mark.parametrize("hz", [2.0, 3.0, 5.0])
def test_one_after_the_other_is_recognised_within_a_second_and_a_half(hz: float) -> None:
    streams = lying(12.0)
    streams["B"] = shaken(streams["B"], 2.0, 4.5, hz)
    streams["E"] = shaken(streams["E"], 7.0, 9.5, hz)
    reported = states(in_blocks(streams, 0.03))
    assert runs([state.shaken for state in reported]) == [None, "B", None, "E", None]
    assert reported[-1].shakes == 2
    first = next(k for k, state in enumerate(reported) if state.shaken) * 0.03
    assert 2.9 < first < 3.5
    assert not any(state.shaken_together for state in reported)


def test_a_sensor_counts_again_once_it_was_calm() -> None:
    streams = lying(14.0)
    streams["A"] = shaken(shaken(streams["A"], 2.0, 6.0), 9.0, 11.0)
    reported = states(in_blocks(streams, 0.03))
    assert runs([(state.shaken, state.shakes) for state in reported]) == [
        (None, 0),
        ("A", 1),
        (None, 1),
        ("A", 2),
        (None, 2),
    ]


def test_two_at_once_are_named_and_neither_counts() -> None:
    streams = lying(8.0)
    for name, from_s in (("C", 2.0), ("D", 2.3)):
        streams[name] = shaken(streams[name], from_s, 5.0)
    reported = states(in_blocks(streams, 0.03))
    assert runs([state.shaken_together for state in reported]) == [(), ("C", "D"), ()]
    assert reported[-1].shakes == 0


@pytest.mark.parametrize(
    ("rad_s", "m_s2", "hz"), [(3.0, 6.0, 2.0), (7.0, 12.0, 3.0)], ids=["carried in a box", "the box is shaken"]
)
def test_moving_all_of_them_shakes_nobody(rad_s: float, m_s2: float, hz: float) -> None:
    streams = {name: moved(block, 2.0, 8.0, hz, rad_s, m_s2) for name, block in lying(10.0).items()}
    reported = states(in_blocks(streams, 0.03))
    assert all(state.shaken is None and not state.shaken_together for state in reported)


def test_strapping_one_on_is_no_shaking() -> None:
    streams = lying(10.0)
    streams["F"] = moved(moved(streams["F"], 1.0, 8.0, 0.4, 2.5, 2.0), 3.0, 3.6, 2.0, 5.0, 8.0)
    assert all(state.shaken is None for state in states(in_blocks(streams, 0.03)))


def test_a_sensor_that_has_fallen_silent_keeps_nobody_from_being_recognised() -> None:
    streams = lying(8.0)
    silent = streams["C"]
    streams["C"] = ImuBlock("C", silent.time_s[:100], silent.gyr_rad_s[:100], silent.acc_m_s2[:100])
    streams["B"] = shaken(streams["B"], 4.0, 6.5)
    assert states(in_blocks(streams, 0.03))[-1].shakes == 1


def test_the_legs_are_reported_and_their_sides_by_who_moved_first(dressed: Worn) -> None:
    estimator, reported = PlacingEstimator(dressed.site_of), []
    for block in in_blocks(dressed.free_motion, 0.03):
        estimator.update(block)
        reported.append(estimator.state)
    named = [state.sites(Side.LEFT) for state in reported]
    assert all(sites in ({}, dressed.site_of) for sites in named)  # never anything wrong
    assert named[-1] == dressed.site_of
    mirrored = {name: site.side for name, site in reported[-1].sites(Side.RIGHT).items()}
    assert all(mirrored[name] is not site.side for name, site in dressed.site_of.items())
    assert not any(state.shaken or state.shaken_together for state in reported)


def test_standing_and_shaking_show_no_legs(dressed: Worn) -> None:
    streams = dict(dressed.standing)
    for number, name in enumerate(streams):
        streams[name] = shaken(streams[name], BEGIN_S + 0.8 * number, BEGIN_S + 0.8 * (number + 1))
    estimator = PlacingEstimator(dressed.site_of)
    for block in in_blocks(streams, 0.03):
        estimator.update(block)
        assert not estimator.state.is_sure


@pytest.mark.parametrize("block_s", [0.013, 60.0])
def test_the_size_of_the_blocks_changes_nothing(dressed: Worn, block_s: float) -> None:
    usual, other = PlacingEstimator(dressed.site_of), PlacingEstimator(dressed.site_of)
    # a look that is going on at the end gives nothing yet, unless one block brings all its steps
    streams = {name: part_of(block, BEGIN_S, BEGIN_S + 21.9) for name, block in dressed.free_motion.items()}
    name = next(iter(streams))
    streams[name] = shaken(streams[name], BEGIN_S + 20.5, BEGIN_S + 21.9)
    for estimator, size_s in ((usual, 0.03), (other, block_s)):
        for block in in_blocks(streams, size_s):
            estimator.update(block)
    assert other.state == usual.state


def test_a_state_that_was_read_stays_as_it_was() -> None:
    streams = lying(4.0)
    streams["B"] = shaken(streams["B"], 1.0, 3.0)
    reported = states(in_blocks(streams, 0.03))
    before, amid = reported[30], reported[60]
    assert before.movement_deg_s["B"] < 3.0
    assert amid.movement_deg_s["B"] > 100.0

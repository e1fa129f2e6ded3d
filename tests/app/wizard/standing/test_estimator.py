"""Standing still: by name, with bars that agree with the verdict."""

from dataclasses import replace

import pytest

from app.wizard.standing.estimator import LIMIT_DEG_S, StandingEstimator, StandingView
from core.samples import ImuBlock
from tests.app.wizard.dressed_patient import BEGIN_S, Worn, in_blocks


def states(dressed: Worn, streams: dict[str, ImuBlock], block_s: float = 0.03) -> list[StandingView]:
    estimator, reported = StandingEstimator(dressed.site_of), []
    for block in in_blocks(streams, block_s):
        estimator.update(block)
        reported.append(estimator.state)
    return reported


def swayed(dressed: Worn, at_s: float) -> tuple[str, dict[str, ImuBlock]]:
    """One sensor turns for a moment."""
    name = sorted(dressed.standing)[2]
    block = dressed.standing[name]
    gyr_rad_s = block.gyr_rad_s.copy()
    gyr_rad_s[(block.time_s >= at_s) & (block.time_s < at_s + 0.1), 0] += 0.4
    return name, {**dressed.standing, name: replace(block, gyr_rad_s=gyr_rad_s)}


def test_who_is_still_is_done_with_every_sensor_at_rest(dressed: Worn) -> None:
    last = states(dressed, dict(dressed.standing))[-1]
    assert set(last.standing.rest) == set(dressed.site_of)
    assert last.standing.restarts == 0
    assert 0.0 < max(last.movement_deg_s.values()) < LIMIT_DEG_S


def test_the_bars_pass_the_limit_just_when_the_verdict_states_so(dressed: Worn) -> None:
    name, streams = swayed(dressed, BEGIN_S + 2.0)
    reported = states(dressed, streams)
    for state in reported:
        over = tuple(one for one, deg_s in state.movement_deg_s.items() if deg_s >= LIMIT_DEG_S)
        assert over == state.standing.moved
    assert {state.standing.moved for state in reported} == {(), (name,)}
    assert reported[-1].standing.restarts == 1


def test_a_sensor_that_is_not_worn_is_passed_over(dressed: Worn) -> None:
    first, *others = sorted(dressed.standing)
    estimator = StandingEstimator(others)
    for block in in_blocks(dressed.standing, 0.1):
        estimator.update(block)
    assert first not in estimator.state.movement_deg_s
    assert estimator.state.standing.is_done


@pytest.mark.parametrize("block_s", [0.013, 10.0])
def test_the_size_of_the_blocks_changes_nothing(dressed: Worn, block_s: float) -> None:
    _, streams = swayed(dressed, BEGIN_S + 1.5)
    usual, other = states(dressed, streams)[-1], states(dressed, streams, block_s)[-1]
    assert other.movement_deg_s == usual.movement_deg_s
    assert (other.standing.still_s, other.standing.moved, other.standing.restarts) == (
        usual.standing.still_s,
        usual.standing.moved,
        usual.standing.restarts,
    )
    assert set(other.standing.rest) == set(usual.standing.rest) == set(dressed.site_of)

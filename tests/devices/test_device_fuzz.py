"""Damaged streams raise nothing, lose nothing whole and are not hoarded."""

import pytest

from tests.safety.device_fuzz import drivers, fuzz, old_shimmer3

LONG = 30_000
COUNTS = (2_000, pytest.param(LONG, marks=pytest.mark.endurance))


@pytest.mark.parametrize("frames", COUNTS)
@pytest.mark.parametrize("name", drivers())
def test_damage_stays_where_it_is(name: str, frames: int) -> None:
    outcome = fuzz(drivers()[name], frames, seed=7)
    assert outcome.faults == []
    assert outcome.count["whole"] > 0.7 * frames


@pytest.mark.parametrize("frames", COUNTS)
def test_without_checksums_damage_costs_one_whole_message_in_a_thousand_at_most(frames: int) -> None:
    assert fuzz(old_shimmer3(), frames, seed=2).faults == []


@pytest.mark.endurance
@pytest.mark.parametrize("name", drivers())
def test_after_a_burst_of_damage_it_is_in_step_again(name: str) -> None:
    outcome = fuzz(drivers()[name], LONG, seed=7, has_bursts=True)
    assert outcome.faults == []
    assert outcome.count["whole"] > 0.6 * LONG

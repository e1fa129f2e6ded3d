"""Tests of what is called different on people measured twice, and of what is found when it is there."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from core.parameters import SPEED, STANCE
from tests.benchmarks.null_differences import tally_pair
from tests.benchmarks.repeat_visits import FEET, called, found, people_called
from tests.benchmarks.repeated_people import (
    FOOT_ANGLE,
    HEALTHY,
    STROKE,
    Repeated,
    after,
    before,
    legs_of_visits,
    rehabilitation,
    two_visits,
)

MOST_CALLED = {HEALTHY: 5.0, STROKE: 9.0}  # percent; people after a stroke do change between two days


@pytest.fixture
def folder(test_data: Callable[[str], Path]) -> Path:
    return test_data("repeat_visits")


@pytest.fixture
def twice(folder: Path) -> dict[str, list[Repeated]]:
    return {who: two_visits(folder, who) for who in (HEALTHY, STROKE)}


@pytest.mark.parametrize("who", [HEALTHY, STROKE])
def test_two_visits_of_people_who_did_not_change_are_called_alike(twice: dict[str, list[Repeated]], who: str) -> None:
    shares = {quantity: called(twice[who], quantity, after) for quantity in FEET}
    assert max(marked for marked, _, _ in shares.values()) <= MOST_CALLED[who], shares
    assert max(beyond_speed for _, _, beyond_speed in shares.values()) <= MOST_CALLED[who], shares


@pytest.mark.parametrize("who", [HEALTHY, STROKE])
def test_page_one_states_nothing_of_nearly_all_who_did_not_change(twice: dict[str, list[Repeated]], who: str) -> None:
    stated, people = people_called(twice[who], after)
    assert stated <= 0.05 * people, f"{stated} of {people}"


def test_changes_of_stance_over_a_rehabilitation_are_called(folder: Path) -> None:
    _, from_first_to_last = rehabilitation(folder)
    assert called(from_first_to_last, STANCE, after)[0] >= 15.0


@pytest.mark.parametrize(
    ("who", "quantity", "change", "least"),
    [(HEALTHY, STANCE, 4.0, 75.0), (HEALTHY, FOOT_ANGLE, 8.0, 90.0), (STROKE, FOOT_ANGLE, 8.0, 75.0)],
)
def test_a_known_change_between_visits_is_found(
    twice: dict[str, list[Repeated]], who: str, quantity: str, change: float, least: float
) -> None:
    assert found(twice[who], quantity, change, after)[0] >= least


@pytest.mark.parametrize("who", [HEALTHY, STROKE])
@pytest.mark.parametrize("change_m_s", FEET[SPEED])
def test_a_change_of_speed_is_found_as_often_as_before(
    twice: dict[str, list[Repeated]], who: str, change_m_s: float
) -> None:
    assert found(twice[who], SPEED, change_m_s, after)[0] >= found(twice[who], SPEED, change_m_s, before)[0]


def test_healthy_legs_are_alike_and_those_after_a_stroke_are_not(folder: Path) -> None:
    pairs = {who: legs_of_visits(folder, who) for who in (HEALTHY, STROKE)}
    marked = {who: Counter(after(pair).is_marked for pair in of_who) for who, of_who in pairs.items()}
    assert marked[HEALTHY][True] <= 0.05 * marked[HEALTHY].total()
    assert marked[STROKE][True] >= 0.3 * marked[STROKE].total()


@pytest.mark.endurance
@pytest.mark.parametrize("name", ["strapped again", "two days"])
def test_a_simulated_body_strapped_again_is_called_the_same(name: str) -> None:
    tallies = [tally_pair(seed, name)[0] for seed in range(4)]
    judged = sum(len(one.judged) for one in tallies)
    assert judged > 300
    assert sum(len(one.larger) for one in tallies) <= 0.05 * judged
    assert sum(len(one.stated) for one in tallies) <= 0.05 * sum(one.eligible for one in tallies)

"""Goals hold from the day on which they were agreed to that on which they end, and nothing of them is lost."""

import datetime
import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.body import Side
from core.goals import (
    GOAL_COLUMNS,
    MOST,
    NO_GOALS,
    OF_TESTS,
    AgreedGoals,
    Goal,
    GoalOf,
    agreed_by,
    brought_together,
    goal_of_table,
    goal_table,
    goals_of_text,
    goals_text,
    held,
    held_on,
    ordered,
    taken_back,
    whose,
    with_goal,
)
from core.parameters import BY_COLUMN, QuantityClass
from core.verdicts.goals import GoalStanding, error_of_visit, standing
from core.verdicts.quantities import OF_HIPS
from core.verdicts.sigmas import ComparisonKind, sigma_of
from core.verdicts.stride_means import MeanOfStrides

KNEE, SPEED, STANCE = "knee_stance_to_swing_deg", "speed_m_s", "stance_percent"
DAY = datetime.date(2026, 9, 30)
NEXT, LATER = DAY + datetime.timedelta(days=1), DAY + datetime.timedelta(days=30)
GOAL = Goal(KNEE, GoalOf.LEFT, 55.0, DAY, "H. Keller", note="stairs", until=LATER)
DAYS = st.dates(datetime.date(2020, 1, 1), datetime.date(2030, 1, 1))
TEXTS = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=20)


@st.composite
def goals(draw: st.DrawFn) -> Goal:
    column = draw(st.sampled_from(GOAL_COLUMNS))
    of = draw(st.sampled_from(whose(column)))
    agreed = draw(DAYS)
    return Goal(
        column,
        of,
        draw(st.floats(0.01, MOST[column])),
        agreed,
        draw(TEXTS),
        is_at_most=of is GoalOf.BETWEEN or draw(st.booleans()),
        note=draw(TEXTS),
        until=draw(st.none() | DAYS),
        ended=draw(st.none() | st.dates(agreed, datetime.date(2030, 1, 1))),
        ended_by=draw(TEXTS),
    )


@given(st.lists(goals(), max_size=4))
def test_what_is_written_is_read_as_it_was(several: list[Goal]) -> None:
    assert goals_of_text(goals_text(several)) == ordered(several)
    for goal in several:
        assert goal_of_table(json.loads(json.dumps(goal_table(goal)))) == goal


@pytest.mark.parametrize(
    "change",
    [
        {"measure": "knee_swing_peak_deg"},
        {"of": "both"},
        {"value": True},
        {"value": "55"},
        {"value": 500.0},
        {"value": float("nan")},
        {"agreed": "30 September"},
        {"by": 7},
        {"colour": "red"},
    ],
)
def test_what_is_no_goal_is_not_taken_for_one(change: dict[str, object]) -> None:
    assert goal_of_table(goal_table(GOAL)) == GOAL
    assert goal_of_table(goal_table(GOAL) | change) is None
    assert goals_of_text(json.dumps([goal_table(GOAL), goal_table(GOAL) | change])) == ()


def test_every_measure_of_a_goal_is_judged_between_visits_and_none_is_a_height() -> None:
    for column in GOAL_COLUMNS:
        assert (sigma_of(column, ComparisonKind.VISITS) is None) is (column in OF_TESTS or column in OF_HIPS)
        assert column not in BY_COLUMN or BY_COLUMN[column].rests_on is not QuantityClass.HEIGHT
        if GoalOf.BETWEEN in whose(column):
            assert (sigma_of(column, ComparisonKind.LEGS) is None) is (column in OF_HIPS)


def test_a_goal_of_a_hip_is_reported_and_not_judged() -> None:
    found = MeanOfStrides(42.0, 3.0, 20, 0.7, 0.0)
    goal = replace(GOAL, column="hip_range_deg", value=45.0)
    assert standing(goal, 42.0, error_of_visit("hip_range_deg", found)) is GoalStanding.NOT_JUDGED
    goal = replace(GOAL, column="knee_range_deg", value=45.0)
    assert standing(goal, 42.0, error_of_visit("knee_range_deg", found)) is not GoalStanding.NOT_JUDGED
    assert whose("knee_swing_peak_deg") == ()


def test_legs_are_to_differ_by_at_most_a_value() -> None:
    assert Goal(STANCE, GoalOf.BETWEEN, 0.0, DAY, is_at_most=True).value == 0.0
    with pytest.raises(ValueError, match="at most"):
        Goal(STANCE, GoalOf.BETWEEN, 2.0, DAY)
    with pytest.raises(ValueError, match="no goal is of"):
        Goal(SPEED, GoalOf.LEFT, 1.0, DAY)
    with pytest.raises(ValueError, match="expected"):
        Goal(KNEE, GoalOf.LEFT, 0.0, DAY)


def test_a_goal_that_replaces_another_ends_it_and_leaves_those_of_other_figures() -> None:
    other, right = Goal(SPEED, GoalOf.WALK, 1.2, DAY), replace(GOAL, of=GoalOf.RIGHT)
    more = Goal(KNEE, GoalOf.LEFT, 60.0, LATER, "B. Berger")
    found = with_goal((GOAL, right, other), more)
    assert set(held(found)) == {right, other, more}
    assert replace(GOAL, ended=LATER, ended_by="B. Berger") in found
    assert {one.key for one in held_on(found, NEXT)} == {GOAL.key, right.key, other.key}
    back = taken_back(found, more.key, LATER, "H. Keller")
    assert {one.key for one in held(back)} == {right.key, other.key}
    assert len(back) == 4


def test_a_measure_is_chosen_before_a_visit_only_by_a_goal_agreed_before_its_day() -> None:
    assert agreed_by([GOAL], NEXT).chosen == {GOAL.key}
    assert agreed_by([GOAL], DAY).chosen == frozenset()  # after the walk, for all that is known
    assert agreed_by([GOAL], DAY).held == (GOAL,)
    earlier = DAY - datetime.timedelta(days=1)
    assert agreed_by([GOAL], earlier) == AgreedGoals((), frozenset(), earlier)
    assert agreed_by([GOAL], None) == NO_GOALS
    ended = replace(GOAL, ended=NEXT)
    assert agreed_by([ended], NEXT) == AgreedGoals((), frozenset({GOAL.key}), NEXT)  # it held when that day began
    assert agreed_by([ended], LATER).chosen == frozenset()


def test_a_goal_is_shown_on_its_own_day_until_the_day_on_which_it_ends() -> None:
    ended = replace(GOAL, ended=LATER)
    assert held_on([ended], DAY) == (ended,)
    assert held_on([ended], LATER) == held_on([ended], DAY - datetime.timedelta(days=1)) == ()


def test_whose_figure_was_chosen() -> None:
    chosen = AgreedGoals((), frozenset({(KNEE, GoalOf.LEFT), (STANCE, GoalOf.BETWEEN), (SPEED, GoalOf.WALK)}))
    assert chosen.is_chosen(KNEE, (Side.LEFT,))
    assert not chosen.is_chosen(KNEE, (Side.RIGHT,))
    assert chosen.is_chosen(STANCE, (Side.RIGHT,))
    assert chosen.is_chosen(SPEED, (Side.RIGHT,))
    assert not chosen.is_chosen("knee_range_deg", tuple(Side))


def test_the_goals_of_a_row_are_those_of_its_leg_of_the_walk_and_between_the_legs() -> None:
    right = replace(GOAL, of=GoalOf.RIGHT)
    apart = Goal(KNEE, GoalOf.BETWEEN, 5.0, DAY, is_at_most=True)
    agreed = AgreedGoals((GOAL, right, apart))
    assert agreed.of(KNEE, Side.LEFT) == (GOAL, apart)
    assert agreed.of(KNEE) == (GOAL, right, apart)
    assert agreed.of(SPEED) == ()


@given(st.lists(goals(), max_size=4), st.lists(goals(), max_size=4))
def test_two_places_together_have_all_goals_once_and_one_that_holds_of_each_figure(
    some: list[Goal], others: list[Goal]
) -> None:
    found = brought_together(some, others)
    keys = [goal.key for goal in held(found)]
    assert len(keys) == len(set(keys))
    agreed = {replace(goal, ended=None, ended_by="") for goal in (*some, *others)}
    assert {replace(goal, ended=None, ended_by="") for goal in found} == agreed
    assert brought_together(found, found) == found


def test_what_ended_in_one_place_has_ended() -> None:
    ended = replace(GOAL, ended=LATER, ended_by="B. Berger")
    assert brought_together([GOAL], [ended]) == brought_together([ended], [GOAL]) == (ended,)

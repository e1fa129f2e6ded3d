"""Goals that were agreed with a patient: of a measure, which value, on which side, by whom, and since when.

The day on which a goal was agreed is that on which it was typed and is never chosen, so that no goal was agreed before
the visit it is held against but those that were. What is taken back or replaced stays, with the day on which it ended.
"""

import datetime
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from enum import StrEnum
from typing import Any

from core.body import Side
from core.parameters import BY_COLUMN, COMPARED, OF_WALK, STRIDE_LENGTH


class GoalOf(StrEnum):
    """Whose figure a goal is of: a leg's, the walk's, or by how much both legs differ, whichever has more."""

    LEFT = "left"
    RIGHT = "right"
    WALK = "both"
    BETWEEN = "between"

    @property
    def side(self) -> Side | None:
        return Side(self.value) if self in (GoalOf.LEFT, GoalOf.RIGHT) else None


# what a goal can be of, with what its value may be at most
_WITH_GOAL = {column: most for column in COMPARED if (most := BY_COLUMN[column].most) is not None}
OF_WALKS = {column: most for column, most in _WITH_GOAL.items() if column in OF_WALK}
OF_LEGS = {column: most for column, most in _WITH_GOAL.items() if column not in OF_WALK}
OF_TESTS = {  # of timed tests, as `core.timed.measures` calls them
    "ten_metres_speed_m_s": 3.0,
    "two_minutes_distance_m": 400.0,
    "six_minutes_distance_m": 1200.0,
    "up_and_go_time_s": 300.0,
    "sit_to_stand_time_s": 300.0,
}
NOT_BETWEEN = (STRIDE_LENGTH,)
MOST = {**OF_LEGS, **OF_WALKS, **OF_TESTS}
GOAL_COLUMNS = tuple(MOST)
LEAST = 0.01  # but legs may be required not to differ at all
MOST_NOTE = 200  # letters

DAYS = ("agreed", "until", "ended")

GoalKey = tuple[str, GoalOf]
"""The column and whose figure it is: of each, one goal holds."""


@dataclass(frozen=True, slots=True)
class Goal:
    """`value` in the unit that the column's name ends with; between the legs it is the most that they may differ by.

    `agreed` is the day on which it was typed, `by` who typed it, `until` the day by which it is to be reached, where
    one was named. `ended`: the day on which it was taken back or replaced, and by whom; None while it holds.

    Raises
    ------
    ValueError
        No goal can be of this figure, or the value is beyond what any walk has.
    """

    column: str
    of: GoalOf
    value: float
    agreed: datetime.date
    by: str = ""
    is_at_most: bool = False
    note: str = ""
    until: datetime.date | None = None
    ended: datetime.date | None = None
    ended_by: str = ""

    def __post_init__(self) -> None:
        if self.of not in whose(self.column):
            raise ValueError(f"no goal is of {self.column}, {self.of}")
        least = 0.0 if self.of is GoalOf.BETWEEN else LEAST
        if not least <= self.value <= MOST[self.column]:
            raise ValueError(f"{self.column} is {self.value}, expected {least} to {MOST[self.column]}")
        if self.of is GoalOf.BETWEEN and not self.is_at_most:
            raise ValueError("legs differ by at most a value, not by at least one")

    @property
    def key(self) -> GoalKey:
        return self.column, self.of

    @property
    def is_held(self) -> bool:
        """Whether it was neither taken back nor replaced."""
        return self.ended is None

    def is_held_on(self, day: datetime.date) -> bool:
        """Whether it held at the end of a day."""
        return self.agreed <= day and (self.ended is None or self.ended > day)

    def is_chosen_before(self, day: datetime.date) -> bool:
        """Whether it was agreed before a day, never on it or after, and held when that day began."""
        return self.agreed < day and (self.ended is None or self.ended >= day)


def is_of_walk(column: str) -> bool:
    """Whether a figure is no leg's: both together have one, in walking or in a timed test."""
    return column in OF_WALKS or column in OF_TESTS


def whose(column: str) -> tuple[GoalOf, ...]:
    """Whose figure a goal of a column can be of; nobody's where no goal can be of it."""
    if is_of_walk(column):
        return (GoalOf.WALK,)
    if column not in OF_LEGS:
        return ()
    return (GoalOf.LEFT, GoalOf.RIGHT) if column in NOT_BETWEEN else (GoalOf.LEFT, GoalOf.RIGHT, GoalOf.BETWEEN)


def held(goals: Iterable[Goal]) -> tuple[Goal, ...]:
    """Those that hold now."""
    return tuple(goal for goal in goals if goal.is_held)


def held_on(goals: Iterable[Goal], day: datetime.date) -> tuple[Goal, ...]:
    """Those that held at the end of a day."""
    return tuple(goal for goal in goals if goal.is_held_on(day))


@dataclass(frozen=True, slots=True)
class AgreedGoals:
    """What had been agreed by a day: the goals `held` at its end, and what those were of that were agreed before it.

    A measure is `chosen` only by a goal that was agreed before the day, so never by one that somebody agreed on who
    had seen what was measured.
    """

    held: tuple[Goal, ...] = ()
    chosen: frozenset[GoalKey] = frozenset()
    day: datetime.date | None = None

    @property
    def reported(self) -> tuple[Goal, ...]:
        """Goals of which it may be stated whether they are reached: agreed before the day, and held at its end."""
        return tuple(goal for goal in self.held if self.day is not None and goal.agreed < self.day)

    def is_chosen(self, column: str, sides: Iterable[Side]) -> bool:
        """Whether a goal was of a column of one of these legs, of the walk, or of what the legs differ by."""
        required = {GoalOf.WALK, GoalOf.BETWEEN, *(GoalOf(side.value) for side in sides)}
        return any(one == column and of in required for one, of in self.chosen)

    def of(self, column: str, side: Side | None = None) -> tuple[Goal, ...]:
        """The goals of a column that are no other leg's; without a side, all of them."""
        own = (None, side) if side is not None else (None, *Side)
        return tuple(goal for goal in self.held if goal.column == column and goal.of.side in own)


NO_GOALS = AgreedGoals()


def agreed_by(goals: Iterable[Goal], day: datetime.date | None) -> AgreedGoals:
    """What had been agreed by a day; nothing where the day is not known."""
    if day is None:
        return NO_GOALS
    every = tuple(goals)
    return AgreedGoals(held_on(every, day), frozenset(goal.key for goal in every if goal.is_chosen_before(day)), day)


def ordered(goals: Iterable[Goal]) -> tuple[Goal, ...]:
    """By the day on which they were agreed, so that the same goals are the same wherever they are kept."""
    return tuple(sorted(goals, key=lambda goal: (goal.agreed, GOAL_COLUMNS.index(goal.column), goal.of)))


def with_goal(goals: Sequence[Goal], goal: Goal) -> tuple[Goal, ...]:
    """The same with one more, which replaces what was agreed of the same figure."""
    return ordered((*taken_back(goals, goal.key, goal.agreed, goal.by), goal))


def taken_back(goals: Sequence[Goal], key: GoalKey, day: datetime.date, by: str) -> tuple[Goal, ...]:
    """The same, where what is held of a figure ends."""
    return tuple(
        replace(one, ended=max(day, one.agreed), ended_by=by) if one.key == key and one.is_held else one
        for one in goals
    )


def brought_together(goals: Iterable[Goal], others: Iterable[Goal]) -> tuple[Goal, ...]:
    """What two places hold of one patient's goals: what ended in one has ended, and of one figure the latest holds."""
    known: dict[Goal, Goal] = {}
    for goal in (*goals, *others):
        as_agreed = replace(goal, ended=None, ended_by="")
        before = known.get(as_agreed)
        if before is None or before.is_held:
            known[as_agreed] = goal
    together: tuple[Goal, ...] = ()
    for goal in ordered(known.values()):
        together = with_goal(together, goal) if goal.is_held else (*together, goal)
    return ordered(together)


# as they are kept


def goal_table(goal: Goal) -> dict[str, object]:
    """A goal as plain values, for a file: what is empty is left out."""
    reported = {"measure": goal.column, **asdict(goal)}
    del reported["column"]
    plain = {name: value.isoformat() if isinstance(value, datetime.date) else value for name, value in reported.items()}
    plain["of"] = str(goal.of)
    return {name: value for name, value in plain.items() if name == "value" or value not in (None, "", False)}


def goal_of_table(table: object) -> Goal | None:
    """What `goal_table` was given; None of anything else."""
    names = {"measure", *(field.name for field in fields(Goal))} - {"column"}
    if not isinstance(table, Mapping) or not {"measure", "of", "value", "agreed"} <= set(table) <= names:
        return None
    reported = dict(table)
    value, is_at_most = reported.pop("value"), reported.pop("is_at_most", False)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not isinstance(is_at_most, bool) or not all(isinstance(one, str) for one in reported.values()):
        return None
    try:
        days = {name: datetime.date.fromisoformat(reported.pop(name)) for name in DAYS if name in reported}
        named: dict[str, Any] = {**days, **reported, "of": GoalOf(reported.pop("of")), "is_at_most": is_at_most}
        return Goal(named.pop("measure"), value=float(value), **named)
    except (ValueError, OverflowError):
        return None


def goals_of_tables(tables: object) -> tuple[Goal, ...] | None:
    """Goals out of a list of tables; None where one of them is none, or the list is no list."""
    if not isinstance(tables, list):
        return None
    found = [goal_of_table(table) for table in tables]
    return ordered(goal for goal in found if goal is not None) if None not in found else None


def goals_text(goals: Sequence[Goal]) -> str:
    """Goals in one line of JSON; empty where there are none."""
    return json.dumps([goal_table(goal) for goal in goals], separators=(",", ":"), ensure_ascii=False) if goals else ""


def goals_of_text(text: str) -> tuple[Goal, ...]:
    """What `goals_text` was given; none of anything else."""
    try:
        return goals_of_tables(json.loads(text)) or () if text else ()
    except (ValueError, RecursionError):
        return ()

"""A patient's course as lanes over the dates of the visits: what is drawn, and what has changed since the first one.

Conditions stand side by side and are never joined. What is not reported is a gap, and a change counts from the first
visit that can be read.
"""

import datetime
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple
from uuid import UUID

from app.summary.course import Course, CourseCondition, change, change_between_legs
from core.body import Side
from core.goals import Goal, GoalOf, held, is_of_walk
from core.parameters import KNEE, SPEED, STANCE
from core.timed.measures import COLUMNS, PROTOCOLS
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict

MOST_TOGETHER = 4  # conditions in one lane: as many marks can be distinguished
USUAL_LANES, MOST_LANES = 3, 4  # without goals, and with as many


class LaneKind(NamedTuple):
    """What a lane is of: a figure of the walk or of each leg, or by how much the left leg has more than the right."""

    column: str
    is_between: bool = False

    @property
    def is_of_walk(self) -> bool:
        return is_of_walk(self.column)

    @property
    def is_of_test(self) -> bool:
        return self.column in PROTOCOLS


SPEED_LANE, KNEE_LANE, STANCE_LANE = LaneKind(SPEED), LaneKind(KNEE), LaneKind(STANCE, is_between=True)
USUAL = (SPEED_LANE, KNEE_LANE, STANCE_LANE)


@dataclass(frozen=True, slots=True)
class CourseVisit:
    """One visit on the axis of dates. `course` None: it is not computed yet, or no longer holds.

    `clock`: at which time of that day, where it is known; it distinguishes visits of one day.
    """

    id: UUID
    day: datetime.date
    course: Course | None
    clock: str = ""


@dataclass(frozen=True, slots=True)
class LanePoint:
    """One value at the visit of this number. `value` NaN: it cannot be read; `whisker` NaN: no error is known."""

    visit: int
    value: float
    whisker: float
    verdict: Verdict

    @property
    def is_reported(self) -> bool:
        return math.isfinite(self.value)


@dataclass(frozen=True, slots=True)
class LaneLine:
    """The points of one condition, and of one leg where the lane is of legs, in order of time."""

    condition: str
    side: Side | None
    points: tuple[LanePoint, ...]

    @property
    def reported(self) -> tuple[LanePoint, ...]:
        return tuple(point for point in self.points if point.is_reported)


@dataclass(frozen=True, slots=True)
class LaneChange:
    """The last visit of a line, less the first that can be read, and less the one before it that can be."""

    line: LaneLine
    since_first: Difference | None
    since_last: Difference | None
    first: int | None  # the visits' numbers
    before: int | None


@dataclass(frozen=True, slots=True)
class CourseLane:
    """`changes`: of the lines of the condition that is reported. `band`: its first visit less and plus the error.

    `goals`: those that hold now.
    """

    kind: LaneKind
    lines: tuple[LaneLine, ...]
    changes: tuple[LaneChange, ...]
    band: tuple[float, float] | None
    goals: tuple[Goal, ...] = ()

    @property
    def goal_values(self) -> list[float]:
        """Where goals are drawn: between the legs on both sides of no difference."""
        signs = (1.0, -1.0) if self.kind.is_between else (1.0,)
        return [sign * one.value for one in self.goals for sign in signs]

    @property
    def values(self) -> list[float]:
        """All that has to have a place in the lane."""
        points = [point for line in self.lines for point in line.reported]
        ends = [end for p in points if math.isfinite(p.whisker) for end in (p.value - p.whisker, p.value + p.whisker)]
        return [*(point.value for point in points), *ends, *(self.band or ()), *self.goal_values]


def walked_at(visits: Sequence[CourseVisit], line: LaneLine) -> CourseCondition | None:
    """What was kept of the last visit that has a value in a line."""
    course = visits[line.points[-1].visit].course if line.points else None
    return course.condition(line.condition) if course is not None else None


def conditions_of_visits(visits: Sequence[CourseVisit]) -> dict[str, int]:
    """At how many visits each condition was walked, the most frequent first, of equal ones the latest."""
    latest_first = [one.condition for visit in reversed(visits) if visit.course for one in visit.course.conditions]
    return dict(Counter(latest_first).most_common())


def lane_kinds(goals: Sequence[Goal] = ()) -> tuple[LaneKind, ...]:
    """What has a lane: first what goals are of, then the usual ones as far as there is room."""
    required = dict.fromkeys(_kind(goal) for goal in held(goals) if not _kind(goal).is_of_test)
    own = [*(kind for kind in USUAL if kind in required), *(kind for kind in required if kind not in USUAL)]
    few = own[:MOST_LANES]
    return (*few, *[kind for kind in USUAL if kind not in own][: max(USUAL_LANES - len(few), 0)])


def kinds_of_tests(visits: Sequence[CourseVisit], goals: Sequence[Goal] = ()) -> tuple[LaneKind, ...]:
    """The timed tests that have a lane: those that were done, and those that goals are of."""
    done = {test.column for visit in visits if visit.course for one in visit.course.conditions for test in one.tests}
    required = done | {goal.column for goal in held(goals)}
    return tuple(LaneKind(column) for column in COLUMNS.values() if column in required)


def without_lane(goals: Sequence[Goal]) -> tuple[Goal, ...]:
    """Goals that hold and whose course has no room; that of each timed test has."""
    shown = lane_kinds(goals)
    return tuple(goal for goal in held(goals) if not (_kind(goal).is_of_test or _kind(goal) in shown))


def lanes(
    visits: Sequence[CourseVisit],
    condition: str | None = None,
    goals: Sequence[Goal] = (),
    kinds: Sequence[LaneKind] | None = None,
) -> tuple[CourseLane, ...]:
    """What goals are of, speed, knee and stance over the visits, in order of time.

    Parameters
    ----------
    condition
        The only one that is shown; None: all of them, and changes are reported for the most frequent one.
    kinds
        What has a lane in place of these.
    """
    known = list(conditions_of_visits(visits))
    shown = known if condition is None else [condition]
    reported = shown[0] if shown else ""
    affected = next((visit.course.affected for visit in reversed(visits) if visit.course is not None), None)
    sides = (affected,) if affected is not None else tuple(Side)
    found = []
    for kind in lane_kinds(goals) if kinds is None else kinds:
        own = tuple(one for one in held(goals) if _kind(one) == kind)
        required: tuple[Side | None, ...] = (None,)
        if not (kind.is_between or kind.is_of_walk):
            with_goal = {one.of.side for one in own}
            required = tuple(side for side in Side if side in sides or side in with_goal)
        lines = [_line(visits, kind, one, side) for one in shown for side in required]
        lines = [line for line in lines if line.points]
        changes = [_change(visits, kind, line) for line in lines if line.condition == reported]
        found.append(CourseLane(kind, tuple(lines), tuple(changes), _band(lines, reported), own))
    return tuple(found)


def _kind(goal: Goal) -> LaneKind:
    return LaneKind(goal.column, goal.of is GoalOf.BETWEEN)


def _line(visits: Sequence[CourseVisit], kind: LaneKind, condition: str, side: Side | None) -> LaneLine:
    points = []
    for number, visit in enumerate(visits):
        walked = visit.course.condition(condition) if visit.course is not None else None
        if walked is not None and (point := _point(number, walked, kind, side)) is not None:
            points.append(point)
    return LaneLine(condition, side, tuple(points))


def _point(number: int, walked: CourseCondition, kind: LaneKind, side: Side | None) -> LanePoint | None:
    """None where it was not measured."""
    if kind.is_between:
        between = walked.between_legs(kind.column)
        if between is None:
            return None
        is_not_reported = between.judgement is Judgement.NOT_REPORTED
        return LanePoint(
            number, between.difference, math.nan, Verdict.NOT_REPORTED if is_not_reported else Verdict.READ
        )
    if kind.is_of_test:
        test = walked.test(kind.column)
        return None if test is None else LanePoint(number, test.found.mean, test.whisker, test.verdict)
    figure = walked.figure(kind.column, side)
    if figure is None or figure.verdict is Verdict.NOT_MEASURED:
        return None
    return LanePoint(
        number,
        figure.found.mean if figure.is_reported else math.nan,
        figure.whisker_at(walked.speed_m_s),
        figure.verdict,
    )


def _change(visits: Sequence[CourseVisit], kind: LaneKind, line: LaneLine) -> LaneChange:
    last = line.points[-1]
    before = [point for point in line.reported if point.visit < last.visit]
    if not before or not last.is_reported:
        return LaneChange(line, None, None, before[0].visit if before else None, None)
    since = [_difference(visits, kind, line, last, point) for point in (before[0], before[-1])]
    return LaneChange(line, since[0], since[1] if len(before) > 1 else None, before[0].visit, before[-1].visit)


def _difference(
    visits: Sequence[CourseVisit], kind: LaneKind, line: LaneLine, last: LanePoint, first: LanePoint
) -> Difference | None:
    walked = [course.condition(line.condition) for at in (last, first) if (course := visits[at.visit].course)]
    one, other = walked
    assert one is not None  # both have a point in this line
    assert other is not None
    if kind.is_between:
        return change_between_legs(one, other, kind.column)
    return change(one, other, kind.column, line.side)


def _band(lines: Sequence[LaneLine], condition: str) -> tuple[float, float] | None:
    """Where one line alone is reported and has two values to compare: the first, less and plus the error."""
    of_condition = [line for line in lines if line.condition == condition]
    if len(of_condition) != 1 or len(of_condition[0].reported) < 2:
        return None
    first = of_condition[0].reported[0]
    error = 2 * first.whisker
    return (first.value - error, first.value + error) if math.isfinite(error) else None

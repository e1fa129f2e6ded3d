"""A patient's course as lanes over the dates of the visits: what is drawn, and what has changed since the first one.

A course is of one condition. What is not reported is a gap, and a change counts from the first visit that can be read.
"""

import datetime
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple
from uuid import UUID

from app.summary.course import Course, CourseCondition, change, change_between_legs
from app.wording.measures import decimals
from core.body import Side
from core.goals import Goal, GoalOf, agreed_by, held, is_of_walk
from core.parameters import KNEE, SPEED, STANCE
from core.timed.measures import COLUMNS, PROTOCOLS
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict

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
    """One value at the visit of this number; NaN where it cannot be read.

    `healthy`, of what the legs differ by: what 95 of 100 healthy people measured as surely stay below.
    """

    visit: int
    value: float
    verdict: Verdict
    healthy: float = math.nan

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

    def at(self, visit: int) -> LanePoint:
        """The point at a visit that has one."""
        return next(point for point in self.points if point.visit == visit)


@dataclass(frozen=True, slots=True)
class LaneChange:
    """The last visit of a line, less the first that can be read, and less the one before it that can be."""

    line: LaneLine
    since_first: Difference | None
    since_last: Difference | None
    first: int | None  # the visits' numbers
    before: int | None

    @property
    def since_before(self) -> Difference | None:
        """Since the visit before, be it the first."""
        return self.since_last if self.since_last is not None else self.since_first


@dataclass(frozen=True, slots=True)
class CourseLane:
    """Lines of one leg each, or of the walk, with their changes. `goals`: those that hold now."""

    kind: LaneKind
    lines: tuple[LaneLine, ...]
    changes: tuple[LaneChange, ...]
    goals: tuple[Goal, ...] = ()

    @property
    def goal_values(self) -> list[float]:
        """Where goals are drawn: between the legs on both sides of no difference."""
        signs = (1.0, -1.0) if self.kind.is_between else (1.0,)
        return [sign * one.value for one in self.goals for sign in signs]

    @property
    def healthy(self) -> tuple[float, float] | None:
        """Between the legs, where 95 of 100 healthy people are, measured as surely as the last visit."""
        known = [point.healthy for line in self.lines for point in line.reported if math.isfinite(point.healthy)]
        return (-known[-1], known[-1]) if known else None

    @property
    def decimals(self) -> int:
        """Of its values: whole degrees, unless two of them so rounded do not differ by the change that is shown."""
        places = decimals(self.kind.column)
        if places:
            return places
        pairs = [
            (found, one.line.at(number), one.line.points[-1])
            for one in self.changes
            for found, number in ((one.since_first, one.first), (one.since_last, one.before))
            if found is not None and number is not None and math.isfinite(found.difference)
        ]
        is_even = all(round(last.value) - round(first.value) == round(found.difference) for found, first, last in pairs)
        return 0 if is_even else 1

    @property
    def values(self) -> list[float]:
        """All that has to have a place in the lane."""
        points = [point.value for line in self.lines for point in line.reported]
        return [*points, *(self.healthy or ()), *self.goal_values]


def walked_at(visits: Sequence[CourseVisit], line: LaneLine) -> CourseCondition | None:
    """What was kept of the last visit that has a value in a line."""
    course = visits[line.points[-1].visit].course if line.points else None
    return course.condition(line.condition) if course is not None else None


def conditions_of_visits(visits: Sequence[CourseVisit]) -> dict[str, int]:
    """At how many visits each condition was walked, the most frequent first, of equal ones the latest."""
    latest_first = [one.condition for visit in reversed(visits) if visit.course for one in visit.course.conditions]
    return dict(Counter(latest_first).most_common())


def usual_condition(visits: Sequence[CourseVisit]) -> str:
    """Of the conditions of the latest visit that is known, the one walked at most visits."""
    latest = next((visit.course for visit in reversed(visits) if visit.course and visit.course.conditions), None)
    own = {one.condition for one in latest.conditions} if latest is not None else set()
    return next((name for name in conditions_of_visits(visits) if name in own), "")


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
    """Build the lanes of goals, speed, knee and stance over the visits; `condition` None: the usual one."""
    shown = usual_condition(visits) if condition is None else condition
    affected = next((visit.course.affected for visit in reversed(visits) if visit.course is not None), None)
    sides = (affected,) if affected is not None else tuple(Side)
    found = []
    for kind in lane_kinds(goals) if kinds is None else kinds:
        own = tuple(one for one in held(goals) if _kind(one) == kind)
        required: tuple[Side | None, ...] = (None,)
        if not (kind.is_between or kind.is_of_walk):
            with_goal = {one.of.side for one in own}
            required = tuple(side for side in Side if side in sides or side in with_goal)
        lines = tuple(line for side in required if (line := _line(visits, kind, shown, side)).points)
        found.append(CourseLane(kind, lines, tuple(_change(visits, kind, line, goals) for line in lines), own))
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
        verdict = Verdict.NOT_REPORTED if between.judgement is Judgement.NOT_REPORTED else Verdict.READ
        return LanePoint(number, between.difference, verdict, between.healthy)
    if kind.is_of_test:
        test = walked.test(kind.column)
        return None if test is None else LanePoint(number, test.found.mean, test.verdict)
    figure = walked.figure(kind.column, side)
    if figure is None or figure.verdict is Verdict.NOT_MEASURED:
        return None
    return LanePoint(number, figure.found.mean if figure.is_reported else math.nan, figure.verdict)


def _change(visits: Sequence[CourseVisit], kind: LaneKind, line: LaneLine, goals: Sequence[Goal]) -> LaneChange:
    last = line.points[-1]
    before = [point for point in line.reported if point.visit < last.visit]
    if not before or not last.is_reported:
        return LaneChange(line, None, None, before[0].visit if before else None, None)
    agreed = agreed_by(goals, visits[last.visit].day)
    is_chosen = agreed.is_chosen(kind.column, tuple(Side) if line.side is None else (line.side,))
    since = [_difference(visits, kind, line, last, point, is_chosen) for point in (before[0], before[-1])]
    return LaneChange(line, since[0], since[1] if len(before) > 1 else None, before[0].visit, before[-1].visit)


def _difference(
    visits: Sequence[CourseVisit], kind: LaneKind, line: LaneLine, last: LanePoint, first: LanePoint, is_chosen: bool
) -> Difference | None:
    walked = [course.condition(line.condition) for at in (last, first) if (course := visits[at.visit].course)]
    one, other = walked
    assert one is not None  # both have a point in this line
    assert other is not None
    if kind.is_between:
        return change_between_legs(one, other, kind.column)
    return change(one, other, kind.column, line.side, is_chosen_before=is_chosen)

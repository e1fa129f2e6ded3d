"""A patient's course as lanes over the dates of the visits: what is drawn, and what has changed since the first one.

Conditions stand side by side and are never joined. What is withheld is a gap, and a change counts from the first visit
that can be read.
"""

import datetime
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from uuid import UUID

from app.reports.course import KNEE, SPEED, Course, CourseCondition, change
from core.body import Side
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict

MOST_TOGETHER = 4  # conditions in one lane: as many marks can be told apart


class LaneKind(StrEnum):
    SPEED = "speed"
    KNEE = "knee"
    STANCE = "stance"


DECIMALS = {LaneKind.SPEED: 2, LaneKind.KNEE: 0, LaneKind.STANCE: 1}


@dataclass(frozen=True, slots=True)
class CourseVisit:
    """One visit on the axis of dates. `course` None: it is not computed yet, or no longer holds.

    `clock`: at which time of that day, where it is known; it tells visits of one day apart.
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
    def is_told(self) -> bool:
        return math.isfinite(self.value)


@dataclass(frozen=True, slots=True)
class LaneLine:
    """The points of one condition, and of one leg where the lane is of legs, in order of time."""

    condition: str
    side: Side | None
    points: tuple[LanePoint, ...]

    @property
    def told(self) -> tuple[LanePoint, ...]:
        return tuple(point for point in self.points if point.is_told)


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
    """`changes`: of the lines of the condition that is told of. `band`: its first visit less and plus the error."""

    kind: LaneKind
    lines: tuple[LaneLine, ...]
    changes: tuple[LaneChange, ...]
    band: tuple[float, float] | None

    @property
    def values(self) -> list[float]:
        """All that has to have a place in the lane."""
        points = [point for line in self.lines for point in line.told]
        ends = [end for p in points if math.isfinite(p.whisker) for end in (p.value - p.whisker, p.value + p.whisker)]
        return [*(point.value for point in points), *ends, *(self.band or ())]


def conditions_of_visits(visits: Sequence[CourseVisit]) -> dict[str, int]:
    """At how many visits each condition was walked, the most frequent first, of equal ones the latest."""
    latest_first = [one.condition for visit in reversed(visits) if visit.course for one in visit.course.conditions]
    return dict(Counter(latest_first).most_common())


def lanes(visits: Sequence[CourseVisit], condition: str | None = None) -> tuple[CourseLane, ...]:
    """Speed, knee and stance over the visits, in order of time.

    Parameters
    ----------
    condition
        The only one that is shown; None: all of them, and changes are told of the most frequent one.
    """
    known = list(conditions_of_visits(visits))
    shown = known if condition is None else [condition]
    told = shown[0] if shown else ""
    affected = next((visit.course.affected for visit in reversed(visits) if visit.course is not None), None)
    sides = (affected,) if affected is not None else tuple(Side)
    of_legs: dict[LaneKind, tuple[Side | None, ...]] = {
        LaneKind.SPEED: (None,),
        LaneKind.KNEE: sides,
        LaneKind.STANCE: (None,),
    }
    found = []
    for kind, wanted in of_legs.items():
        lines = [_line(visits, kind, one, side) for one in shown for side in wanted]
        lines = [line for line in lines if line.points]
        changes = [_change(visits, kind, line) for line in lines if line.condition == told]
        found.append(CourseLane(kind, tuple(lines), tuple(changes), _band(lines, told)))
    return tuple(found)


def _line(visits: Sequence[CourseVisit], kind: LaneKind, condition: str, side: Side | None) -> LaneLine:
    points = []
    for number, visit in enumerate(visits):
        walked = visit.course.condition(condition) if visit.course is not None else None
        if walked is not None and (point := _point(number, walked, kind, side)) is not None:
            points.append(point)
    return LaneLine(condition, side, tuple(points))


def _point(number: int, walked: CourseCondition, kind: LaneKind, side: Side | None) -> LanePoint | None:
    """None where it was not measured."""
    if kind is LaneKind.STANCE:
        between = walked.stance_between_legs
        if between is None:
            return None
        is_withheld = between.judgement is Judgement.WITHHELD
        return LanePoint(number, between.difference, math.nan, Verdict.WITHHELD if is_withheld else Verdict.READ)
    figure = walked.figure(SPEED if kind is LaneKind.SPEED else KNEE, side)
    if figure is None or figure.verdict is Verdict.NOT_MEASURED:
        return None
    return LanePoint(number, figure.found.mean if figure.is_told else math.nan, figure.whisker, figure.verdict)


def _change(visits: Sequence[CourseVisit], kind: LaneKind, line: LaneLine) -> LaneChange:
    last = line.points[-1]
    before = [point for point in line.told if point.visit < last.visit]
    if not before or not last.is_told:
        return LaneChange(line, None, None, before[0].visit if before else None, None)
    since = [_difference(visits, kind, line, last, point) for point in (before[0], before[-1])]
    return LaneChange(line, since[0], since[1] if len(before) > 1 else None, before[0].visit, before[-1].visit)


def _difference(
    visits: Sequence[CourseVisit], kind: LaneKind, line: LaneLine, last: LanePoint, first: LanePoint
) -> Difference | None:
    if kind is LaneKind.STANCE:  # what legs differ by at one visit and another: no error of that is known
        return Difference(last.value - first.value, math.nan, Judgement.NO_PUBLISHED_FIGURE)
    walked = [course.condition(line.condition) for at in (last, first) if (course := visits[at.visit].course)]
    one, other = walked
    assert one is not None  # both have a point in this line
    assert other is not None
    return change(one, other, SPEED if kind is LaneKind.SPEED else KNEE, line.side)


def _band(lines: Sequence[LaneLine], condition: str) -> tuple[float, float] | None:
    """Where one line alone is told of and has two values to compare: the first, less and plus the error."""
    of_condition = [line for line in lines if line.condition == condition]
    if len(of_condition) != 1 or len(of_condition[0].told) < 2:
        return None
    first = of_condition[0].told[0]
    error = 2 * first.whisker
    return (first.value - error, first.value + error) if math.isfinite(error) else None

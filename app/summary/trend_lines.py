"""What each measure was at every visit of the patient's course, and what it has changed by: for pages and sentences."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from app.summary.course import CourseCondition, change
from app.summary.course_lanes import CourseVisit
from core.body import Side
from core.goals import AgreedGoals, GoalOf, is_of_walk
from core.parameters import KNEE, PUSH_OFF, SPEED, STANCE
from core.timed.measures import COLUMNS, PROTOCOLS
from core.verdicts.measurement_error import Difference
from core.verdicts.model import Verdict

MEASURES = (KNEE, PUSH_OFF, STANCE, SPEED)
MOST_CHARTS = 4  # those with goals come first


@dataclass(frozen=True, slots=True)
class TrendValue:
    """What a visit has of one measure. NaN: it cannot be read there, or no error is known."""

    visit: int
    value: float
    whisker: float


@dataclass(frozen=True, slots=True)
class TrendLine:
    """One measure of one leg, or of the walk, at all visits."""

    column: str
    side: Side | None
    values: tuple[TrendValue, ...]
    since_first: Difference | None
    since_last: Difference | None
    first: int
    before: int

    @property
    def reported(self) -> list[TrendValue]:
        return [one for one in self.values if math.isfinite(one.value)]


def walked_visits(visits: Sequence[CourseVisit], condition: str) -> list[CourseVisit]:
    """Those whose figures are known under a condition."""
    return [visit for visit in visits if visit.course is not None and visit.course.condition(condition) is not None]


def trend_columns(agreed: AgreedGoals) -> tuple[str, ...]:
    """What has a chart: what goals are of, then the usual measures as far as there is room."""
    own = (goal for goal in agreed.held if goal.of is not GoalOf.BETWEEN and goal.column not in PROTOCOLS)
    required = dict.fromkeys(goal.column for goal in own)
    few = list(required)[:MOST_CHARTS]
    others = [column for column in MEASURES if column not in few][: MOST_CHARTS - len(few)]
    shown = {*few, *others}
    return tuple(column for column in dict.fromkeys((*MEASURES, *few)) if column in shown)


def trend_lines(
    walked: Sequence[CourseVisit], condition: str, columns: Sequence[str], agreed: AgreedGoals
) -> list[TrendLine]:
    """Each column of each leg, or of the walk, over visits that were walked under a condition."""
    parts = [visit.course.condition(condition) if visit.course is not None else None for visit in walked]
    at = [part for part in parts if part is not None]
    found = []
    for column in columns:
        for side in (None,) if is_of_walk(column) else tuple(Side):
            values = [value for number, part in enumerate(at) if (value := _value(part, column, side, number))]
            reported = [value.visit for value in values if math.isfinite(value.value)]
            if not reported:
                continue
            last = len(at) - 1
            before = [visit for visit in reported if visit < last]
            first, previous = (before[0], before[-1]) if before else (0, 0)
            is_changed = bool(before) and reported[-1] == last
            is_chosen = agreed.is_chosen(column, tuple(Side) if side is None else (side,))
            since = [
                change(at[last], at[k], column, side, is_chosen_before=is_chosen) if is_changed else None
                for k in (first, previous)
            ]
            found.append(TrendLine(column, side, tuple(values), since[0], since[1], first, previous))
    return found


def all_lines(visits: Sequence[CourseVisit], condition: str, agreed: AgreedGoals) -> list[TrendLine]:
    """What the page of the course reports about a condition: its charts and the timed tests."""
    columns = (*trend_columns(agreed), *COLUMNS.values())
    return trend_lines(walked_visits(visits, condition), condition, columns, agreed)


def _value(part: CourseCondition, column: str, side: Side | None, number: int) -> TrendValue | None:
    """None where it was not measured."""
    if column in PROTOCOLS:
        test = part.test(column)
        return TrendValue(number, test.found.mean, test.whisker) if test is not None else None
    figure = part.figure(column, side)
    if figure is None or figure.verdict is Verdict.NOT_MEASURED:
        return None
    return TrendValue(number, figure.found.mean if figure.is_reported else math.nan, figure.whisker_at(part.speed_m_s))

"""Words for a patient's course. Each lane with its unit and its changes, and what is to be done next."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from uuid import UUID

from app.summary.course_lanes import (
    STANCE_LANE,
    CourseLane,
    CourseVisit,
    LaneChange,
    LaneKind,
    LaneLine,
    LanePoint,
    walked_at,
)
from app.summary.goals import GoalFigure, beyond_in_words, in_course, standing_in_words
from app.summary.goals import value_in_words as value_in_words_of_goal
from app.summary.numbers_in_words import DAGGER, dagger_note, fixed, signed
from app.wording.body import name_of, side_name
from app.wording.dates import day_in_words, short_date
from app.wording.measures import decimals, goal_in_words, measure_name, short_unit, spoken_name, spoken_value
from app.wording.translation import capitalised, joined, tr, tr_n
from core.body import Joint
from core.parameters import Unit, unit_of
from core.verdicts.measurement_error import Difference, Judgement

LONG_AGO = datetime.timedelta(weeks=8)


class NextKind(StrEnum):
    """Where pressing the next step leads."""

    REVIEW = "review"
    REPORT = "report"
    GOALS = "goals"
    SESSION = "session"


@dataclass(frozen=True, slots=True)
class NextStep:
    """What is to be done next, why, and the session that it is about, where it is about one."""

    kind: NextKind
    verb: str
    reason: str
    session_id: UUID | None = None


@dataclass(frozen=True, slots=True)
class LatestVisit:
    """What is known of the latest visit. `not_reported`: joints that could not be read; `reached`: goals that were.

    `when`: its time in words.
    """

    id: UUID
    day: datetime.date
    when: str
    not_reported: tuple[Joint, ...]
    has_walk: bool
    has_report: bool
    reached: tuple[GoalFigure, ...] = ()


def day_of(number: int, visits: Sequence[CourseVisit]) -> str:
    """The day of the visit of this number, with the time where another was on that day."""
    visit, days = visits[number], [visit.day for visit in visits]
    stated = day_in_words(visit.day, days)
    return f"{stated}, {visit.clock}" if visit.clock and days.count(visit.day) > 1 else stated


def value_in_words(value: float, lane: CourseLane) -> str:
    """A value of a lane without its unit; what the legs differ by has its sign."""
    return (signed if lane.kind.is_between else fixed)(value, lane.decimals)


def change_in_figures(lane: CourseLane, one: LaneChange, *, is_since_last: bool = False) -> str:
    """A change as the values beside it are rounded: it is what these differ by."""
    found, number = (one.since_before, one.before) if is_since_last else (one.since_first, one.first)
    if found is None or number is None or not math.isfinite(found.difference):
        return ""
    places, last = lane.decimals, one.line.points[-1].value
    first = one.line.at(number).value
    return signed(round(last, places) - round(first, places), places) + (
        "°" if lane.kind.column.endswith("_deg") else ""
    )


def last_in_words(lane: CourseLane, one: LaneChange) -> str:
    """The last value without its unit, but for degrees."""
    last = one.line.points[-1]
    if not last.is_reported:
        return tr("not reported")
    return value_in_words(last.value, lane) + ("°" if lane.kind.column.endswith("_deg") else "")


def lane_name(kind: LaneKind) -> str:
    """A lane as its row is called."""
    if kind == STANCE_LANE:
        return tr("Stance symmetry, L − R")
    return measure_name(kind.column, is_between=kind.is_between)


def unit_beside(kind: LaneKind) -> str:
    """The unit that is written small beside the last value; empty of degrees, which follow the number."""
    if kind.is_between and unit_of(kind.column) is Unit.PERCENT:
        return tr("points")
    return "" if kind.column.endswith("_deg") else short_unit(kind.column).strip()


def change_in_words(lane: CourseLane, one: LaneChange, visits: Sequence[CourseVisit]) -> str:
    """What has changed since the first visit that can be read; empty where there is none."""
    figures = change_in_figures(lane, one)
    if not figures or one.first is None:
        return ""
    return tr("{change} since {day}").format(change=figures, day=day_of(one.first, visits))


def judged_in_words(found: Difference, kind: LaneKind) -> str:
    """Whether a change is larger than its error; the dagger marks an error whose source could not be read."""
    if not found.is_judged:
        return _verdict(found)
    error = fixed(found.error, max(1, decimals(kind.column))) + (f" {DAGGER}" if found.is_unverified else "")
    return tr("{verdict} ({error})").format(verdict=_verdict(found), error=error)


def _verdict(found: Difference) -> str:
    if found.judgement is Judgement.TOO_FEW_STRIDES:
        return tr("too few strides to judge")
    if not found.is_judged:
        return tr("not judged")
    return tr("beyond error") if found.exceeds else tr("within error")


def key_in_words(lanes: Sequence[CourseLane]) -> str:
    """How values and marks are to be read."""
    changes = [found for lane in lanes for one in lane.changes if (found := one.since_first) is not None]
    stated = [tr("Means of the strides used at each visit.")]
    if any(found.is_judged for found in changes):
        stated.append(tr("Filled arrow: beyond measurement error. Outlined: within."))
    if any(lane.healthy for lane in lanes):
        stated.append(tr("Grey: 95 of 100 healthy people."))
    if any(lane.goals for lane in lanes):
        stated.append(tr("Dotted: goal."))
    if any(found.is_unverified for found in changes):
        stated.append(dagger_note())
    return " ".join(stated)


def lane_in_words(lane: CourseLane, visits: Sequence[CourseVisit]) -> str:
    """All of a lane, for a screen reader: every value with its day, then what has changed."""
    name = spoken_name(lane.kind.column, is_between=lane.kind.is_between)
    agreed = [tr("Goal: {required}.").format(required=goal_in_words(goal)) for goal in lane.goals]
    if not lane.lines:
        return " ".join([tr("{name}: no value.").format(name=name), *agreed])
    stated = []
    for line in lane.lines:
        values = [_spoken(point, lane, visits) for point in line.points]
        stated.append(f"{_head(lane.kind, line)}: {', '.join(values)}.")
    stated += [words for one in lane.changes if (words := _judged_change(lane, one, visits))]
    reported = [found for one in lane.changes for found in reported_goals(lane, one, visits)]
    agreed += [f"{capitalised(standing_in_words(found))}." for found in reported]
    return " ".join([*stated, *agreed])


def reported_goals(lane: CourseLane, one: LaneChange, visits: Sequence[CourseVisit]) -> list[GoalFigure]:
    """How the last value of a line compares with its goals, of those agreed before the visit's day."""
    walked = walked_at(visits, one.line)
    if walked is None:
        return []
    day = visits[one.line.points[-1].visit].day
    return [in_course(goal, walked) for goal in lane.goals if goal.of.side is one.line.side and goal.agreed < day]


def changes_since_in_words(lane: CourseLane, visits: Sequence[CourseVisit]) -> str:
    """What the last visit differs by from the one before, and from the first; empty where there is none before."""
    stated = []
    for one in lane.changes:
        since = [(one.since_last, one.before)] if one.since_last is not None else []
        for found, number in (*since, (one.since_first, one.first)):
            if found is None or number is None or not math.isfinite(found.difference):
                continue
            change = signed(found.difference, decimals(lane.kind.column)) + short_unit(lane.kind.column)
            words = tr("{change} since {day}, {judged}.")
            judged = judged_in_words(found, lane.kind)
            stated.append(words.format(change=change, day=day_of(number, visits), judged=judged))
    return " ".join(stated)


def visit_in_words(number: int, lanes: Sequence[CourseLane], visits: Sequence[CourseVisit]) -> str:
    """All values of one visit, for who goes from visit to visit."""
    stated = []
    for lane in lanes:
        for line in lane.lines:
            for point in line.points:
                if point.visit == number:
                    value = tr("not reported")
                    if point.is_reported:
                        value = spoken_value(lane.kind.column, value_in_words(point.value, lane))
                    stated.append(f"{_head(lane.kind, line)}: {value}")
    if visits[number].course is None:
        stated = [capitalised(tr("not calculated yet"))]
    return f"{day_of(number, visits)}. {'. '.join(stated or [tr('no walk')])}."


def nothing_between(visits: Sequence[CourseVisit]) -> str:
    """What a course still lacks; empty where it has a trend."""
    missing = sum(visit.course is None for visit in visits)
    walked = sum(bool(visit.course and visit.course.conditions) for visit in visits)
    if missing:
        return tr_n("{count} visit is not calculated yet.", "{count} visits are not calculated yet.", missing).format(
            count=missing
        )
    if walked == 1:
        return tr("A trend needs a second visit.")
    return "" if walked else tr("No visit has a walk yet.")


def next_step(recovered: NextStep | None, latest: LatestVisit | None, today: datetime.date) -> NextStep | None:
    """The first that holds: a recovered walk, a joint not read, no report, a goal reached, long without a visit."""
    if recovered is not None or latest is None:
        return recovered
    day = short_date(latest.day)
    if latest.not_reported:
        names = capitalised(joined([name_of(joint) for joint in latest.not_reported]))
        reason = tr("{joints}: not reported. Repeat at the next walk.").format(joints=names)
        return NextStep(NextKind.REVIEW, tr("Review visit of {day}").format(day=day), reason, latest.id)
    if latest.has_walk and not latest.has_report:
        reason = tr("Not written yet. Measured {when}.").format(when=latest.when)
        return NextStep(NextKind.REPORT, tr("Write report of {day}").format(day=day), reason, latest.id)
    if latest.reached:
        return NextStep(NextKind.GOALS, tr("Agree next goal"), reached_in_words(latest.reached))
    if (ago := today - latest.day) >= LONG_AGO:
        reason = tr("Last visit {weeks} weeks ago.").format(weeks=ago.days // 7)
        return NextStep(NextKind.SESSION, tr("Begin next visit"), reason)
    return None


def reached_in_words(reached: Sequence[GoalFigure]) -> str:
    """Which goal was reached, and whether by more than the error; of several the surest, and how many more."""
    first, *others = reached
    stated = tr("Goal reached: {goal}; measured {value}, {standing}.").format(
        goal=goal_in_words(first.goal),
        value=value_in_words_of_goal(first),
        standing=beyond_in_words(first.standing),
    )
    if not others:
        return stated
    more = tr_n("One other goal reached.", "Other goals reached: {count}.", len(others)).format(count=len(others))
    return f"{stated} {more}"


def undecided_step(session_id: UUID, day: datetime.date | None) -> NextStep:
    """A walk of which nobody has stated whether it is kept."""
    verb = tr("Review last walk") if day is None else tr("Review walk of {day}").format(day=short_date(day))
    return NextStep(NextKind.REVIEW, verb, tr("Recovered. Include or exclude it."), session_id)


def _head(kind: LaneKind, line: LaneLine) -> str:
    """What the values are of, and whose they are."""
    name = spoken_name(kind.column, is_between=kind.is_between)
    return ", ".join([name, *([side_name(line.side)] if line.side is not None else [])])


def _spoken(point: LanePoint, lane: CourseLane, visits: Sequence[CourseVisit]) -> str:
    day = day_of(point.visit, visits)
    if not point.is_reported:
        return tr("not reported on {day}").format(day=day)
    value = spoken_value(lane.kind.column, value_in_words(point.value, lane))
    return tr("{value} on {day}").format(value=value, day=day)


def _judged_change(lane: CourseLane, one: LaneChange, visits: Sequence[CourseVisit]) -> str:
    figures = change_in_figures(lane, one)
    if not figures or one.first is None or one.since_first is None:
        return ""
    judged = judged_in_words(one.since_first, lane.kind)
    return tr("{change} since {day}, {judged}.").format(change=figures, day=day_of(one.first, visits), judged=judged)

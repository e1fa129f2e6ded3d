"""Words for a patient's course. Each lane with its unit and its changes, and what is to be done next."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from app.summary.course_lanes import CourseLane, CourseVisit, LaneChange, LaneKind, LaneLine, LanePoint, walked_at
from app.summary.goals import GoalFigure, beyond_in_words, in_course, standing_in_words
from app.summary.goals import value_in_words as value_in_words_of_goal
from app.summary.numbers_in_words import DAGGER, dagger_note, fixed, signed
from app.summary.visits import condition_in_words
from app.wording.body import name_of, side_name
from app.wording.dates import day_in_words, short_date
from app.wording.measures import decimals, goal_in_words, short_unit, spoken_name, spoken_value
from app.wording.translation import capitalised, joined, tr, tr_n
from core.body import Joint
from core.verdicts.measurement_error import Difference, Judgement

LONG_AGO = datetime.timedelta(weeks=8)


@dataclass(frozen=True, slots=True)
class NextStep:
    """What is to be done next, and the session that it is about; `verb` is empty where nothing is pressed.

    Without a session, what is pressed leads to the goals.
    """

    sentence: str
    verb: str = ""
    session_id: UUID | None = None


@dataclass(frozen=True, slots=True)
class LatestVisit:
    """What is known of the latest visit. `not_reported`: joints that could not be read; `reached`: goals that were."""

    id: UUID
    day: datetime.date
    not_reported: tuple[Joint, ...]
    has_walk: bool
    has_report: bool
    reached: tuple[GoalFigure, ...] = ()


def day_of(number: int, visits: Sequence[CourseVisit]) -> str:
    """The day of the visit of this number, with the time where another was on that day."""
    visit, days = visits[number], [visit.day for visit in visits]
    stated = day_in_words(visit.day, days)
    return f"{stated}, {visit.clock}" if visit.clock and days.count(visit.day) > 1 else stated


def value_in_words(value: float, kind: LaneKind) -> str:
    return fixed(value, decimals(kind.column))


def change_in_words(found: Difference, kind: LaneKind) -> str:
    return signed(found.difference, decimals(kind.column)) + ("°" if kind.column.endswith("_deg") else "")


def last_in_words(one: LaneChange, kind: LaneKind) -> str:
    """The last value with its unit."""
    last = one.line.points[-1]
    if not last.is_reported:
        return tr("not reported")
    return value_in_words(last.value, kind) + short_unit(kind.column)


def judged_in_words(found: Difference, kind: LaneKind) -> str:
    """Whether a change is larger than its error; the dagger marks an error whose source could not be read."""
    if not found.is_judged:
        return _verdict(found)
    error = fixed(found.error, max(1, decimals(kind.column))) + (f" {DAGGER}" if found.is_unverified else "")
    return tr("{verdict} ({error})").format(verdict=_verdict(found), error=error)


def since_last_in_words(found: Difference, kind: LaneKind) -> str:
    """What has changed since the visit before."""
    stated = tr("since last visit {change}, {verdict}")
    return stated.format(change=change_in_words(found, kind), verdict=_verdict(found))


def _verdict(found: Difference) -> str:
    if found.judgement is Judgement.TOO_FEW_STRIDES:
        return tr("too few strides to judge")
    if not found.is_judged:
        return tr("not judged")
    return tr("beyond error") if found.exceeds else tr("within error")


def key_in_words(lanes: Sequence[CourseLane]) -> str:
    """What is drawn beside the values; empty where nothing of it is."""
    has_whiskers = any(math.isfinite(point.whisker) for lane in lanes for line in lane.lines for point in line.reported)
    changes = [found for lane in lanes for one in lane.changes if (found := one.since_first) is not None]
    stated = [tr("Whisker: half the measurement error of a change.")] if has_whiskers else []
    stated += [tr("Grey: first visit ± measurement error.")] if any(lane.band for lane in lanes) else []
    stated += [tr("Dotted: goal.")] if any(lane.goals for lane in lanes) else []
    if any(found.is_unverified for found in changes):
        stated.append(dagger_note())
    return " ".join(stated)


def lane_in_words(lane: CourseLane, visits: Sequence[CourseVisit]) -> str:
    """All of a lane, for a screen reader: every value with its day, then what has changed."""
    name = spoken_name(lane.kind.column, is_between=lane.kind.is_between)
    agreed = [tr("Goal: {required}.").format(required=goal_in_words(goal)) for goal in lane.goals]
    if not lane.lines:
        return " ".join([tr("{name}: no value.").format(name=name), *agreed])
    conditions = {line.condition for line in lane.lines}
    stated = []
    for line in lane.lines:
        values = [_spoken(point, lane.kind, visits) for point in line.points]
        stated.append(f"{_head(lane.kind, line, has_condition=len(conditions) > 1)}: {', '.join(values)}.")
    stated += [words for one in lane.changes if (words := _change_in_words(one, lane.kind, visits))]
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
        conditions = {line.condition for line in lane.lines}
        for line in lane.lines:
            for point in line.points:
                if point.visit == number:
                    value = tr("not reported")
                    if point.is_reported:
                        value = spoken_value(lane.kind.column, value_in_words(point.value, lane.kind))
                    stated.append(f"{_head(lane.kind, line, has_condition=len(conditions) > 1)}: {value}")
    if visits[number].course is None:
        stated = [tr("not calculated yet")]
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
        names = joined([name_of(joint) for joint in latest.not_reported])
        stated = tr("check {joints}: no values were reported on {day}.")
        return NextStep(stated.format(joints=names, day=day), tr("Review"), latest.id)
    if latest.has_walk and not latest.has_report:
        return NextStep(tr("write the report for {day}.").format(day=day), tr("Open"), latest.id)
    if latest.reached:
        return NextStep(reached_in_words(latest.reached, day), tr("Goals"))
    if (ago := today - latest.day) >= LONG_AGO:
        return NextStep(tr("the last visit was {weeks} weeks ago.").format(weeks=ago.days // 7))
    return None


def reached_in_words(reached: Sequence[GoalFigure], day: str) -> str:
    """Which goal was reached on a day, and whether by more than the error; of several the surest, and how many more."""
    first, *others = reached
    stated = tr("goal reached on {day}: {goal}; measured {value}, {standing}.").format(
        day=day,
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
    stated = tr("include or exclude the last walk.")
    if day is not None:
        stated = tr("include or exclude the walk of {day}.").format(day=short_date(day))
    return NextStep(stated, tr("Review"), session_id)


def _head(kind: LaneKind, line: LaneLine, *, has_condition: bool) -> str:
    """What the values are of, and whose they are."""
    name = spoken_name(kind.column, is_between=kind.is_between)
    who = [side_name(line.side)] if line.side is not None else []
    who += [condition_in_words(line.condition)] if has_condition else []
    return ", ".join([name, *who])


def _spoken(point: LanePoint, kind: LaneKind, visits: Sequence[CourseVisit]) -> str:
    day = day_of(point.visit, visits)
    if not point.is_reported:
        return tr("not reported on {day}").format(day=day)
    value = spoken_value(kind.column, value_in_words(point.value, kind))
    return tr("{value} on {day}").format(value=value, day=day)


def _change_in_words(one: LaneChange, kind: LaneKind, visits: Sequence[CourseVisit]) -> str:
    found = one.since_first
    if found is None or one.first is None or not math.isfinite(found.difference):
        return ""
    stated = tr("{change} since {day}, {judged}.")
    day = day_of(one.first, visits)
    return stated.format(
        change=signed(found.difference, decimals(kind.column)), day=day, judged=judged_in_words(found, kind)
    )

"""What has changed over a patient's visits, in one sentence and a second line, and in a few words for a list.

A change is stated when it is beyond what page one asks of a change between visits, else with its error. With one
visit, or where no change can be read, the values are stated.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from app.summary.course import CourseCondition
from app.summary.course_lanes import CourseLane, CourseVisit, LaneChange, LaneKind, lane_kinds, lanes
from app.summary.course_words import change_in_figures, day_of, reported_goals
from app.summary.goals import GoalFigure
from app.summary.headline import kind_of
from app.summary.interval_words import healthy_sentence, interval_words
from app.summary.legs_in_words import both_knees, clause_of, legs_differ, legs_similar
from app.summary.measure_sentences import unit_in_sentence
from app.summary.numbers_in_words import DAGGER, fixed, signed
from app.wording.body import side_name
from app.wording.dates import day_and_month, long_date
from app.wording.measures import decimals, name_in_sentence, short_unit
from app.wording.translation import capitalised, tr
from core.body import Side
from core.goals import Goal
from core.parameters import KNEE, SPEED, STANCE, Unit, unit_of
from core.verdicts.goals import GoalStanding, beyond
from core.verdicts.measurement_error import Difference

MOST_NAMED = 2  # changes in the sentence


@dataclass(frozen=True, slots=True)
class Arrow:
    """Which way a change went, and whether it is beyond its error."""

    is_up: bool
    is_filled: bool


@dataclass(frozen=True, slots=True)
class ProgressWords:
    """`brief` and `arrow` are the last change as a list has it; empty and None where there is none."""

    sentence: str
    second: str
    brief: str = ""
    arrow: Arrow | None = None


@dataclass(frozen=True, slots=True)
class _Change:
    """A measure's change since one earlier visit, of this number."""

    lane: CourseLane
    one: LaneChange
    found: Difference
    since: int
    is_since_last: bool

    @property
    def figures(self) -> str:
        """With a unit, where the number alone would not be understood."""
        figures = change_in_figures(self.lane, self.one, is_since_last=self.is_since_last)
        return figures if self.lane.kind.column.endswith("_deg") else figures + _unit(self.lane.kind.column)


def arrow_of(lane: CourseLane, found: Difference | None) -> Arrow | None:
    """The arrow before a change; None where its error is not known, or it is shown as none."""
    if found is None or not found.is_judged or round(found.difference, lane.decimals) == 0:
        return None
    return Arrow(found.difference > 0, found.exceeds)


def progress_words(visits: Sequence[CourseVisit], condition: str, goals: Sequence[Goal]) -> ProgressWords:
    """The change since the last visit, else since the first, else the last change with its error, else the values."""
    kinds = [kind for kind in dict.fromkeys((*lane_kinds(goals), LaneKind(STANCE))) if not kind.is_between]
    shown = sorted(lanes(visits, condition, goals, kinds), key=_rank)
    own = [(lane, one) for lane in shown for one in lane.changes]
    last = [
        _Change(lane, one, one.since_before, one.before, is_since_last=True)
        for lane, one in own
        if one.since_before is not None and one.before is not None
    ]
    first = [
        _Change(lane, one, one.since_first, one.first, is_since_last=False)
        for lane, one in own
        if one.since_first is not None and one.first is not None
    ]
    affected = next((visit.course.affected for visit in reversed(visits) if visit.course is not None), None)
    for changes in (last, first):
        worth = [change for change in changes if change.found.is_worth_a_sentence]
        if worth:
            return _changed(worth, last, shown, visits, affected)
    walked = _walked(visits, condition)
    judged = next((change for change in last if change.found.is_judged), None)
    if judged is not None:
        return _within(judged, shown, visits, walked, affected)
    return _values(visits, walked, shown, affected)


def _changed(
    worth: Sequence[_Change],
    last: Sequence[_Change],
    shown: Sequence[CourseLane],
    visits: Sequence[CourseVisit],
    affected: Side | None,
) -> ProgressWords:
    leading = worth[0]
    named = [change for change in worth if change.since == leading.since][:MOST_NAMED]
    changes = ", ".join(_named(change, affected) for change in named)
    sentence = tr("Since {day}: {changes}.").format(day=_long_day(leading.since, visits), changes=changes)
    dagger = f" {DAGGER}" if any(change.found.is_unverified for change in named) else ""
    if len(named) > 1:
        beyond_error = tr("Both beyond measurement error.")
    else:
        beyond_error = capitalised(interval_words(leading.lane.kind.column, leading.found)) + "."
    after = _goals_sentence(shown, visits, affected)
    since_last = next((one for one in last if one.one is leading.one and one.since != leading.since), None)
    if not after and since_last is not None and since_last.found.is_judged:
        after = _judged_sentence(since_last, visits, affected)
    return _with_brief(ProgressWords(sentence, " ".join(filter(None, [beyond_error + dagger, after]))), leading, visits)


def _within(
    change: _Change,
    shown: Sequence[CourseLane],
    visits: Sequence[CourseVisit],
    walked: CourseCondition | None,
    affected: Side | None,
) -> ProgressWords:
    """No change that page one would state: the leading measure's, with all that fits."""
    column = change.lane.kind.column
    sentence = _judged_sentence(change, visits, affected)
    if change.found.exceeds:
        fits = capitalised(interval_words(column, change.found)) + "."
    else:
        low, high = (signed(end, decimals(column)) + _unit(column) for end in change.found.interval)
        fits = tr("Anything from {low} to {high} fits.").format(low=low, high=high)
    dagger = f" {DAGGER}" if change.found.is_unverified else ""
    after = _goals_sentence(shown, visits, affected) or (_beside_sentence(walked, affected) if walked else "")
    return _with_brief(ProgressWords(sentence, " ".join(filter(None, [fits + dagger, after]))), change, visits)


def _values(
    visits: Sequence[CourseVisit],
    walked: CourseCondition | None,
    shown: Sequence[CourseLane],
    affected: Side | None,
) -> ProgressWords:
    """What was measured at a visit that no earlier one can be compared with."""
    if walked is None:
        return ProgressWords("", "")
    legs = _legs_sentence(walked, affected)
    speed = ""
    if math.isfinite(walked.speed_m_s):
        value = fixed(walked.speed_m_s, decimals(SPEED)) + short_unit(SPEED)
        speed = tr("Walking speed {value}.").format(value=value)
    sentence, *others = [*filter(None, [legs, speed]), ""]
    if not sentence:
        number = max(k for k, visit in enumerate(visits) if visit.course and visit.course.conditions)
        sentence = tr("No values were reported on {day}.").format(day=_long_day(number, visits))
    healthy = _healthy_beside(walked) if legs else ""
    goals = _goals_sentence(shown, visits, affected)
    return ProgressWords(sentence, " ".join(filter(None, [*others, healthy, goals])))


def _with_brief(words: ProgressWords, change: _Change, visits: Sequence[CourseVisit]) -> ProgressWords:
    column = change.lane.kind.column
    figures = change_in_figures(change.lane, change.one, is_since_last=change.is_since_last)
    if column == SPEED:
        figures += short_unit(column)
    brief = tr("{measure} {change} since {day}").format(
        measure=_short_name(column), change=figures, day=day_of(change.since, visits)
    )
    return ProgressWords(words.sentence, words.second, brief, arrow_of(change.lane, change.found))


def _rank(lane: CourseLane) -> tuple[bool, int, float]:
    """As in the headline: measures with a goal, then by their kind; of equal ones the one of most errors."""
    ratios = [one.since_before.ratio for one in lane.changes if one.since_before is not None]
    return not lane.goals, kind_of(lane.kind.column), -max(ratios, default=0.0)


def _walked(visits: Sequence[CourseVisit], condition: str) -> CourseCondition | None:
    """The condition at the last visit that has it."""
    found = [visit.course.condition(condition) for visit in visits if visit.course is not None]
    return next((one for one in reversed(found) if one is not None), None)


def _legs_sentence(walked: CourseCondition, affected: Side | None) -> str:
    """Both knees from stance to swing, the affected one first; one where only one is reported."""
    side = affected if affected is not None else Side.LEFT
    own, other = (walked.figure(KNEE, one) for one in (side, side.other))
    reported = [one for one in (own, other) if one is not None and one.is_reported and one.side is not None]
    if not reported:
        return ""
    between = walked.between_legs(KNEE)
    if len(reported) == 1 or between is None or not between.is_reported:
        alone = reported[0]
        assert alone.side is not None
        return clause_of(KNEE, alone.side, f"{fixed(alone.found.mean, 0)}°") + "."
    value, second = (one.found.mean for one in reported)
    left_right = (value, second) if side is Side.LEFT else (second, value)
    if not between.is_judged:
        return both_knees(*left_right)
    if not between.exceeds:
        return legs_similar(KNEE, left_right, between.difference)
    return legs_differ(KNEE, side, (value, second), between.difference if side is Side.LEFT else -between.difference)


def _healthy_beside(walked: CourseCondition) -> str:
    between = walked.between_legs(KNEE)
    return healthy_sentence(between) if between is not None else ""


def _beside_sentence(walked: CourseCondition, affected: Side | None) -> str:
    """Both knees, and how healthy people's differ."""
    legs = _legs_sentence(walked, affected)
    return " ".join(filter(None, [legs, _healthy_beside(walked)])) if legs else ""


def _goals_sentence(shown: Sequence[CourseLane], visits: Sequence[CourseVisit], affected: Side | None) -> str:
    """How the last values compare with goals agreed before: "Speed goal reached; knee 2° below its goal, ..."."""
    stated = [
        _goal_words(found, lane, one, affected)
        for lane in reversed(shown)  # the walk's before those of the joints
        for one in lane.changes
        for found in reported_goals(lane, one, visits)
    ]
    stated = list(filter(None, stated))
    return capitalised("; ".join(stated)) + "." if stated else ""


def _goal_words(found: GoalFigure, lane: CourseLane, one: LaneChange, affected: Side | None) -> str:
    name = _name(lane.kind.column, one.line.side, affected)
    if found.standing is GoalStanding.REACHED:
        return tr("{measure} goal reached").format(measure=name)
    if found.standing is GoalStanding.REACHED_INSIDE:
        return tr("{measure} goal reached, within error").format(measure=name)
    if found.standing not in (GoalStanding.SHORT, GoalStanding.SHORT_INSIDE):
        return ""
    short = abs(beyond(found.goal, round(found.value, lane.decimals)))
    size = fixed(short, lane.decimals) + _unit(lane.kind.column)
    pattern = tr("{measure} {size} above its goal") if found.goal.is_at_most else tr("{measure} {size} below its goal")
    words = pattern.format(measure=name, size=size)
    return tr("{words}, within error").format(words=words) if found.standing is GoalStanding.SHORT_INSIDE else words


def _judged_sentence(change: _Change, visits: Sequence[CourseVisit], affected: Side | None) -> str:
    """A change that page one does not state, with its error: beyond it, a choice among several measures asks more."""
    day, changes = _long_day(change.since, visits), _named(change, affected)
    if not change.found.exceeds:
        return tr("Since {day}: {changes}, within measurement error.").format(day=day, changes=changes)
    column = change.lane.kind.column
    error = fixed(change.found.error, max(1, decimals(column))) + _unit(column)
    return tr("Since {day}: {changes} (error ±{error}).").format(day=day, changes=changes, error=error)


def _named(change: _Change, affected: Side | None) -> str:
    name = _name(change.lane.kind.column, change.one.line.side, affected)
    return f"{name} {change.figures}"


def _name(column: str, side: Side | None, affected: Side | None) -> str:
    """The measure in a word or two; with its side, unless that is the affected one."""
    name = _short_name(column)
    if side is None or side is affected:
        return name
    return tr("{side} {measure}").format(side=side_name(side), measure=name)


def _short_name(column: str) -> str:
    short = {KNEE: tr("knee"), SPEED: tr("speed"), STANCE: tr("stance")}
    return short.get(column) or name_in_sentence(column)


def _unit(column: str) -> str:
    """A share differs by points, since 2 % less means another thing."""
    return f"\N{NO-BREAK SPACE}{tr('points')}" if unit_of(column) is Unit.PERCENT else unit_in_sentence(column)


def _long_day(number: int, visits: Sequence[CourseVisit]) -> str:
    """The day with its month written out; with year or time where that distinguishes it."""
    visit, days = visits[number], [visit.day for visit in visits]
    if len({day.year for day in days}) > 1:
        return long_date(visit.day, tr)
    stated = day_and_month(visit.day, tr)
    return f"{stated}, {visit.clock}" if visit.clock and days.count(visit.day) > 1 else stated

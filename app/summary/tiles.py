"""The four values that are always over the curves: speed, cadence, the knee, and stance of the legs beside each other.

Each with what it was at the last visit, its goal, and where it lies on a scale that is the same for every patient.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from app.charts.cycles import is_mean_enough
from app.summary.comparison import compare_legs
from app.summary.course import CourseCondition, change, change_between_legs
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.goals import goal_mark, goal_sentence
from app.summary.numbers_in_words import NOTHING, fixed, signed
from app.summary.trend_lines import walked_visits
from app.summary.walk_figures import NOT_REPORTED
from app.wording.dates import day_in_words
from app.wording.measures import bare_limit
from app.wording.translation import tr
from core.body import Side
from core.goals import GoalOf
from core.parameters import CADENCE, KNEE, SPEED, STANCE
from core.verdicts.measurement_error import Difference

SCALES = {SPEED: (0.0, 2.0), CADENCE: (40.0, 160.0), KNEE: (0.0, 80.0), STANCE: (-10.0, 10.0)}
DECIMALS = {SPEED: 2, CADENCE: 0, KNEE: 0, STANCE: 1}


@dataclass(frozen=True, slots=True)
class TileChange:
    """What a value has changed by since a visit, in words; `rises` None: there is none. Beyond error it is filled."""

    words: str
    rises: bool | None = None
    is_beyond_error: bool = False
    brief: str = ""
    """Without what the arrow states, where room is short; `size` alone where it is shorter."""
    size: str = ""
    day: str = ""


@dataclass(frozen=True, slots=True)
class TileValue:
    """One value, as text and as it is on the scale; `side` None: of both legs. NaN and a dash: not reported."""

    text: str
    value: float
    side: Side | None = None
    last: float = math.nan


@dataclass(frozen=True, slots=True)
class Tile:
    """One of the four.

    `zone`: what is drawn grey: cited group, or what 95 of 100 healthy people differ by; None: nothing.
    """

    column: str  # as in strides.csv; of stance it is the left leg less the right
    name: str
    unit: str
    values: tuple[TileValue, ...]  # one, or that of each leg
    change: TileChange
    scale: tuple[float, float]  # both ends
    zone: tuple[float, float] | None = None
    goals: tuple[float, ...] = ()  # values of the goals; `goal` has the first in short, `goal_words` how it was met
    goal: str = ""
    why: str = ""  # why there is no value
    goal_words: str = ""
    brief: str = ""
    """The name where room is short; empty: the same."""

    @property
    def last(self) -> str:
        """The values at the visit that the change is since: "23 Sep 48°"; empty without one."""
        known = [value for value in self.values if math.isfinite(value.last)]
        if not known or not self.change.day:
            return ""
        letters = [f"{one.side.letter}\u00a0" if one.side is not None and len(self.values) > 1 else "" for one in known]
        write, unit = signed if self.column == STANCE else fixed, "°" if self.column == KNEE else ""
        values = (write(value.last, DECIMALS[self.column]) + unit for value in known)
        return " ".join([self.change.day, *map("".join, zip(letters, values, strict=True))])

    @property
    def in_words(self) -> str:
        """The tile read out, by its whole name."""
        values = ", ".join(
            " ".join(filter(None, [one.side.letter if one.side is not None else "", one.text])) for one in self.values
        )
        if not any(math.isfinite(one.value) for one in self.values):
            stated = [f"{self.name}: {self.why}"]
        else:
            stated = [f"{self.name}: {values} {self.unit}".strip(), self.why]
        return ". ".join(filter(None, [*stated, self.change.words, self.goal_words or self.goal]))


def tiles_of(facts: Facts) -> tuple[Tile, ...]:
    """The four of a walk's condition, in their order."""
    walked = walked_visits(facts.course, facts.condition)
    return (
        _of_walk(facts, walked, SPEED),
        _of_walk(facts, walked, CADENCE),
        _knee(facts, walked),
        _stance(facts, walked),
    )


def _of_walk(facts: Facts, walked: list[CourseVisit], column: str) -> Tile:
    row = facts.time_distance[column]
    value = row.both if row.both is not None and not row.unknown_both else math.nan
    was, stated = _since_last(
        facts, walked, column, partial(_course_value, column, None), lambda now, then: change(now, then, column)
    )
    shown = TileValue(fixed(value, DECIMALS[column]), value, last=was)
    is_known = math.isfinite(value)
    why = "" if is_known else tr(row.unknown_both) if row.unknown_both else tr("not measured")
    tile = Tile(column, row.name, row.unit, (shown,), stated, SCALES[column], row.band, why=why)
    return _with_goals(facts, tile if is_known else replace(tile, change=TileChange("")), GoalOf.WALK)


def _knee(facts: Facts, walked: list[CourseVisit]) -> Tile:
    """Of the affected leg, else of both."""
    sides = (facts.affected,) if facts.affected is not None else tuple(Side)
    sides = tuple(side for side in sides if side in facts.gait) or tuple(facts.gait)
    name = tr("Knee flexion, stance to swing")
    if not sides:
        nothing = TileValue(NOTHING, math.nan)
        return Tile(KNEE, name, "", (nothing,), TileChange(""), SCALES[KNEE], why=tr("not measured"))
    each = [_knee_of(facts, walked, side) for side in sides]
    values, changes = [value for value, _ in each], [one for _, one in each]
    missing = [value for value in values if not math.isfinite(value.value)]
    is_worn = any(facts.is_worn(side, KNEE) for side in sides)
    letters = [one.side.letter for one in missing if one.side is not None and len(missing) < len(values)]
    why = " ".join([*letters, tr(NOT_REPORTED) if is_worn else tr("not measured")])
    stated = changes[0] if len(changes) == 1 else _of_both(values, changes)
    if len(values) == 1 and len(walked) < 2 and not missing:
        stated = _beside_other(facts, sides[0]) or stated
    tile = Tile(
        KNEE,
        name,
        "",
        tuple(values),
        stated,
        SCALES[KNEE],
        why=why if missing else "",
        brief=tr("Knee, stance to swing"),
    )
    return _with_goals(facts, tile, GoalOf.LEFT, GoalOf.RIGHT)


def _knee_of(facts: Facts, walked: list[CourseVisit], side: Side) -> tuple[TileValue, TileChange]:
    value = _knee_value(facts, side)
    was, stated = _since_last(
        facts, walked, KNEE, partial(_course_value, KNEE, side), lambda now, then: change(now, then, KNEE, side)
    )
    is_known = math.isfinite(value)
    text = fixed(value, DECIMALS[KNEE]) + ("°" if is_known else "")
    return TileValue(text, value, side, was), stated if is_known else TileChange("")


def _knee_value(facts: Facts, side: Side) -> float:
    """NaN where it is not reported."""
    if side not in facts.gait or not facts.assessment(side, KNEE).is_reported:
        return math.nan
    found = facts.value(side, KNEE)
    return found.mean if is_mean_enough(found.n) else math.nan


def _of_both(values: list[TileValue], changes: list[TileChange]) -> TileChange:
    """The change of one leg, by its letter: of that beyond error, else of the first."""
    known = [(value, one) for value, one in zip(values, changes, strict=True) if one.words]
    rising = [(value, one) for value, one in known if one.rises is not None]
    if not rising:
        return known[0][1] if known else TileChange("")
    value, leading = max(rising, key=lambda pair: pair[1].is_beyond_error)
    letter = value.side.letter if value.side is not None else ""
    return replace(
        leading, words=f"{letter} {leading.words}", brief=f"{letter} {leading.brief}", size=f"{letter} {leading.size}"
    )


def _beside_other(facts: Facts, side: Side) -> TileChange | None:
    """At a first visit the other leg's value."""
    value = _knee_value(facts, side.other)
    if not math.isfinite(value):
        return None
    words = f"{side.other.letter} {fixed(value, DECIMALS[KNEE])}°"
    return TileChange(words, brief=words)


def _stance(facts: Facts, walked: list[CourseVisit]) -> Tile:
    """The left leg's stance less the right's."""
    name = tr("Stance symmetry, L − R")
    if len(facts.gait) < len(Side):
        value = TileValue(NOTHING, math.nan)
        return Tile(STANCE, name, "", (value,), TileChange(""), SCALES[STANCE], why=tr("one leg measured"))
    found = compare_legs(facts.part, STANCE, (Side.LEFT, Side.RIGHT))
    was, stated = _since_last(
        facts, walked, STANCE, _course_symmetry, lambda now, then: change_between_legs(now, then, STANCE)
    )
    value = TileValue(signed(found.difference, DECIMALS[STANCE]), found.difference, last=was)
    zone = (-found.healthy, found.healthy) if math.isfinite(found.healthy) else None
    if not found.is_reported:
        return Tile(STANCE, name, "", (value,), TileChange(""), SCALES[STANCE], why=tr(NOT_REPORTED))
    tile = Tile(STANCE, name, tr("points"), (value,), stated, SCALES[STANCE], zone, brief=tr("Stance, L − R"))
    return _with_goals(facts, tile, GoalOf.BETWEEN)


def _course_value(column: str, side: Side | None, walked: CourseCondition) -> float:
    found = walked.figure(column, side)
    return found.found.mean if found is not None and found.is_reported else math.nan


def _course_symmetry(walked: CourseCondition) -> float:
    found = walked.between_legs(STANCE)
    return found.difference if found is not None and found.is_reported else math.nan


def _since_last(
    facts: Facts,
    walked: list[CourseVisit],
    column: str,
    read: Callable[[CourseCondition], float],
    judge: Callable[[CourseCondition, CourseCondition], Difference | None],
) -> tuple[float, TileChange]:
    """The value at the last visit before that has one, and what it has changed by since."""
    if len(walked) < 2:
        if len(facts.course) > 1:
            return math.nan, TileChange(tr("First in this condition"), brief=tr("First time"))
        return math.nan, TileChange(tr("First visit"), brief=tr("First visit"))
    parts = [visit.course.condition(facts.condition) if visit.course is not None else None for visit in walked]
    days, now = [visit.day for visit in walked], parts[-1]
    for visit, then in reversed(list(zip(walked, parts, strict=True))[:-1]):
        if then is None or now is None or not math.isfinite(value := read(then)):
            continue
        found = judge(now, then)
        if found is not None and found.is_reported:
            return value, _change(column, found, day_in_words(visit.day, days))
    words = tr("{day}: not reported").format(day=day_in_words(days[-2], days))
    return math.nan, TileChange(words, brief=words)


def _change(column: str, found: Difference, day: str) -> TileChange:
    """What has changed since a day: within error, or with an arrow that is filled."""
    size = signed(found.difference, DECIMALS[column]) + ("°" if column == KNEE else "")
    brief = tr("{change} since {day}").format(change=size, day=day)
    if not found.is_judged:
        return TileChange(brief, brief=brief, size=size, day=day)
    words = brief if found.exceeds else tr("{change} since {day}, within error").format(change=size, day=day)
    is_none = not round(found.difference, DECIMALS[column])  # what is shown as no change has no arrow
    return TileChange(words, None if is_none else found.difference > 0, found.exceeds, brief, size, day)


def _with_goals(facts: Facts, tile: Tile, *kinds: GoalOf) -> Tile:
    """The goals of the values that a tile has, and of the first how the walk compares with it, in a sentence."""
    sides = {one.side for one in tile.values}
    own = [
        found
        for found in facts.goals
        if found.goal.column == tile.column and found.goal.of in kinds and found.goal.of.side in {*sides, None}
    ]
    if not own:
        return tile
    first = own[0].goal
    signs = (1.0, -1.0) if first.of is GoalOf.BETWEEN else (1.0,)
    values = tuple(sign * found.goal.value for found in own for sign in signs)
    is_lettered = len(sides) > 1 or first.of is GoalOf.BETWEEN
    stated = goal_sentence(own[0]) if own[0] in facts.reported_goals else ""
    return replace(
        tile,
        goals=values,
        goal=goal_mark(first) if is_lettered else f"{tr('goal')} {bare_limit(first)}",
        goal_words=stated,
    )

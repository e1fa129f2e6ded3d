"""The one sentence over a walk: what changed, else how the legs differ, else that they are similar, with numbers.

The first rule that holds makes it: a change since the last visit, since the first, the affected side against the sound
one beyond what healthy people differ by, the same beyond error alone, and legs that are similar. Screen and report show
the same one.
"""

import datetime
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from app.charts.cycles import is_mean_enough
from app.summary.comparison import compare_legs
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.interval_words import edge_decimals, further_evidence, interval_words
from app.summary.legs_in_words import both_knees, clause_of, legs_differ, legs_similar, rounded
from app.summary.measure_sentences import unit_and_decimals, unit_in_sentence
from app.summary.numbers_in_words import DAGGER, fixed, signed
from app.summary.trend_lines import TrendLine, all_lines, walked_visits
from app.summary.what_stands_out import LEAST_CERTAIN, STATED_BETWEEN_LEGS, unsure_sentence
from app.wording.body import side_name
from app.wording.dates import day_in_words
from app.wording.measures import name_in_sentence
from app.wording.translation import capitalised, joined, tr
from core.body import Side
from core.parameters import BY_COLUMN, KNEE, SPEED, STANCE, QuantityClass, Unit, unit_of
from core.timed.measures import PROTOCOLS
from core.verdicts.measurement_error import Difference, Mark
from core.verdicts.quantities import joint_of

MOST_BESIDE = 3  # sentences of the second line


class Rule(StrEnum):
    """What the sentence is of."""

    SINCE_LAST = "since_last_visit"
    SINCE_FIRST = "since_first_visit"
    LEGS = "legs_beyond_healthy"
    LEGS_BEYOND_ERROR = "legs_beyond_error"
    SIMILAR = "similar"
    ONE_LEG = "one_leg"
    NOTHING = "nothing"
    """Too few strides, or nothing of the walk is reported."""


@dataclass(frozen=True, slots=True)
class Headline:
    """`first` is read from afar, `beside` are at most three sentences under it; the last is left out first.

    `column` and `side` are what it is of, empty and None where it is of no single measure. `since` is the visit that
    it compares with, else the last one before, None at a first visit: its curves are drawn thin.
    """

    rule: Rule
    first: str
    beside: tuple[str, ...] = ()
    column: str = ""
    side: Side | None = None
    since: CourseVisit | None = None

    @property
    def then(self) -> str:
        """The second line whole."""
        return " ".join(self.beside)


def headline_of(facts: Facts) -> Headline:
    """The sentence of a walk's condition."""
    strides = {side: facts.strides(side) for side in facts.gait}
    if not strides:
        return Headline(Rule.NOTHING, tr("No results for this walk: no foot or shank sensor showed a stride."))
    if not any(map(is_mean_enough, strides.values())):
        counted = joined([f"{side.letter}\N{NO-BREAK SPACE}{strides[side]}" for side in Side if side in strides])
        first = tr("Too few strides for a mean: {counted}.").format(counted=counted)
        return Headline(Rule.NOTHING, first, (tr("Repeat the walk over a longer distance or time."),))
    walked = walked_visits(facts.course, facts.condition)
    lines = all_lines(facts.course, facts.condition, facts.part.agreed)
    found = _change(facts, walked, lines) or _between_legs(facts) or _similar(facts) or _one_leg(facts)
    if found is None:
        found = Headline(Rule.NOTHING, tr("No value of this walk is reported."))
    last = _since_last(facts, walked, lines, found)
    beside = (*found.beside[:2], last, *found.beside[2:])  # behind what the first sentence is about
    since = found.since if found.since is not None else walked[-2] if len(walked) > 1 else None
    shown = tuple(filter(None, beside))[:MOST_BESIDE]
    return Headline(found.rule, found.first, shown, found.column, found.side, since)


def order_of(facts: Facts, column: str, side: Side | None, found: Difference) -> tuple[bool, int, bool, float]:
    """Give the sort key of differences of one rule: goals, kind, the affected side, then the one of most errors."""
    sides = tuple(Side) if side is None else (side,)
    is_of_other = side is not None and facts.affected not in (None, side)
    return not facts.part.agreed.is_chosen(column, sides), kind_of(column), is_of_other, -round(found.ratio, 1)


def kind_of(column: str) -> int:
    """Joints come before timing and speed, and these before the foot."""
    if joint_of(column, Side.LEFT) is not None:
        return 0
    if column in PROTOCOLS or column == SPEED or BY_COLUMN[column].rests_on is QuantityClass.TIMING:
        return 1
    return 2


def _change(facts: Facts, walked: Sequence[CourseVisit], lines: Sequence[TrendLine]) -> Headline | None:
    """What has changed by more than a sentence needs, since the last visit, else since the first."""
    days = [visit.day for visit in walked]
    for rule in (Rule.SINCE_LAST, Rule.SINCE_FIRST):
        changed = [(line, found, at) for line, found, at in _since(rule, lines) if found.is_worth_a_sentence]
        if changed:
            line, found, at = min(changed, key=lambda one: order_of(facts, one[0].column, one[0].side, one[1]))
            values = {one.visit: one.value for one in line.values}
            first = _change_sentence_since(
                line.column, line.side, found.difference, (values[at], line.values[-1].value), (walked[at].day, days)
            )
            parts = _evidence_in_sentences(line.column, found)
            return Headline(rule, first, parts, line.column, line.side, walked[at])
    return None


def _since(rule: Rule, lines: Sequence[TrendLine]) -> Iterator[tuple[TrendLine, Difference, int]]:
    """Each line with its change and the visit that this is from; since the first only where another is the last."""
    for line in lines:
        found, at = (line.since_last, line.before) if rule is Rule.SINCE_LAST else (line.since_first, line.first)
        if found is not None and (rule is Rule.SINCE_LAST or line.first != line.before):
            yield line, found, at


def _change_sentence_since(
    column: str,
    side: Side | None,
    difference: float,
    values: tuple[float, float],
    since: tuple[datetime.date, Sequence[datetime.date]],
) -> str:
    """State a measure and its change since a day; values get a decimal more where rounding contradicts it."""
    day = day_in_words(*since)
    if column == STANCE and side is not None:
        before, now, size = rounded(column, (*values, abs(difference)))
        stated = (
            tr("{side} stance is {size} points shorter than on {day}: {before} → {now} %.")
            if difference < 0
            else tr("{side} stance is {size} points longer than on {day}: {before} → {now} %.")
        )
        return stated.format(side=capitalised(side_name(side)), size=size, day=day, before=before, now=now)
    _, now, size = rounded(column, (*values, abs(difference)))
    unit = unit_and_decimals(column)[0]
    stated = tr("{clause}, down {size} since {day}.") if difference < 0 else tr("{clause}, up {size} since {day}.")
    sentence = stated.format(clause=clause_of(column, side, now + unit), size=size + unit, day=day)
    return sentence.removesuffix("..") + "." if sentence.endswith("..") else sentence  # a shortened month has its own


def _evidence_in_sentences(column: str, found: Difference, *, is_of_legs: bool = False) -> tuple[str, ...]:
    """What is known of a difference beyond its error, sentence by sentence, so that the last can be left out."""
    whose = tr("Difference {likely}.") if is_of_legs else tr("Change {likely}.")
    likely = whose.format(likely=interval_words(column, found)) + (f" {DAGGER}" if found.is_unverified else "")
    return tuple(filter(None, [likely, further_evidence(column, found)]))


def _between_legs(facts: Facts) -> Headline | None:
    """How the affected leg differs from the other: beyond healthy people's difference, else beyond error."""
    if len(facts.gait) < len(Side):
        return None
    first, second = facts.first_and_second
    legs = {column: compare_legs(facts.part, column, (first, second)) for column in STATED_BETWEEN_LEGS}
    for rule, mark in ((Rule.LEGS, Mark.HEALTHY), (Rule.LEGS_BEYOND_ERROR, Mark.ERROR)):
        marked = {column: found for column, found in legs.items() if found.is_reported and found.mark is mark}
        if marked:
            column = min(marked, key=lambda one: order_of(facts, one, None, marked[one]))
            found = marked[column]
            values = facts.value(first, column).mean, facts.value(second, column).mean
            is_usual = mark is Mark.ERROR and math.isfinite(found.healthy)
            sentence = legs_differ(column, first, values, found.difference, is_usual=is_usual)
            beside = _evidence_in_sentences(column, found, is_of_legs=True)[: None if mark is Mark.HEALTHY else 1]
            return Headline(rule, sentence, (*beside, *_unsure(facts)), column, first)
    return None


def _similar(facts: Facts) -> Headline | None:
    """Both legs' values, where nothing that is judged differs by more than its error."""
    if len(facts.gait) < len(Side):
        return None
    sides = facts.first_and_second
    legs = {column: compare_legs(facts.part, column, sides) for column in (KNEE, STANCE, *STATED_BETWEEN_LEGS)}
    column = next((one for one, found in legs.items() if found.is_judged), None)
    if column is None:
        return None
    values = facts.value(Side.LEFT, column).mean, facts.value(Side.RIGHT, column).mean
    first = legs_similar(column, values, legs[column].difference)
    may_be = _may_be_error(column, legs[column], sides) + (f" {DAGGER}" if legs[column].is_unverified else "")
    return Headline(Rule.SIMILAR, first, (may_be, *_unsure(facts)), column)


def _may_be_error(column: str, found: Difference, sides: tuple[Side, Side]) -> str:
    """What the legs' difference may be, with its sign, as the table has it."""
    unit, decimals = unit_and_decimals(column)
    unit = f"\N{NO-BREAK SPACE}{tr('points')}" if unit_of(column) is Unit.PERCENT else unit
    low, high = (signed(edge, edge_decimals(column, found)) + unit for edge in found.interval)
    stated = tr("{first} − {second} {size}, which may be measurement error: anything from {low} to {high} fits.")
    size = signed(found.difference, decimals) + unit
    return stated.format(first=sides[0].letter, second=sides[1].letter, size=size, low=low, high=high)


def _unsure(facts: Facts) -> list[str]:
    """What tables mark and no sentence is made of: named, so that legs are not called similar above its mark."""
    found = {column: compare_legs(facts.part, column, facts.first_and_second) for column in LEAST_CERTAIN}
    return [unsure_sentence(column, one) for column, one in found.items() if one.exceeds]


def _one_leg(facts: Facts) -> Headline | None:
    """What both legs have of the knee, where nothing is judged; one leg of knee or stance; else the walking speed."""
    known = {side: facts.value(side, KNEE) for side in facts.gait}
    if len(known) > 1 and all(is_mean_enough(found.n) and math.isfinite(found.mean) for found in known.values()):
        return Headline(Rule.ONE_LEG, both_knees(known[Side.LEFT].mean, known[Side.RIGHT].mean), (), KNEE)
    alone = next(iter(facts.gait)) if len(facts.gait) == 1 else None
    if alone is not None and (found := _leg_of(facts)) is not None:
        note = tr("Only the {side} leg was measured.").format(side=side_name(alone))
        return replace(found, beside=(note,))
    return _leg_of(facts)


def _leg_of(facts: Facts) -> Headline | None:
    for side in facts.first_and_second:
        for column in (KNEE, STANCE):
            found = facts.value(side, column)
            if side in facts.gait and is_mean_enough(found.n) and math.isfinite(found.mean):
                unit, decimals = unit_and_decimals(column)
                value = fixed(found.mean, 0 if unit_of(column) is Unit.DEGREES else decimals) + unit
                return Headline(Rule.ONE_LEG, f"{clause_of(column, side, value)}.", (), column, side)
    if math.isfinite(facts.speed_m_s):
        unit, decimals = unit_and_decimals(SPEED)
        return Headline(Rule.ONE_LEG, f"{clause_of(SPEED, None, fixed(facts.speed_m_s, decimals) + unit)}.", (), SPEED)
    return None


def _since_last(facts: Facts, walked: Sequence[CourseVisit], lines: Sequence[TrendLine], found: Headline) -> str:
    """What the headline's measure, else the knee, stance or speed, is since the last visit: under other rules."""
    if found.rule is Rule.SINCE_LAST:
        return ""
    judged = [line for line in lines if line.since_last is not None and line.since_last.is_judged]
    side = found.side if found.side is not None else facts.first_and_second[0]
    for column in (found.column, KNEE, STANCE, SPEED):
        for line in judged:
            if line.column == column and line.side in (None, side) and (change := line.since_last) is not None:
                return _last_visit_sentence(line, change, walked, is_named=column != found.column)
    return ""


def _last_visit_sentence(line: TrendLine, change: Difference, walked: Sequence[CourseVisit], *, is_named: bool) -> str:
    """A change since the last visit that makes no headline: "Since 3 November: +1°, within measurement error."."""
    is_whole = unit_of(line.column) is Unit.DEGREES and round(change.difference)
    decimals = 0 if is_whole else unit_and_decimals(line.column)[1]
    size = signed(change.difference, decimals) + (unit_in_sentence(line.column))
    day = day_in_words(walked[line.before].day, [visit.day for visit in walked])
    dagger = f" {DAGGER}" if change.is_unverified else ""
    if not is_named:
        stated = (
            tr("Since {day}: {size}, beyond measurement error.")
            if change.exceeds
            else tr("Since {day}: {size}, within measurement error.")
        )
        return stated.format(day=day, size=size) + dagger
    stated = (
        tr("Since {day}: {measure} {size}, beyond measurement error.")
        if change.exceeds
        else tr("Since {day}: {measure} {size}, within measurement error.")
    )
    return stated.format(day=day, measure=name_in_sentence(line.column), size=size) + dagger

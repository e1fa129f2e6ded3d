"""Measures in which the legs differ most: beyond healthy people's difference, beyond error, within it, not reported.

Among alike those with goals come first, then joints, stance and time, the foot, then the one of most errors.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from app.summary.comparison import compare_legs
from app.summary.course import change
from app.summary.facts import Facts
from app.summary.headline import order_of
from app.summary.measure_sentences import unit_and_decimals
from app.summary.trend_lines import walked_visits
from app.summary.walk_figures import NO_HEIGHT, NO_ZERO, doubt_in
from app.summary.what_stands_out import FAMILIES
from app.wording.measures import measure_name
from app.wording.translation import tr
from app.wording.verdicts import verdict_word
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.goals import Goal
from core.parameters import BETWEEN_LEGS
from core.verdicts.measurement_error import Difference, Mark
from core.verdicts.model import Verdict
from core.verdicts.quantities import joint_of

ZONES, HALVES = 2.3, 1.6  # to either edge: healthy people's differences, or errors


@dataclass(frozen=True, slots=True)
class LegsRow:
    """One measure of both legs.

    A leg whose figure may not be reported, or is not known, is missing in `values`, and `unknown` states why.
    `difference` is the first side's less the second's, as `Facts.first_and_second` orders them. `goals` had been
    agreed by the walk's day.
    """

    column: str
    name: str
    unit: str
    decimals: int
    values: Mapping[Side, MeanAndSd]
    verdicts: Mapping[Side, Verdict]
    unknown: Mapping[Side, str]
    difference: Difference
    goals: tuple[Goal, ...] = ()


def what_differs(facts: Facts) -> tuple[LegsRow, ...]:
    """Every measure of the legs, the largest differences first."""
    rows = [_row(facts, column) for column in BETWEEN_LEGS if any(facts.is_worn(side, column) for side in facts.gait)]
    return tuple(sorted(rows, key=lambda row: _weight(facts, row)))


def half_of_strip(found: Difference, reach: float = 1.0) -> float:
    """Half the width of a strip: by healthy people, else by the interval; at least `reach` times what it reaches."""
    usual = ZONES * found.healthy if math.isfinite(found.healthy) else HALVES * found.error
    return max(usual, reach * (abs(found.difference) + found.error))


def without_family(rows: Sequence[LegsRow]) -> list[LegsRow]:
    """A range and the excursion that makes most of it are one movement: the excursion, where it is reported."""
    reported = {row.column for row in rows if row.difference.is_reported}
    return [row for row in rows if FAMILIES.get(row.column) not in reported]


def since_last(facts: Facts, column: str) -> tuple[Side, Difference] | None:
    """What a measure of the affected leg, else the left, has changed by since the last visit, if both have it."""
    walked = walked_visits(facts.course, facts.condition)
    parts = [visit.course.condition(facts.condition) for visit in walked if visit.course is not None]
    side = facts.first_and_second[0]
    if len(parts) < 2 or parts[-1] is None or parts[-2] is None:
        return None
    changed = change(parts[-1], parts[-2], column, side)
    return (side, changed) if changed is not None and changed.is_reported else None


def _weight(facts: Facts, row: LegsRow) -> tuple[bool, bool, int, tuple[bool, int, bool, float]]:
    """What is shown first is least: the mark, then as for the headline; what is not judged, then not reported, last."""
    found = row.difference
    marks = (Mark.HEALTHY, Mark.ERROR, Mark.NONE)
    return (
        not found.is_reported,
        not found.is_judged,
        marks.index(found.mark),
        order_of(facts, row.column, None, found),
    )


def _row(facts: Facts, column: str) -> LegsRow:
    unit, decimals = unit_and_decimals(column)
    verdicts = {side: _verdict(facts, side, column) for side in Side}
    found = {side: facts.value(side, column) for side in Side}
    unknown = {side: why for side in Side if (why := _unknown(facts, side, column, verdicts[side]))}
    name = measure_name(column)
    return LegsRow(
        column=column,
        name=name,
        unit=unit,
        decimals=decimals,
        values={side: value for side, value in found.items() if side not in unknown},
        verdicts=verdicts,
        unknown=unknown,
        difference=compare_legs(facts.part, column, facts.first_and_second),
        goals=facts.part.agreed.of(column),
    )


def _verdict(facts: Facts, side: Side, column: str) -> Verdict:
    is_measured = side in facts.gait and facts.is_worn(side, column)
    return facts.assessment(side, column).verdict if is_measured else Verdict.NOT_MEASURED


def _unknown(facts: Facts, side: Side, column: str, verdict: Verdict) -> str:
    if verdict is Verdict.NOT_REPORTED:
        joint = joint_of(column, side)
        doubt = doubt_in(facts.verdicts.joint(joint)) if joint is not None else None
        return tr(doubt) if doubt in (NO_ZERO, NO_HEIGHT) else verdict_word(verdict)
    if verdict is Verdict.NOT_MEASURED:
        return verdict_word(verdict)
    if facts.is_no_peak(side, column):
        return tr("no peak")
    return "" if facts.value(side, column).n else tr("no value")

"""Measures in which the legs differ most.

Measures with goals come first, then those judged, the one of most errors first.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from app.summary.comparison import compare_legs
from app.summary.facts import Facts
from app.summary.measure_sentences import unit_and_decimals
from app.summary.numbers_in_words import Band
from app.summary.walk_figures import NO_HEIGHT, NO_ZERO, doubt_in
from app.wording.measures import measure_name
from app.wording.translation import tr
from app.wording.verdicts import verdict_word
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.goals import Goal
from core.parameters import BETWEEN_LEGS
from core.verdicts.measurement_error import Difference
from core.verdicts.model import Verdict
from core.verdicts.quantities import joint_of


@dataclass(frozen=True, slots=True)
class LegsRow:
    """One measure of both legs.

    A leg whose figure may not be reported, or is not known, is missing in `values`, and `unknown` states why.
    `difference` is the first side's less the second's, as `Facts.first_and_second` orders them. `band` is the cited
    group's mean less and plus 2 SD. `goals` had been agreed by the walk's day.
    """

    column: str
    name: str
    unit: str
    decimals: int
    values: Mapping[Side, MeanAndSd]
    verdicts: Mapping[Side, Verdict]
    unknown: Mapping[Side, str]
    difference: Difference
    band: Band | None
    goals: tuple[Goal, ...] = ()


def what_differs(facts: Facts) -> tuple[LegsRow, ...]:
    """Judged differences by how many errors they are large, then those without an error, then those not reported."""
    rows = [_row(facts, column) for column in BETWEEN_LEGS if any(facts.is_worn(side, column) for side in facts.gait)]
    return tuple(sorted(rows, key=_weight))


def _weight(row: LegsRow) -> tuple[bool, bool, bool, float]:
    """What is reported first is least: measures with goals, then what is judged by how many errors it is large."""
    return not row.goals, not row.difference.is_judged, not row.difference.is_reported, -row.difference.ratio


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
        band=_band(facts, column),
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


def _band(facts: Facts, column: str) -> Band | None:
    """2 SD about the mean of a group that may stand beside the walk; None for what its source does not have."""
    if not facts.sides_with_band:
        return None
    one_sd = facts.band(column) if column.endswith("_deg") else _band_of_time(facts, column)
    if one_sd is None:
        return None
    half = one_sd[1] - one_sd[0]
    middle = (one_sd[0] + one_sd[1]) / 2
    return middle - half, middle + half


def _band_of_time(facts: Facts, column: str) -> Band | None:
    return facts.time_distance[column].band if column in ("stance_percent", "stride_length_m") else None

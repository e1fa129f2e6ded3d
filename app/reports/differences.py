"""By how much do conditions or visits differ, and is that more than the measurement error? One table of every pair.

Within a session each later condition is told against the first. Between sessions a condition is told against the same
one of the first session; where they share none, the last walks are. What is judged, and how, is as in the report.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from app.reports.csv_report import write_table
from app.reports.gait_csv import PARAMETERS
from app.reports.patient_report.comparison_page import Compared, Comparison
from app.reports.patient_report.facts import KINDS, Facts
from app.reports.patient_report.request import Visit, default_walks
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.gait.symmetry import curve_difference
from core.norms import MIN_STRIDES_FOR_MEAN, Verdict

NO_COMMON_ZERO = "no_common_zero"  # heights of the curves say nothing, so only their ranges are compared
OF_BOTH = ("cadence_steps_min", "double_support_percent", "speed_m_s")
OF_PAIR = ("one_session", "one_walk", "one_condition", "other_session", "other_walk", "other_condition")
OF_MEANS = ("one_mean", "one_sd", "one_n", "other_mean", "other_sd", "other_n")
HEADER = (*OF_PAIR, "side", "parameter", *OF_MEANS, "difference", "error", "verdict")


@dataclass(frozen=True, slots=True)
class Told:
    """One walk of the session `number`, counted from 1 in the order they were given."""

    number: int
    facts: Facts

    @property
    def condition(self) -> str:
        return self.facts.visit.recording(self.facts.walk.name).condition


@dataclass(frozen=True, slots=True)
class Row:
    """One figure of two walks, `one` being the later. `side` None: of both. NaN where something is not known."""

    one: Told
    other: Told
    side: Side | None
    parameter: str
    one_mean: MeanAndSd
    other_mean: MeanAndSd
    difference: float
    error: float
    verdict: str


def pairs(visits: Sequence[Visit]) -> list[tuple[Told, Told]]:
    """Which walks are told against which, the later one first."""
    walks = [
        [Told(number, Facts(visit, visit.walk(name))) for name in _last_of_conditions(visit)]
        for number, visit in enumerate(visits, start=1)
    ]
    found = [(one, of_one[0]) for of_one in walks for one in of_one[1:]]
    first = {told.condition: told for told in walks[0]} if walks else {}
    for later in walks[1:]:
        shared = [(one, first[one.condition]) for one in later if one.condition in first]
        found += shared or [(one, other) for one, other in zip(later[-1:], walks[0][-1:], strict=False)]
    return found


def rows_of(one: Told, other: Told) -> Iterator[Row]:
    """Every figure that both walks have."""
    parts = [Compared(letter, "", told.facts) for letter, told in (("A", other), ("B", one))]
    comparison = Comparison(parts, is_visits=one.number != other.number)
    for side in Side:
        for column in PARAMETERS:
            mine, theirs = one.facts.value(side, column), other.facts.value(side, column)
            if mine.n and theirs.n:
                difference, error, verdict = _judged(comparison, side, column, mine, theirs)
                yield Row(one, other, side, column, mine, theirs, difference, error, verdict)
        yield from _curves(one, other, side, comparison)
    for name in OF_BOTH:
        values = [getattr(told.facts.feet, name) for told in (one, other)]
        if all(map(math.isfinite, values)):
            mine, theirs = (MeanAndSd(value, math.nan, 0) for value in values)
            verdict = str(Verdict.NO_PUBLISHED_FIGURE)
            yield Row(one, other, None, name, mine, theirs, mine.mean - theirs.mean, math.nan, verdict)


def write_differences(found: Sequence[Row], path: Path) -> None:
    """Write the table.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    write_table(HEADER, (_cells(row) for row in found), path)


def _last_of_conditions(visit: Visit) -> list[str]:
    """The last walk of each condition, however many, in order of time."""
    last = {visit.recording(name).condition: name for name in visit.walk_names()}
    return [name for name in visit.walk_names() if name in last.values()] or list(default_walks(visit))


def _judged(
    comparison: Comparison, side: Side, column: str, one: MeanAndSd, other: MeanAndSd
) -> tuple[float, float, str]:
    if not comparison.is_comparable(column) and column.endswith("_deg"):
        return math.nan, math.nan, NO_COMMON_ZERO
    if column.endswith("_deg") or column == "stance_percent":
        found = comparison.difference(comparison.parts[-1], side, column)
        return found.difference_deg, found.error_deg, str(found.verdict)
    if min(one.n, other.n) < MIN_STRIDES_FOR_MEAN:
        return math.nan, math.nan, str(Verdict.TOO_FEW_STRIDES)
    return one.mean - other.mean, math.nan, str(Verdict.NO_PUBLISHED_FIGURE)


def _curves(one: Told, other: Told, side: Side, comparison: Comparison) -> Iterator[Row]:
    """How far apart the mean curves lie on average, where both are told from the same kind of zero."""
    nothing = MeanAndSd(math.nan, math.nan, 0)
    for kind in KINDS if comparison.has_one_zero else ():
        curves = [told.facts.mean_curve_deg(side, kind) for told in (one, other)]
        difference = curve_difference(curves[0], curves[1])
        if math.isfinite(difference):
            name, verdict = f"{kind}_curve_difference_deg", str(Verdict.NO_PUBLISHED_FIGURE)
            yield Row(one, other, side, name, nothing, nothing, difference, math.nan, verdict)


def _cells(row: Row) -> list[str]:
    walks = [text for told in (row.one, row.other) for text in (str(told.number), told.facts.walk.name, told.condition)]
    means = [
        cell for mean in (row.one_mean, row.other_mean) for cell in (_cell(mean.mean), _cell(mean.sd), _count(mean.n))
    ]
    side = "both" if row.side is None else str(row.side)
    return [*walks, side, row.parameter, *means, _cell(row.difference), _cell(row.error), row.verdict]


def _cell(value: float) -> str:
    return f"{value:.5f}" if math.isfinite(value) else ""


def _count(n: int) -> str:
    return str(n) if n else ""

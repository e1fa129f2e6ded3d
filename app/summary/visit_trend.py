"""A measure over the visits of one condition: what of it may be drawn, where, and over which error."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from app.charts.cycles import is_mean_enough
from app.summary.comparison import Compared, Comparison
from app.summary.conditions import Part
from core.verdicts.measurement_error import least_error
from core.verdicts.model import Verdict
from core.verdicts.sigmas import ComparisonKind


@dataclass(frozen=True, slots=True)
class Trend:
    """One value for each visit, in the measure's unit; NaN where none may be drawn.

    `band`: what the change shown is counted from, less and plus its error; None where the change is not judged.
    `edges`: the values at the lower and upper edge: all that is drawn, and not less than twice the error, so that what
    is inside the error is not blown up.
    """

    places: tuple[float, ...]  # where the visits lie between the first, 0, and the last, 1
    values: tuple[float, ...]
    band: tuple[float, float] | None
    edges: tuple[float, float]


def trend_of(found: Comparison, row: Compared) -> Trend:
    """The measure of `row`, which is the change to one visit, over all visits that are compared."""
    values = _values(found, row)
    error = row.difference.error
    is_judged = row.is_reported and row.difference.is_judged
    band = (row.other.mean - error, row.other.mean + error) if is_judged else None
    known = [value for value in values if math.isfinite(value)]
    drawn = [*known, *(band or ())]
    low, high = min(drawn, default=0.0), max(drawn, default=0.0)
    least = error if is_judged else _usual_error(row.measure.column, known)
    half, middle = max((high - low) / 2, least), (low + high) / 2
    return Trend(_places(found.parts), values, band, (middle - half, middle + half))


def _values(found: Comparison, row: Compared) -> tuple[float, ...]:
    """As the table shows them; heights above zeros of different kinds make no line."""
    measure, joint = row.measure, row.measure.joint(row.side)
    if joint is not None and measure.needs_height and not found.has_one_zero(joint):
        return (math.nan,) * len(found.parts)
    figures = [part.figure(measure, row.side) for part in found.parts]
    return tuple(
        value.mean if verdict in (Verdict.READ, Verdict.CARE) and is_mean_enough(value.n) else math.nan
        for value, verdict in figures
    )


def _places(parts: Sequence[Part]) -> tuple[float, ...]:
    """To the scale of days; side by side where a day is not known or is that of two visits."""
    days = [part.day.toordinal() for part in parts if part.day is not None]
    if len(days) < len(parts) or not all(one < other for one, other in pairwise(days)):
        days = list(range(len(parts)))
    return tuple((day - days[0]) / max(days[-1] - days[0], 1) for day in days)


def _usual_error(column: str, values: Sequence[float]) -> float:
    """What strapping and another day alone make of the error of a change."""
    error = least_error(column, ComparisonKind.VISITS, values[-1])[0] if values else math.nan
    return error if math.isfinite(error) else 0.0

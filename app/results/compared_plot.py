"""A comparison as dots over the grey of their error: which measures have a row, and what is drawn in it."""

import math
from collections.abc import Sequence

from app.plots.difference_plot import DifferenceGroup, DifferenceRow, Dot
from app.results.compared_words import BRIEF, change_in_words, why_not_reported
from app.summary.comparison import Compared, Comparison, SideRow
from app.summary.measures import Measure
from app.wording.translation import tr
from core.body import Side

IN_DEGREES = ("°", "%")  # what the axis of the differences can hold


def comparison_groups(found: Comparison, *, is_brief: bool) -> list[DifferenceGroup]:
    """A row for each leg of a measure, a dot for each part."""
    groups: dict[str, dict[Side, list[Compared]]] = {}
    for row in found.rows:
        if _is_drawn(row.measure, is_brief=is_brief):
            groups.setdefault(tr(row.measure.name), {}).setdefault(row.side, []).append(row)
    return [
        DifferenceGroup(title, tuple(_row(side, rows) for side, rows in sides.items()))
        for title, sides in groups.items()
    ]


def side_groups(rows: Sequence[SideRow], first: Side, *, is_brief: bool) -> list[DifferenceGroup]:
    """A row for each measure, with one dot: the first leg less the second."""
    return [
        DifferenceGroup(tr(row.measure.name), (_row_of_sides(row, first),))
        for row in rows
        if _is_drawn(row.measure, is_brief=is_brief)
    ]


def _is_drawn(measure: Measure, *, is_brief: bool) -> bool:
    """Whether a measure has a place among the differences that are drawn; the table has all."""
    return measure.unit in IN_DEGREES and (not is_brief or measure.column in BRIEF)


def _row(side: Side, rows: Sequence[Compared]) -> DifferenceRow:
    reported = [row for row in rows if row.is_reported]
    dots = tuple(Dot(row.part.letter, row.difference.difference, row.exceeds) for row in reported)
    if not reported:
        return DifferenceRow(side, why_not_reported(rows[-1]), (), math.nan)
    last = reported[-1]
    words = f"{last.part.letter} {change_in_words(last.difference.difference, last.measure)}"
    return DifferenceRow(side, words, dots, last.difference.error)


def _row_of_sides(row: SideRow, first: Side) -> DifferenceRow:
    if not row.is_reported:
        return DifferenceRow(None, why_not_reported(row), (), row.difference.error)
    found = row.difference
    dot = Dot(first.letter, found.difference, row.exceeds)
    return DifferenceRow(None, change_in_words(found.difference, row.measure), (dot,), found.error)

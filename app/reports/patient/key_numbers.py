"""Few figures of both legs for page one. Those that the findings report first, then always the same."""

from app.charts.cycles import is_spread_enough
from app.reports.blocks import Block, Cell, Column, Row, heading, note, table
from app.reports.patient.key_strips import strip
from app.summary.comparison import Comparison
from app.summary.facts import Facts
from app.summary.goals import goal_mark
from app.summary.interval_words import interval_in_figures
from app.summary.numbers_in_words import (
    MARKS,
    NOTHING,
    band_in_figures,
    dagger_note,
    marked,
    marks_note,
    signed,
    spread,
)
from app.summary.what_differs import LegsRow, what_differs
from app.summary.what_stands_out import BANDS_ON_PAPER, ranked_findings
from app.wording.measures import with_unit
from app.wording.translation import tr
from core.body import Side
from core.parameters import KNEE, KNEE_RANGE, PUSH_OFF, STANCE, STEP_TIME
from core.verdicts.model import Verdict

MOST_ROWS = 5
ALWAYS = (KNEE, PUSH_OFF, STANCE, STEP_TIME, KNEE_RANGE)


def key_numbers(facts: Facts, comparison: Comparison | None) -> list[Block]:
    """A table of up to five measures that were worn and are reported for at least one leg; nothing without any."""
    rows = key_rows(facts, comparison)
    if not rows:
        return []
    one, other = facts.first_and_second
    columns = [
        Column(tr("Measure"), "1fr", is_number=False),
        *(Column(facts.counted(side)) for side in Side),
        Column(f"{one.letter} − {other.letter}"),
        Column(tr("likely between"), "23mm"),
        Column(tr("Reference")),
        Column(tr("L above, R below, ± half the error"), "31mm", is_number=False),
    ]
    cells: list[Row] = [_cells(row) for row in rows]
    stated = []
    if any(row.difference.is_judged for row in rows):
        stated.append(marks_note())
    if any(row.difference.is_judged and row.difference.is_unverified for row in rows):
        stated.append(dagger_note())
    notes = [note(" ".join(stated))] if stated else []
    return [heading(tr("Key values")), table(columns, cells), *notes]


def key_rows(facts: Facts, comparison: Comparison | None) -> list[LegsRow]:
    """What the findings report, what goals are about, then what is always shown."""
    rows = {row.column: row for row in what_differs(facts) if row.values}
    reported = [one.column for one in ranked_findings(facts, comparison, BANDS_ON_PAPER)]
    columns = dict.fromkeys([*reported, *(column for column, row in rows.items() if row.goals), *ALWAYS])
    return [rows[column] for column in columns if column in rows][:MOST_ROWS]


def _cells(row: LegsRow) -> list[Cell | str]:
    found = row.difference
    values = [_value(row, side) for side in Side]
    unit = row.unit.strip()
    apart = f"{MARKS[found.mark]} {signed(found.difference, row.decimals)}".strip()
    return [
        "; ".join([with_unit(row.name, unit), *map(goal_mark, row.goals)]),
        *values,
        Cell(apart if found.is_reported else NOTHING, is_bold=found.exceeds),
        interval_in_figures(row.column, found),
        _band(row),
        Cell("", picture=strip(row)),
    ]


def _value(row: LegsRow, side: Side) -> Cell | str:
    if side not in row.values:
        return row.unknown.get(side, NOTHING)
    value = row.values[side]
    verdict = row.verdicts.get(side, Verdict.READ)
    return Cell(marked(spread(value, row.decimals), verdict), is_grey=not is_spread_enough(value.n))


def _band(row: LegsRow) -> str:
    if row.band is None:
        return tr("no reference")
    low, high = row.band
    quarter = (high - low) / 4
    return band_in_figures((low + quarter, high - quarter), row.decimals)

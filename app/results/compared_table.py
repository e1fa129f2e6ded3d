"""A comparison as a table: the values of all parts, their changes with the error, and between visits the trend."""

import math
from collections.abc import Sequence
from dataclasses import replace

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.results.compared_words import BRIEF, change_in_words, days_of, interval_of
from app.summary.comparison import Compared, Comparison, Contrast, SideRow
from app.summary.conditions import Part
from app.summary.goals import goal_mark
from app.summary.numbers_in_words import DAGGER, MARKS, NOTHING, fixed
from app.summary.visit_trend import trend_of
from app.theme.icons import Icon
from app.widgets.figures_table import CARE_MARK, FIGURE
from app.widgets.table import TableColumn, TableRow
from app.widgets.table_cells import EMPTY, RIGHT, TextCell
from app.widgets.text import REGULAR, SEMIBOLD
from app.widgets.trend_cell import TrendCell
from app.wording.body import side_name
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, tr
from app.wording.verdicts import verdict_word
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.goals import Goal, GoalOf
from core.verdicts.measurement_error import Difference, Judgement
from core.verdicts.model import Verdict

WALK_FIRST = {"speed_m_s": 0, "cadence_steps_min": 1, "stride_length_m": 2}  # the rows of a table
TableOfParts = tuple[list[TableColumn], list[TableRow]]


def comparison_table(found: Comparison, most_visits: int, *, is_brief: bool = False) -> TableOfParts:
    """Give each leg's measures: values of all parts, changes, error of the last. Trends have all visits.
    `most_visits`: columns at most, base and latest; `is_brief`: no near-duplicates unless beyond error.
    """
    rows: dict[tuple[str, Side], list[Compared]] = {}
    for row in sorted(found.changes, key=lambda row: WALK_FIRST.get(row.measure.column, len(WALK_FIRST))):
        rows.setdefault((row.measure.column, row.side), []).append(row)
    reported = _reported_briefly(found)
    shown = _shown(found, most_visits)
    heads = _heads(found, shown)
    lines = [
        _comparison_row(found, shown, compared, [head.text for head in heads])
        for (column, _), compared in rows.items()
        if not is_brief or column in reported
    ]
    return _columns(heads, has_sides=True), lines


def has_brief_table(found: Comparison) -> bool:
    """Whether the brief table is without some measures."""
    return len(_reported_briefly(found)) < len({row.measure.column for row in found.changes})


def side_table(rows: Sequence[SideRow], first: Side, second: Side) -> TableOfParts:
    """Every measure of both legs, their difference with its error, and symmetry."""
    one, other = first.letter, second.letter
    heads = [one, other, f"{one} {MINUS} {other}", tr("likely between"), tr("symmetry, %")]
    return _columns([head_cell(head) for head in heads], has_sides=False), [side_table_row(row, heads) for row in rows]


def head_cell(words: str, small: str = "", spoken: str = "") -> TextCell:
    """What is shown above a column of figures."""
    return TextCell(words, small, align=RIGHT, size=12, tone="ink2", spoken=spoken)


def _reported_briefly(found: Comparison) -> set[str]:
    """The columns of the measures in a brief table."""
    marked = {row.measure.column for row in found.changes if row.exceeds}
    agreed = {goal.column for part in found.parts for goal in part.agreed.held}
    return {row.measure.column for row in found.changes} & marked.union(WALK_FIRST, BRIEF, agreed)


def _shown(found: Comparison, most_visits: int) -> list[Part]:
    """The parts whose values have a column."""
    if found.kind is not Contrast.VISITS:
        return list(found.parts)
    latest = found.others[-(most_visits - 1) :]
    return [part for part in found.parts if part is found.against or any(part is one for one in latest)]


def _heads(found: Comparison, shown: Sequence[Part]) -> list[TextCell]:
    """Between visits each has its day, and one change is reported: that to the latest."""
    is_of_visits = found.kind is Contrast.VISITS
    each = zip(shown, days_of(shown), strict=True)
    heads = [head_cell(part.letter, day if is_of_visits else "") for part, day in each]
    others = [found.latest] if is_of_visits and found.latest is not None else found.others
    changes = [head_cell(f"{part.letter} {MINUS} {found.against.letter}") for part in others if part is not None]
    many = tr("{letter} likely between").format(letter=found.others[-1].letter) if len(others) > 1 else ""
    trend = [TextCell(tr("trend; grey: error"), size=12, tone="ink2")] if is_of_visits else []
    return [*heads, *trend, *changes, head_cell(many or tr("likely between"))]


def _columns(heads: Sequence[TextCell], *, has_sides: bool) -> list[TableColumn]:
    """The legs where rows are of one of them, the names, and `heads` over values, trends, differences and errors."""
    return [TableColumn(is_hidden=not has_sides), TableColumn(share=1), *(TableColumn(head) for head in heads)]


def _comparison_row(
    found: Comparison, shown: Sequence[Part], compared: Sequence[Compared], heads: Sequence[str]
) -> TableRow:
    measure, side = compared[0].measure, compared[0].side
    is_of_visits = found.kind is Contrast.VISITS
    values = [value_cell(*part.figure(measure, side), measure.decimals, has_spread=not is_of_visits) for part in shown]
    changes = [*(_changed(row, found.against) for row in compared), _error_cell(compared[-1])]
    trend = [_trend_cell(found, compared[-1])] if is_of_visits else []
    goals = _goals(compared[-1])
    return _table_row(tr(measure.name), None if measure.is_of_walk else side, heads, (*values, *trend, *changes), goals)


def _goals(row: Compared) -> str:
    """What had been agreed of a measure by the day of the part that is compared."""
    return " · ".join(map(goal_mark, _agreed(row)))


def _agreed(row: Compared) -> tuple[Goal, ...]:
    """The goals of a leg, or of the walk."""
    required = GoalOf.WALK if row.measure.is_of_walk else GoalOf(row.side.value)
    return tuple(goal for goal in row.part.agreed.held if goal.key == (row.measure.column, required))


def _trend_cell(found: Comparison, row: Compared) -> TrendCell:
    trend = trend_of(found, row)
    each = zip(found.parts, trend.values, strict=True)
    stated = ", ".join(f"{part.letter} {fixed(value, row.measure.decimals)}" for part, value in each)
    side = None if row.measure.is_of_walk else row.side
    goals = tuple(goal.value for goal in _agreed(row))
    low, high = (pick((edge, *goals)) for pick, edge in zip((min, max), trend.edges, strict=True))
    return TrendCell(trend.places, trend.values, (low, high), trend.band, side, stated, goals)


def side_table_row(row: SideRow, heads: Sequence[str]) -> TableRow:
    """One measure of both legs, their difference with its error, and symmetry."""
    is_known = math.isfinite(row.symmetry_percent)
    symmetry = figure_text(row.symmetry_percent, "+.1f").replace("-", MINUS) if is_known else NOTHING
    each = zip((row.first, row.second), row.verdicts, strict=True)
    values = [value_cell(value, verdict, row.measure.decimals) for value, verdict in each]
    return _table_row(tr(row.measure.name), None, heads, (*values, _changed(row), _error_cell(row), _figure(symmetry)))


def _table_row(
    name: str, side: Side | None, heads: Sequence[str], cells: Sequence[TextCell | TrendCell], small: str = ""
) -> TableRow:
    """A row whose cells say which leg, measure and part they are of, for a screen reader, cell by cell."""
    chip = EMPTY if side is None else TextCell(side=side, spoken=side_name(side))
    who = name if side is None else f"{side.letter} {name}"
    stated = (replace(cell, spoken=f"{who}, {head}: {cell.stated}") for head, cell in zip(heads, cells, strict=True))
    return TableRow((chip, TextCell(name, small), *stated))


def _figure(value: str, small: str = "", *, is_marked: bool = False, is_grey: bool = False) -> TextCell:
    """A value and what follows it in smaller type; marked: beyond the error; grey: not to be relied on."""
    return TextCell(
        value,
        small,
        align=RIGHT,
        size=FIGURE,
        weight=SEMIBOLD if is_marked else REGULAR,
        tone="ink3" if is_grey else "ink",
    )


def value_cell(value: MeanAndSd, verdict: Verdict, decimals: int, *, has_spread: bool = True) -> TextCell:
    """A mean with its spread, grey from few strides; where it may not be reported, only that is stated."""
    if verdict is Verdict.NOT_REPORTED:
        return TextCell(small=verdict_word(verdict), align=RIGHT, mark=Icon.NOT_REPORTED)
    if not value.n:
        return _figure(NOTHING, is_grey=True)
    spread = f"± {fixed(value.sd, decimals)}" if has_spread and is_spread_enough(value.n) else ""
    spread = f"{spread} {CARE_MARK}".lstrip() if verdict is Verdict.CARE else spread
    return _figure(fixed(value.mean, decimals), spread, is_grey=not is_mean_enough(value.n))


def _changed(row: Compared | SideRow, against: Part | None = None) -> TextCell:
    """A difference; where it is against another part than the others are, that is stated beside it."""
    if not row.is_reported:
        return _figure(NOTHING, is_grey=True)  # the values beside it say why
    words = change_in_words(row.difference.difference, row.measure)
    doubt = _doubt(row.difference)
    if against is not None and isinstance(row, Compared) and row.against is not against:
        doubt = " ".join(filter(None, [tr("from {letter}").format(letter=row.against.letter), doubt]))
    mark = MARKS[row.difference.mark]
    return _figure(words, " ".join(filter(None, [mark, doubt])), is_marked=row.exceeds)


def _error_cell(row: Compared | SideRow) -> TextCell:
    return replace(_figure(interval_of(row)), tone="ink2")


def _doubt(found: Difference) -> str:
    if found.judgement is Judgement.TOO_FEW_STRIDES:
        return tr("few strides")
    if found.judgement is Judgement.NO_PUBLISHED_FIGURE:
        return tr("not judged")
    return DAGGER if found.is_unverified else ""

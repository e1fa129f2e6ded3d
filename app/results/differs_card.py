"""In what the legs differ most: both values, their difference, its likely interval beside healthy people's, a mark."""

from collections.abc import Sequence

from app.charts.cycles import is_mean_enough
from app.summary.facts import Facts
from app.summary.goals import goal_mark
from app.summary.interval_words import interval_in_figures
from app.summary.numbers_in_words import NOTHING, fixed, judged_in_words, signed
from app.summary.what_differs import LegsRow, half_of_strip, what_differs, without_family
from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.figures_table import CARE_MARK
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import CENTRE, RIGHT, IntervalStrip, MarkCell, TableCell, TextCell
from app.widgets.text import REGULAR, SEMIBOLD
from app.wording.body import side_name
from app.wording.translation import tr
from core.body import Side
from core.parameters import Unit, unit_of
from core.verdicts.measurement_error import Difference, Judgement, Mark
from core.verdicts.model import Verdict

REACH = 1.04  # half a strip is at least so many times what the interval reaches
HEAD, ROW = 34, 28
EDGES = 4  # px: the card's padding above and below
SIDE, COMPACT_SIDE = 16, 12
LEAST, MOST = 3, 8  # rows


class DiffersCard(Card):
    """As many rows as there is room for, but at least three; those beyond healthy people's difference first."""

    def __init__(self) -> None:
        super().__init__()
        self._space(SIDE)
        self._columns: Sequence[TableColumn] = ()
        self.rows: Sequence[TableRow] = ()
        self._most = LEAST
        self.table = CellTable(tr("Largest differences"), row=ROW, head=HEAD)
        self.column.addWidget(self.table)

    def show_facts(self, facts: Facts) -> None:
        """What the legs differ in; a single leg has nothing to compare."""
        rows = without_family(what_differs(facts)) if len(facts.gait) == len(Side) else []
        self._columns, self.rows = _columns(facts), [_row(row) for row in rows]
        self._show()

    @property
    def has_rows(self) -> bool:
        return bool(self.rows)

    def set_room(self, height: float, *, is_compact: bool) -> None:
        """Show what fits into so many px of the design; nearer to the edge where the page is narrow."""
        self._space(COMPACT_SIDE if is_compact else SIDE)
        most = min(max(int((height - HEAD - EDGES) // ROW), LEAST), MOST)
        if most != self._most:
            self._most = most
            self._show()

    def _show(self) -> None:
        if self._columns:
            self.table.show_rows(self._columns, self.rows[: self._most])

    def _space(self, side: float) -> None:
        scaled(self.column.setContentsMargins, side, EDGES / 3, side, EDGES * 2 / 3)


def _columns(facts: Facts) -> list[TableColumn]:
    first, second = facts.first_and_second
    less = f"{first.letter} \N{MINUS SIGN} {second.letter}"
    return [
        TableColumn(TextCell(tr("Largest differences"), weight=SEMIBOLD), share=3),
        *(TableColumn(TextCell(align=RIGHT, side=side, spoken=side_name(side)), share=1) for side in Side),
        TableColumn(TextCell(less, align=RIGHT, size=12, tone="ink2"), share=1),
        TableColumn(TextCell(tr("likely between"), align=RIGHT, size=12, tone="ink2"), share=2),
        TableColumn(TextCell(tr("grey: 95 of 100 healthy people"), align=CENTRE, size=12, tone="ink2"), share=1),
        TableColumn(share=1),
    ]


def _row(row: LegsRow) -> TableRow:
    found, unit = row.difference, "°" if unit_of(row.column) is Unit.DEGREES else ""
    weight = SEMIBOLD if found.mark is not Mark.NONE else REGULAR
    shown = signed(found.difference, row.decimals) + unit if found.is_reported else NOTHING
    stated = tr("{measure}, difference: {difference}{unit}").format(
        measure=row.name, difference=signed(found.difference, row.decimals), unit=row.unit
    )
    goals = " · ".join(map(goal_mark, row.goals))
    cells: tuple[TableCell, ...] = (
        TextCell(row.name, goals, weight=weight, small_yields=True),
        *(_value(row, side, unit) for side in Side),
        TextCell(shown, align=RIGHT, weight=weight, spoken=stated if found.is_reported else ""),
        TextCell(interval_in_figures(row.column, found, unit), align=RIGHT, tone="ink2"),
        _strip(found),
        _mark(found),
    )
    return TableRow(cells, hint=goals)


def _value(row: LegsRow, side: Side, unit: str) -> TextCell:
    """Bold where it can be read, regular where with care; else why there is none, behind a barred circle."""
    if side not in row.values:
        is_not_reported = row.verdicts[side] is Verdict.NOT_REPORTED
        return TextCell(
            row.unknown[side], align=RIGHT, size=12, tone="ink2", mark=Icon.NOT_REPORTED if is_not_reported else None
        )
    value, is_care = row.values[side], row.verdicts[side] is Verdict.CARE
    if not is_mean_enough(value.n):
        return TextCell(NOTHING, align=RIGHT, tone="ink2")
    mean = fixed(value.mean, row.decimals)
    stated = tr("{measure}, {side}: {value}{unit}").format(
        measure=row.name, side=side_name(side), value=mean, unit=row.unit
    )
    stated = tr("{stated}, caution").format(stated=stated) if is_care else stated
    weight = REGULAR if is_care else SEMIBOLD
    return TextCell(mean + unit, CARE_MARK if is_care else "", align=RIGHT, weight=weight, spoken=stated)


def _strip(found: Difference) -> TableCell:
    if not found.is_reported:
        return TextCell(tr("difference not reported"), align=CENTRE, size=12, tone="ink2")
    if not found.is_judged:
        word = tr("too few strides") if found.judgement is Judgement.TOO_FEW_STRIDES else tr("no published error")
        return TextCell(word, align=CENTRE, size=12, tone="ink2")
    scale = half_of_strip(found, REACH)
    return IntervalStrip(found.difference, found.error, found.healthy, scale, spoken=judged_in_words(found))


def _mark(found: Difference) -> TableCell:
    if not found.is_judged:
        return TextCell("")
    words = {
        Mark.HEALTHY: tr("beyond 95 of 100"),
        Mark.ERROR: tr("beyond error"),
        Mark.NONE: tr("within error"),
    }
    return MarkCell(words[found.mark], found.mark is not Mark.NONE, found.mark is Mark.HEALTHY)

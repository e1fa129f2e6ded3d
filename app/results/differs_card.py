"""In what the legs differ most, as a table: both values, their difference over its error, the band, and a word."""

import math
from collections.abc import Sequence

from app.charts.cycles import is_mean_enough, is_spread_enough
from app.results.beside_words import beside_columns, beside_rows
from app.summary.comparison import Comparison
from app.summary.facts import Facts
from app.summary.goals import goal_mark
from app.summary.interval_words import interval_in_figures
from app.summary.numbers_in_words import NOTHING, fixed, in_brief, judged_in_words, signed
from app.summary.what_differs import LegsRow, what_differs
from app.theme.icons import Icon
from app.theme.notifier import ThemeNotifier
from app.widgets.card import Card
from app.widgets.figures_table import CARE_MARK
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import CENTRE, RIGHT, ErrorStrip, TableCell, TextCell
from app.widgets.text import REGULAR, SEMIBOLD
from app.wording.body import side_name
from app.wording.translation import tr
from core.body import Side
from core.verdicts.measurement_error import Judgement
from core.verdicts.model import Verdict

SCALE = 1.8  # errors, to either edge of a strip
HEAD, ROW = 32, 28
EDGES = 12  # px: the card's padding above and below


class DiffersCard(Card):
    """As many rows as there is room for, judged ones first."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__(look, padding=16)
        self._columns: Sequence[TableColumn] = ()
        self._rows: Sequence[TableRow] = ()
        self._most = 0
        self.table = CellTable(look, tr("Largest differences"), row=ROW, head=HEAD)
        self.column.addWidget(self.table)

    def show_facts(self, facts: Facts, found: Comparison | None = None) -> None:
        """What the legs differ in, or else this walk and what is shown beside it."""
        if found is not None:
            self._columns, self._rows = beside_columns(found), beside_rows(found)
        else:
            rows = what_differs(facts) if len(facts.gait) == len(Side) else ()
            self._columns, self._rows = _columns(facts), [_row(facts, row) for row in rows]
        self._show()

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self.column.setContentsMargins(px(16), px(EDGES / 3), px(16), px(EDGES * 2 / 3))

    @property
    def has_rows(self) -> bool:
        """Whether there is anything to compare: both legs, or a walk beside this one."""
        return bool(self._rows)

    def set_room(self, height: float) -> None:
        """Show what fits into so many px of the design."""
        most = max(int((height - HEAD - EDGES) // ROW), 0)
        if most != self._most:
            self._most = most
            self._show()

    def _show(self) -> None:
        if self._columns:
            self.table.show_rows(self._columns, self._rows[: self._most])


def _columns(facts: Facts) -> list[TableColumn]:
    first, second = facts.first_and_second
    less = f"{first.letter} \N{MINUS SIGN} {second.letter}"
    return [
        TableColumn(TextCell(tr("Largest differences"), weight=SEMIBOLD), share=3),
        *(TableColumn(_counted(facts, side), share=1) for side in Side),
        TableColumn(TextCell(less, align=RIGHT, size=12, tone="ink2"), share=1),
        TableColumn(TextCell(tr("grey: error"), align=CENTRE, size=12, tone="ink2"), share=2),
        TableColumn(TextCell(tr("likely between"), align=RIGHT, size=12, tone="ink2"), share=1),
        TableColumn(TextCell(tr("ref. ±2 SD"), align=RIGHT, size=12, tone="ink2"), share=1),
        TableColumn(TextCell(tr("result"), size=12, tone="ink2"), share=1),
    ]


def _counted(facts: Facts, side: Side) -> TextCell:
    count = facts.strides(side)
    return TextCell(
        tr("{count} strides").format(count=count),
        align=RIGHT,
        size=12,
        tone="ink2",
        side=side,
        spoken=tr("{side}, {count} strides").format(side=side_name(side), count=count),
    )


def _row(facts: Facts, row: LegsRow) -> TableRow:
    found, unit = row.difference, row.unit
    exceeds = found.exceeds
    weight = SEMIBOLD if exceeds else REGULAR
    shown = signed(found.difference, row.decimals) if found.is_reported else ""
    stated = tr("{measure}, difference: {difference}{unit}").format(measure=row.name, difference=shown, unit=unit)
    cells: tuple[TableCell, ...] = (
        TextCell(row.name, " · ".join(map(goal_mark, row.goals)), weight=weight),
        *(_value(row, side) for side in Side),
        TextCell(shown, align=RIGHT, weight=weight, spoken=stated if shown else ""),
        _strip(row),
        TextCell(interval_in_figures(row.column, found), align=RIGHT, tone="ink2"),
        TextCell(_band(facts, row), align=RIGHT, tone="ink2"),
        TextCell(in_brief(found), size=12, weight=weight, tone="ink" if exceeds else "ink2"),
    )
    return TableRow(cells)


def _value(row: LegsRow, side: Side) -> TextCell:
    """Bold where it can be read, regular where with care; else why there is none, behind a barred circle."""
    if side not in row.values:
        is_not_reported = row.verdicts[side] is Verdict.NOT_REPORTED
        return TextCell(
            row.unknown[side], align=RIGHT, size=12, tone="ink2", mark=Icon.NOT_REPORTED if is_not_reported else None
        )
    value, verdict = row.values[side], row.verdicts[side]
    if not is_mean_enough(value.n):
        return TextCell(NOTHING, align=RIGHT, tone="ink2")
    spread = f"± {fixed(value.sd, row.decimals)}" if is_spread_enough(value.n) else ""
    is_care = verdict is Verdict.CARE
    small = f"{spread} {CARE_MARK}".strip() if is_care else spread
    mean = fixed(value.mean, row.decimals)
    stated = tr("{measure}, {side}: {value}{unit}").format(
        measure=row.name, side=side_name(side), value=f"{mean} {spread}".strip(), unit=row.unit
    )
    stated = tr("{stated}, caution").format(stated=stated) if is_care else stated
    return TextCell(mean, small, align=RIGHT, weight=REGULAR if is_care else SEMIBOLD, spoken=stated)


def _strip(row: LegsRow) -> TableCell:
    found = row.difference
    if not found.is_reported:
        return TextCell(tr("difference not reported"), align=CENTRE, size=12, tone="ink2")
    if not row.difference.is_judged:
        word = tr("too few strides") if found.judgement is Judgement.TOO_FEW_STRIDES else tr("no published error")
        return TextCell(word, align=CENTRE, size=12, tone="ink2")
    return ErrorStrip(found.difference, found.error, SCALE * found.error, is_judged=True, spoken=judged_in_words(found))


def _band(facts: Facts, row: LegsRow) -> str:
    if row.band is None or not math.isfinite(row.band[0]):
        return ""
    low, high = (fixed(edge, 0 if row.unit == "°" else row.decimals) for edge in row.band)
    return tr("{low} to {high}").format(low=low, high=high)

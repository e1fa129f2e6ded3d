"""Samples that were lost, by recording and sensor, while the patient is there and can walk again."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QSizePolicy

from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import RIGHT, TextCell
from app.widgets.text import MEDIUM, Text
from app.wording.body import name_of
from app.wording.translation import capitalised, figure_text, tr
from core.body import Site
from core.signal.received import SamplesReceived
from core.signal.tracks import MAX_REPORTED_GAP_S

MOST_ROWS = 6  # the worst of them: the page has walks to show as well


@dataclass(frozen=True, slots=True)
class ReceivedRow:
    """A sensor that lost samples in a recording, which is named as everywhere."""

    recording: str
    site: Site
    counts: SamplesReceived


class ReceivedCard(Card):
    """Shown only where samples were lost."""

    accessible_role = QAccessible.Role.Note

    def __init__(self) -> None:
        super().__init__(spacing=4)
        self.title = Text(tr("Samples were lost"), weight=MEDIUM, wraps=True)
        self.then = Text(
            tr(
                "Strides with gaps over {gap} s are excluded. Repeat the recording while the patient is here if too "
                "few remain."
            ).format(gap=figure_text(MAX_REPORTED_GAP_S, ".2f")),
            tone="ink2",
            wraps=True,
        )
        self.table = CellTable(tr("Samples received"), row=24, head=24)
        self.rows: tuple[ReceivedRow, ...] = ()
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        lay_out(self.column, self.title, self.then, self.table)

    def show_rows(self, rows: Sequence[ReceivedRow]) -> None:
        """Show the worst of these, in the order they are given."""
        rows = tuple(rows)
        if rows == self.rows:
            return
        self.rows = rows
        worst = sorted(rows, key=lambda row: row.counts.lost_percent, reverse=True)[:MOST_ROWS]
        heads = (tr("Expected"), tr("Received"), tr("Lost"), tr("Longest gap"))
        columns = [TableColumn(_head(tr("Recording")), share=1), TableColumn(_head(tr("Sensor")), share=1)]
        columns += [TableColumn(TextCell(head, align=RIGHT, size=12, tone="ink2"), share=1) for head in heads]
        self.table.show_rows(columns, [_row(row) for row in rows if row in worst])
        shown = [" ".join(cell.words for cell in row.cells) for row in self.table.cells.rows]
        self.setAccessibleName(" ".join([self.title.text(), self.then.text(), *shown]))


def _head(words: str) -> TextCell:
    return TextCell(words, size=12, tone="ink2")


def _row(row: ReceivedRow) -> TableRow:
    counts = row.counts
    gap = tr("{length} s") if counts.longest_gap_s else tr("under {length} s")
    gap = gap.format(length=figure_text(counts.longest_gap_s or MAX_REPORTED_GAP_S, ".2f"))
    figures = (
        str(counts.expected),
        str(counts.received),
        tr("{share} %").format(share=figure_text(counts.lost_percent, ".1f")),
        gap,
    )
    cells = [TextCell(row.recording), TextCell(capitalised(name_of(row.site)))]
    return TableRow((*cells, *(TextCell(figure, align=RIGHT) for figure in figures)))

"""The clinic's own error figures beside the published ones, and which of them are in use."""

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.cohort.repeatability.people import CONDITION
from app.cohort.repeatability.table import ATTACHED_AGAIN, BETWEEN_LEGS, RepeatabilityRow, rows_of
from app.summary.report_dates import day
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import EMPTY, RIGHT, TextCell
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import tr
from core.verdicts.own_figures import MIN_PEOPLE, MIN_PEOPLE_SETTLED, Between, OwnFigures

MARGIN, GAP = 24, 12


class RepeatabilityPage(QWidget):
    """Shows one study at a time, and the figures in use."""

    def __init__(self) -> None:
        super().__init__()
        self.own: OwnFigures | None = None
        self._title = Text(tr("Repeatability"), size=26, weight=SEMIBOLD)
        lead = tr(
            "Healthy people measured twice show the measurement error of your own clinic. Record each of them twice, "
            "with the condition “{condition}”. At least {least} people, 20 are recommended."
        )
        self._lead = Text(lead.format(condition=CONDITION, least=MIN_PEOPLE), tone="ink2", wraps=True)
        self.used = Text(weight=MEDIUM, wraps=True)
        self.refusal = Notice(size=16)
        self.sentence = Text(size=18, weight=SEMIBOLD, wraps=True)
        self.notes = Text(tone="ink2", wraps=True)
        self.table = CellTable(tr("Repeatability"))
        self._card = Card()
        lay_out(self._card.column, self.sentence, self.notes, self.table)
        column = QVBoxLayout(self)
        for widget in (self._title, self._lead, self.used, self.refusal, self._card):
            column.addWidget(widget)
        lay_out(column, 1, margins=(MARGIN, 16, MARGIN, GAP), spacing=GAP)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.forget()

    def focus(self) -> None:
        if self.own is not None:
            self.table.setFocus()

    def forget(self) -> None:
        self.own = None
        self._card.hide()
        self.refusal.hide()

    def show_used(self, words: str) -> None:
        """Say which figures are in use."""
        self.used.setText(words)

    def show_refused(self, what: str, remedy: str) -> None:
        """Say why there is no study; one that was shown stays."""
        self.refusal.show_message(Icon.WARNING, what, remedy, is_caution=True)
        self.refusal.show()

    def show_study(self, own: OwnFigures, notes: Sequence[str]) -> None:
        """Show what a study found, and what was left out of it."""
        self.own = own
        self.refusal.hide()
        self.sentence.setText(study_sentence(own))
        self.notes.setText(" ".join(notes))
        self.notes.setVisible(bool(notes))
        self.table.show_rows(*study_table(own))
        self.table.setAccessibleDescription(self.sentence.text())
        self._card.show()


def study_sentence(own: OwnFigures) -> str:
    """How many people, what lay between, and when."""
    between = (
        tr("{count} people measured on different days.")
        if own.between is Between.DAYS
        else tr("{count} people measured twice, not always on another day.")
    )
    stated = [between.format(count=own.people)]
    if own.is_simulated:
        stated.insert(0, tr("SIMULATED."))
    if own.days[1]:
        first, last = map(day, own.days)
        stated.append(f"{last}." if first == last else tr("{first} to {last}.").format(first=first, last=last))
    if own.is_preliminary:
        stated.append(tr("Preliminary: fewer than {count} people.").format(count=MIN_PEOPLE_SETTLED))
    return " ".join(stated)


def study_table(own: OwnFigures) -> tuple[list[TableColumn], list[TableRow]]:
    """As the command line prints it."""
    heads = (tr("Own"), tr("95 % limits"), tr("People"), tr("Published"))
    columns = [TableColumn(EMPTY, share=1)]
    columns += [TableColumn(TextCell(head, size=12, tone="ink2", align=RIGHT)) for head in heads]
    columns.append(TableColumn(TextCell(tr("Comparison"), size=12, tone="ink2")))
    titles = {
        ATTACHED_AGAIN: tr("Standard deviation of one mean, sensors reattached"),
        BETWEEN_LEGS: tr("Left vs right: 95 of 100 healthy people differ by less"),
    }
    rows: list[TableRow] = []
    for group, title in titles.items():
        blank = tuple(EMPTY for _ in columns[1:])
        rows.append(TableRow((TextCell(title, weight=SEMIBOLD), *blank), is_heading=True))
        rows += [_row(row) for row in rows_of(own) if row.group == group]
    return columns, rows


def _row(row: RepeatabilityRow) -> TableRow:
    tone = "ink2" if row.is_within else "ink"
    figures = (row.number(row.found.value), row.limits, str(row.found.people), row.number(row.published))
    return TableRow(
        (
            TextCell(f"{row.title}, {row.unit}" if row.unit else row.title),
            *(TextCell(figure, align=RIGHT) for figure in figures),
            TextCell(row.verdict, tone=tone),
        )
    )

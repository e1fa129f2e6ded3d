"""Content of files and whose it is, shown before recordings are taken into the library."""

import datetime
from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.home.importing.import_draft import DraftCards
from app.home.importing.table_form import TableForm
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.field import Field, NumberField
from app.widgets.findings_list import FindingsList
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr, tr_n
from core.findings import Finding

if TYPE_CHECKING:
    from app.importing.import_drafts import SessionDraft

RATE_HZ = (1.0, 2000.0)
NARROW_BELOW = 900  # px of the design


class ImportPage(QWidget):
    """Recordings of another program become a session: files, patient, and what each sensor and recording is."""

    changed = Signal()  # something was typed or chosen
    reading_requested = Signal(float)  # what could not be read is to be tried again at a rate, Hz
    explaining_requested = Signal()  # the columns of tables that could not be read are to be stated

    def __init__(self) -> None:
        super().__init__()
        self._title = Text(tr("Import recordings"), size=26, weight=SEMIBOLD, wraps=True)
        self._folder = Text(tone="ink2", wraps=True)
        self._begin = Card(padding=20, spacing=12)
        self.choose_files = Button(tr("Choose files"), ButtonKind.SECONDARY, Icon.FOLDER, height=56)
        self.choose_folder = Button(tr("Choose a folder"), ButtonKind.SECONDARY, Icon.FOLDER, height=56)
        self._formats = Text(tone="ink2", wraps=True)
        self._recordings_title = Text(size=16, weight=SEMIBOLD, wraps=True)
        self._recordings = Text(tone="ink2", wraps=True)
        self.code = Field(tr("Patient code"), is_code=True)
        self._hint = Text(tone="ink2", wraps=True)
        self.day_field = Field(tr("Session date"), is_optional=True, placeholder=tr("year-month-day"))
        self.findings = FindingsList()
        self._card = Card(padding=20, spacing=12)
        self.draft = DraftCards(self._card)
        self.table = TableForm()
        self._unread = Card(padding=20, spacing=8)
        self._unread_words = Text(tone="ink2", wraps=True)
        self.rate = NumberField(
            tr("Sampling rate, if not given in the file"),
            low=RATE_HZ[0],
            high=RATE_HZ[1],
            decimals=1,
            unit=tr("Hz"),
            is_optional=True,
        )
        self.read_again = Button(tr("Read again"), ButtonKind.SECONDARY, Icon.IMPORT, height=48)
        self.explain = Button(tr("Describe the table"), ButtonKind.SECONDARY, Icon.EDIT, height=48)
        self._build()

    @property
    def tab_order(self) -> list[QWidget]:
        codes = [self.code.line_edit, self.day_field.line_edit]
        again = [self.rate.line_edit, self.read_again, self.explain]
        chosen = [*self.draft.tab_order, *codes, self.findings, *again]
        return [self.choose_files, self.choose_folder, *self.table.tab_order, *chosen]

    @property
    def day(self) -> str | None:
        """The day of the session, ISO 8601; empty where nobody states it, None where what was typed is none."""
        try:
            return datetime.date.fromisoformat(stated).isoformat() if (stated := self.day_field.text.strip()) else ""
        except ValueError:
            return None

    def focus(self) -> None:
        if not self.table.isHidden():
            self.table.focus()
        else:
            (self.choose_files if self.draft.isHidden() else self.code).setFocus()

    def set_room(self, width: float) -> None:
        """Lay out for a page of this width, in px of the design."""
        for part in (self.draft, self.table):
            part.set_narrow(width < NARROW_BELOW)

    def show_nothing(self, formats: Sequence[str]) -> None:
        """Show how to begin. `formats`: the programs whose files can be read."""
        self._formats.setText(tr("Files of {programs}, and session folders.").format(programs=", ".join(formats)))
        self._folder.setText(tr("Drop files or folders here, or choose them."))
        self._show_parts(self._begin)

    def show_session(
        self, folder: str, recordings: Sequence[str], code: str, findings: Sequence[Finding], *, is_simulated: bool
    ) -> None:
        """Show a session folder: the names of its recordings, the patient's code as it has it, what was odd."""
        count = len(recordings)
        self._folder.setText(folder)
        self._recordings_title.setText(tr_n("{count} recording", "{count} recordings", count).format(count=count))
        self._recordings.setText(", ".join(recordings))
        self._show_code(code, is_simulated=is_simulated)
        self.findings.show_findings(tuple(findings))
        self.draft.show_folder()
        self._show_parts(self.draft, self._recordings_title, self._recordings)
        self.findings.setVisible(bool(findings))

    def show_draft(
        self,
        folder: str,
        program: str,
        draft: "SessionDraft",
        *,
        has_columns: bool = False,
        can_be_combined: bool = False,
    ) -> None:
        """Show recordings of another program, to be confirmed or changed; their files do not say whose they are.

        For the last two see `DraftCards.show_draft`.
        """
        self._folder.setText(folder)
        self.draft.show_draft(program, draft, has_columns=has_columns, can_be_combined=can_be_combined)
        self._show_code("", is_simulated=False)
        self.day_field.set_text(draft.started[:10])
        self.day_field.set_wrong("")
        self._show_parts(self.draft, self.day_field)

    def show_table(self, where: str) -> None:
        """Show the form of a table; what else could not be read is not shown meanwhile."""
        self._folder.setText(where)
        self._show_parts(self.table)
        self._unread.hide()

    def show_unread(self, sentences: Sequence[str], *, can_try_again: bool, can_explain: bool = False) -> None:
        """Say what could not be read, and why; `can_try_again`: a rate may be all that is missing.

        `can_explain`: there are tables among it.
        """
        self._unread_words.setText("\n".join(sentences))
        self._unread.setVisible(bool(sentences) or can_explain)
        self.rate.setVisible(can_try_again)
        self.read_again.setVisible(can_try_again)
        self.explain.setVisible(can_explain)

    def _build(self) -> None:
        buttons = lay_out(QHBoxLayout(), self.choose_files, self.choose_folder, 1)
        lay_out(self._begin.column, buttons, self._formats)
        lay_out(self._card.column, self._recordings_title, self._recordings, self.code, self._hint, self.day_field)
        not_read = Text(tr("Not read"), size=16, weight=SEMIBOLD)
        again = lay_out(QHBoxLayout(), self.read_again, self.explain, 1)
        lay_out(self._unread.column, not_read, self._unread_words, self.rate, again)
        cards = (self._begin, self.table, self.draft, self._unread, self.findings)
        column = lay_out(QVBoxLayout(self), self._title, self._folder, *cards, 1)
        lay_out(column, margins=(24, 16, 24, 20), spacing=16)
        self.day_field.edited.connect(self._on_day_edited)
        self.draft.changed.connect(self.changed)
        self.read_again.clicked.connect(self._on_read_again)
        self.explain.clicked.connect(self.explaining_requested)
        self._show_parts(self._begin)
        self.show_unread((), can_try_again=False)

    def _show_code(self, code: str, *, is_simulated: bool) -> None:
        self._hint.setText(
            tr("These recordings are simulated. Use a patient code that starts with DEMO.")
            if is_simulated
            else tr("The session is added to the patient with this code. If there is none, a new patient is created.")
        )
        self.code.set_text(code)
        self.code.set_wrong("")

    def _show_parts(self, *shown: QWidget) -> None:
        for part in (self._begin, self.table, self.draft, self._recordings_title, self._recordings, self.day_field):
            part.setVisible(part in shown)
        self.findings.hide()

    def _on_day_edited(self, _text: str) -> None:
        self.day_field.set_wrong(
            "" if self.day is not None else tr("Enter the date as year-month-day, such as 2026-03-09.")
        )
        self.changed.emit()

    def _on_read_again(self) -> None:
        if self.rate.value is not None:
            self.reading_requested.emit(self.rate.value)
        else:
            self.rate.setFocus()

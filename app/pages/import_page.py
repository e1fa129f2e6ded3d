"""What is in this folder, and whose is it? Before recordings are taken into the library."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.theme import ThemeNotifier
from app.widgets.card import Card
from app.widgets.field import Field
from app.widgets.findings_list import FindingsList
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording import tr, tr_n
from core.findings import Finding


class ImportPage(Themed):
    code_changed = Signal(str)

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._title = Text(look, tr("Import recordings"), size=26, weight=SEMIBOLD, wraps=True)
        self._folder = Text(look, tone="ink2", wraps=True)
        self._recordings_title = Text(look, size=16, weight=SEMIBOLD, wraps=True)
        self._recordings = Text(look, tone="ink2", wraps=True)
        self.code = Field(look, tr("Patient's code"), is_code=True)
        self._hint = Text(look, tone="ink2", wraps=True)
        self.findings = FindingsList(look)
        self._card = Card(look, padding=20, spacing=12)
        for part in (self._recordings_title, self._recordings, self.code, self._hint):
            self._card.column.addWidget(part)
        self._column = QVBoxLayout(self)
        self._column.addWidget(self._title)
        self._column.addWidget(self._folder)
        self._column.addWidget(self._card)
        self._column.addWidget(self.findings)
        self._column.addStretch(1)
        self.code.edited.connect(self.code_changed)
        self._on_look_changed()

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.code.line_edit, self.findings]

    def focus(self) -> None:
        self.code.setFocus()

    def show_session(
        self, folder: str, recordings: Sequence[str], code: str, findings: Sequence[Finding], *, is_simulated: bool
    ) -> None:
        """Show what was read: the names of the recordings, the patient's code as the folder has it, what was odd."""
        count = len(recordings)
        self._folder.setText(folder)
        self._recordings_title.setText(tr_n("{count} recording", "{count} recordings", count).format(count=count))
        self._recordings.setText(", ".join(recordings))
        self._hint.setText(
            tr("These are simulated. They belong to a patient whose code starts with DEMO.")
            if is_simulated
            else tr("A patient who has this code gets the session; else a new patient is added.")
        )
        self.code.set_text(code)
        self.code.set_wrong("")
        self.findings.show_findings(tuple(findings))
        self.findings.setVisible(bool(findings))

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._column.setContentsMargins(px(24), px(16), px(24), px(20))
        self._column.setSpacing(px(16))

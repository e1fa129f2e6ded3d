"""A control under its label, as a field has it."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, Text


class Captioned(QWidget):
    """`note`: a few words at the label's right."""

    def __init__(self, content: QWidget, caption: str, note: str = "") -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Maximum)
        self._note = Text(note, size=12, tone="ink2", wraps=True)
        self._note.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignBottom)
        above = lay_out(QHBoxLayout(), Text(caption, size=14, weight=MEDIUM), (self._note, 1), spacing=8)
        lay_out(QVBoxLayout(self), above, content, margins=0, spacing=6)

    def set_note(self, note: str) -> None:
        self._note.setText(note)

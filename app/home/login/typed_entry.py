"""What the pages before a library is open have in common: a narrow column of cards in the middle, which scrolls."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.widgets.banner import Banner
from app.widgets.header import ProductMark
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.text import SEMIBOLD, Text

COLUMN = 540  # a whole recovery key fits into a field
ABOVE = 48


class EntryPage(QWidget):
    """`column` is what a page fills, under the program's mark and name."""

    def __init__(self) -> None:
        super().__init__()
        mark_row = lay_out(QHBoxLayout(), ProductMark(), (Text("Gaitwright", size=18, weight=SEMIBOLD), 1), spacing=12)
        self.banner = Banner()
        inside = QWidget()
        scaled(inside.setMaximumWidth, COLUMN + 48)
        self.column = lay_out(QVBoxLayout(inside), self.banner, mark_row, margins=(24, ABOVE, 24, 24), spacing=16)
        middle = QWidget()
        lay_out(QHBoxLayout(middle), 1, (inside, 100, Qt.AlignmentFlag.AlignTop), 1, margins=0)
        lay_out(QVBoxLayout(self), scrolled(middle, is_upright=False), margins=0)

"""What the pages before a library is open have in common: a narrow column of cards in the middle, which scrolls."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.widgets.banner import Banner
from app.widgets.header import ProductMark
from app.widgets.text import SEMIBOLD, Text

COLUMN = 540  # a whole recovery key fits into a field
ABOVE = 48


class EntryPage(QWidget):
    """`column` is what a page fills, under the program's mark and name."""

    def __init__(self) -> None:
        super().__init__()
        mark_row = QHBoxLayout()
        mark_row.addWidget(ProductMark())
        mark_row.addWidget(Text("Gaitwright", size=18, weight=SEMIBOLD), 1)
        scaled(mark_row.setSpacing, 12)
        self.banner = Banner()
        inside = QWidget()
        scaled(inside.setMaximumWidth, COLUMN + 48)
        self.column = QVBoxLayout(inside)
        scaled(self.column.setContentsMargins, 24, ABOVE, 24, 24)
        scaled(self.column.setSpacing, 16)
        self.column.addWidget(self.banner)
        self.column.addLayout(mark_row)
        middle = QWidget()
        row = QHBoxLayout(middle)
        row.setContentsMargins(0, 0, 0, 0)
        row.addStretch(1)
        row.addWidget(inside, 100, Qt.AlignmentFlag.AlignTop)
        row.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scroll.setWidget(middle)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(0, 0, 0, 0)
        outer.addWidget(scroll)

"""What the pages before a library is open have in common: a narrow column of cards in the middle, which scrolls."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from app.theme.current import current_theme
from app.widgets.banner import Banner
from app.widgets.header import ProductMark
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed

COLUMN = 540  # a whole recovery key fits into a field
ABOVE = 48


class EntryPage(Themed):
    """`column` is what a page fills, under the program's mark and name."""

    def __init__(self) -> None:
        super().__init__()
        self._name = Text("Gaitwright", size=18, weight=SEMIBOLD)
        self._mark_row = QHBoxLayout()
        self._mark_row.addWidget(ProductMark())
        self._mark_row.addWidget(self._name, 1)
        self.banner = Banner()
        self._inside = QWidget()
        self.column = QVBoxLayout(self._inside)
        self.column.addWidget(self.banner)
        self.column.addLayout(self._mark_row)
        middle = QWidget()
        row = QHBoxLayout(middle)
        row.setContentsMargins(0, 0, 0, 0)
        row.addStretch(1)
        row.addWidget(self._inside, 100, Qt.AlignmentFlag.AlignTop)
        row.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scroll.setWidget(middle)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(0, 0, 0, 0)
        outer.addWidget(scroll)

    def paintEvent(self, _event: QPaintEvent) -> None:
        QPainter(self).fillRect(self.rect(), QColor(current_theme().colours.ground))

    def _apply_theme(self) -> None:
        px = current_theme().px
        self._inside.setMaximumWidth(px(COLUMN + 48))
        self.column.setContentsMargins(px(24), px(ABOVE), px(24), px(24))
        self.column.setSpacing(px(16))
        self._mark_row.setSpacing(px(12))

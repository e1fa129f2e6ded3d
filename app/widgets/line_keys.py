"""Key to the lines of a picture: each line as it is drawn, with its name behind it."""

from collections.abc import Callable, Sequence

from PySide6.QtGui import QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.theme.current import px, scaled
from app.widgets.lay_out import lay_out
from app.widgets.text import Text

KEY = 28


class LineKeys(QWidget):
    def __init__(self) -> None:
        super().__init__()
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(0, 0, 0, 0)

    def show_keys(self, keys: Sequence[tuple[Callable[[], QPen], str]]) -> None:
        """Show each line, whose pen is asked for whenever it is painted, and its name."""
        while (item := self._row.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for pen_of, name in keys:
            lay_out(self._row, _Line(pen_of), Text(name, size=12, tone="ink2"))
            self._row.addSpacing(px(8))
        self._row.addStretch(1)


class _Line(QWidget):
    """A piece of a line as it is drawn in the picture."""

    def __init__(self, pen_of: Callable[[], QPen]) -> None:
        super().__init__()
        self._pen_of = pen_of
        scaled(self.setFixedWidth, KEY)
        scaled(self.setMinimumHeight, 16)

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setPen(self._pen_of())
        painter.drawLine(0, self.height() // 2, self.width(), self.height() // 2)

"""A widget that draws itself: shapes first, then words, which a test can measure against their boxes."""

from collections.abc import Callable, Sequence

from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from app.theme.current import current_theme
from app.widgets.painted_text import PaintedText


class Painted(QWidget):
    """`draw` gives the shapes, `painted_texts` the words over them."""

    def paintEvent(self, _event: QPaintEvent) -> None:
        paint(self, self.draw, self.painted_texts)

    def draw(self, painter: QPainter) -> None:
        """Draw all but words."""

    def painted_texts(self) -> Sequence[PaintedText]:
        """What is written, and where."""
        return ()


def paint(widget: QWidget, draw: Callable[[QPainter], object], texts: Callable[[], Sequence[PaintedText]]) -> None:
    """Paint a widget: its shapes, and its words over them."""
    painter = smooth_painter(widget)
    draw(painter)
    for text in texts():
        text.paint(painter, current_theme().colours)


def smooth_painter(widget: QWidget) -> QPainter:
    """Give a painter on a widget whose lines have smooth edges."""
    painter = QPainter(widget)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    return painter

"""A widget that draws itself: shapes first, then words, which a test can measure against their boxes."""

from collections.abc import Sequence

from PySide6.QtGui import QPainter, QPaintEvent

from app.theme.current import current_theme
from app.widgets.painted_text import PaintedText
from app.widgets.themed import Themed


class Painted(Themed):
    """`draw` gives the shapes, `painted_texts` the words over them."""

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self.draw(painter)
        for text in self.painted_texts():
            text.paint(painter, current_theme().colours)

    def draw(self, painter: QPainter) -> None:
        """Draw all but words."""

    def painted_texts(self) -> Sequence[PaintedText]:
        """What is written, and where."""
        return ()

"""A piece of text in a painted widget: what is painted, and so what a test can measure against its box."""

from dataclasses import dataclass

from PySide6.QtCore import QRect, QRectF, Qt
from PySide6.QtGui import QFont, QFontMetrics, QPainter

from app.theme.colours import Colours

LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
CENTRE = Qt.AlignmentFlag.AlignCenter


@dataclass(frozen=True, slots=True)
class PaintedText:
    """`tone` is the token of its colour."""

    text: str
    box: QRectF
    font: QFont
    tone: str = "ink"
    align: Qt.AlignmentFlag = LEFT
    wraps: bool = False

    @property
    def flags(self) -> int:
        wrap = Qt.TextFlag.TextWordWrap.value if self.wraps else 0
        return int(self.align.value) | wrap

    @property
    def needed(self) -> QRect:
        """The room the text takes when it is painted."""
        return QFontMetrics(self.font).boundingRect(self.box.toRect(), self.flags, self.text)

    def paint(self, painter: QPainter, colours: Colours) -> None:
        painter.setPen(getattr(colours, self.tone))
        painter.setFont(self.font)
        painter.drawText(self.box, self.flags, self.text)


def height_for(text: str, font: QFont, width: int) -> int:
    """Give how high `text` is where it may take several lines of `width`."""
    if not text:
        return 0
    flags = Qt.TextFlag.TextWordWrap.value | Qt.AlignmentFlag.AlignLeft.value
    return QFontMetrics(font).boundingRect(QRect(0, 0, max(width, 1), 10_000), flags, text).height()

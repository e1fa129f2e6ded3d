"""The arrow before a change of the patient: filled beyond measurement error, outlined within."""

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPolygonF

from app.summary.progress_words import Arrow
from app.theme.current import current_theme, scaled
from app.theme.theme import Theme
from app.widgets.painted import Painted

ARROW = 10  # px, wide and high


def paint_change_arrow(painter: QPainter, box: QRectF, arrow: Arrow, theme: Theme) -> None:
    """Draw it into the middle of a box."""
    half, centre = theme.px(ARROW) / 2, box.center()
    tip, foot = (-half, half) if arrow.is_up else (half, -half)
    ends = ((0, 0.9 * tip), (half, 0.9 * foot), (-half, 0.9 * foot))
    ink = QColor(theme.colours.ink)
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(theme.pen(ink, 1.25))
    painter.setBrush(ink if arrow.is_filled else Qt.BrushStyle.NoBrush)
    painter.drawPolygon(QPolygonF([centre + QPointF(x, y) for x, y in ends]))
    painter.restore()


class ChangeArrow(Painted):
    """The arrow beside words that state the change, so a screen reader passes over it."""

    def __init__(self, arrow: Arrow) -> None:
        super().__init__()
        self.arrow = arrow
        scaled(self.setFixedSize, ARROW + 2, ARROW + 2)

    def draw(self, painter: QPainter) -> None:
        paint_change_arrow(painter, QRectF(self.rect()), self.arrow, current_theme())

"""Charge of a sensor's battery: a small cell, filled as far as it is charged."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QPainter

from app.theme.theme import Theme

WIDTH, HEIGHT = 26, 14  # px
LOW = 0.15  # of a full charge; below it the sensor is charged after this patient
SHOWN_AT_LEAST = 0.06  # the last of a charge is still a line


def paint_battery(painter: QPainter, rect: QRectF, charge: float, theme: Theme, ink: QColor | str) -> None:
    """Draw the cell into `rect`, which is best 26 x 14 px; `charge` is 0 to 1."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    unit = rect.width() / WIDTH
    cell = QRectF(rect.left() + 0.5, rect.top() + 0.5, 22.5 * unit, rect.height() - 1)
    painter.setPen(theme.pen(ink, 1.25))
    painter.drawRoundedRect(cell, 2.5 * unit, 2.5 * unit)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(ink))
    painter.drawRoundedRect(
        QRectF(cell.right() + unit, cell.center().y() - 2.2 * unit, 1.8 * unit, 4.4 * unit), unit, unit
    )
    inner = cell.adjusted(2.2 * unit, 2.2 * unit, -2.2 * unit, -2.2 * unit)
    inner.setWidth(inner.width() * max(min(charge, 1.0), SHOWN_AT_LEAST))
    painter.drawRoundedRect(inner, unit, unit)
    painter.restore()

"""The letter of a leg in its frame: L filled, R outlined and dashed, so that it is read without colour too."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter

from app.theme.theme import CHIP_RADIUS, Theme
from core.body import Side

CHIP = 20


def paint_chip(painter: QPainter, rect: QRectF, side: Side, theme: Theme) -> None:
    """Draw the chip of `side` into the square `rect`."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    radius = CHIP_RADIUS * theme.scale
    colour = theme.text(side)
    if side is Side.LEFT:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawRoundedRect(rect, radius, radius)
        painter.setPen(QColor(theme.colours.ground if theme.is_dark else theme.colours.surface))
    else:
        pen = theme.pen(colour, 1.75)
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        pen.setDashPattern([2.4, 1.4])
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        half = pen.widthF() / 2
        painter.drawRoundedRect(rect.adjusted(half, half, -half, -half), radius, radius)
        painter.setPen(colour)
    painter.setFont(theme.font(CHIP * 0.65, QFont.Weight.DemiBold))
    painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, side.letter)
    painter.restore()

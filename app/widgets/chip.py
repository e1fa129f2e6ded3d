"""The letter of a leg in its frame: L filled, R outlined and dashed, so that it is read without colour too."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.notifier import ThemeNotifier
from app.theme.theme import CHIP_RADIUS, Theme
from app.widgets.text import SEMIBOLD
from app.wording.translation import tr
from core.body import Side

CHIP = 20
LINE = 24


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
    painter.setFont(theme.font(CHIP * 0.65, SEMIBOLD))
    painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, side.letter)
    painter.restore()


class Chip(QWidget):
    """The chip alone, before words about that leg."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, look: ThemeNotifier, side: Side) -> None:
        super().__init__()
        self._look, self._side = look, side
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(leg_name(side))

    @property
    def side(self) -> Side:
        return self._side

    def set_side(self, side: Side) -> None:
        if side is not self._side:
            self._side = side
            self.setAccessibleName(leg_name(side))
            self.update()

    def sizeHint(self) -> QSize:
        chip = self._look.theme.px(CHIP)
        return QSize(chip, chip)

    def paintEvent(self, _event: QPaintEvent) -> None:
        paint_chip(QPainter(self), QRectF(self.rect()), self._side, self._look.theme)


class SideKey(QWidget):
    """Chip and line of one leg: the key to the curves."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, look: ThemeNotifier, side: Side) -> None:
        super().__init__()
        self._look, self._side = look, side
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(leg_name(side))

    def sizeHint(self) -> QSize:
        px = self._look.theme.px
        return QSize(px(CHIP) + px(8) + px(LINE), px(CHIP))

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        chip = theme.px(CHIP)
        paint_chip(painter, QRectF(0, (self.height() - chip) / 2, chip, chip), self._side, theme)
        painter.setPen(theme.side_pen(self._side, 2))
        middle = self.height() // 2
        painter.drawLine(chip + theme.px(8), middle, self.width(), middle)


def leg_name(side: Side) -> str:
    return tr("left leg") if side is Side.LEFT else tr("right leg")

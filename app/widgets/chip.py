"""The chip of a leg as a widget, alone or before its line."""

from PySide6.QtCore import QRectF, QSize
from PySide6.QtGui import QAccessible, QPainter
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px, scaled
from app.theme.leg_chip import CHIP, paint_chip
from app.widgets.painted import Painted
from app.wording.translation import tr
from core.body import Side

LINE = 24


class Chip(Painted):
    """The chip alone, before words about that leg."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, side: Side) -> None:
        super().__init__()
        self._side = side
        scaled(self.setFixedSize, CHIP, CHIP)
        self.setAccessibleName(leg_name(side))

    @property
    def side(self) -> Side:
        return self._side

    def set_side(self, side: Side) -> None:
        if side is not self._side:
            self._side = side
            self.setAccessibleName(leg_name(side))
            self.update()

    def draw(self, painter: QPainter) -> None:
        paint_chip(painter, QRectF(self.rect()), self._side, current_theme())


class SideKey(Painted):
    """Chip and line of one leg: the key to the curves."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, side: Side) -> None:
        super().__init__()
        self._side = side
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(leg_name(side))

    def sizeHint(self) -> QSize:
        return QSize(px(CHIP) + px(8) + px(LINE), px(CHIP))

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        chip = theme.px(CHIP)
        paint_chip(painter, QRectF(0, (self.height() - chip) / 2, chip, chip), self._side, theme)
        painter.setPen(theme.side_pen(self._side, 2))
        middle = self.height() // 2
        painter.drawLine(chip + theme.px(8), middle, self.width(), middle)


def leg_name(side: Side) -> str:
    return tr("left leg") if side is Side.LEFT else tr("right leg")

"""The tokens of the window: colours, type and space of one scheme at one size."""

from dataclasses import dataclass
from functools import cache

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPen

from app.theme.colours import DARK, LIGHT, Colours
from core.body import Side

DISPLAY_FROM_PX = 24  # from here on the letters are drawn for size
CHIP_RADIUS = 4
CONTROL_RADIUS = 8
CARD_RADIUS = 10


@dataclass(frozen=True, slots=True)
class Theme:
    """One scheme at one size. Every length on the screen goes through `px`.

    `has_less_motion`: nothing moves by itself, whatever the system was asked for.
    """

    colours: Colours = LIGHT
    scale: float = 1.0
    has_less_motion: bool = False

    @property
    def is_dark(self) -> bool:
        return self.colours is DARK

    def px(self, length: float) -> int:
        return max(1, round(length * self.scale))

    def font(self, size: float, weight: QFont.Weight = QFont.Weight.Normal, is_code: bool = False) -> QFont:
        """Give the font of `size` px of the type table, with figures of one width; codes distinguish 0 from O."""
        return QFont(_font("Inter Display" if size >= DISPLAY_FROM_PX else "Inter", self.px(size), weight, is_code))

    def curve(self, side: Side) -> QColor:
        return QColor(self.colours.left if side is Side.LEFT else self.colours.right)

    def text(self, side: Side) -> QColor:
        return QColor(self.colours.left_text if side is Side.LEFT else self.colours.right_text)

    def pale(self, side: Side) -> QColor:
        return QColor(self.colours.left_pale if side is Side.LEFT else self.colours.right_pale)

    def soft(self, side: Side) -> QColor:
        return QColor(self.colours.left_soft if side is Side.LEFT else self.colours.right_soft)

    def band(self, side: Side) -> QColor:
        """Give the fill of a band of certainty, clear enough for the other leg's band to show through."""
        colour = self.soft(side)
        colour.setAlphaF(0.55 if self.is_dark else 0.45)
        return colour

    def pen(self, colour: QColor | str, width: float) -> QPen:
        pen = QPen(QColor(colour), width * self.scale)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        return pen

    def side_pen(self, side: Side, width: float) -> QPen:
        """Give the pen of one leg's curve: left solid, right dashed."""
        pen = self.pen(self.curve(side), width)
        pen.setCosmetic(True)
        if side is Side.RIGHT:
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            pen.setDashPattern([4.0, 2.2])
        return pen

    def veil(self, is_pressed: bool, ink: QColor | None = None) -> QColor:
        """Give the thin layer of ink over a control under the mouse, twice as strong in the `ink` of a dark one."""
        colour = QColor(ink or self.colours.ink)
        colour.setAlphaF((0.10 if is_pressed else 0.04) * (2 if ink is not None else 1))
        return colour

    def paint_box(
        self,
        painter: QPainter,
        box: QRectF,
        fill: QColor | str | None,
        line: QColor | str | None = None,
        width: float = 1.25,
        radius: float = CONTROL_RADIUS,
    ) -> None:
        """Draw a box with round corners; without `fill` or `line` what is under it is seen."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self.pen(line, width) if line is not None else Qt.PenStyle.NoPen)
        painter.setBrush(QColor(fill) if fill is not None else Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(box, radius * self.scale, radius * self.scale)

    def paint_cap(self, painter: QPainter, box: QRectF, key: str, ink: QColor | str, line: QColor | str) -> None:
        """Draw a key cap."""
        self.paint_box(painter, box, None, line, 1, CHIP_RADIUS)
        painter.setPen(QColor(ink))
        painter.setFont(self.font(12, QFont.Weight.Medium))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, key)


@cache
def _font(family: str, pixels: int, weight: QFont.Weight, is_code: bool) -> QFont:
    """Kept, since painters ask for the same few thousands of times a second."""
    font = QFont(family)
    font.setPixelSize(pixels)
    font.setWeight(weight)
    font.setHintingPreference(QFont.HintingPreference.PreferNoHinting)
    font.setFeature(QFont.Tag("tnum"), 1)
    if is_code:
        font.setFeature(QFont.Tag("zero"), 1)
    return font

"""The key to a chart's curves: each leg's chip and line, the thin line with its date, and the reference band."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QPainter, QPen
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px
from app.theme.icons import VERDICT_ICONS, paint_icon
from app.theme.leg_chip import CHIP, paint_chip
from app.widgets.chip import leg_name
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, PaintedText
from app.wording.translation import joined, tr
from app.wording.verdicts import verdict_word
from core.body import Side
from core.verdicts.model import Verdict

HEIGHT, GAP, LINE_APART, LINE, ICON = 24, 12, 6, 20, 14
THIN_PX, LINE_PX = 1.25, 2.5
SWATCH = (18, 10)


@dataclass(frozen=True, slots=True)
class ChartKeyWords:
    """What is drawn: legs with their verdicts, the thin line of `thin_sides`, the reference.

    `reference` are wordings of one thing, the first that has room is shown; `has_band`: the band is drawn.
    """

    legs: Mapping[Side, Verdict]
    thin: str = ""
    thin_sides: tuple[Side, ...] = ()
    reference: Sequence[str] = ()
    has_band: bool = False


NOTHING_DRAWN = ChartKeyWords({})


class ChartKey(Painted):
    """At the right of its room; where that is narrow, the reference gives way, then the thin line's date."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self) -> None:
        super().__init__()
        self.words = NOTHING_DRAWN
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_words(self, words: ChartKeyWords) -> None:
        self.words = words
        stated = [f"{leg_name(side)}: {verdict_word(verdict)}" for side, verdict in words.legs.items()]
        stated += [tr("Thin line: {walk}.").format(walk=words.thin).removesuffix(".")] if words.thin else []
        self.setAccessibleName(joined([*stated, *words.reference[:1]]))
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(self._width_of_legs() + self._width_of_thin(self.words.thin) + px(GAP), px(HEIGHT))

    def minimumSizeHint(self) -> QSize:
        return QSize(self._width_of_legs(), px(HEIGHT))

    def painted_texts(self) -> list[PaintedText]:
        font, px = current_theme().font(12), current_theme().px
        found, right = [], float(self.width())
        thin, reference = self._fitting()
        for text, mark in ((reference, px(SWATCH[0]) * self.words.has_band), (thin, px(LINE))):
            if text:
                width = QFontMetrics(font).horizontalAdvance(text) + 1
                found.append(PaintedText(text, QRectF(right - width, 0, width, self.height()), font, "ink2", LEFT))
                right -= width + (mark + px(LINE_APART) if mark else 0) + px(GAP)
        return found

    def draw(self, painter: QPainter) -> None:
        theme, px, middle = current_theme(), current_theme().px, self.height() / 2
        right = float(self.width())
        thin, reference = self._fitting()
        left_of = {text.text: text.box.left() for text in self.painted_texts()}
        if reference:
            right = left_of[reference]
            if self.words.has_band:
                right -= px(LINE_APART) + px(SWATCH[0])
                self._paint_swatch(painter, right)
            right -= px(GAP)
        if thin:
            right = left_of[thin] - px(LINE_APART)
            painter.setPen(self._thin_pen())
            painter.drawLine(round(right - px(LINE)), round(middle), round(right), round(middle))
            right -= px(LINE) + px(GAP)
        left = right - self._width_of_legs()
        for side, verdict in self.words.legs.items():
            paint_chip(painter, QRectF(left, middle - px(CHIP) / 2, px(CHIP), px(CHIP)), side, theme)
            left += px(CHIP) + px(LINE_APART)
            pen = theme.side_pen(side, LINE_PX)
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            painter.setPen(pen)
            painter.drawLine(round(left), round(middle), round(left + px(LINE)), round(middle))
            left += px(LINE)
            if verdict is not Verdict.READ:
                box = QRectF(left + px(LINE_APART), middle - px(ICON) / 2, px(ICON), px(ICON))
                paint_icon(painter, VERDICT_ICONS[verdict], box, theme.colours.ink)
                left += px(LINE_APART) + px(ICON)
            left += px(GAP)

    def _paint_swatch(self, painter: QPainter, left: float) -> None:
        c, px, middle = current_theme().colours, current_theme().px, self.height() / 2
        width, height = (px(length) for length in SWATCH)
        painter.fillRect(QRectF(left, middle - height / 2, width, height), QColor(c.band_2sd))
        painter.fillRect(QRectF(left, middle - height / 4, width, height / 2), QColor(c.band_1sd))

    def _thin_pen(self) -> QPen:
        theme = current_theme()
        is_one = len(self.words.thin_sides) == 1
        return theme.pen(theme.text(self.words.thin_sides[0]) if is_one else theme.colours.ink2, THIN_PX)

    def _fitting(self) -> tuple[str, str]:
        """The thin line's date and the reference, as far as they have room beside the legs."""
        room = self.width() - self._width_of_legs()
        thin = self.words.thin if self._width_of_thin(self.words.thin) <= room else ""
        room -= self._width_of_thin(thin)
        fitting = (text for text in self.words.reference if self._width_of_reference(text) <= room)
        return thin, next(fitting, "")

    def _width_of_legs(self) -> int:
        each = (
            px(CHIP) + px(LINE_APART) + px(LINE) + (px(LINE_APART) + px(ICON)) * (verdict is not Verdict.READ)
            for verdict in self.words.legs.values()
        )
        return sum(each) + px(GAP) * max(len(self.words.legs) - 1, 0)

    def _width_of_thin(self, text: str) -> int:
        return px(GAP) + px(LINE) + px(LINE_APART) + self._width(text) if text else 0

    def _width_of_reference(self, text: str) -> int:
        return px(GAP) + (px(SWATCH[0]) + px(LINE_APART)) * self.words.has_band + self._width(text)

    def _width(self, text: str) -> int:
        return QFontMetrics(current_theme().font(12)).horizontalAdvance(text) + 1

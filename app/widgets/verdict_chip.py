"""The key to one leg's curve, with what may be read of it: letter, line, and the verdict after its circle."""

from PySide6.QtCore import QRectF, QSize
from PySide6.QtGui import QAccessible, QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy

from app.theme.icons import VERDICT_ICONS, paint_icon
from app.theme.notifier import ThemeNotifier
from app.widgets.chip import CHIP, LINE, leg_name, paint_chip
from app.widgets.painted_text import LEFT, PaintedText
from app.widgets.text import SEMIBOLD
from app.widgets.themed import Themed
from app.wording.verdicts import verdict_alone, verdict_word
from core.body import Side
from core.verdicts.model import Verdict

HEIGHT = 30
PADDING = 6
ICON = 16
GAP = 6


class VerdictChip(Themed):
    """Brief, it leaves out the curve's line and states the verdict in a word."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, look: ThemeNotifier, side: Side) -> None:
        super().__init__()
        self._look, self._side = look, side
        self._verdict = Verdict.READ
        self._has_line, self._is_brief = True, False
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.show_message(Verdict.READ)

    @property
    def verdict(self) -> Verdict:
        return self._verdict

    def set_brief(self, is_brief: bool) -> None:
        self._is_brief = is_brief
        self._on_look_changed()

    def show_message(self, verdict: Verdict, *, has_line: bool = True) -> None:
        """`has_line`: whether the leg's curve is drawn."""
        self._verdict, self._has_line = verdict, has_line
        self.setAccessibleName(f"{leg_name(self._side)}: {verdict_word(verdict)}")
        self.updateGeometry()
        self.update()

    def texts(self) -> list[PaintedText]:
        """What is painted, and where."""
        theme = self._look.theme
        font = theme.font(12, SEMIBOLD)
        left = self._icon_left() + theme.px(ICON + 4)
        tone = "caution_ink" if self._verdict is Verdict.NOT_REPORTED else "ink"
        box = QRectF(left, 0, self.width() - left - theme.px(PADDING), self.height())
        return [PaintedText(self._word, box, font, tone, LEFT)]

    def sizeHint(self) -> QSize:
        px = self._look.theme.px
        words = QFontMetrics(self._look.theme.font(12, SEMIBOLD)).horizontalAdvance(self._word)
        return QSize(self._icon_left() + px(ICON + 4) + words + px(PADDING + 2), px(HEIGHT))

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        fill, line = {
            Verdict.CARE: (c.sunken, c.control),
            Verdict.NOT_REPORTED: (c.caution, c.caution_edge),
        }.get(self._verdict, (c.ground, c.line))
        theme.paint_box(painter, QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), fill, line, 1)
        chip, middle = px(CHIP), self.height() / 2
        paint_chip(painter, QRectF(px(PADDING), middle - chip / 2, chip, chip), self._side, theme)
        if self._has_line and not self._is_brief:
            left = px(PADDING) + chip + px(GAP)
            painter.setPen(theme.side_pen(self._side, 2))
            painter.drawLine(left, round(middle), left + px(LINE), round(middle))
        ink = c.caution_ink if self._verdict is Verdict.NOT_REPORTED else c.ink
        icon = px(ICON)
        box = QRectF(self._icon_left(), middle - icon / 2, icon, icon)
        paint_icon(painter, VERDICT_ICONS[self._verdict], box, ink)
        for text in self.texts():
            text.paint(painter, c)

    @property
    def _word(self) -> str:
        return verdict_alone(self._verdict)

    def _icon_left(self) -> int:
        px = self._look.theme.px
        line = px(LINE + GAP) if self._has_line and not self._is_brief else 0
        return px(PADDING) + px(CHIP) + px(GAP) + line

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()

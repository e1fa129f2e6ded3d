"""How far what is shown can be trusted, in one line, and the way to the whole of it."""

from dataclasses import dataclass

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px, scaled
from app.theme.icons import VERDICT_ICONS, Icon, paint_icon
from app.widgets.painted_button import PaintedButton
from app.widgets.painted_text import LEFT, RIGHT, PaintedText
from app.widgets.text import SEMIBOLD
from app.wording.translation import tr
from core.verdicts.model import Verdict

HEIGHT = 40
PADDING = 16
ICON = 20
CAP = 22
LEAST_WIDTH = 320


@dataclass(frozen=True, slots=True)
class DetailText:
    """`details`: how much is behind it. `is_caution`: it is yellow, for something is taken away."""

    verdict: Verdict
    first: str
    then: str = ""
    details: str = ""
    is_caution: bool = False


class DetailButton(PaintedButton):
    """What does not fit is cut short on the screen, and read out whole."""

    def __init__(self, key: str) -> None:
        super().__init__()
        self._key, self._shown = key, DetailText(Verdict.READ, "")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        scaled(self.setMinimumSize, LEAST_WIDTH, HEIGHT)
        self.setAccessibleDescription(tr("Key {key}").format(key=key))

    @property
    def words(self) -> str:
        return " ".join(filter(None, [self._shown.first, self._shown.then]))

    def show_message(self, shown: DetailText) -> None:
        self._shown = shown
        self.setAccessibleName(tr("Data quality: {words}").format(words=f"{self.words} {self._details}"))
        self.setToolTip(self.words)
        self.update()

    @property
    def _details(self) -> str:
        return self._shown.details or tr("Details")

    def texts(self) -> list[PaintedText]:
        """What is painted, and where."""
        theme, height = current_theme(), self.height()
        px, tone = theme.px, self._tone
        bold, plain = theme.font(14, SEMIBOLD), theme.font(14)
        right = self._cap().left() - px(10)
        width = QFontMetrics(bold).horizontalAdvance(self._details) + 1
        found = [PaintedText(self._details, QRectF(right - width, 0, width, height), bold, tone, RIGHT)]
        left, room = px(PADDING + ICON + 8), right - width - px(16)
        first = QFontMetrics(bold).elidedText(self._shown.first, Qt.TextElideMode.ElideRight, int(room - left))
        taken = QFontMetrics(bold).horizontalAdvance(first) + 1
        found.append(PaintedText(first, QRectF(left, 0, taken, height), bold, tone, LEFT))
        left += taken + px(8)
        if first == self._shown.first and self._shown.then and room - left > px(40):
            then = QFontMetrics(plain).elidedText(self._shown.then, Qt.TextElideMode.ElideRight, int(room - left))
            grey = tone if self._shown.is_caution else "ink2"
            found.append(PaintedText(then, QRectF(left, 0, room - left, height), plain, grey, LEFT))
        return found

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        box = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        is_grave = self._shown.is_caution
        theme.paint_box(
            painter, box, c.caution if is_grave else c.surface, c.caution_edge if is_grave else c.control, 1
        )
        self.paint_veil(painter, box)
        ink, middle, icon = getattr(c, self._tone), self.height() / 2, px(ICON)
        paint_icon(painter, VERDICT_ICONS[self._shown.verdict], QRectF(px(PADDING), middle - icon / 2, icon, icon), ink)
        for text in self.texts():
            text.paint(painter, c)
        theme.paint_cap(painter, self._cap(), self._key, ink, c.caution_edge if is_grave else c.control)
        paint_icon(painter, Icon.NEXT, self._chevron(), ink)

    @property
    def _tone(self) -> str:
        return "caution_ink" if self._shown.is_caution else "ink"

    def _chevron(self) -> QRectF:
        icon = px(ICON)
        return QRectF(self.width() - px(PADDING) - icon, self.height() / 2 - icon / 2, icon, icon)

    def _cap(self) -> QRectF:
        cap, right = px(CAP), self._chevron().left() - px(8)
        return QRectF(right - cap, self.height() / 2 - cap / 2, cap, cap)

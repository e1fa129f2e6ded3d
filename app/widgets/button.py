"""A button with icon, word and key cap. Filled only if pressing it is what we wish."""

from enum import Enum, auto

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QKeyEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QSizePolicy, QWidget

from app.theme import CHIP_RADIUS, CONTROL_RADIUS, Look
from app.widgets.icons import Icon, paint_icon
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording import tr

HEIGHT = 48
ICON = 22
GAP = 8
PADDING = 20


class Kind(Enum):
    PRIMARY = auto()
    SECONDARY = auto()
    QUIET = auto()


class Button(QAbstractButton):
    """`key` is what the cap shows; the shortcut itself belongs to the window, which knows when it holds."""

    def __init__(
        self,
        look: Look,
        text: str,
        kind: Kind = Kind.SECONDARY,
        icon: Icon | None = None,
        key: str = "",
        height: float = HEIGHT,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._look, self._kind, self._icon, self._key, self._height = look, kind, icon, key, height
        self.setText(text)
        self.setAccessibleName(text)
        self.setAccessibleDescription(tr("Key {key}").format(key=key) if key else "")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        look.changed.connect(self._on_look_changed)

    @property
    def key(self) -> str:
        return self._key

    def sizeHint(self) -> QSize:
        px = self._look.theme.px
        widths = [width for width in (self._icon_width(), self._text_width(), self._key_width()) if width]
        padding = PADDING if self._kind is not Kind.QUIET else PADDING / 2
        return QSize(sum(widths) + px(GAP) * (len(widths) - 1) + 2 * px(padding), px(self._height))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.click()
            return
        super().keyPressEvent(event)

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        ink = self._paint_frame(painter)
        widths = [width for width in (self._icon_width(), self._text_width(), self._key_width()) if width]
        x = (self.width() - sum(widths) - px(GAP) * (len(widths) - 1)) // 2
        if self._icon is not None:
            side = self._icon_width()
            paint_icon(painter, self._icon, QRectF(x, (self.height() - side) / 2, side, side), ink)
            x += side + px(GAP)
        if self.text():
            painter.setPen(ink)
            painter.setFont(theme.font(16, SEMIBOLD))
            painter.drawText(x, 0, self._text_width(), self.height(), Qt.AlignmentFlag.AlignCenter, self.text())
            x += self._text_width() + px(GAP)
        if self._key:
            cap = QRectF(x + 0.5, (self.height() - px(22)) / 2, self._key_width() - 1, px(22))
            painter.setPen(theme.pen(ink if self._kind is Kind.PRIMARY else c.control, 1))
            painter.drawRoundedRect(cap, CHIP_RADIUS * theme.scale, CHIP_RADIUS * theme.scale)
            painter.setPen(ink)
            painter.setFont(theme.font(12, MEDIUM))
            painter.drawText(cap, Qt.AlignmentFlag.AlignCenter, self._key)

    def _paint_frame(self, painter: QPainter) -> QColor:
        """Draw what lies under icon and word, and give the ink for them."""
        theme = self._look.theme
        c = theme.colours
        radius = CONTROL_RADIUS * theme.scale
        box = QRectF(self.rect()).adjusted(1, 1, -1, -1)
        painter.setPen(Qt.PenStyle.NoPen)
        ink = QColor(c.ink if self.isEnabled() else c.disabled)
        if self._kind is Kind.PRIMARY and self.isEnabled():
            painter.setBrush(QColor(c.inv))
            ink = QColor(c.inv_ink)
        elif self._kind is Kind.PRIMARY:
            painter.setBrush(QColor(c.track))
        elif self._kind is Kind.SECONDARY:
            painter.setBrush(QColor(c.surface))
            painter.setPen(theme.pen(c.control, 1.25))
        painter.drawRoundedRect(box, radius, radius)
        if self.isEnabled() and (self.underMouse() or self.isDown()):
            painter.setPen(Qt.PenStyle.NoPen)
            veil = theme.veil(self.isDown())
            if self._kind is Kind.PRIMARY:
                veil.setRgb(ink.red(), ink.green(), ink.blue(), veil.alpha() * 2)
            painter.setBrush(veil)
            painter.drawRoundedRect(box, radius, radius)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        return ink

    def _icon_width(self) -> int:
        return self._look.theme.px(ICON) if self._icon is not None else 0

    def _text_width(self) -> int:
        return QFontMetrics(self._look.theme.font(16, SEMIBOLD)).horizontalAdvance(self.text())

    def _key_width(self) -> int:
        if not self._key:
            return 0
        metrics = QFontMetrics(self._look.theme.font(12, MEDIUM))
        return metrics.horizontalAdvance(self._key) + self._look.theme.px(16)

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()

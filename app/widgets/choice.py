"""One choice out of many, folded away until it is asked for."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPaintEvent, QWheelEvent
from PySide6.QtWidgets import QComboBox, QSizePolicy

from app.theme import CONTROL_RADIUS, Look
from app.widgets.icons import Icon, paint_icon
from app.widgets.text import SEMIBOLD

HEIGHT = 52
PADDING = 16
ICON = 22


class Choice(QComboBox):
    def __init__(self, look: Look, name: str) -> None:
        super().__init__()
        self._look = look
        self.setAccessibleName(name)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        look.changed.connect(self._on_look_changed)
        self._on_look_changed()

    def sizeHint(self) -> QSize:
        theme = self._look.theme
        metrics = QFontMetrics(theme.font(16, SEMIBOLD))
        words = [self.placeholderText(), *(self.itemText(i) for i in range(self.count()))]
        widest = max(metrics.horizontalAdvance(word) for word in words)
        return QSize(widest + theme.px(2 * PADDING + 8 + ICON), theme.px(HEIGHT))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # who scrolls past must not change what is shown

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        c, px = theme.colours, theme.px
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(theme.pen(c.control, 1.25))
        painter.setBrush(QColor(c.surface))
        radius = CONTROL_RADIUS * theme.scale
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), radius, radius)
        painter.setPen(QColor(c.ink))
        painter.setFont(theme.font(16, SEMIBOLD))
        text = self.rect().adjusted(px(PADDING), 0, -px(PADDING + ICON), 0)
        painter.drawText(
            text,
            Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft,
            self.currentText() or self.placeholderText(),
        )
        side = px(ICON)
        arrow = QRectF(self.width() - px(PADDING) - side, (self.height() - side) / 2, side, side)
        paint_icon(painter, Icon.CHEVRON, arrow, c.ink)

    def _on_look_changed(self) -> None:
        self.view().setFont(self._look.theme.font(16))
        self.updateGeometry()
        self.update()

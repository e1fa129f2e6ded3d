"""In place of what is not reported: of which leg, why, and what to do. Hatched, so that nobody takes it for a curve."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QAccessible, QBrush, QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy

from app.theme.notifier import ThemeNotifier
from app.theme.theme import CONTROL_RADIUS
from app.widgets.chip import Chip
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed
from app.wording.verdicts import verdict_alone
from core.body import Side
from core.verdicts.model import Verdict

PADDING = 8
LEAST_WIDTH = 260  # narrower, its sentences have no room in height


class NotReportedPanel(Themed):
    """Hidden while there is nothing to say."""

    accessible_role = QAccessible.Role.Note

    def __init__(self, look: ThemeNotifier, side: Side) -> None:
        super().__init__()
        self._look = look
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        self._word = Text(look, verdict_alone(Verdict.NOT_REPORTED), size=12, weight=SEMIBOLD)
        self._why = Text(look, size=12, wraps=True)
        self._row = QHBoxLayout(self)
        self._row.addWidget(Chip(look, side), 0, Qt.AlignmentFlag.AlignVCenter)
        self._row.addWidget(self._word, 0, Qt.AlignmentFlag.AlignVCenter)
        self._row.addWidget(self._why, 1, Qt.AlignmentFlag.AlignVCenter)
        self._on_look_changed()
        self.show_message("")

    @property
    def text(self) -> str:
        return f"{self._word.text()}. {self._why.text()}" if self._why.text() else ""

    def show_message(self, why: str) -> None:
        """Say why; empty: nothing is left out."""
        self._why.setText(why)
        self.setAccessibleName(self.text)
        self.setVisible(bool(why))

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        radius = CONTROL_RADIUS * theme.scale
        room = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setPen(theme.pen(theme.colours.control, 1))
        painter.setBrush(QBrush(QColor(theme.colours.line), Qt.BrushStyle.BDiagPattern))
        painter.drawRoundedRect(room, radius, radius)
        for label in (self._word, self._why):  # words on hatching are hard to read
            wraps = Qt.TextFlag.TextWordWrap
            words = QRectF(label.fontMetrics().boundingRect(label.geometry(), wraps, label.text()))
            painter.fillRect(words.adjusted(-theme.px(4), -1, theme.px(4), 1), QColor(theme.colours.surface))

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._row.setContentsMargins(px(PADDING), px(PADDING / 2), px(PADDING), px(PADDING / 2))
        self._row.setSpacing(px(8))
        self.setMinimumWidth(px(LEAST_WIDTH))

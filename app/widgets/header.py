"""Whose session is on the screen, and is it real? The line at the top of every page."""

from PySide6.QtCore import QPointF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from app.theme import Look
from app.widgets.text import SEMIBOLD, Text
from core.body import Side

HEIGHT = 56


class Header(QWidget):
    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look = look
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._name = Text(look, "Gaitwright", size=18, weight=SEMIBOLD)
        self._code = Text(look, size=22, weight=SEMIBOLD, is_code=True)
        self._facts = Text(look, size=14, tone="ink2")
        self._simulated = _Tag(look, "SIMULATED")
        self._row = QHBoxLayout(self)
        self._row.addWidget(Mark(look))
        self._row.addWidget(self._name)
        self._row.addWidget(self._code)
        self._row.addWidget(self._facts)
        self._row.addStretch(1)
        self._row.addWidget(self._simulated)
        self.show_session("", "", is_simulated=False)
        look.changed.connect(self._on_look_changed)
        self._on_look_changed()

    def show_session(self, code: str, facts: str, is_simulated: bool) -> None:
        """Show the patient's code and what the clinic typed; without a session, the program's name."""
        for label, text in ((self._code, code), (self._facts, facts)):
            label.setText(text)
            label.setVisible(bool(text))
        self._name.setVisible(not code)
        self._simulated.setVisible(is_simulated)

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme.colours.surface))
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.drawLine(self.rect().bottomLeft(), self.rect().bottomRight())

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._row.setContentsMargins(px(24), 0, px(24), 0)
        self._row.setSpacing(px(16))
        self.setMinimumHeight(px(HEIGHT))
        self.update()


class Mark(QWidget):
    """The program's mark: two legs, left solid, right dashed."""

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look = look
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        look.changed.connect(self.updateGeometry)

    def sizeHint(self) -> QSize:
        side = self._look.theme.px(28)
        return QSize(side, side)

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        unit = self.width() / 24
        hip = QPointF(12.5 * unit, 2.5 * unit)
        for side, foot in ((Side.RIGHT, 3.5), (Side.LEFT, 20.5)):  # it faces you: the right leg stands at your left
            pen = theme.pen(theme.curve(side), 3.4)
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)
            if side is Side.RIGHT:
                pen.setDashPattern([1.6, 0.8])
            painter.setPen(pen)
            painter.drawLine(hip, QPointF(foot * unit, 21 * unit))


class _Tag(Text):
    """A word in a frame of ink."""

    def __init__(self, look: Look, text: str) -> None:
        super().__init__(look, text, size=14, weight=SEMIBOLD)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        look.changed.connect(self._on_margin_changed)
        self._on_margin_changed()

    def paintEvent(self, event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(theme.pen(theme.colours.ink, 1.75))
        painter.drawRoundedRect(self.rect().adjusted(1, 1, -1, -1), theme.px(4), theme.px(4))
        painter.end()
        super().paintEvent(event)

    def _on_margin_changed(self) -> None:
        px = self._look.theme.px
        self.setContentsMargins(px(10), px(5), px(10), px(5))

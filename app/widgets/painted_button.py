"""A button that draws itself: Enter presses it as Space does, and a veil lies over it under the mouse."""

from collections.abc import Sequence

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QKeyEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QWidget

from app.theme.current import current_theme
from app.theme.theme import CONTROL_RADIUS
from app.widgets.painted import paint
from app.widgets.painted_text import PaintedText


class PaintedButton(QAbstractButton):
    """`pressing_keys`: what presses it besides Space. It is drawn as `Painted` is."""

    pressing_keys: tuple[Qt.Key, ...] = (Qt.Key.Key_Return, Qt.Key.Key_Enter)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in self.pressing_keys:
            self.click()
            return
        super().keyPressEvent(event)

    def paintEvent(self, _event: QPaintEvent) -> None:
        paint(self, self.draw, self.painted_texts)

    def draw(self, painter: QPainter) -> None:
        """Draw all but words."""

    def painted_texts(self) -> Sequence[PaintedText]:
        """What is written, and where."""
        return ()

    def paint_veil(self, painter: QPainter, box: QRectF, radius: float = CONTROL_RADIUS) -> None:
        """Show that the mouse is over it; `radius` in pixels at scale 1."""
        if self.underMouse() or self.isDown():
            theme = current_theme()
            theme.paint_box(painter, box, theme.veil(self.isDown()), radius=radius)

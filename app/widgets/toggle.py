"""Something that is on or off: a check mark stands before its word while it is on."""

from PySide6.QtCore import QRectF, QSignalBlocker
from PySide6.QtGui import QColor, QPainter

from app.theme import CONTROL_RADIUS, Look
from app.widgets.button import Button, Kind
from app.widgets.icons import Icon

HEIGHT = 52  # as high as the controls beside it


class Toggle(Button):
    def __init__(self, look: Look, text: str, key: str, is_on: bool) -> None:
        super().__init__(look, text, Kind.SECONDARY, Icon.CHECK if is_on else Icon.UNCHECKED, key, HEIGHT)
        self.setCheckable(True)
        self.setChecked(is_on)
        self.toggled.connect(self._on_toggled)

    def show_on(self, is_on: bool) -> None:
        """Show what is so already, without telling anybody."""
        with QSignalBlocker(self):
            self.setChecked(is_on)
        self._on_toggled(is_on)

    def _paint_frame(self, painter: QPainter) -> QColor:
        ink = super()._paint_frame(painter)
        if self.isChecked():
            theme = self._look.theme
            painter.setPen(theme.pen(theme.colours.ink, 1.75))
            radius = CONTROL_RADIUS * theme.scale
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), radius, radius)
        return ink

    def _on_toggled(self, is_on: bool) -> None:
        self._icon = Icon.CHECK if is_on else Icon.UNCHECKED
        self.update()

"""A widget that sizes its parts by the theme in ways that `scaled` cannot repeat: Qt notifies it of another style."""

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QWidget


class Themed(QWidget):
    """`_apply_theme` is called by whoever derives from it once its parts are there; Qt paints again by itself."""

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self._apply_theme()

    def _apply_theme(self) -> None: ...

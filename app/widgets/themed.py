"""A widget that spaces its parts by the theme: Qt tells it when the style has changed."""

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QWidget


class Themed(QWidget):
    """What it paints is painted anew by itself; `apply_theme` sets margins and sizes, and is called at first by
    whoever derives from it."""

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self.apply_theme()

    def apply_theme(self) -> None:
        raise NotImplementedError

"""A widget that spaces its parts by the theme: Qt notifies it when the style has changed."""

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QWidget


class Themed(QWidget):
    """`_apply_theme` sets margins and sizes; what is painted, Qt paints again and measures by itself.

    Whoever derives from it calls it once its parts are there.
    """

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self._apply_theme()

    def _apply_theme(self) -> None:
        raise NotImplementedError

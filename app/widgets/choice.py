"""One choice out of many, folded away until it is asked for."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QComboBox, QSizePolicy

from app.theme import ThemeNotifier


class Choice(QComboBox):
    def __init__(self, _look: ThemeNotifier, name: str) -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)  # words come after it is first shown

        self.ensurePolished()  # its font, and so its size, is the style's

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # who scrolls past must not change what is shown

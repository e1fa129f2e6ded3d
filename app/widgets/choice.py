"""One choice out of many, folded away until it is asked for."""

from PySide6.QtCore import QPoint, Qt
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

    def showPopup(self) -> None:
        """Open below the box, above it where there is no room below, and as the style does where there is none at all.

        The style lays the chosen line over the box, so that what comes before it covers what stands above: the tabs.
        """
        super().showPopup()
        popup, room = self.view().window(), self.screen().availableGeometry()
        top = self.mapToGlobal(QPoint(0, 0)).y()
        below, above = top + self.height(), top - popup.height()
        if below + popup.height() <= room.bottom() + 1:
            popup.move(popup.x(), below)
        elif above >= room.top():
            popup.move(popup.x(), above)

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # who scrolls past must not change what is shown

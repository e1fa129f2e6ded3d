"""One choice out of many, folded away until it is asked for."""

import sys
from collections.abc import Iterable

from PySide6.QtCore import QEvent, QPoint, QSignalBlocker, QSize, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QComboBox, QSizePolicy

from app.theme.current import px


class Choice(QComboBox):
    def __init__(self, name: str) -> None:
        super().__init__()
        self._least: float | None = None
        self._most = 0.0
        self._height: float | None = None
        self.setAccessibleName(name)
        if sys.platform.startswith("linux"):  # there Qt gives the choice in force as the name, and ours is not read out
            self.setAccessibleDescription(name)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)  # words come after it is first shown

        self.ensurePolished()  # its font, and so its size, is the style's
        self.currentIndexChanged.connect(self.updateGeometry)

    def offer(self, lines: Iterable[tuple[str, object]], chosen: object, otherwise: int = 0) -> None:
        """Offer other lines, each its words and its data; `chosen` is in force, or another line. Nobody is notified."""
        with QSignalBlocker(self):
            self.clear()
            for words, data in lines:
                self.addItem(words, data)
            found = self.findData(chosen)
            self.setCurrentIndex(found if found >= 0 else otherwise)
        self.updateGeometry()

    def let_shrink(self, least: float, most: float) -> None:
        """Shorten long typed texts, with a tooltip; not below `least` px, and the box not above `most` px."""
        self._least, self._most = least, most
        self.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Fixed)
        self.updateGeometry()

    def set_height(self, height: float) -> None:
        """Be as high as this, in px of the design: in the head of a card it is lower than in a form."""
        self._height = height
        self.updateGeometry()

    @property
    def is_cut(self) -> bool:
        """Whether the choice in force is wider than its box."""
        return self.width() < self._width_for(self.currentText())

    def sizeHint(self) -> QSize:
        required = super().sizeHint()
        if self._height is not None:
            required.setHeight(px(self._height))
        return required if self._least is None else required.boundedTo(QSize(px(self._most), 99_999))

    def minimumSizeHint(self) -> QSize:
        hint = self.sizeHint()
        if self._least is None:
            return hint
        least = px(self._least)
        height = min(hint.height(), self.maximumHeight())  # where it was made lower
        return QSize(min(self._width_for(self.currentText()), least), height)

    def event(self, event: QEvent) -> bool:
        if event.type() is QEvent.Type.ToolTip and self._least is not None:
            self.setToolTip(self.currentText() if self.is_cut else "")
        return super().event(event)

    def showPopup(self) -> None:
        """Open below the box, or above it without room below; the style's place covers what is above."""
        if self._least is not None:
            widest = self.screen().availableGeometry().width()
            self.view().setMinimumWidth(min(self.view().sizeHintForColumn(0), widest))
        super().showPopup()
        popup, room = self.view().window(), self.screen().availableGeometry()
        top = self.mapToGlobal(QPoint(0, 0)).y()
        below, above = top + self.height(), top - popup.height()
        left = max(min(popup.x(), room.right() + 1 - popup.width()), room.left())
        if below + popup.height() <= room.bottom() + 1:
            popup.move(left, below)
        elif above >= room.top():
            popup.move(left, above)

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # who scrolls past must not change what is shown

    def _width_for(self, words: str) -> int:
        """How wide the box is in which these have their room; the widest line of all gives the space around words."""
        widths = [self.fontMetrics().horizontalAdvance(self.itemText(row)) for row in range(self.count())]
        around = super().sizeHint().width() - max(widths, default=0)
        return around + self.fontMetrics().horizontalAdvance(words)

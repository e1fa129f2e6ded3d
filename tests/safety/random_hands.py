"""Hands on keys and mouse: what can be pressed, and how it is, as somebody in front of the screen would do it."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QInputMethodEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QApplication,
    QComboBox,
    QLineEdit,
    QPlainTextEdit,
    QScrollArea,
    QWidget,
)

if TYPE_CHECKING:
    from app.main_window import MainWindow

CONTROLS = (QAbstractButton, QComboBox, QLineEdit, QPlainTextEdit, QAbstractItemView, QAbstractSlider)
NO_MODIFIER = Qt.KeyboardModifier.NoModifier
CTRL, SHIFT, ALT = (
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.AltModifier,
)
LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
Key = Qt.Key
LONGEST_TYPED = 60  # letters, key by key


class Hands:
    """`place` is a folder of the user's own, with session folders to import and room for what is saved."""

    def __init__(self, window: "MainWindow", chance: random.Random, place: Path) -> None:
        self._window, self._chance, self._place = window, chance, place
        self._saved = self._waits = 0
        self._last_saved: Path | None = None
        self.did: Callable[[str], None] = print
        self.recovery_key = ""

    def controls(self, front: QWidget | None = None) -> list[QWidget]:
        """What can be pressed or typed into now, and is in sight or can be scrolled there."""
        front = front or QApplication.activeModalWidget() or self._window
        found = [widget for kind in CONTROLS for widget in front.findChildren(kind)]
        return [one for one in found if one.isVisible() and one.isEnabled() and one.width() > 0]

    # hands

    def click(self, widget: QWidget, *, button: Qt.MouseButton = LEFT, is_double: bool = False) -> None:
        """Scroll to it as a hand would, and press what is there: something may lie over it."""
        _bring_into_sight(widget)
        shown = widget.visibleRegion().boundingRect()
        if shown.isEmpty():
            return
        at = widget.mapTo(widget.window(), shown.center())
        target = widget.window().childAt(at) or widget
        press = QTest.mouseDClick if is_double else QTest.mouseClick
        press(target, button, NO_MODIFIER, target.mapFrom(widget.window(), at))

    def press(self, key: Qt.Key, modifier: Qt.KeyboardModifier = NO_MODIFIER) -> None:
        QTest.keyClick(QApplication.focusWidget() or self._window, key, modifier)

    def type_into(self, line: QWidget, text: str) -> None:
        self.click(line)
        if QApplication.focusWidget() is line:
            self.press(Key.Key_A, CTRL)
            if len(text) <= LONGEST_TYPED and text.isascii() and text.isprintable():
                QTest.keyClicks(line, text)
            else:  # at once, as it is pasted or an input method gives it
                self.press(Key.Key_Delete)
                event = QInputMethodEvent("", [])
                event.setCommitString(text.encode("utf-8", "ignore").decode())
                QApplication.sendEvent(line, event)

    def press_named(self, words: str, front: QWidget | None = None) -> bool:
        for one in self.controls(front):
            name = one.accessibleName() or (one.text() if isinstance(one, QAbstractButton) else "")
            if name.replace("&", "").startswith(words):
                self.click(one)
                return True
        return False


def _bring_into_sight(widget: QWidget) -> None:
    parent = widget.parentWidget()
    while parent is not None:
        if isinstance(parent, QScrollArea):
            parent.ensureWidgetVisible(widget, 0, 0)
        parent = parent.parentWidget()

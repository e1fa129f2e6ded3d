"""Areas that scroll where they are too small for what is in them: to be read, or beside what is worked with."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QFrame, QScrollArea, QWidget


class ReadingArea(QScrollArea):
    """It takes the focus, so that the keys scroll it, and is a document to screen readers."""

    accessible_role = QAccessible.Role.Document

    def __init__(self, content: QWidget, name: str) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setWidget(content)
        self.setAccessibleName(name)


def scrolled(content: QWidget, *, is_upright: bool = True) -> QScrollArea:
    """`content` over all of its room, scrolling where that is too small; `is_upright`: up and down alone."""
    area = QScrollArea()
    area.setWidgetResizable(True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    if is_upright:
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setWidget(content)
    return area

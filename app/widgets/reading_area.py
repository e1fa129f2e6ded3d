"""What is read by scrolling: it takes the focus, so that the keys scroll it, and is a document to screen readers."""

from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QScrollArea


class ReadingArea(QScrollArea):
    accessible_role = QAccessible.Role.Document

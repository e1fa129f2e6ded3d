"""No page shows a part of it before the part has a place: it would be a window for a moment, and take the keys."""

import pytest
from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from tests.app.accessibility.framed_pages import FRAMED, framed


class Shown(QObject):
    """Notes which windows are shown."""

    def __init__(self) -> None:
        super().__init__()
        self.windows: list[str] = []

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() is QEvent.Type.Show and isinstance(watched, QWidget) and watched.isWindow():
            self.windows.append(f"{type(watched).__name__} {watched.accessibleName()}")
        return False


@pytest.mark.parametrize("name", FRAMED)
def test_nothing_is_a_window_while_a_page_is_made(qapp: QApplication, qtbot: QtBot, name: str) -> None:
    shown = Shown()
    qapp.installEventFilter(shown)
    try:
        page = framed(name)
    finally:
        qapp.removeEventFilter(shown)
    qtbot.addWidget(page)
    assert shown.windows == []

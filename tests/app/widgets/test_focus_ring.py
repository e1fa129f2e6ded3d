"""The ring lies round all of what has the focus, and follows it."""

import pytest
from PySide6.QtCore import QPoint, QRect
from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton, QTextBrowser, QWidget
from pytestqt.qtbot import QtBot

from app.widgets.focus_ring import NO_RING, FocusRing


@pytest.fixture
def window(qtbot: QtBot) -> QWidget:
    window = QWidget()
    window.resize(400, 300)
    row = QHBoxLayout(window)
    text = QTextBrowser()
    text.setFrameShape(QFrame.Shape.NoFrame)  # as in the manual: without, its edge alone counts as seen
    row.addWidget(text)
    row.addWidget(QPushButton("Back"))
    qtbot.addWidget(window)
    window.show()
    qtbot.waitUntil(window.isVisible)
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    return window


def test_what_scrolls_has_its_ring_round_text_and_bar(qtbot: QtBot, window: QWidget) -> None:
    """It lay round the scroll bar alone."""
    ring = FocusRing(window)
    (text,) = window.findChildren(QTextBrowser)
    text.setPlainText("line\n" * 200)
    (button,) = window.findChildren(QPushButton)
    button.setFocus()
    text.setFocus()
    qtbot.waitUntil(ring.isVisible)
    whole = QRect(text.mapTo(window, QPoint(0, 0)), text.size())
    assert ring.geometry().contains(whole)
    button.setFocus()
    assert ring.geometry().contains(button.geometry())
    assert not ring.geometry().contains(whole)


def test_a_region_that_is_read_alone_has_none(qtbot: QtBot, window: QWidget) -> None:
    ring = FocusRing(window)
    (text,) = window.findChildren(QTextBrowser)
    text.setProperty(NO_RING, True)
    text.setFocus()
    assert not ring.isVisible()

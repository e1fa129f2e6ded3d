"""What the theme's style sheet makes of Qt's own parts."""

from collections.abc import Iterator

import pytest
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QApplication, QFrame, QScrollArea, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.theme import Look


@pytest.fixture
def look(qapp: QApplication) -> Iterator[Look]:
    look = Look()
    look.set_dark(False)
    yield look
    qapp.setStyleSheet("")


def test_the_corner_between_two_scroll_bars_is_as_empty_as_the_page(qtbot: QtBot, look: Look) -> None:
    look.set_scale(2.0)
    window, area, content = QWidget(), QScrollArea(), QWidget()
    window.setPalette(QColor(look.theme.colours.ground))
    window.setAutoFillBackground(True)
    column = QVBoxLayout(window)
    column.setContentsMargins(0, 0, 0, 0)
    column.addWidget(area)
    content.setFixedSize(900, 900)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setWidget(content)
    qtbot.addWidget(window)
    window.resize(300, 300)
    window.show()
    picture = window.grab().toImage()
    side = area.verticalScrollBar().width()
    colours = {picture.pixelColor(x, y).name() for x in range(300 - side, 300) for y in range(300 - side, 300)}
    assert colours == {QColor(look.theme.colours.ground).name()}

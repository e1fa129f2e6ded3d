"""The helper that finds cut words must find them."""

import pytest
from PySide6.QtCore import QRectF
from PySide6.QtWidgets import QLineEdit, QScrollArea, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import current_theme
from app.widgets.button import Button
from app.widgets.painted_text import PaintedText
from app.widgets.segmented import Segmented
from app.widgets.text import Text
from tests.app.room import words_cut


class Painted(QWidget):
    def painted_texts(self) -> list[PaintedText]:
        font = current_theme().font(14)
        return [PaintedText("Left knee", QRectF(0, 0, self.width(), self.height()), font)]


def parts() -> list[QWidget]:
    field = QLineEdit()
    field.setPlaceholderText("kept out of exports")
    options = [
        ("mean", "Mean cycle", "all strides"),
        ("walk", "Whole walk", "second by second"),
    ]
    return [
        Text("The patient faces you"),
        Text("Unreasonableness is one word", wraps=True),
        Button("Continue to walking"),
        Segmented("View", options),
        field,
        Painted(),
    ]


@pytest.mark.parametrize("kind", range(6))
def test_what_has_its_room_passes_and_what_has_not_is_named(qtbot: QtBot, kind: int) -> None:
    page = QWidget()
    qtbot.addWidget(page)
    page.resize(600, 300)
    part = parts()[kind]
    part.setParent(page)
    part.setGeometry(10, 10, 400, 60)
    page.show()
    assert words_cut(page) == []
    part.setGeometry(10, 10, 40, 60)
    assert words_cut(page) != []


def test_lines_that_have_no_room_below_are_named(qtbot: QtBot) -> None:
    page = QWidget()
    qtbot.addWidget(page)
    text = Text("Recording goes on. Right ankle and right phases are missing until it is back.", wraps=True)
    text.setParent(page)
    text.setGeometry(0, 0, 200, 20)
    page.show()
    assert "height" in words_cut(page)[0]


def test_what_sticks_out_of_the_page_is_named_but_not_what_scrolls(qtbot: QtBot) -> None:
    page = QWidget()
    qtbot.addWidget(page)
    page.resize(300, 200)
    button = Button("Stop walk")
    button.setParent(page)
    button.setGeometry(250, 10, 200, 48)
    page.show()
    assert "is cut by QWidget" in words_cut(page)[0]
    scroll, inside = QScrollArea(), QWidget()
    column = QVBoxLayout(page)
    column.addWidget(scroll)
    inside.resize(600, 200)
    scroll.setWidget(inside)
    button.setParent(inside)
    button.setGeometry(250, 10, 200, 48)
    button.show()
    assert words_cut(page) == []


def test_what_is_hidden_is_not_looked_at(qtbot: QtBot) -> None:
    page = QWidget()
    qtbot.addWidget(page)
    text = Text("The patient faces you", parent=page)
    text.setGeometry(0, 0, 5, 5)
    text.hide()
    page.show()
    assert words_cut(page) == []

"""Tests that a widget's parts are received in their order in it, however late they came."""

from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.widgets.heard_order import hear_as_laid_out


def received(widget: QWidget) -> list[str]:
    reported = QAccessible.queryAccessibleInterface(widget)
    return [reported.child(k).text(QAccessible.Text.Name) for k in range(reported.childCount())]


def test_what_came_into_a_widget_last_is_received_where_it_is(qtbot: QtBot) -> None:
    page = QWidget()
    qtbot.addWidget(page)
    column, grid = QVBoxLayout(page), QGridLayout()
    tabs = QVBoxLayout()
    column.addLayout(tabs)
    column.addLayout(grid)
    column.addWidget(QLabel("verb"))
    for name, row, at in (("fourth", 1, 1), ("third", 1, 0), ("second", 0, 1), ("first", 0, 0)):
        grid.addWidget(QLabel(name), row, at)
    tabs.addWidget(QLabel("tabs"))
    assert received(page) != ["tabs", "first", "second", "third", "fourth", "verb"]
    hear_as_laid_out(page)
    assert received(page) == ["tabs", "first", "second", "third", "fourth", "verb"]


def test_a_widget_without_a_layout_is_received_as_before(qtbot: QtBot) -> None:
    page = QWidget()
    qtbot.addWidget(page)
    for name in ("one", "other"):
        QLabel(name, page)
    hear_as_laid_out(page)
    assert received(page) == ["one", "other"]

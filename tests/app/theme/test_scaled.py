"""Lengths given once follow the size of everything."""

from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import scaled, set_scale


def test_what_was_scaled_follows_the_size_within_layouts_too(qtbot: QtBot) -> None:
    window, label = QWidget(), QLabel("Knee")
    qtbot.addWidget(window)
    column = QVBoxLayout(window)
    row = QHBoxLayout()
    column.addLayout(row)
    row.addWidget(label)
    scaled(column.setContentsMargins, 16, 0, 8, 4)
    scaled(row.setSpacing, 12)
    scaled(label.setMinimumSize, 40, 20)
    del row, column  # Qt keeps what Python let go of
    set_scale(2.0)
    layout = window.layout()
    assert layout is not None
    margins = layout.contentsMargins()
    assert (margins.left(), margins.top(), margins.right(), margins.bottom()) == (32, 0, 16, 8)
    (inner,) = layout.findChildren(QHBoxLayout)
    assert inner.spacing() == 24
    assert (label.minimumWidth(), label.minimumHeight()) == (80, 40)


def test_a_further_length_takes_the_place_of_the_one_before(qtbot: QtBot) -> None:
    window = QWidget()
    qtbot.addWidget(window)
    scaled(window.setMinimumWidth, 100)
    scaled(window.setMinimumWidth, 60)
    set_scale(1.5)
    assert window.minimumWidth() == 90

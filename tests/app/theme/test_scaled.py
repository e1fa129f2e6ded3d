"""Lengths given once follow the size of everything."""

from PySide6.QtWidgets import QDialog, QHBoxLayout, QLabel, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import on_theme, scaled, set_scale


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


class Measured(QWidget):
    """Notes the lengths that its own measuring finds."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.row = QHBoxLayout(self)
        self.found: list[tuple[int, int]] = []
        on_theme(self.a_measure)  # by its name the first of all
        scaled(self.setMinimumWidth, 100)
        scaled(self.row.setSpacing, 10)

    def a_measure(self) -> None:
        self.found.append((self.minimumWidth(), self.row.spacing()))


def test_what_measures_by_hand_finds_all_lengths_as_they_are_now(qtbot: QtBot) -> None:
    one = Measured()
    qtbot.addWidget(one)
    set_scale(2.0)
    assert one.found[-1] == (200, 20)


def test_a_dialog_of_a_window_follows_once(qtbot: QtBot) -> None:
    window = QWidget()
    qtbot.addWidget(window)
    dialog = QDialog(window)
    one = Measured(dialog)
    before = len(one.found)
    set_scale(2.0)
    assert len(one.found) == before + 1

"""What the style makes of Qt's own parts, and whether a change of theme reaches them."""

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QFrame,
    QLineEdit,
    QMenu,
    QProgressBar,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)
from pytestqt.qtbot import QtBot

from app.theme.current import current_theme, set_dark, set_scale
from app.theme.icons import Icon
from app.theme.style import BUSY_S, IS_WRONG
from app.widgets.button import Button, ButtonKind
from app.widgets.chips import Chips
from app.widgets.choice import Choice
from app.widgets.field import Field
from app.widgets.notice import Notice
from app.widgets.segmented import Segmented
from app.widgets.toggle import Toggle


def colours_in(picture: QImage, box: QRect | None = None) -> set[str]:
    room = picture.rect() if box is None else box
    points = ((x, y) for x in range(room.left(), room.right()) for y in range(room.top(), room.bottom()))
    return {picture.pixelColor(x, y).name() for x, y in points}


def name(token: str) -> str:
    return QColor(token).name()


def test_a_larger_scale_reaches_every_kind_of_control(qtbot: QtBot) -> None:
    field, choice = Field("Code"), Choice("Size")
    choice.addItems(["80 %", "100 %"])
    segmented = Segmented("Legs", [("l", "Left", ""), ("r", "Right", "")])
    chips = Chips("Aids", [("cane", "Cane")])
    own = [Button("Go", icon=Icon.NEXT, key="Enter"), Toggle("Band", "B", is_on=True), choice]
    window = QWidget()
    qtbot.addWidget(window)
    column = QVBoxLayout(window)
    for widget in (*own, segmented, chips, field):
        column.addWidget(widget)
    controls: list[QWidget] = [*own, *segmented.segments, *chips.buttons, field.line_edit]
    window.show()
    before = [control.sizeHint() for control in controls]
    set_scale(2.0)
    after = [control.sizeHint() for control in controls]
    assert all(then.height() >= 1.9 * now.height() for now, then in zip(before, after, strict=True))
    assert all(then.width() >= 1.8 * now.width() for now, then in zip(before, after, strict=True))


def test_the_dark_theme_reaches_what_is_shown_already(qtbot: QtBot) -> None:
    button = Button("Go", ButtonKind.PRIMARY)
    line = QLineEdit("P-0147")
    for widget in (button, line):
        qtbot.addWidget(widget)
        widget.show()
    light = current_theme().colours
    assert name(light.inv) in colours_in(button.grab().toImage())
    set_dark(True)  # the palette too, without waiting for another turn of the loop
    dark = current_theme().colours
    assert name(dark.inv) in colours_in(button.grab().toImage())
    assert {name(dark.surface), name(dark.ink)} <= colours_in(line.grab().toImage())
    assert name(light.surface) not in colours_in(line.grab().toImage(), line.rect().adjusted(8, 4, -8, -4))


def test_what_cannot_be_pressed_is_not_painted_as_requested(qtbot: QtBot) -> None:
    button = Button("Go", ButtonKind.PRIMARY)
    qtbot.addWidget(button)
    button.setEnabled(False)
    found = colours_in(button.grab().toImage())
    assert name(current_theme().colours.inv) not in found
    assert name(current_theme().colours.track) in found


def test_a_button_that_is_on_is_framed_in_ink(qtbot: QtBot) -> None:
    toggle = Toggle("", "", is_on=False)
    qtbot.addWidget(toggle)
    toggle.resize(toggle.sizeHint())
    off = toggle.grab().toImage().pixelColor(toggle.width() // 3, 1)
    toggle.show_on(True)
    on = toggle.grab().toImage().pixelColor(toggle.width() // 3, 1)
    assert off.lightness() > 100 > 64 > on.lightness()  # half of the line lies on the pixel beside it


def test_a_field_with_what_does_not_fit_is_yellow_and_else_is_not(qtbot: QtBot) -> None:
    line = QLineEdit()
    qtbot.addWidget(line)
    line.resize(200, 48)
    assert name(current_theme().colours.caution) not in colours_in(line.grab().toImage())
    line.setProperty(IS_WRONG, True)
    assert name(current_theme().colours.caution) in colours_in(line.grab().toImage())


@pytest.mark.qt_log_ignore("This plugin does not support")
def test_every_line_of_a_menu_can_be_hit_and_the_one_in_force_has_a_check(qtbot: QtBot) -> None:
    menu = QMenu()
    qtbot.addWidget(menu)
    one, other = menu.addAction("One"), menu.addAction("Other")
    other.setCheckable(True)
    other.setChecked(True)
    menu.popup(QPoint(0, 0))
    picture, ink = menu.grab().toImage(), name(current_theme().colours.ink)
    marks = {line: menu.actionGeometry(line).adjusted(menu.width() - 40, 4, -4, -4) for line in (one, other)}
    assert all(menu.actionGeometry(line).height() >= 44 for line in (one, other))
    assert ink in colours_in(picture, marks[other])
    assert ink not in colours_in(picture, marks[one])
    menu.close()


@pytest.mark.qt_log_ignore("This plugin does not support")
def test_an_open_box_of_choices_has_lines_as_high_as_a_menu(qtbot: QtBot) -> None:
    choice = Choice("Size")
    qtbot.addWidget(choice)
    choice.addItems(["80 %", "100 %"])
    choice.show()
    choice.showPopup()
    view = choice.view()
    assert view.sizeHintForRow(0) >= 44
    assert name(current_theme().colours.surface) in colours_in(view.grab().toImage())
    choice.hidePopup()


def test_a_bar_is_filled_as_far_as_the_work_is(qtbot: QtBot) -> None:
    bar = QProgressBar()
    qtbot.addWidget(bar)
    bar.setTextVisible(False)
    bar.setFixedSize(100, 8)
    bar.setValue(50)
    picture = bar.grab().toImage()
    assert picture.pixelColor(40, 4).name() == name(current_theme().colours.ink)
    assert picture.pixelColor(60, 4).name() == name(current_theme().colours.track)


def test_a_bar_of_unknown_length_shows_that_something_is_done(qtbot: QtBot) -> None:
    bar = QProgressBar()
    qtbot.addWidget(bar)
    bar.setTextVisible(False)
    bar.setRange(0, 0)
    bar.setFixedSize(100, 8)
    row = [bar.grab().toImage().pixelColor(x, 4).name() for x in range(4, 96)]
    assert {name(current_theme().colours.ink), name(current_theme().colours.track)} <= set(row)


def test_beneath_the_round_ends_of_a_bar_of_unknown_length_nothing_else_is_painted(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.theme.style.monotonic", lambda: BUSY_S / 2)  # its half bar is in the middle
    bar = QProgressBar()
    qtbot.addWidget(bar)
    bar.setTextVisible(False)
    bar.setRange(0, 0)
    bar.setFixedSize(320, 8)
    bar.show()
    picture = bar.grab().toImage()
    track = QColor(current_theme().colours.track).lightness()
    assert min(picture.pixelColor(x, y).lightness() for x in (0, 1, 318, 319) for y in range(8)) >= track


def test_enter_belongs_to_the_page_and_not_to_a_chip_or_segment(qtbot: QtBot) -> None:
    button, chips = Button("Go"), Chips("Aids", [("cane", "Cane")])
    segmented = Segmented("Legs", [("l", "Left", ""), ("r", "Right", "")])
    pressed: list[str] = []
    button.clicked.connect(lambda: pressed.append("button"))
    for widget in (button, chips, segmented):
        qtbot.addWidget(widget)
        widget.show()
    for target in (chips.buttons[0], segmented.segments[1], button):
        QTest.keyClick(target, Qt.Key.Key_Return)
    assert (pressed, chips.chosen, segmented.choice) == (["button"], (), "l")


def test_a_notice_that_is_reported_before_it_is_shown_has_the_ink_of_a_caution(qtbot: QtBot) -> None:
    set_dark(True)
    notice = Notice()
    qtbot.addWidget(notice)
    notice.show_message(None, "The left leg moved.", is_caution=True)
    notice.resize(300, 60)
    notice.show()
    assert name(current_theme().colours.caution_ink) in colours_in(notice.grab().toImage())


def test_the_corner_between_two_scroll_bars_is_as_empty_as_the_page(qtbot: QtBot) -> None:
    set_scale(2.0)
    window, area, content = QWidget(), QScrollArea(), QWidget()
    window.setPalette(QColor(current_theme().colours.ground))
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
    assert colours == {QColor(current_theme().colours.ground).name()}

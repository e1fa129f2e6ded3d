"""Where a box of choices opens, what is above it staying in sight, and what of its words is cut where."""

import pytest
from PySide6.QtCore import QEvent, QPoint, QRect
from PySide6.QtGui import QHelpEvent
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from app.widgets.choice import Choice

pytestmark = pytest.mark.qt_log_ignore("This plugin does not support")


def opened(qtbot: QtBot, top: int, lines: int, chosen: int) -> tuple[QRect, QRect]:
    """Give where a box is whose top lies `top` px under the screen's, and where its lines open."""
    window = QWidget()
    qtbot.addWidget(window)
    choice = Choice("Recording")
    choice.setParent(window)
    choice.addItems([f"walk {number}" for number in range(lines)])
    choice.setCurrentIndex(chosen)
    choice.resize(choice.sizeHint())
    window.resize(400, choice.height())
    window.move(window.screen().availableGeometry().topLeft() + QPoint(0, top))
    window.show()
    qtbot.waitUntil(window.isVisible)
    choice.showPopup()
    popup = choice.view().window()
    box = QRect(choice.mapToGlobal(QPoint(0, 0)), choice.size())
    found = box, QRect(popup.mapToGlobal(QPoint(0, 0)), popup.size())
    choice.hidePopup()
    return found


def shrinking(qtbot: QtBot, *lines: str) -> Choice:
    choice = Choice("Recording")
    qtbot.addWidget(choice)
    choice.addItems(lines)
    choice.let_shrink(120, 240)
    return choice


def tooltip_of(choice: Choice) -> str:
    point = QPoint(4, 4)
    QApplication.sendEvent(choice, QHelpEvent(QEvent.Type.ToolTip, point, choice.mapToGlobal(point)))
    return choice.toolTip()


def test_words_that_were_typed_are_cut_where_room_is_short_and_whole_in_the_tooltip(qtbot: QtBot) -> None:
    choice = shrinking(qtbot, "A Barefoot", "B Own shoes with insoles of four millimetres")
    assert choice.sizeHint().width() == 240
    choice.setCurrentIndex(1)
    choice.resize(choice.minimumSizeHint())
    assert (choice.width(), choice.is_cut) == (120, True)
    assert tooltip_of(choice) == "B Own shoes with insoles of four millimetres"


def test_words_that_have_their_room_are_not_cut_and_need_no_tooltip(qtbot: QtBot) -> None:
    choice = shrinking(qtbot, "A", "B Own shoes with insoles of four millimetres")
    assert choice.minimumSizeHint().width() < 120  # as the word in force asks for
    choice.resize(choice.minimumSizeHint())
    assert not choice.is_cut
    assert tooltip_of(choice) == ""


def test_other_boxes_never_cut(qtbot: QtBot) -> None:
    choice = Choice("Paper")
    qtbot.addWidget(choice)
    choice.addItems(["A4", "Own shoes with insoles of four millimetres, and the left one raised"])
    assert choice.minimumSizeHint() == choice.sizeHint()
    assert choice.sizeHint().width() > 320


def test_what_is_cut_in_the_box_is_whole_in_its_list(qtbot: QtBot) -> None:
    choice = shrinking(qtbot, "A Barefoot", "B Own shoes with insoles of four millimetres")
    choice.resize(choice.minimumSizeHint())
    choice.show()
    choice.showPopup()
    assert choice.view().width() >= choice.view().sizeHintForColumn(0)
    choice.hidePopup()


@pytest.mark.parametrize("chosen", [0, 3])
def test_a_box_opens_below_itself(qtbot: QtBot, chosen: int) -> None:
    """With the last line chosen, the list lay over what is above."""
    box, popup = opened(qtbot, top=200, lines=4, chosen=chosen)
    assert popup.top() == box.bottom() + 1


def test_at_the_foot_of_the_screen_it_opens_above_itself(qtbot: QtBot) -> None:
    window = QWidget()
    qtbot.addWidget(window)
    height = window.screen().availableGeometry().height()
    box, popup = opened(qtbot, top=height - 60, lines=4, chosen=3)
    assert popup.bottom() == box.top() - 1


def test_a_list_that_fits_nowhere_stays_on_the_screen(qtbot: QtBot) -> None:
    window = QWidget()
    qtbot.addWidget(window)
    room = window.screen().availableGeometry()
    lines = room.height() // 30
    _, popup = opened(qtbot, top=room.height() // 2, lines=lines, chosen=0)
    assert room.contains(popup)

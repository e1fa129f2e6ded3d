"""Where a box of choices opens: what stands above it stays in sight, whichever line is chosen."""

import pytest
from PySide6.QtCore import QPoint, QRect
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.theme import ThemeNotifier
from app.widgets.choice import Choice

pytestmark = pytest.mark.qt_log_ignore("This plugin does not support")


def opened(qtbot: QtBot, top: int, lines: int, chosen: int) -> tuple[QRect, QRect]:
    """Give where a box is whose top lies `top` px under the screen's, and where its lines open."""
    window = QWidget()
    qtbot.addWidget(window)
    choice = Choice(ThemeNotifier(), "Recording")
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


@pytest.mark.parametrize("chosen", [0, 3])
def test_a_box_opens_below_itself(qtbot: QtBot, chosen: int) -> None:
    """With the last line chosen, the list lay over what stands above."""
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

"""A recovery key is in even columns, is selected and copied as one text, and leaves nothing behind."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QTextCursor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.widgets.key_groups import COLUMNS, KeyGroups

GROUPS = ["7ATX", "CTM1", "NEMQ", "0PG8", "MMPN", "YTHB", "DZ7F", "Z1CR", "X"]


@pytest.fixture
def key(qtbot: QtBot) -> KeyGroups:
    key = KeyGroups()
    qtbot.addWidget(key)
    key.show_groups(GROUPS)
    key.resize(key.sizeHint())
    key.show()
    return key


def places(key: KeyGroups) -> list[QPoint]:
    """Where each group begins."""
    found, at = [], 0
    for group in GROUPS:
        at = key.toPlainText().index(group, at)
        cursor = key.textCursor()
        cursor.setPosition(at)
        found.append(key.cursorRect(cursor).topLeft())
        at += len(group)
    return found


def test_groups_stand_in_even_columns(key: KeyGroups) -> None:
    found = places(key)
    for column in range(COLUMNS):
        assert len({place.x() for place in found[column::COLUMNS]}) == 1
    assert len({place.y() for place in found}) == len(GROUPS) // COLUMNS
    assert key.accessibleName() == " ".join(GROUPS)
    assert key.text.split("\n")[1] == "0PG8 MMPN YTHB"


def test_all_of_it_is_in_sight(key: KeyGroups) -> None:
    size = key.document().size()
    assert size.width() <= key.viewport().width()
    assert size.height() <= key.viewport().height()


def test_one_drag_of_the_mouse_copies_the_whole_key_in_one_line(key: KeyGroups) -> None:
    """Each group was a text of its own: nine had to be copied one by one."""
    last = key.viewport().rect().bottomRight() - QPoint(2, 2)
    QTest.mousePress(key.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(0, 4))
    QTest.mouseMove(key.viewport(), last)
    QTest.mouseRelease(key.viewport(), Qt.MouseButton.LeftButton, pos=last)
    key.copy()
    assert QApplication.clipboard().text() == "-".join(GROUPS)
    QApplication.clipboard().clear()


def test_nothing_is_copied_that_nobody_selects(key: KeyGroups) -> None:
    QApplication.clipboard().clear()
    key.copy()
    assert QApplication.clipboard().text() == ""
    assert not key.textCursor().hasSelection()


def test_it_cannot_be_written_over(key: KeyGroups) -> None:
    key.moveCursor(QTextCursor.MoveOperation.End)
    QTest.keyClicks(key, "A")
    assert key.text.split() == GROUPS


def test_nothing_of_a_key_stays(key: KeyGroups) -> None:
    key.selectAll()
    key.show_groups([])
    assert (key.text, key.accessibleName(), key.toPlainText()) == ("", "", "")
    assert not key.document().isUndoAvailable()

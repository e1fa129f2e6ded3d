"""Both versions stand side by side, arrows choose, and nothing is decided by a key that was pressed too late."""

import datetime

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from app.editing.dialog import EditDialog
from app.editing.question import EditQuestion
from app.storage.three_way import MergeConflict
from app.theme.current import set_scale

NOW = datetime.datetime(2026, 11, 23, 12, 0).astimezone()
AT = NOW.replace(hour=10, minute=32)
CONTESTS = (
    MergeConflict("height_m", 1.82, 1.80, "B. Berger", AT),
    MergeConflict("device", "", "knee K " + "with a long name " * 12, "", None),
)
LEFT, RIGHT, UP, DOWN = Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down
ENTER, ESCAPE = Qt.Key.Key_Return, Qt.Key.Key_Escape


@pytest.fixture
def dialog(qtbot: QtBot) -> EditDialog:
    window = QWidget()
    qtbot.addWidget(window)
    window.resize(1280, 800)
    window.show()
    dialog = EditDialog(EditQuestion("P-3", CONTESTS, print), window, lambda: NOW)
    dialog.open()
    return dialog


def press(dialog: EditDialog, *keys: Qt.Key) -> None:
    for key in keys:
        QTest.keyClick(dialog.focusWidget(), key)


def test_each_line_states_both_values_and_whose_they_are(dialog: EditDialog) -> None:
    (mine, theirs), (nothing, unknown) = dialog.cells
    assert (mine.value, mine.whose) == ("182 cm", "Yours")
    assert (theirs.value, theirs.whose) == ("180 cm", "Theirs: B. Berger, today 10:32")
    assert nothing.value == "not recorded"
    assert unknown.whose == "Theirs: another user"
    assert mine.accessibleName() == "Height, Yours: 182 cm"


@pytest.mark.parametrize(
    ("keys", "chosen"),
    [
        ((LEFT, DOWN, RIGHT, ENTER), {"height_m"}),
        ((RIGHT, DOWN, RIGHT, ENTER), set()),
        ((RIGHT, DOWN, LEFT, UP, LEFT, ENTER), {"height_m", "device"}),
        ((LEFT, RIGHT, LEFT, ENTER, LEFT, ENTER), {"height_m", "device"}),  # Enter leads to the line that is left
        ((ESCAPE,), set()),
    ],
)
def test_arrows_choose_and_enter_saves(
    qtbot: QtBot, dialog: EditDialog, keys: tuple[Qt.Key, ...], chosen: set[str]
) -> None:
    with qtbot.waitSignal(dialog.settled) as settled:
        press(dialog, *keys)
    assert settled.args == [frozenset(chosen)]


def test_enter_that_comes_before_anything_is_chosen_decides_nothing(qtbot: QtBot, dialog: EditDialog) -> None:
    with qtbot.assertNotEmitted(dialog.settled):
        press(dialog, ENTER, ENTER, LEFT, ENTER, ENTER)  # the second line is not chosen yet
    assert dialog.chosen is None
    assert not dialog.save.isEnabled()


def test_leaving_theirs_takes_none_of_ours(qtbot: QtBot, dialog: EditDialog) -> None:
    press(dialog, LEFT, DOWN, LEFT)
    with qtbot.waitSignal(dialog.settled) as settled:
        dialog.leave.click()
    assert settled.args == [frozenset()]


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_it_fits_the_window_and_cuts_no_word(qtbot: QtBot, dialog: EditDialog, scale: float) -> None:
    window = dialog.parentWidget()
    assert window is not None
    dialog.close()
    set_scale(scale)
    window.resize(960, 600)
    shown = EditDialog(EditQuestion("P-3", CONTESTS, print), window, lambda: NOW)
    shown.open()
    assert shown.width() <= 960
    assert shown.height() <= 600
    for pair in shown.cells:
        for cell in pair:
            assert cell.height() >= cell.heightForWidth(cell.width())
            assert cell.x() + cell.width() <= shown.width()

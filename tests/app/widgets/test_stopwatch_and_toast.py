"""The stopwatch reports and never warns; the toast offers, stays under the mouse, and goes."""

import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QEnterEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from app.theme.colours import LIGHT
from app.theme.current import set_scale
from app.widgets import toast as toast_module
from app.widgets.header import Header
from app.widgets.stopwatch import Stopwatch
from app.widgets.toast import Toast
from tests.app.room import settle, words_cut


@pytest.fixture
def stopwatch(qtbot: QtBot) -> Stopwatch:
    stopwatch = Stopwatch()
    qtbot.addWidget(stopwatch)
    stopwatch.resize(stopwatch.sizeHint())
    stopwatch.show()
    return stopwatch


@pytest.fixture
def window(qtbot: QtBot) -> QWidget:
    window = QWidget()
    qtbot.addWidget(window)
    window.resize(600, 200)
    return window


@pytest.fixture
def toast(window: QWidget) -> Toast:
    toast = Toast(window)
    toast.move(100, 100)  # not under the mouse, which is at 0, 0
    window.show()
    return toast


def dark_of_line(stopwatch: Stopwatch) -> int:
    """How many pixels of the line are filled."""
    image = stopwatch.grab().toImage()
    y = round(stopwatch.painted_texts()[0].box.bottom()) + 6
    return sum(image.pixelColor(x, y).name().upper() == LIGHT.ink for x in range(round(image.width() * 0.6)))


@pytest.mark.parametrize(
    ("elapsed_s", "time", "words"),
    [
        (0.0, "00:00", "of 5 min target"),
        (246.7, "04:06", "of 5 min target"),
        (300.4, "05:00", "of 5 min target"),
        (301.0, "05:01", "5 min target exceeded"),
        (3725.0, "62:05", "5 min target exceeded"),
    ],
)
def test_the_stopwatch_states_time_and_target(stopwatch: Stopwatch, elapsed_s: float, time: str, words: str) -> None:
    stopwatch.show_elapsed(elapsed_s)
    assert [text.text for text in stopwatch.painted_texts()] == [words, time]
    assert stopwatch.accessibleName() == f"{time}, {words}"
    assert words_cut(stopwatch) == []


def test_the_line_grows_to_the_target_and_no_farther(stopwatch: Stopwatch) -> None:
    lengths = []
    for elapsed_s in (75.0, 150.0, 300.0, 900.0):
        stopwatch.show_elapsed(elapsed_s)
        lengths.append(dark_of_line(stopwatch))
    assert lengths == pytest.approx([24, 48, 96, 96], abs=4)


def test_the_stopwatch_keeps_its_width_so_that_the_header_does_not_shift(stopwatch: Stopwatch) -> None:
    widths = set()
    for elapsed_s in (0.0, 111.0, 299.0, 301.0, 3000.0):
        stopwatch.show_elapsed(elapsed_s)
        widths.add(stopwatch.sizeHint().width())
    assert len(widths) == 1


def test_the_toast_offers_and_its_button_takes_back(toast: Toast, qtbot: QtBot) -> None:
    assert not toast.isVisible()
    toast.offer("Walk 2 excluded.")
    assert toast.isVisible()
    assert toast.accessibleName() == "Walk 2 excluded."
    with qtbot.waitSignal(toast.undone):
        QTest.mouseClick(toast.button, Qt.MouseButton.LeftButton)
    assert not toast.isVisible()


def test_a_toast_that_has_gone_takes_nothing_back(toast: Toast) -> None:
    reported: list[int] = []
    toast.undone.connect(lambda: reported.append(1))
    toast.undo()
    assert reported == []


def test_the_toast_goes_after_a_while(toast: Toast, qtbot: QtBot) -> None:
    assert toast_module.STAYS_MS == 6000
    toast._clock.setInterval(30)
    toast.offer("Walk 2 excluded.")
    qtbot.waitUntil(lambda: not toast.isVisible())


def test_the_toast_stays_under_the_mouse(toast: Toast, qtbot: QtBot) -> None:
    toast._clock.setInterval(30)
    toast.offer("Walk 2 excluded.")
    point = QPointF(5, 5)
    QApplication.sendEvent(toast, QEnterEvent(point, point, point))
    qtbot.wait(90)
    assert toast.isVisible()
    QApplication.sendEvent(toast, QEvent(QEvent.Type.Leave))
    qtbot.waitUntil(lambda: not toast.isVisible())


def test_long_words_make_the_toast_higher(toast: Toast) -> None:
    toast.offer("Free motion of the right leg was taken back, and the calibration before it is in use again.")
    settle()
    assert toast.height() > 56
    assert words_cut(toast) == []


@pytest.mark.parametrize("scale", [0.8, 1.0, 2.0])
@pytest.mark.parametrize("width", [1064, 736, 500])
@pytest.mark.usefixtures("pseudo_language")
def test_the_header_has_room_for_all_it_states(qtbot: QtBot, scale: float, width: int) -> None:
    set_scale(scale)
    header = Header(has_mark=False)
    qtbot.addWidget(header)
    header.show_session("P-0147", "1968, male · left prosthetic, microprocessor knee, carbon foot", is_simulated=True)
    header.show_elapsed(301.0)
    header.set_fold_shown(True)
    header.set_compact(width < 964)
    header.resize(round(width * scale), header.height())
    header.show()
    assert words_cut(header) == []
    boxes = [one.geometry() for one in (*header._left, *header._right) if not one.isHidden()]
    assert not any(one.intersects(other) for k, one in enumerate(boxes) for other in boxes[:k])


def test_the_header_of_a_window_with_a_rail_has_neither_mark_nor_name(qtbot: QtBot) -> None:
    for has_mark in (True, False):
        header = Header(has_mark)
        qtbot.addWidget(header)
        header.show()
        assert header._mark.isVisible() == has_mark
        assert header._name.isVisible() == has_mark

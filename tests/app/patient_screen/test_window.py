"""What the patient sees and is reported: figures, reached or not, waiting; and the keys of the window."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.patient_screen.patient_view import PatientView, figure, title_of
from app.patient_screen.window import PatientWindow
from app.theme.current import current_theme, set_dark
from core.body import Side
from core.targets import Target, TargetMeasure

KNEE = Target(TargetMeasure.KNEE_SWING_PEAK, Side.LEFT, 55)
TEN = (51, 56, 53, 55, 57, 56, 58, 55, 56, 54)


@pytest.fixture
def window(qtbot: QtBot) -> PatientWindow:
    window = PatientWindow()
    qtbot.addWidget(window)
    window.resize(1280, 800)
    window.show()
    return window


def picture(window: PatientWindow) -> QImage:
    return window.grab().toImage()


def is_leg(image: QImage, x: int, y: int) -> bool:
    return QColor(image.pixel(x, y)) == QColor(current_theme().colours.left)


def test_the_bar_ends_at_the_value_on_a_scale_about_the_target(window: PatientWindow) -> None:
    window.show_view(PatientView(KNEE, TEN))
    image = picture(window)
    assert is_leg(image, 748, 468)  # 54 of 30 to 70 on 1120 px
    assert not is_leg(image, 756, 468)
    window.show_view(PatientView(KNEE, (60,)))
    image = picture(window)
    assert is_leg(image, 916, 468)
    assert not is_leg(image, 924, 468)


def test_steps_that_reached_are_filled_and_others_hollow(window: PatientWindow) -> None:
    window.show_view(PatientView(KNEE, TEN))
    image = picture(window)
    middles = [479 + 73 * k + 29 for k in range(10)]
    assert [is_leg(image, x, 712) for x in middles] == [value >= 55 for value in TEN]


def test_its_words_say_the_value_and_how_many_reached(window: PatientWindow) -> None:
    window.show_view(PatientView(KNEE, TEN))
    stated = "Left knee: bend it as the leg swings. Target 55°. Now 54°. Last 10 steps: 7 reached 55°."
    assert window.accessibleName() == stated


def test_while_it_waits_no_value_is_shown_not_even_old_ones(window: PatientWindow) -> None:
    window.show_view(PatientView(KNEE, TEN, is_waiting=True))
    assert window.accessibleName() == "Left knee: bend it as the leg swings. Target 55°. One moment"
    image = picture(window)
    assert not any(is_leg(image, x, y) for x in range(80, 1200, 4) for y in (468, 712))
    window.show_view(PatientView(KNEE, TEN))
    assert "One moment" not in window.accessibleName()


def test_before_the_first_step_nothing_is_counted() -> None:
    assert PatientView(KNEE).in_words == "Left knee: bend it as the leg swings. Target 55°."
    assert PatientView().in_words == "One moment"


def test_without_a_target_the_steps_of_a_walk_are_shown_and_nobody_is_to_wait(window: PatientWindow) -> None:
    window.show_view(PatientView(steps=13))
    assert window.accessibleName() == "13 steps so far"
    shown = picture(window)
    window.show_view(PatientView(steps=14))
    assert picture(window) != shown
    window.show_view(PatientView(steps=None))
    assert window.accessibleName() == "One moment"


@pytest.mark.parametrize("side", Side)
@pytest.mark.parametrize("measure", [measure for measure in TargetMeasure if measure.has_side])
def test_each_title_names_its_leg(measure: TargetMeasure, side: Side) -> None:
    stated = title_of(Target(measure, side, 50))
    assert stated.startswith("Left" if side is Side.LEFT else "Right")


def test_figures_have_their_unit_and_a_true_minus() -> None:
    assert figure(-3, TargetMeasure.FOOT_STRIKE) == "\N{MINUS SIGN}3°"
    assert figure(96, TargetMeasure.STANCE_RATIO) == "96\N{NO-BREAK SPACE}%"
    assert figure(110, TargetMeasure.CADENCE) == "110"


@pytest.mark.parametrize("key", [Qt.Key.Key_Escape, Qt.Key.Key_F8])
def test_esc_and_f8_close_it(qtbot: QtBot, window: PatientWindow, key: Qt.Key) -> None:
    with qtbot.waitSignal(window.closed):
        QTest.keyClick(window, key)
    assert not window.isVisible()


def test_f11_fills_the_screen_and_space_is_for_the_walk(qtbot: QtBot, window: PatientWindow) -> None:
    QTest.keyClick(window, Qt.Key.Key_F11)
    assert window.isFullScreen()
    QTest.keyClick(window, Qt.Key.Key_F11)
    assert not window.isFullScreen()
    with qtbot.waitSignal(window.run_requested):
        QTest.keyClick(window, Qt.Key.Key_Space)


@pytest.mark.parametrize("size", [(960, 600), (1280, 800), (1920, 1080), (800, 1200)])
@pytest.mark.parametrize("is_dark", [False, True])
def test_it_fills_any_room_in_both_schemes(window: PatientWindow, size: tuple[int, int], is_dark: bool) -> None:
    set_dark(is_dark)
    window.resize(*size)
    window.show_view(PatientView(KNEE, TEN))
    image = picture(window)
    scale = min(size[0] / 1280, size[1] / 800)
    x = size[0] / 2 + scale * (400 - 640)
    y = size[1] / 2 + scale * (468 - 400)
    assert is_leg(image, round(x), round(y))
    assert QColor(image.pixel(2, 2)) == QColor(current_theme().colours.surface)

"""What the patient sees and is reported: figures, reached or not, waiting; and the keys of the window."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QObject, QRect, Qt
from PySide6.QtGui import QColor, QFont, QGuiApplication, QImage, QScreen
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.patient_screen.patient_view import PatientView, figure, title_of
from app.patient_screen.window import PatientWindow, Placing
from app.theme.current import current_theme, set_dark
from app.theme.theme import Theme
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


def test_the_words_say_what_is_shown(window: PatientWindow, snapshot: SnapshotAssertion) -> None:
    views = {
        "the value and how many reached": PatientView(KNEE, TEN),
        "waiting for what can no longer be a target, though steps are counted": PatientView(steps=13, is_waiting=True),
        "steps of a walk without a target": PatientView(steps=13),
        "before the first step nothing is counted": PatientView(KNEE),
        "neither a target nor a walk": PatientView(),
    }
    assert {case: view.in_words for case, view in views.items()} == snapshot
    window.show_view(PatientView(KNEE, TEN))
    assert window.accessibleName() == PatientView(KNEE, TEN).in_words


def test_titles_name_their_leg_and_figures_have_their_unit_and_a_true_minus(snapshot: SnapshotAssertion) -> None:
    sides = {measure: tuple(Side) if measure.has_side else () for measure in TargetMeasure}
    assert {
        **{f"{measure}, {side}": title_of(Target(measure, side, 50)) for measure in sides for side in sides[measure]},
        **{str(measure): figure(-3, measure) for measure in TargetMeasure},
    } == snapshot


def test_while_it_waits_no_value_is_shown_not_even_old_ones(window: PatientWindow) -> None:
    window.show_view(PatientView(KNEE, TEN, is_waiting=True))
    assert window.accessibleName() == "Left knee: bend it as the leg swings. Target 55°. One moment"
    image = picture(window)
    assert not any(is_leg(image, x, y) for x in range(80, 1200, 4) for y in (468, 712))
    window.show_view(PatientView(KNEE, TEN))
    assert "One moment" not in window.accessibleName()


def test_while_the_patient_is_standing_it_waits_for_the_next_step_and_keeps_the_last_ones(
    window: PatientWindow,
) -> None:
    window.show_view(PatientView(KNEE, TEN, is_standing=True))
    assert window.accessibleName() == (
        "Left knee: bend it as the leg swings. Target 55°. Waiting for the next step. Last 10 steps: 7 reached 55°."
    )
    image = picture(window)
    assert not any(is_leg(image, x, 468) for x in range(80, 1200, 4))  # no bar
    assert any(is_leg(image, x, 712) for x in range(80, 1200, 4))
    window.show_view(PatientView(KNEE, TEN))
    assert "Waiting" not in window.accessibleName()
    assert is_leg(picture(window), 400, 468)


def test_without_a_target_the_steps_of_a_walk_are_shown_and_nobody_is_to_wait(window: PatientWindow) -> None:
    window.show_view(PatientView(steps=13))
    assert window.accessibleName() == "13 steps so far"
    shown = picture(window)
    window.show_view(PatientView(steps=14))
    assert picture(window) != shown
    window.show_view(PatientView(steps=None))
    assert window.accessibleName() == "One moment"


@pytest.mark.parametrize("key", [Qt.Key.Key_Escape, Qt.Key.Key_F8])
def test_esc_and_f8_close_it(qtbot: QtBot, window: PatientWindow, key: Qt.Key) -> None:
    with qtbot.waitSignal(window.closed):
        QTest.keyClick(window, key)
    assert not window.isVisible()


class Beside:
    """A window of a clinician on the one screen of the tests, and the patient's beside it."""

    def __init__(self, qtbot: QtBot, room: QRect) -> None:
        self.clinician = QWidget()
        self.placing = Placing()
        self.windows: list[PatientWindow] = []
        self._qtbot = qtbot
        qtbot.addWidget(self.clinician)
        self.clinician.setGeometry(room)
        self.clinician.show()

    @property
    def screen(self) -> QRect:
        return self.clinician.screen().availableGeometry()

    def open(self) -> PatientWindow:
        window = PatientWindow(self.placing)
        self._qtbot.addWidget(window)
        window.open_beside(self.clinician)
        return window


@pytest.fixture
def whole(qtbot: QtBot) -> Beside:
    """The clinician's window fills the screen."""
    return Beside(qtbot, QGuiApplication.primaryScreen().availableGeometry())


def test_on_one_screen_it_opens_in_a_corner_above_the_action_bar_and_takes_no_focus(whole: Beside) -> None:
    window = whole.open()
    place, screen = window.geometry(), whole.screen
    assert not window.isFullScreen()
    assert screen.contains(place)
    assert place.width() * place.height() < 0.2 * screen.width() * screen.height()
    assert place.bottom() < screen.bottom() - 72
    flags = window.windowFlags()
    assert flags & Qt.WindowType.WindowStaysOnTopHint
    assert flags & Qt.WindowType.WindowDoesNotAcceptFocus
    assert window.testAttribute(Qt.WidgetAttribute.WA_ShowWithoutActivating)


def test_where_the_screen_has_room_beside_the_clinicians_window_it_hides_nothing_of_it(qtbot: QtBot) -> None:
    screen = QGuiApplication.primaryScreen().availableGeometry()
    for room in (screen.adjusted(0, 0, -400, 0), screen.adjusted(400, 0, 0, 0), screen.adjusted(0, 0, 0, -300)):
        beside = Beside(qtbot, room)
        assert not beside.open().geometry().intersects(room)


def test_it_comes_back_where_it_was_moved_to_and_as_large(whole: Beside) -> None:
    window = whole.open()
    window.setGeometry(50, 60, 400, 260)
    window.close()
    assert whole.open().geometry() == QRect(50, 60, 400, 260)


def test_a_place_beyond_the_screen_is_not_gone_back_to(whole: Beside) -> None:
    usual = whole.open().geometry()
    whole.placing.corner = whole.screen.translated(whole.screen.width(), 0)  # as of a screen that is gone
    assert whole.open().geometry() == usual


def test_full_screen_is_by_choice_and_is_remembered(qtbot: QtBot, whole: Beside) -> None:
    window = whole.open()
    usual = window.geometry()
    with qtbot.waitSignal(window.placed) as placed:
        window.toggle_full_screen()
    assert placed.args == [True]
    assert window.isFullScreen()
    window.close()
    again = whole.open()
    assert again.isFullScreen()
    again.toggle_full_screen()
    assert not again.isFullScreen()
    assert again.geometry() == usual


def test_a_second_screen_is_filled_and_where_it_is_unplugged_the_corner_takes_its_place(
    qtbot: QtBot, whole: Beside, monkeypatch: pytest.MonkeyPatch
) -> None:
    second: list[QScreen] = [QGuiApplication.primaryScreen()]  # the tests have one
    monkeypatch.setattr(PatientWindow, "_second", property(lambda _: next(iter(second), None)))
    whole.placing.ask_for_full()  # by F11; where there is one screen it would hide the clinician's
    window = whole.open()
    assert window.isFullScreen()
    removed = second.pop()
    application = QGuiApplication.instance()
    assert isinstance(application, QGuiApplication)
    with qtbot.waitSignal(window.placed) as placed:
        application.screenRemoved.emit(removed)
    assert placed.args == [False]
    assert window.isVisible()
    assert not window.isFullScreen()
    assert whole.screen.contains(window.geometry())
    second.append(removed)
    window.close()
    assert whole.open().isFullScreen()  # a choice of one screen is none of two


def test_two_screens_of_one_computer(tmp_path: Path) -> None:
    """In a process of its own, whose platform has two."""
    screens = [
        {"name": name, "x": x, "y": 0, "width": 1280, "height": 800} for name, x in (("mine", 0), ("other", 1280))
    ]
    file = tmp_path / "screens.json"
    file.write_text(json.dumps({"screens": screens}), encoding="utf-8")
    code = (
        "from PySide6.QtWidgets import QApplication, QWidget\n"
        "from app.patient_screen.window import PatientWindow\n"
        "app = QApplication([]); mine = QWidget(); mine.setGeometry(0, 0, 1280, 800); mine.show()\n"
        "window = PatientWindow(); window.open_beside(mine); app.processEvents()\n"
        "print(window.screen().name(), window.isFullScreen(), window.geometry().getRect())"
    )
    environment = {**os.environ, "QT_QPA_PLATFORM": f"offscreen:configfile={file}"}
    shown = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert shown.stdout.split(maxsplit=2)[:2] == ["other", "True"]


def test_another_theme_is_shown_at_once(qtbot: QtBot, window: PatientWindow) -> None:
    window.show_view(PatientView(KNEE, TEN))
    painted: list[QColor] = []

    class Watch(QObject):
        def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
            if event.type() is QEvent.Type.Paint:
                painted.append(QColor(current_theme().colours.surface))
            return False

    watch = Watch()
    window.installEventFilter(watch)
    qtbot.waitUntil(lambda: painted != [])
    QApplication.processEvents()
    painted.clear()
    set_dark(True)
    qtbot.waitUntil(lambda: QColor(current_theme().colours.surface) in painted)
    assert QColor(picture(window).pixel(2, 2)) == QColor(current_theme().colours.surface)


def test_in_a_corner_no_letter_is_too_small_to_be_read(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[float] = []
    plain = Theme.font

    def noted(theme: Theme, size: float, weight: QFont.Weight = QFont.Weight.Normal, is_code: bool = False) -> QFont:
        sizes.append(size)
        return plain(theme, size, weight, is_code)

    window = PatientWindow()
    qtbot.addWidget(window)
    window.resize(384, 240)
    for target in (KNEE, Target(TargetMeasure.CADENCE, None, 110)):
        window.show_view(PatientView(target, TEN))
        with monkeypatch.context() as patched:
            patched.setattr(Theme, "font", noted)
            patched.setattr("app.patient_screen.picture.paint_chip", lambda *_: None)  # its letter is scaled with it
            picture(window)
    assert sizes != []
    assert min(sizes) * 384 / 1280 >= 11.0


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

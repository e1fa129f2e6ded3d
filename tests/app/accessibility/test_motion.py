"""Less motion: nothing moves by itself where it is asked for here, all does where neither here nor the system asks."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QProgressBar, QWidget
from pytestqt.qtbot import QtBot

from app.help.help_page import HelpPage
from app.help.help_topics import Topic
from app.home.settings.settings_page import SettingsPage
from app.main_window import MainWindow
from app.plots.stride_legs import StrideLegs
from app.system.settings import Settings
from app.theme import motion
from app.theme.current import current_theme, set_theme
from app.theme.theme import Theme
from app.wizard.shell import WizardShell
from app.wizard.step import StepId


@pytest.fixture(autouse=True)
def _moving_system(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A system that was not asked for less motion, whatever the machine of the test was."""
    monkeypatch.setattr(motion, "_is_motion_required", lambda: True)
    yield
    set_theme(replace(current_theme(), has_less_motion=False))


def test_either_the_setting_or_the_system_takes_the_time_of_a_transition(monkeypatch: pytest.MonkeyPatch) -> None:
    assert motion.duration_ms(120, Theme()) == 120
    assert motion.duration_ms(120, Theme(has_less_motion=True)) == 0
    monkeypatch.setattr(motion, "_is_motion_required", lambda: False)
    assert motion.duration_ms(120, Theme()) == 0


@pytest.mark.parametrize("is_less", [False, True])
def test_a_film_plays_by_itself_unless_less_motion_is_asked_for(qtbot: QtBot, is_less: bool) -> None:
    set_theme(replace(current_theme(), has_less_motion=is_less))
    page = HelpPage()
    qtbot.addWidget(page)
    page.show_topic(Topic.FREE_MOTION)
    page.show()
    assert page.text.is_playing is not is_less


def test_a_film_that_plays_stops_when_less_motion_is_asked_for(qtbot: QtBot) -> None:
    page = HelpPage()
    qtbot.addWidget(page)
    page.show_topic(Topic.FREE_MOTION)
    page.show()
    playing = [page.text.is_playing]
    set_theme(replace(current_theme(), has_less_motion=True))
    playing.append(page.text.is_playing)
    assert playing == [True, False]


def frames_of(qtbot: QtBot, bar: QProgressBar) -> int:
    """How many different pictures of a bar there are within a third of a second."""
    pictures = []
    for _ in range(4):
        qtbot.wait(80)
        pictures.append(bar.grab().toImage())
    return sum(one != other for one, other in pairwise(pictures))


@pytest.mark.parametrize("is_less", [False, True])
def test_a_bar_of_unknown_length_is_in_the_middle(qtbot: QtBot, is_less: bool) -> None:
    set_theme(replace(current_theme(), has_less_motion=is_less))
    bar = QProgressBar()
    qtbot.addWidget(bar)
    bar.setTextVisible(False)
    bar.setRange(0, 0)
    bar.setFixedSize(100, 8)
    bar.show()
    assert (frames_of(qtbot, bar) == 0) is is_less
    if is_less:
        picture = bar.grab().toImage()
        row = [picture.pixelColor(x, 4).name() == current_theme().colours.ink.lower() for x in (10, 50, 90)]
        assert row == [False, True, False]


@pytest.mark.parametrize("is_less", [False, True])
def test_pages_of_a_visit_fade_into_each_other_unless_less_motion_is_asked_for(qtbot: QtBot, is_less: bool) -> None:
    set_theme(replace(current_theme(), has_less_motion=is_less))
    shell = WizardShell()
    qtbot.addWidget(shell)
    shell.resize(1280, 800)
    shell.show()
    shell.show_page(StepId.PATIENT, QWidget())
    shell.begin_fade()
    shell.show_page(StepId.SENSORS, QWidget())
    fades = [one for one in shell.findChildren(QWidget) if type(one).__name__ == "_Fade"]
    assert len(fades) == 1
    assert fades[0].isVisible() is not is_less
    qtbot.waitUntil(lambda: not fades[0].isVisible())


def test_legs_move_only_when_somebody_plays_them(qtbot: QtBot) -> None:
    legs = StrideLegs()
    qtbot.addWidget(legs)
    legs.show()
    assert not legs.is_playing


def test_the_setting_is_chosen_by_keys_and_stated(qtbot: QtBot) -> None:
    page = SettingsPage(12, [])
    qtbot.addWidget(page)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    page.motion.focus()
    focused = QApplication.focusWidget()
    assert focused is not None
    with qtbot.waitSignal(page.motion_chosen) as reported:
        QTest.keyClick(focused, Qt.Key.Key_Right)
    assert reported.args == [True]
    assert page.motion.segments[1].accessibleName() == "Reduced"


def test_the_window_follows_the_setting_and_a_new_start_keeps_it(
    qtbot: QtBot, settings: Settings, tmp_path: Path
) -> None:
    def end(window: MainWindow) -> None:
        window.close()
        window.finish()

    window = MainWindow(settings)
    qtbot.addWidget(window, before_close_func=end)
    seen = [current_theme().has_less_motion]
    settings.has_less_motion = True
    seen.append(current_theme().has_less_motion)
    again = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    assert again.has_less_motion
    settings.has_less_motion = False
    seen.append(current_theme().has_less_motion)
    assert seen == [False, True, False]

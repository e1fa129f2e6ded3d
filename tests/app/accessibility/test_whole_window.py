"""Home with a patient's course and all that opens from it, entry, help and the patient's screen, by Tab alone."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from app.help.help_page import HelpPage
from app.help.help_topics import Topic
from app.home.home import Home
from app.main_window import MainWindow
from app.system.settings import Settings
from app.theme.current import set_scale
from app.workers.library_controller import LibraryController
from tests.app.accessibility.accessible_tree import complaints, wrong_order
from tests.app.accessibility.framed_pages import patient_screen
from tests.app.accessibility.reach import out_of_reach
from tests.app.home.course_library import PASSPHRASE, make_course_library
from tests.app.room import settle, words_cut

QUESTIONS = 3  # its row in the rail
pytestmark = pytest.mark.endurance


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_course_library(tmp_path_factory.mktemp("course"), missing=frozenset({1}))


@pytest.fixture
def controller() -> Iterator[LibraryController]:
    controller = LibraryController()
    yield controller
    controller.finish()


@pytest.fixture
def home(qtbot: QtBot, controller: LibraryController, untouched: Path, tmp_path: Path) -> Iterator[Home]:
    home = Home(controller, Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat)))
    home.resize(1280, 800)
    qtbot.addWidget(home)
    with qtbot.waitActive(home):
        home.show()
        home.activateWindow()
    with qtbot.waitSignal(controller.opened) as reported:
        controller.open(lambda holder: holder.open(Path(shutil.copytree(untouched, tmp_path / "library")), PASSPHRASE))
    home.show_library((reported.args or [])[0])
    qtbot.waitUntil(lambda: bool(home.page.sessions.lines))
    yield home
    home.finish()


def wrong_with(window: QWidget) -> list[str]:
    settle()
    assert QApplication.focusWidget() is not None, "nothing has the focus"
    return [*complaints(window), *wrong_order(window)]


def opened(qtbot: QtBot, page: QWidget) -> QWidget:
    qtbot.addWidget(page)
    page.resize(1280, 800)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    return page


def ways(home: Home) -> dict[str, Callable[[], object]]:
    """How each page is come to."""
    return {
        "home": home.focus,
        "settings": home.show_settings,
        "questions": lambda: home.rail.step_pressed.emit(QUESTIONS),
        "goals": home.page.panel.goals.clicked.emit,
        "analyse again": home.page.panel.analyse_again.triggered.emit,
    }


def test_home_and_what_opens_from_it(qtbot: QtBot, home: Home) -> None:
    found, pages = {}, set()
    for name, show in ways(home).items():
        show()
        qtbot.wait(300)  # what is read of the library comes meanwhile
        pages.add(home.current)
        found[name] = wrong_with(home)
        home.escape()
    assert len(pages) == len(found)
    assert {name: stated for name, stated in found.items() if stated} == {}


@pytest.mark.parametrize("size", [(1920, 1200), (1280, 800)])
def test_home_twice_as_large_has_all_its_words_and_controls(qtbot: QtBot, home: Home, size: tuple[int, int]) -> None:
    set_scale(2.0)
    home.resize(*size)
    found = {}
    for name, show in ways(home).items():
        show()
        qtbot.wait(100)
        settle()
        found[name] = [*words_cut(home), *out_of_reach(home)]
        home.escape()
    assert {name: stated for name, stated in found.items() if stated} == {}


def test_the_first_start(qtbot: QtBot, tmp_path: Path) -> None:
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    window = MainWindow(settings, tmp_path / "library")
    try:
        opened(qtbot, window)
        assert wrong_with(window) == []
    finally:
        window.close()
        window.finish()


@pytest.mark.parametrize("topic", [Topic.KEYS, Topic.FREE_MOTION])
def test_the_manual(qtbot: QtBot, topic: Topic) -> None:
    page = HelpPage()
    page.show_topic(topic)
    opened(qtbot, page)
    page.focus()
    assert wrong_with(page) == []
    with qtbot.waitSignal(page.closed):
        QTest.keyClick(QApplication.focusWidget() or page, Qt.Key.Key_Escape)


def test_the_patients_screen_states_what_it_shows(qtbot: QtBot) -> None:
    window = patient_screen()
    qtbot.addWidget(window)
    with qtbot.waitExposed(window):
        window.show()  # it takes no focus
    assert complaints(window) == []
    assert window.accessibleName().startswith("Left knee")

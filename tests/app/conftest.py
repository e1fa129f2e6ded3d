"""What tests of the screen get: a watchdog over its thread, a long language, a theme, settings, the results."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QLockFile, QSettings
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.results.result_page import ResultPage
from app.system.settings import Settings
from app.theme.current import current_theme, load_fonts, set_theme
from app.theme.theme import Theme
from app.wording.translation import use_language
from tests.app.watchdog import Watchdog


@pytest.fixture
def watchdog(qapp: QApplication) -> Iterator[Watchdog]:
    """Fail the test, with the stack, if anything holds up the screen's thread for 150 ms; 100 are aimed at."""
    dog = Watchdog()
    dog.start()
    yield dog
    dog.stop()
    assert dog.late == [], "\n".join(map(str, dog.late))


@pytest.fixture
def pseudo_language() -> Iterator[None]:
    """Let every sentence on the screen be 35 % longer."""
    use_language("pseudo")
    yield
    use_language("en")


@pytest.fixture(autouse=True, scope="session")
def usual_theme(qapp: QApplication) -> Theme:
    """The light theme at its usual size, in force from the first test on."""
    load_fonts()
    set_theme(Theme())
    return Theme()


@pytest.fixture(autouse=True)
def theme_as_before(qapp: QApplication, usual_theme: Theme) -> Iterator[None]:
    """Whatever a test makes of the theme, the next one begins with the usual one."""
    yield
    assert qapp.styleSheet() == ""  # one beside the style would be asked in its stead
    if current_theme() != usual_theme:
        # what the test closed is gone first: a scene that Python let go of must not be given of a change
        qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        set_theme(usual_theme)


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Settings of one test, which nobody has changed yet."""
    return Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))


@pytest.fixture
def result_page(qtbot: QtBot) -> ResultPage:
    """The results by themselves, in the light theme."""
    page = ResultPage()
    qtbot.addWidget(page)
    return page


@pytest.fixture
def alone_with_lsl() -> Iterator[None]:
    """No other test of this computer streams: whoever asks for streams by name gets those of every process."""
    lock = QLockFile(str(Path(tempfile.gettempdir(), "gaitwright-tests-lsl.lock")))
    lock.setStaleLockTime(0)  # as long as its process lives
    lock.lock()
    yield
    lock.unlock()

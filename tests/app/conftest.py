"""What tests of the screen get: a watchdog over its thread, a language as long as German, a theme, the results."""

from collections.abc import Iterator

import pytest
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.results.result_page import ResultPage
from app.theme.notifier import ThemeNotifier, load_fonts
from app.wording.translation import use_language
from tests.app.watchdog import Watchdog


@pytest.fixture
def watchdog(qapp: QApplication) -> Iterator[Watchdog]:
    """Fail the test, with the stack, if anything holds up the screen's thread for more than 100 ms."""
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


@pytest.fixture
def look(qapp: QApplication) -> Iterator[ThemeNotifier]:
    """The light theme at its usual size, whatever a test makes of it."""
    load_fonts()
    look = ThemeNotifier()
    look.set_dark(False)
    yield look
    # what the test closed is gone first: a scene that Python let go of must not be given of a change
    qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    look.set_scale(1.0)
    qapp.setStyleSheet("")


@pytest.fixture
def result_page(qtbot: QtBot, look: ThemeNotifier) -> ResultPage:
    """The results by themselves, in the light theme."""
    page = ResultPage(look)
    qtbot.addWidget(page)
    return page

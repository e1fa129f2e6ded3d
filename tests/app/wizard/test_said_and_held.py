"""Tests of `tests.safety.stated_and_held`. It sees when screen and library disagree, and is silent when they agree."""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import sqlcipher3.dbapi2 as sqlite
from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.storage.exchange import import_session
from app.storage.opened import OpenedLibrary
from app.system.settings import Settings
from app.wizard.step import StepId
from app.wizard.wizard import Wizard
from app.workers.library_controller import LibraryController
from core.session import Session
from tests.app.wizard.present import present
from tests.safety.random_keys import play
from tests.safety.said_and_held import HeldLibrary, contradictions, left_open

Alter = Callable[[str], None]


@pytest.fixture
def opened(controller: LibraryController, simulated_session: Session) -> OpenedLibrary:
    """The controller's library, with a session of two walks."""
    library = present(controller.state).library
    import_session(library, simulated_session, lambda _share, _what: None, "DEMO-1")
    return library


@pytest.fixture
def held(opened: OpenedLibrary) -> HeldLibrary:
    return HeldLibrary(opened.folder, opened.data_key)


@pytest.fixture
def alter(opened: OpenedLibrary) -> Alter:
    """Change the library behind the program's back."""

    def change(statement: str) -> None:
        with closing(sqlite.connect(str(opened.folder / "library.db"), isolation_level=None)) as connection:
            connection.execute(f"PRAGMA key = \"x'{present(opened.data_key).hex()}'\"")
            connection.execute(statement)

    return change


@pytest.fixture
def session_in_sight(qtbot: QtBot, wizard: Wizard, opened: OpenedLibrary) -> Any:
    """A window that shows the session at Walking."""
    (line,) = opened.library.sessions.list()
    wizard.show_session(line.id)
    visit = present(wizard.visit)
    qtbot.waitUntil(lambda: wizard.step_id is StepId.RESULTS and not visit.evaluation.is_busy)
    wizard.go_to(StepId.WALKING)
    return SimpleNamespace(screens=SimpleNamespace(currentWidget=lambda: wizard), home=None, wizard=wizard)


@pytest.fixture
def home_in_sight(
    qtbot: QtBot, qapp: QApplication, controller: LibraryController, opened: OpenedLibrary, tmp_path: Path
) -> Any:
    home = Home(controller, Settings(QSettings(str(tmp_path / "s.ini"), QSettings.Format.IniFormat)))
    qtbot.addWidget(home)
    home.show_library(present(controller.state))
    qtbot.waitUntil(lambda: bool(home.page.sessions.lines))
    return SimpleNamespace(screens=SimpleNamespace(currentWidget=lambda: home), home=home, wizard=None)


def test_what_is_stated_otherwise_of_a_session_is_seen(session_in_sight: Any, held: HeldLibrary, alter: Alter) -> None:
    assert contradictions(session_in_sight, held) == []
    for statement, *words in (
        ("UPDATE recordings SET condition = 'else' WHERE name = 'walk 2'", "the list of walks says"),
        ("UPDATE recordings SET condition = '' WHERE name = 'walk 2'",),
        ("UPDATE recordings SET is_kept = 0 WHERE name = 'walk 2'", "held are 1 walks kept", "held is is_kept 0"),
        ("UPDATE patients SET code = 'DEMO-9'", "held as 'DEMO-9'"),
        ("UPDATE patients SET birth_year = 1801", "birth year 1801"),
        ("UPDATE sessions SET cannot_stand = 1", "cannot_stand True"),
        ("UPDATE recordings SET is_kept = 0 WHERE kind = 'standing'", "held is no kept standing"),
        ("DELETE FROM sessions", "the session in sight is not held"),
    ):
        assert not any(word in one for word in words for one in contradictions(session_in_sight, held))
        alter(statement)
        stated = contradictions(session_in_sight, held)
        assert all(any(word in one for one in stated) for word in words), stated


def test_what_is_stated_otherwise_on_home_is_seen(home_in_sight: Any, held: HeldLibrary, alter: Alter) -> None:
    assert contradictions(home_in_sight, held) == []
    home_in_sight.home.banner.show_message("The program closed during recording. 00:14 of walk 1 was recovered.")
    for statement, words in (
        ("UPDATE sessions SET is_simulated = 0", "simulated, it is not held as such"),
        ("UPDATE recordings SET condition = 'else'", "home says conditions"),
        ("UPDATE sessions SET deleted_at = '2026-01-01'", "home lists sessions"),
        ("UPDATE patients SET code = 'DEMO-9'", "home lists patients"),
        ("UPDATE recordings SET name = 'walk 3' WHERE name = 'walk 1'", "no recovered 'walk 1'"),
    ):
        alter(statement)
        stated = contradictions(home_in_sight, held)
        assert any(words in one for one in stated), stated


def test_a_banner_that_is_hidden_states_nothing(home_in_sight: Any, held: HeldLibrary) -> None:
    home_in_sight.home.banner.show_message("The program closed during recording. 00:05 of standing 6 was recovered.")
    assert any("no recovered 'standing 6'" in one for one in contradictions(home_in_sight, held))
    home_in_sight.home.banner.hide()  # as where another library is opened
    assert contradictions(home_in_sight, held) == []


def test_a_recording_that_nobody_ended_is_seen(held: HeldLibrary, alter: Alter) -> None:
    assert left_open(held) == []
    alter("UPDATE recordings SET state = 'open' WHERE name = 'walk 1'")
    assert len(left_open(held)) == 1


@pytest.mark.endurance
def test_half_a_minute_of_random_keys_finds_nothing(tmp_path: Path) -> None:
    outcome = play(30.0, 5, tmp_path)
    assert outcome.faults == []
    assert outcome.did["steps"] > 50
    assert outcome.did["comparisons"] > 5

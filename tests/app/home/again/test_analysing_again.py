"""Sessions are chosen and analysed again by all processors: each once, kept, and failures have reasons."""

from collections.abc import Iterator
from pathlib import Path
from uuid import UUID

import pytest
from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.cohort.batch.again import analyse_again
from app.cohort.batch.executors import of_this_computer
from app.cohort.batch.spread import SelectionResult
from app.home.again.analyse_again_page import AgainLine, AnalyseAgainPage
from app.home.home import Home
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from app.storage.kept_analyses import algorithm
from app.storage.library import DEMONSTRATOR, Library
from app.storage.opened import OpenedLibrary
from app.system.progress import nobody
from app.system.settings import Settings
from app.wizard.resuming import read_analysed, session_to_analyse
from app.workers.library_controller import LibraryController
from core.session import Session
from tests.app.home.course_library import PASSPHRASE, make_course_library
from tests.simulated import SHORT_VISIT, session_of

ANY_ROOM = Room(start_bytes=0, kept_bytes=0)


@pytest.fixture(scope="module")
def walked() -> Session:
    return session_of(SHORT_VISIT)


@pytest.fixture
def opened(tmp_path: Path, walked: Session) -> Iterator[OpenedLibrary]:
    """Two sessions that nobody has analysed, in a library of no operator's own."""
    folder = tmp_path / "opened"
    with OpenedLibrary(Library.create(folder, None, DEMONSTRATOR), folder, None) as library:
        for _ in range(2):
            import_session(library, walked, nobody, "DEMO-1", room=ANY_ROOM)
        yield library


def again(opened: OpenedLibrary, ids: tuple[UUID, ...], workers: int = 1) -> SelectionResult[UUID]:
    with of_this_computer(workers) as those:
        return analyse_again(ids, lambda one: session_to_analyse(opened, one), those, nobody)


def ids_of(opened: OpenedLibrary) -> tuple[UUID, ...]:
    return tuple(one.id for one in opened.library.sessions.list())


@pytest.mark.endurance
def test_what_is_analysed_again_is_what_opening_the_session_would_compute(
    opened: OpenedLibrary, monkeypatch: pytest.MonkeyPatch
) -> None:
    ids = ids_of(opened)
    assert opened.library.results.analysed_by(algorithm()) == frozenset()
    done = again(opened, ids[:1])
    assert (done.analysed, done.as_before, done.failures) == (1, 0, {})
    assert opened.library.results.analysed_by(algorithm()) == {ids[0]}
    assert list(opened.library.courses.find(ids)) == [ids[0]]

    def computed(*_: object, **__: object) -> None:
        raise AssertionError("it was computed a second time")

    monkeypatch.setattr("app.wizard.resuming.analyse", computed)
    _, analysis = read_analysed(opened, ids[0], nobody)
    assert analysis.recordings


@pytest.mark.endurance
def test_what_this_version_has_analysed_is_not_done_twice(opened: OpenedLibrary) -> None:
    ids = ids_of(opened)
    again(opened, ids[:1])
    done = again(opened, ids)
    assert (done.analysed, done.as_before) == (1, 1)


@pytest.mark.endurance
def test_a_session_that_cannot_be_read_does_not_stop_the_others(opened: OpenedLibrary) -> None:
    ids = ids_of(opened)
    for recording in opened.library.sessions.get(ids[0]).recordings:
        (opened.recordings / recording.journals[0].file).unlink()
    done = again(opened, ids)
    assert (done.analysed, list(done.failures)) == (1, [ids[0]])
    assert "missing" in done.failures[ids[0]]


@pytest.mark.endurance
def test_several_processes_give_what_one_gives(opened: OpenedLibrary) -> None:
    ids = ids_of(opened)
    done = again(opened, ids, workers=2)
    assert (done.analysed, done.failures) == (2, {})
    assert opened.library.results.analysed_by(algorithm()) == set(ids)


def line(number: int, *, is_current: bool = False, failure: str = "") -> AgainLine:
    return AgainLine(UUID(int=number), f"P-{number}", "20 Mar", "Shoes", is_current, failure)


def test_ticks_are_turned_by_the_space_bar_and_by_whole_kinds(qtbot: QtBot) -> None:
    page = AnalyseAgainPage()
    qtbot.addWidget(page)
    lines = [line(1), line(2, is_current=True), line(3)]
    page.show_lines(lines, [lines[0].id])
    page.list.choose(1)
    QTest.keyClick(page.list, Qt.Key.Key_Space)
    assert list(page.ticked) == [lines[0].id, lines[1].id]
    assert page.list.currentIndex().row() == 1
    page.earlier.click()
    assert list(page.ticked) == [lines[0].id, lines[2].id]
    page.all.click()
    assert len(page.ticked) == 3
    page.none.click()
    assert (len(page.ticked), page.none.isEnabled()) == (0, False)


def test_why_a_session_could_not_be_analysed_is_in_its_line(qtbot: QtBot) -> None:
    page = AnalyseAgainPage()
    qtbot.addWidget(page)
    page.show_lines([line(1, failure="this recording's file is missing"), line(2)], [])
    text = page.list.as_text().splitlines()
    assert "this recording's file is missing" in text[1]
    assert "not with this version" in text[2]


@pytest.mark.endurance
def test_home_leads_there_with_the_patients_sessions_ticked_and_shows_what_failed(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path
) -> None:
    """Of the fixture no samples were recorded: all fail, each for its reason."""
    controller = LibraryController()
    home = Home(controller, Settings(QSettings(str(tmp_path / "s.ini"), QSettings.Format.IniFormat)))
    qtbot.addWidget(home)
    home.show()
    with qtbot.waitSignal(controller.opened) as reported:
        (tmp_path / "library").mkdir()
        controller.open(lambda holder: holder.open(make_course_library(tmp_path / "library", visits=2), PASSPHRASE))
    home.show_library((reported.args or [])[0])
    qtbot.waitUntil(lambda: bool(home.page.sessions.lines))
    home.page.panel.analyse_again.trigger()
    qtbot.waitUntil(lambda: len(home.again.page.ticked) == 2)
    assert home.bar.primary.text().startswith("Analyse 2 sessions")
    home.again.analyse()
    assert home.current is home.working
    qtbot.waitUntil(lambda: home.current is home.again.page)
    assert "2 could not be" in home.banner.text
    qtbot.waitUntil(lambda: "missing" in home.again.page.list.as_text())
    controller.finish()
    home.finish()

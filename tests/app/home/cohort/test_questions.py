"""Questions from home: a table is chosen, asked beside the screen, remembered, saved, and gone when somebody leaves."""

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QObject, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.cohort.study.groups import Grouping, GroupQuestion, answer
from app.cohort.study.parameter_table import ParameterTable
from app.home.cohort.cohort_page import QuestionsPage
from app.home.home import QUESTIONS, Home
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from app.system.settings import Settings
from app.workers.library_controller import LibraryController
from tests.app.cohort.study.study_tables import MEASURE, random_rows, write_rows
from tests.app.watchdog import Watchdog
from tests.simulated import SHORT_VISIT, session_of


@pytest.fixture
def table(tmp_path: Path) -> Path:
    (tmp_path / "batch").mkdir()
    path = write_rows(random_rows(7, 30), tmp_path / "batch" / "parameters.parquet")
    with ParameterTable.opened(path):  # imports what the product imports once, without pandas beside it
        return path


def asked(qtbot: QtBot, home: Home, table: Path) -> QuestionsPage:
    home.rail.step_pressed.emit(QUESTIONS)
    home.questions.open(table)
    page = home.questions.page
    qtbot.waitUntil(lambda: page.found is not None)
    return page


def test_home_leads_to_the_page_which_states_how_a_table_comes_to_be(home: Home) -> None:
    row = home.rail.rows[QUESTIONS]
    assert row.text() == "Cohort"
    row.click()
    page = home.questions.page
    assert home.current is page
    assert page.make_table.hasFocus()
    assert home.rail.rows[QUESTIONS].is_current
    assert not home.bar.primary.isVisible()
    home.escape()
    assert home.page.isVisible()


def test_a_table_is_asked_beside_the_screen_and_each_change_again(
    qtbot: QtBot, home: Home, table: Path, watchdog: Watchdog
) -> None:
    page = asked(qtbot, home, table)
    assert page.sentence.text().startswith("Walking speed: means of ")
    QTest.keyClicks(page.measure, "K")  # as a list of choices takes letters
    required = GroupQuestion(MEASURE, Grouping.CONDITION)
    qtbot.waitUntil(lambda: page.found is not None and page.found.question == required)
    page.grouping.setCurrentIndex(page.grouping.findData("age"))  # while the first is asked, the last of these waits
    page.grouping.setCurrentIndex(page.grouping.findData("side"))
    page.included.choose("care")
    required = GroupQuestion(MEASURE, Grouping.SIDE, has_care=True)
    qtbot.waitUntil(lambda: page.found is not None and page.found.question == required)


def test_everything_is_reached_by_tab_in_the_order_of_reading(qtbot: QtBot, home: Home, table: Path) -> None:
    page = asked(qtbot, home, table)
    page.choose_table.setFocus()
    reached = []
    for _ in range(6):
        reached.append(home.focusWidget())
        QTest.keyClick(home.focusWidget(), Qt.Key.Key_Tab)
    included = next(one for one in page.included.segments if one.isChecked())
    required = [page.choose_table, page.measure, page.grouping, included, page.simulated, page.table]
    assert reached == required


def test_what_is_shown_is_the_answer_and_is_saved_with_all_its_numbers(
    qtbot: QtBot, home: Home, table: Path, tmp_path: Path
) -> None:
    page = asked(qtbot, home, table)
    assert page.found is not None
    with ParameterTable.opened(table) as opened:
        required = answer(opened, page.found.question)
    assert [one.group for one in page.found.rows] == [one.group for one in required.rows]
    # two threads add up in any order
    assert [one.mean for one in page.found.rows] == pytest.approx(
        [one.mean for one in required.rows], rel=1e-12, nan_ok=True
    )
    assert home.bar.primary.text() == "Save as CSV"
    out = tmp_path / "groups.csv"
    home.questions.write(out)
    qtbot.waitUntil(lambda: "Groups saved." in home.banner.text)
    with out.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["group"] for row in rows] == [one.group for one in page.found.rows]
    assert [float(row["mean"]) for row in rows] == [one.mean for one in page.found.rows]
    home.questions.write(tmp_path)  # a folder
    qtbot.waitUntil(lambda: "The groups could not be saved" in home.banner.text)


def test_the_last_table_is_asked_again_the_next_time(qtbot: QtBot, home: Home, settings: Settings, table: Path) -> None:
    asked(qtbot, home, table)
    assert settings.latest_table == str(table)
    home.clear()
    page = home.questions.page
    assert (page.found, page.question) == (None, None)
    home.rail.step_pressed.emit(QUESTIONS)
    qtbot.waitUntil(lambda: page.found is not None)


def test_a_table_that_is_gone_is_not_asked_for(home: Home, settings: Settings, tmp_path: Path) -> None:
    settings.latest_table = str(tmp_path / "gone.parquet")
    home.rail.step_pressed.emit(QUESTIONS)
    assert not home.questions.page.refusal.isVisible()
    assert home.questions.page.first_table.isVisible()


def test_a_file_that_is_no_table_is_refused_in_words(
    qtbot: QtBot, home: Home, settings: Settings, table: Path, tmp_path: Path
) -> None:
    page = asked(qtbot, home, table)
    broken = tmp_path / "broken.parquet"
    broken.write_bytes(b"PAR1")
    home.questions.open(broken)
    qtbot.waitUntil(page.refusal.isVisible)
    assert "broken.parquet: the file is not a readable Parquet file" in page.refusal.text
    assert "parquet written by gaitwright batch" in page.refusal.text
    assert page.question is None
    assert settings.latest_table == str(table)
    assert not home.bar.primary.isVisible()


def test_where_no_session_has_a_recording_no_table_is_made_and_the_page_states_why(
    qtbot: QtBot, home: Home, tmp_path: Path
) -> None:
    home.rail.step_pressed.emit(QUESTIONS)
    home.again.write(tmp_path / "made", None)
    qtbot.waitUntil(lambda: "no session in this library has a recording" in home.banner.text.lower())
    page = home.questions.page
    assert home.current is page
    assert page.make_table.isVisible()
    assert not page.measure.isVisible()


@pytest.mark.endurance
def test_a_table_of_the_whole_library_is_made_and_asked_by_one_button(
    qtbot: QtBot, home: Home, controller: LibraryController, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = session_of(SHORT_VISIT)
    kept: list[object] = []

    class Keeper(QObject):
        def on_done(self, result: object) -> None:
            kept.append(result)

    keeper, room = Keeper(), Room(start_bytes=0, kept_bytes=0)
    controller.run(
        lambda opened: import_session(opened, session, lambda *_: None, "DEMO-1", room=room),
        keeper.on_done,
        None,
        keeper,
    )
    qtbot.waitUntil(lambda: bool(kept))
    asked_in: list[object] = []

    def choose(_window: object, _title: str, _proposed: object, chosen: Callable[[str], None]) -> None:
        asked_in.append(home.current)
        chosen(str(tmp_path / "made"))

    monkeypatch.setattr("app.home.again.controller.ask_for_new_folder", choose)
    monkeypatch.setattr("app.home.again.controller.processors", lambda: 1)
    home.rail.step_pressed.emit(QUESTIONS)
    page = home.questions.page
    page.make_table.click()
    assert asked_in == [page]
    assert home.working.isVisible()
    qtbot.waitUntil(lambda: page.found is not None)
    assert home.current is page
    assert page.measure.isVisible()
    assert not page.make_table.isVisible()
    assert (tmp_path / "made" / "parameters.parquet").exists()

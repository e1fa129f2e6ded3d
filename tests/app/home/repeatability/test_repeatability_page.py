"""The clinic's own figures on their page: from a file or the library, used by all differences, and given up again."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.cohort.repeatability.study import FIGURES, write_figures
from app.home.home import QUESTIONS, Home
from app.home.repeatability.repeatability_page import RepeatabilityPage, study_sentence
from app.workers.library_controller import LibraryController
from core.verdicts.sigmas import PUBLISHED, in_use, use
from tests.app.cohort.repeatability.own_study import own_study
from tests.app.home.home_library import open_library

OWN = "Error figures: own study, 20 people, 12 Nov 2026."


@pytest.fixture(autouse=True)
def _published_again() -> Iterator[None]:
    yield
    use(PUBLISHED)  # the controller's thread may still have the library open


@pytest.fixture
def shown(qtbot: QtBot, home: Home) -> RepeatabilityPage:
    """The page as Cohort leads to it."""
    home.rail.step_pressed.emit(QUESTIONS)
    next(one for one in home.bar.state.quiet if one.text == "Repeatability").run()
    page = home.repeatability.page
    assert home.current is page
    assert page.used.text() == "Error figures: published."
    return page


def press(home: Home, words: str) -> None:
    state = home.bar.state
    next(one for one in (state.primary, *state.others, *state.quiet) if one is not None and one.text == words).run()


def test_figures_of_a_file_are_used_by_every_difference_and_given_up_again(
    qtbot: QtBot, home: Home, shown: RepeatabilityPage, controller: LibraryController, folder: Path, tmp_path: Path
) -> None:
    write_figures(own_study(), tmp_path)
    home.repeatability.open(tmp_path / FIGURES)
    assert in_use() is PUBLISHED  # to look at figures is not to use them
    press(home, "Use these figures")
    qtbot.waitUntil(lambda: shown.used.text() == OWN)
    assert in_use().study is not None
    open_library(qtbot, controller, home, folder)  # at the next start
    assert in_use().study is not None
    home.questions.repeatability_requested.emit()
    qtbot.waitUntil(lambda: shown.own is not None)
    press(home, "Use published figures")
    qtbot.waitUntil(lambda: shown.used.text() == "Error figures: published.")
    assert in_use() is PUBLISHED


def test_a_library_without_such_walks_is_refused_with_what_to_do(
    qtbot: QtBot, home: Home, shown: RepeatabilityPage
) -> None:
    press(home, "Calculate from this library")
    qtbot.waitUntil(shown.refusal.isVisible)
    assert home.current is shown
    assert "0 of the 5 people needed" in shown.refusal.text
    assert "with the condition “repeatability”" in shown.refusal.text


def test_a_file_of_something_else_is_refused_and_simulated_figures_cannot_be_used(
    home: Home, shown: RepeatabilityPage, tmp_path: Path
) -> None:
    (tmp_path / FIGURES).write_text("{}", encoding="utf-8")
    home.repeatability.open(tmp_path / FIGURES)
    assert "is no study of repeatability" in shown.refusal.text
    assert shown.own is None
    write_figures(own_study(is_simulated=True), tmp_path)
    home.repeatability.open(tmp_path / FIGURES)
    assert not shown.refusal.isVisible()
    primary = home.bar.state.primary
    assert primary is not None
    assert (primary.text, primary.is_enabled) == ("Use these figures", False)
    assert shown.sentence.text().startswith("SIMULATED.")


def test_the_page_states_each_figure_with_its_limits_beside_the_published_one(qtbot: QtBot) -> None:
    page = RepeatabilityPage()
    qtbot.addWidget(page)
    page.show_study(own_study(), ())
    cells = [[cell.words for cell in row.cells] for row in page.table.cells.rows]
    assert cells[1] == ["Stance, %", "1.65", "1.32 to 2.31", "20", "1.10", "own is higher"]
    assert cells[3] == ["Stance, %", "3.20", "2.50 to 4.30", "20", "4.00", "within limits"]
    assert study_sentence(own_study()) == "20 people measured on different days. 10 Nov 2026 to 12 Nov 2026."
    assert study_sentence(own_study(people=6)).endswith("Preliminary: fewer than 10 people.")

"""A session beside an optical system, in the window: chosen, compared, read, refused and saved."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from app.results.agreement_controller import AgreementController
from app.results.agreement_page import AgreementPage
from app.widgets.text import Text
from app.workers.background import Background
from core.results import Analysis
from core.session import Session
from devices.simulation.walker import SessionTruth
from tests.app.reports.agreement.agreement_material import SETTINGS, rows_of, write_reference
from tests.simulated import analysis_of, simulation_of


@pytest.fixture(scope="module")
def walked() -> tuple[Session, Analysis, SessionTruth]:
    simulated = simulation_of(SETTINGS)
    return simulated.session, analysis_of(simulated.session), simulated.truth


@pytest.fixture
def parent(qapp: QObject) -> Iterator[QObject]:
    """What the controller and its thread belong to, until the thread has ended."""
    parent = QObject()
    yield parent
    for background in parent.findChildren(Background):
        background.finish()


@pytest.fixture
def page(qtbot: QtBot) -> AgreementPage:
    page = AgreementPage()
    qtbot.addWidget(page)
    page.resize(1064, 680)
    page.show()
    return page


@pytest.fixture
def controller(
    page: AgreementPage, parent: QObject, walked: tuple[Session, Analysis, SessionTruth]
) -> AgreementController:
    controller = AgreementController(page, Background(parent), parent)
    controller.show(walked[0], walked[1])
    return controller


def words(page: AgreementPage) -> str:
    return " ".join(text.text() for text in page.waiting.findChildren(Text))


def test_before_anything_is_chosen_it_states_what_can_be(page: AgreementPage, controller: AgreementController) -> None:
    assert words(page).startswith("Choose the optical system's file Accepted files: CSV with time_s and left_knee")
    assert page.waiting.button.text() == "Choose reference file"
    assert not page.save.isVisible()


def test_pages_are_shown_and_saved_as_the_command_saves_them(
    qtbot: QtBot,
    page: AgreementPage,
    controller: AgreementController,
    walked: tuple[Session, Analysis, SessionTruth],
    tmp_path: Path,
) -> None:
    reference = write_reference(tmp_path / "walk 1.csv", rows_of(walked[2], "walk 1"))
    controller.compare([reference])
    assert words(page).startswith("Searching walk 1.csv for the recorded walks.")
    qtbot.waitUntil(lambda: page.sheets.count > 1)
    assert page.save.isVisible()
    assert page.note.text() == "Not compared, no matching recording: walk 2."
    asked: list[tuple[Path, Callable[[], None]]] = []
    controller.writing.connect(lambda folder, write: asked.append((folder, write)))
    page.save.click()
    (dialog,) = page.findChildren(QFileDialog)
    dialog.fileSelected.emit(str(tmp_path / "agreement"))
    dialog.close()
    ((folder, write),) = asked
    write()
    assert (folder / "agreement.pdf").read_bytes().startswith(b"%PDF")
    assert (folder / "figure_8_knee.svg").exists()
    page.show_saved(folder.name)
    assert page.note.text() == "Saved in agreement."


def test_what_is_no_reference_is_refused_in_its_place(
    qtbot: QtBot,
    page: AgreementPage,
    controller: AgreementController,
    walked: tuple[Session, Analysis, SessionTruth],
    tmp_path: Path,
) -> None:
    strange = tmp_path / "notes.txt"
    strange.write_text("no angles\n", encoding="utf-8")
    controller.compare([strange])
    qtbot.waitUntil(lambda: page.waiting.button.text() == "Choose another file")
    assert words(page).startswith("notes.txt: ")
    assert page.sheets.count == 0
    controller.show(walked[0], walked[1])  # left, and asked for again
    assert words(page).startswith("Choose the optical system's file")


@pytest.mark.endurance
def test_of_another_analysis_nothing_stays_in_sight(
    qtbot: QtBot,
    page: AgreementPage,
    controller: AgreementController,
    walked: tuple[Session, Analysis, SessionTruth],
    tmp_path: Path,
) -> None:
    session, analysis, truth = walked
    controller.compare([write_reference(tmp_path / "walk 1.csv", rows_of(truth, "walk 1"))])
    qtbot.waitUntil(lambda: page.sheets.count > 1)
    controller.show(session, analysis)
    assert page.sheets.count > 1
    controller.show(session, analysis_of(session))
    assert page.sheets.count == 0


def test_walks_are_called_as_on_the_screen_and_pages_are_drawn_finer_in_a_larger_window(
    qtbot: QtBot,
    page: AgreementPage,
    controller: AgreementController,
    walked: tuple[Session, Analysis, SessionTruth],
    tmp_path: Path,
) -> None:
    session, analysis, truth = walked
    conditions = {"walk 1": "Barefoot", "walk 2": "AFO"}
    named = tuple(replace(one, condition=conditions.get(one.name, "")) for one in session.recordings)
    page.resize(700, 680)
    controller.show(replace(session, recordings=named), replace(analysis))
    controller.compare([write_reference(tmp_path / "walk 1.csv", rows_of(truth, "walk 1"))])
    qtbot.waitUntil(lambda: page.sheets.count > 1)
    assert page.note.text() == "Not compared, no matching recording: B AFO."
    coarse, count = page.sheets.pages[0].width, page.sheets.count
    page.resize(1400, 680)
    qtbot.waitUntil(lambda: page.sheets.pages[0].width > coarse)
    assert page.sheets.count == count
    assert page.note.text() == "Not compared, no matching recording: B AFO."

"""What tests of home get: the thread that has the library, settings of their own, home with two patients."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.storage.keys import KeySlots
from app.system import kept_json
from app.system.settings import Settings
from app.workers.library_controller import LibraryController
from core.session import Patient, Session
from tests.app.home.home_library import open_library
from tests.quick_library import CHEAP, quick_library


@pytest.fixture(autouse=True)
def tables_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Where this test keeps what is stated of tables."""
    place = tmp_path / "config" / "tables.json"
    monkeypatch.setattr(kept_json, "place_of", place.with_name)
    return place


@pytest.fixture(autouse=True)
def quick_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys that the program derives cost next to nothing, as those of `quick_library`."""
    monkeypatch.setattr(KeySlots.__init__, "__defaults__", (CHEAP,))


@pytest.fixture
def controller(qtbot: QtBot) -> Iterator[LibraryController]:
    controller = LibraryController()
    yield controller
    controller.finish()


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A closed library of `hk` with two patients, the second of whom was here three times."""
    folder = tmp_path_factory.mktemp("home")
    with quick_library(folder) as opened:
        library = opened.library
        library.patients.create(Patient(code="P-0147", birth_year=1968, device="microprocessor knee"))
        patient = library.patients.create(Patient(code="P-0163", birth_year=1951, sex="female", affected_side="right"))
        for month in (3, 4, 5):
            library.sessions.create(patient.id, Session((), started=f"2026-0{month}-20T09:00:00"))
    return folder


@pytest.fixture
def folder(untouched: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(untouched, tmp_path / "library"))


@pytest.fixture
def home(
    qtbot: QtBot, qapp: QApplication, controller: LibraryController, settings: Settings, folder: Path
) -> Iterator[Home]:
    home = Home(controller, settings)
    home.resize(1280, 800)
    qtbot.addWidget(home)
    with qtbot.waitActive(home):
        home.show()
        home.activateWindow()
    open_library(qtbot, controller, home, folder)
    yield home
    home.finish()

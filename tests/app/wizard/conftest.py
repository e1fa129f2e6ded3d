"""A visit on the demonstration patient, whose time runs faster than ours."""

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.slots import Cost
from app.storage.stored import Operator, Role
from app.system.settings import Settings
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from app.wizard.wizard import Wizard
from app.wizard.worn_sensors import SourceChoice
from app.workers.library_controller import LibraryController
from core.body import LEG_SITES, Site
from core.session import Patient, Session
from devices.emulators.dot_faults import DotFaults
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk
from tests.app.wizard.begun_visit import begin, save_patient
from tests.app.wizard.dressed_patient import Worn, dressed_patient
from tests.app.wizard.present import present
from tests.devices.dot.fast_radio import FastRadio
from tests.simulated import session_of

PASSPHRASE = "four short words here"
SPEED = 20.0


@pytest.fixture(scope="session")
def simulated_session() -> Session:
    played = (Standing(duration_s=10.0), FreeMotion(duration_s=30.0), Walk(strides=14), Walk("walk 2", strides=14))
    return session_of(replace(DEMONSTRATION, recordings=played))


@pytest.fixture(scope="session")
def untouched_library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A closed library of one operator, with one patient."""
    folder = tmp_path_factory.mktemp("wizard")
    slots = KeySlots(folder / KEYS, Cost(passes=1, memory_kib=64))
    data_key, recovery_key = slots.create("hk", PASSPHRASE)
    slots.confirm_recovery_key(recovery_key)
    with Library.create(folder, data_key, Operator("hk", "H. Keller", Role.ADMINISTRATOR)) as library:
        library.patients.create(Patient(code="DEMO-1"))
    return folder


@pytest.fixture
def controller(qtbot: QtBot, untouched_library: Path, tmp_path: Path) -> Iterator[LibraryController]:
    controller = LibraryController()
    folder = shutil.copytree(untouched_library, tmp_path / "library")
    with qtbot.waitSignal(controller.opened):
        controller.open(lambda holder: holder.open(folder, PASSPHRASE))
    yield controller
    controller.finish()


@pytest.fixture
def library(controller: LibraryController) -> Library:
    """What the controller has open."""
    return present(controller.state).library.library


@pytest.fixture
def source(simulated_session: Session) -> ReplaySource:
    return ReplaySource(simulated_session, speed=SPEED)


@pytest.fixture
def radio() -> Iterator[FastRadio]:
    """Two DOTs in the air; who wears them takes `emulated_dots.dot_choice`."""
    radio = FastRadio([DotFaults(), DotFaults()])
    yield radio
    radio.close()


@pytest.fixture
def choice(source: ReplaySource) -> SourceChoice:
    """Where the visit's sensors are received; files about DOTs have their own."""
    return SourceChoice("fast", "Fast patient", lambda: Acquisition([source], source.now_ns), is_simulated=True)


@pytest.fixture
def visit(controller: LibraryController, choice: SourceChoice) -> Iterator[Visit]:
    visit = Visit(controller, [choice])
    yield visit
    visit.close()
    visit.finish()


@pytest.fixture
def begun(qtbot: QtBot, visit: Visit, worn: dict[str, Site]) -> Visit:
    """A visit with sensors on."""
    begin(qtbot, visit, worn)
    return visit


@pytest.fixture
def looked_at(qtbot: QtBot, begun: Visit, monkeypatch: pytest.MonkeyPatch) -> Iterator[Visit]:
    """The same, whose recordings nobody evaluates."""
    monkeypatch.setattr(begun, "evaluate", lambda: None)
    yield begun
    if begun.recordings.is_recording:
        with qtbot.waitSignal(begun.recordings.ended):
            begun.recordings.stop()


@pytest.fixture
def wizard(qtbot: QtBot, qapp: QApplication, controller: LibraryController, tmp_path: Path) -> Iterator[Wizard]:
    settings = Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))
    wizard = Wizard(controller, settings)
    qtbot.addWidget(wizard)
    wizard.resize(1280, 800)
    wizard.show()
    yield wizard
    wizard.finish()


@pytest.fixture
def worn() -> dict[str, Site]:
    return {f"DEMO-{site}": site for site in LEG_SITES}


@pytest.fixture
def step(qtbot: QtBot, visit: Visit) -> Iterator[SensorsStep]:
    """Sensors, entered; files about another step have their own."""
    save_patient(qtbot, visit, Patient(code="DEMO-7"))
    step = SensorsStep(visit)
    qtbot.addWidget(step.page)
    step.page.resize(1064, 672)
    step.page.show()
    with qtbot.waitSignal(visit.changed):
        step.enter()
    yield step
    step.leave()
    step.deleteLater()


@pytest.fixture(scope="session")
def dressed() -> Worn:
    """The simulated patient of the estimators' tests, who takes a few seconds to make."""
    return dressed_patient()

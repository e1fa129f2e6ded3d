"""A visit on the demonstration patient, whose time runs faster than ours."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from pytestqt.qtbot import QtBot

from app.acquisition.acquisition import Acquisition
from app.wizard.visit import Visit
from app.wizard.worn_sensors import SourceChoice
from app.workers.library_desk import LibraryDesk
from core.body import Site
from core.samples import Session
from devices.replay import ReplaySource
from devices.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate

SPEED = 20.0


@pytest.fixture(scope="session")
def simulated_session() -> Session:
    played = (Standing(duration_s=10.0), FreeMotion(duration_s=30.0), Walk(strides=14), Walk("walk 2", strides=14))
    return simulate(replace(DEMONSTRATION, recordings=played)).session


@pytest.fixture
def desk(qtbot: QtBot) -> Iterator[LibraryDesk]:
    desk = LibraryDesk()
    with qtbot.waitSignal(desk.opened, timeout=20_000):
        desk.open_demonstration()
    yield desk
    desk.finish()


@pytest.fixture
def source(simulated_session: Session) -> ReplaySource:
    return ReplaySource(simulated_session, speed=SPEED)


@pytest.fixture
def visit(desk: LibraryDesk, source: ReplaySource) -> Iterator[Visit]:
    choice = SourceChoice("fast", "Fast patient", lambda: Acquisition([source], source.now_ns), is_simulated=True)
    visit = Visit(desk, [choice])
    yield visit
    visit.close()
    visit.finish()


@pytest.fixture
def worn() -> dict[str, Site]:
    return {f"DEMO-{site}": site for site in Site}

"""A short session of a simulated patient's left leg, and the folder it is written to."""

from pathlib import Path

import pytest

from devices.files.session_folder import write_session
from devices.simulation.walker import SimulatedSession
from tests.example_sessions import ONE_LEG
from tests.simulated import simulation_of


@pytest.fixture(scope="session")
def simulated() -> SimulatedSession:
    return simulation_of(ONE_LEG)


@pytest.fixture(scope="session")
def folder(simulated: SimulatedSession, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("examples") / "session"
    write_session(simulated.session, place)
    return place

"""A short session of a simulated patient's left leg, and the folder it is written to."""

from pathlib import Path

import pytest

from core.body import Site
from devices.files.session_folder import write_session
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Walk, WalkerSettings
from tests.simulated import simulation_of

LEFT_LEG = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)


@pytest.fixture(scope="session")
def simulated() -> SimulatedSession:
    walk = Walk(strides=6, standing_before_s=3.0)  # long enough for a port to be opened meanwhile
    recordings = (Standing(duration_s=2.0), FreeMotion(duration_s=5.0), walk)
    return simulation_of(WalkerSettings(seed=3, sites=LEFT_LEG, recordings=recordings))


@pytest.fixture(scope="session")
def folder(simulated: SimulatedSession, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("examples") / "session"
    write_session(simulated.session, place)
    return place

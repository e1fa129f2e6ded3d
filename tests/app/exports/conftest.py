"""One simulated visit with typed names, its analysis and the CSV files of it, for every format."""

from dataclasses import replace
from pathlib import Path

import pytest

from app.exports.result_folder import write_results
from core.results import Analysis
from core.session import Session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings
from tests.simulated import analysis_of, session_of

NAME = "Miller"


@pytest.fixture(scope="session")
def visit() -> tuple[Session, Analysis]:
    """A visit in which everything that can be typed holds a name."""
    session = session_of(WalkerSettings(seed=2, recordings=(Standing(), FreeMotion(), Walk(strides=12))))
    recordings = tuple(
        replace(r, name=f"{r.name} {NAME}", folder=f"{r.folder}_{NAME}", note=NAME, condition="=barefoot")
        for r in session.recordings
    )
    session = replace(
        session,
        recordings=recordings,
        patient=replace(session.patient, code=NAME, birth_year=1950, sex="female"),
        operator=NAME,
        notes=NAME,
        started="2026-11-21T10:00:00+01:00",
    )
    return session, analysis_of(session)


@pytest.fixture(scope="session")
def tables(visit: tuple[Session, Analysis], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of results with its CSV files and summary.json."""
    folder = tmp_path_factory.mktemp("tables")
    write_results(*visit, folder)
    return folder

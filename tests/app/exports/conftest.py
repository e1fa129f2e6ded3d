"""One simulated visit with typed names, its analysis and the CSV files of it, for every format."""

from dataclasses import replace
from pathlib import Path

import pytest

from app.exports.exports import Format, export_from_folder
from app.exports.result_folder import write_results
from core.results import Analysis, RecordingAnalysis
from core.session import RecordingKind, Session
from devices.simulation.walker_truth import RecordingTruth
from tests.simulated import EXACT_WALK, analysis_of, session_of, simulation_of

NAME = "Miller"
OF_FIGURES = [Format.C3D, Format.FHIR, Format.MOT, Format.XLSX]
Visit = tuple[Session, Analysis]


@pytest.fixture(scope="session")
def visit() -> Visit:
    """A visit in which everything that can be typed holds a name."""
    session = session_of(EXACT_WALK)
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
def walk(visit: Visit) -> RecordingAnalysis:
    (found,) = (one for one in visit[1].recordings if one.kind is RecordingKind.WALKING)
    return found


@pytest.fixture(scope="session")
def truth() -> RecordingTruth:
    """What the walk of the visit was made of."""
    return simulation_of(EXACT_WALK).truth.recordings["walk 1"]


@pytest.fixture(scope="session")
def exported(visit: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Every format that states figures, with the CSV files."""
    folder = tmp_path_factory.mktemp("exported")
    export_from_folder(*visit, OF_FIGURES, folder, is_identified=True)
    write_results(*visit, folder)
    return folder


@pytest.fixture(scope="session")
def tables(visit: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of results with its CSV files and summary.json."""
    folder = tmp_path_factory.mktemp("tables")
    write_results(*visit, folder)
    return folder

"""What was simulated stays so through every file that we write and read again, and nothing else becomes so."""

from dataclasses import replace
from pathlib import Path

import pytest

from app.exports.exports import Format, export_from_folder
from app.exports.result_folder import write_results
from app.importing.import_drafts import drafts_of, session_of
from app.reports.agreement.study import study_of
from core.body import Site
from core.session import Recording, RecordingKind, Session
from devices.files.answers import details_of, value_from
from devices.files.formats import format_of, read_trial
from devices.files.imports import add_recording, place_sensors
from devices.files.references.reading import read_reference
from devices.files.references.trial import ReferenceFile
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import read_session, write_session
from devices.files.trial import ImportedTrial
from devices.simulation.walker import Walk, WalkerSettings
from tests.app.exports.conftest import Visit
from tests.simulated import analysis_of
from tests.simulated import session_of as simulated

SITES = (Site.LEFT_THIGH, Site.LEFT_SHANK)


@pytest.fixture(scope="module")
def walked() -> Visit:
    session = simulated(WalkerSettings(seed=2, recordings=(Walk(strides=3),), sites=SITES))
    return session, analysis_of(session)


def everything_written(walked: Visit, is_simulated: bool, folder: Path) -> Path:
    """All formats of exports, the results of an analysis, and the session folder."""
    session, analysis = replace(walked[0], is_simulated=is_simulated), replace(walked[1], is_simulated=is_simulated)
    export_from_folder(session, analysis, list(Format), folder, is_identified=True)
    write_results(session, analysis, folder / "results")
    write_session(session, folder / "session")
    return folder


def read_back(folder: Path) -> dict[str, ImportedTrial]:
    """Every file that any of our readers takes, by its place."""
    found = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        try:
            name = format_of(path)
            if name is not None:
                found[str(path.relative_to(folder))] = read_trial(name, [path], None)
        except FileRefusedError:  # recognised by its letters, and none that holds samples
            continue
    return found


@pytest.mark.parametrize("is_simulated", [True, False])
def test_every_file_that_can_be_read_again_states_who_was_measured(
    walked: Visit, is_simulated: bool, tmp_path: Path
) -> None:
    found = read_back(everything_written(walked, is_simulated, tmp_path))
    assert {trial.format for trial in found.values()} == {"bids-motion", "csv"}
    assert {place for place, trial in found.items() if trial.is_simulated is not is_simulated} == set()
    assert read_session(tmp_path / "session").is_simulated is is_simulated
    for trial in found.values():  # as it comes from the process that reads, and as the window makes a session of it
        arrays: list[object] = []
        assert value_from(ImportedTrial, details_of(trial, arrays), arrays).is_simulated is is_simulated  # type: ignore[arg-type]  # of any kind
        (draft,) = drafts_of([("walk", trial)])
        sites = dict(zip((one.key for one in draft.sensors), SITES, strict=False))
        assert session_of(draft, [RecordingKind.WALKING], sites).is_simulated is is_simulated


@pytest.mark.parametrize("is_simulated", [True, False])
def test_a_reference_that_was_simulated_marks_what_is_compared_with_it(
    visit: Visit, is_simulated: bool, tmp_path: Path
) -> None:
    """`agree` with our own C3D or OpenSim export of a simulated patient, of somebody who was measured."""
    session, analysis = visit
    export_from_folder(
        session, replace(analysis, is_simulated=is_simulated), [Format.C3D, Format.MOT], tmp_path, is_identified=True
    )
    found = {path.suffix: read_reference(path) for path in tmp_path.glob("walk*/angles.*")}
    assert set(found) == {".c3d", ".mot"}
    for name, reference in found.items():
        arrays: list[object] = []
        assert value_from(ReferenceFile, details_of(reference, arrays), arrays).is_simulated is is_simulated  # type: ignore[arg-type]  # of any kind
        assert study_of(replace(analysis, is_simulated=False), [(name, reference)]).is_simulated is is_simulated
    assert study_of(replace(analysis, is_simulated=True), [(name, reference)]).is_simulated


def test_what_was_simulated_joins_no_session_of_a_patient(walked: Visit, tmp_path: Path) -> None:
    found = read_back(everything_written(walked, True, tmp_path))
    trial = next(trial for trial in found.values() if trial.format == "bids-motion")
    imported = place_sensors(trial, list(zip(SITES, trial.sensors, strict=True)), "walk 2")
    later = Recording("walk 2", RecordingKind.WALKING, "walk_2", imported.imu)
    assert imported.is_simulated
    assert add_recording(Session(()), later, is_simulated=True).is_simulated
    assert add_recording(walked[0], later).is_simulated
    measured = replace(walked[0], is_simulated=False)
    assert not add_recording(measured, later).is_simulated
    with pytest.raises(FileRefusedError, match="simulated"):
        add_recording(measured, later, is_simulated=True)

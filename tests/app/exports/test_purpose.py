"""Tests that every file that leaves states what it is for, and whether anybody was measured."""

from dataclasses import replace
from pathlib import Path
from zipfile import ZipFile

import pytest

from app.exports.exports import Format, export_from_folder
from core.results import Analysis
from core.session import Session

PURPOSE = b"Research use. Not a medical device."
SIMULATED = b"SIMULATED: nobody was measured."


def contents(files: list[Path]) -> bytes:
    """Everything that is in the files, archives unzipped."""
    found = b""
    for file in files:
        if file.suffix == ".xlsx":
            with ZipFile(file) as archive:
                found += b"".join(archive.read(name) for name in archive.namelist())
        else:
            found += file.read_bytes()
    return found


@pytest.mark.endurance
@pytest.mark.parametrize("required", Format)
@pytest.mark.parametrize("is_simulated", [True, False])
def test_every_export_states_what_it_is_for_and_whether_it_is_simulated(
    visit: tuple[Session, Analysis], tmp_path: Path, required: Format, is_simulated: bool
) -> None:
    session, analysis = visit
    measured = {site: replace(info, model="MTi") for site, info in session.sensors.items()}
    session = session if is_simulated else replace(session, is_simulated=False, sensors=measured)
    export_from_folder(session, replace(analysis, is_simulated=is_simulated, findings=()), [required], tmp_path)
    stated = contents([file for file in tmp_path.rglob("*") if file.is_file()])
    assert PURPOSE in stated
    assert (SIMULATED in stated) is is_simulated

"""What is exported and can be imported gives the same figures again: session folder, its tables alone, BIDS-Motion."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest

from app.exports.bids_motion import write_bids
from app.exports.exports import Format, export_from_folder
from app.exports.summary import summarise
from app.summary.events import events_of
from core.body import LEG_JOINTS, Site
from core.results import Analysis
from core.session import Recording, Session
from devices.files.formats import read_trial, recognised
from devices.files.imports import add_recording, place_trial
from devices.files.session_folder import read_session, write_session
from devices.files.site_names import site_of_name
from tests.app.exports.conftest import Visit
from tests.simulated import analysis_of

TASKS = {"standing": "standing", "free_motion": "freeMotion", "walking": "walking"}


def imported(
    session: Session, files_of: Callable[[Recording], list[Path]], format_name: str, *, is_one_receiver: bool = True
) -> Session:
    """All recordings imported, each from its files, into a session of what people state: tables name no clock."""
    found = replace(session, recordings=(), sensors={}, findings=(), is_simulated=False)
    for recording in session.recordings:
        files = files_of(recording)
        assert recognised(files) == format_name
        trial = read_trial("", files, None)
        names = {site: sensor.name for sensor in trial.sensors if (site := site_of_name(sensor.name)) is not None}
        placed = place_trial(trial, names, recording.name, is_one_receiver=is_one_receiver)
        again = replace(recording, imu=placed.imu)
        found = add_recording(found, again, placed.sensors, placed.findings, is_simulated=placed.is_simulated)
    return found


def as_folder(session: Session, _: Analysis, folder: Path) -> Session:
    write_session(session, folder / "session")
    return read_session(folder / "session")


def as_parquet(session: Session, analysis: Analysis, folder: Path) -> Session:
    as_folder(session, analysis, folder)
    in_parquet(folder / "session")
    return read_session(folder / "session")


def in_parquet(folder: Path) -> None:
    for path in sorted(folder.glob("*/*.csv")):
        pyarrow.parquet.write_table(pyarrow.csv.read_csv(path), path.with_suffix(".parquet"))
        path.unlink()


def as_tables(session: Session, analysis: Analysis, folder: Path) -> Session:
    as_folder(session, analysis, folder)
    return imported(session, lambda one: sorted((folder / "session" / one.folder).glob("*.csv")), "csv")


def as_parquet_tables(session: Session, analysis: Analysis, folder: Path) -> Session:
    as_parquet(session, analysis, folder)
    return imported(session, lambda one: sorted((folder / "session" / one.folder).glob("*.parquet")), "parquet")


def as_bids(session: Session, analysis: Analysis, folder: Path) -> Session:
    write_bids(session, analysis, folder)

    def files_of(one: Recording) -> list[Path]:
        return sorted(folder.rglob(f"*_task-{TASKS[one.kind]}_*_motion.tsv"))

    return imported(session, files_of, "bids-motion", is_one_receiver=False)


WAYS = {
    "session folder": as_folder,
    "session folder, Parquet": as_parquet,
    "tables": as_tables,
    "tables, Parquet": as_parquet_tables,
    "BIDS-Motion": as_bids,
}


def figures(session: Session, analysis: Analysis) -> Mapping[str, Any]:
    """Everything but what was noticed, which names how files were read."""
    return {key: value for key, value in summarise(analysis, session.recordings).items() if key != "findings"}


@pytest.mark.parametrize("name", WAYS)
def test_what_comes_back_has_the_same_figures_events_and_marks(visit: Visit, name: str, tmp_path: Path) -> None:
    session, analysis = visit
    back = WAYS[name](session, analysis, tmp_path)
    again = analysis_of(back)
    assert back.is_simulated
    assert again.is_simulated
    assert [(one.name, one.kind, one.condition) for one in back.recordings] == [
        (one.name, one.kind, one.condition) for one in session.recordings
    ]
    for recording, was in zip(back.recordings, session.recordings, strict=True):
        assert set(recording.imu) == set(was.imu) >= {Site.LEFT_THIGH, Site.RIGHT_FOOT}
        for site, block in recording.imu.items():
            for values in ("time_s", "acc_m_s2", "gyr_rad_s"):
                np.testing.assert_array_equal(getattr(block, values), getattr(was.imu[site], values))
    assert figures(back, again) == figures(session, analysis)
    for walk, known in zip(again.recordings, analysis.recordings, strict=True):
        assert events_of(walk) == events_of(known)
    assert events_of(again.recordings[-1])


def test_orientations_for_opensim_come_back_with_the_ranges_of_the_joints(visit: Visit, tmp_path: Path) -> None:
    """Orientations alone, whose rates are derived: within a degree."""
    session, analysis = visit
    export_from_folder(session, analysis, [Format.STO], tmp_path, is_identified=True)
    written = {path.parent.name: path for path in tmp_path.rglob("*.sto")}
    assert set(written) == {one.folder for one in session.recordings}
    back = imported(session, lambda one: [written[one.folder]], "opensim", is_one_receiver=False)
    again = analysis_of(back)
    assert again.is_simulated
    walk, known = again.recordings[-1], analysis.recordings[-1]
    for joint in LEG_JOINTS:
        angles = (walk.joints[joint].angle_rad, known.joints[joint].angle_rad)
        found, was = (np.rad2deg(np.nanmax(angle) - np.nanmin(angle)) for angle in angles)
        assert was > 25.0
        assert abs(found - was) < 1.0


def test_figures_of_another_walk_differ(visit: Visit) -> None:
    """Else the comparison above could not fail."""
    session, analysis = visit
    walk = session.recordings[-1]
    slower = {
        site: replace(block, gyr_rad_s=block.gyr_rad_s * (1.01 if site is Site.LEFT_SHANK else 1.0))
        for site, block in walk.imu.items()
    }
    other = replace(session, recordings=(*session.recordings[:-1], replace(walk, imu=slower)))
    assert figures(other, analysis_of(other)) != figures(session, analysis)

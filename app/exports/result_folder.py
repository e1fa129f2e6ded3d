"""Place where an analysis is written, and what it may replace there.

A folder of results is written beside its place and renamed, so that it is whole or not there. Recordings are never
replaced: a place that holds any is refused, but for the session of which the results stand around it (`OUT/session`).
"""

import shutil
import tempfile
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from app.exports.columns import COLUMNS, write_columns
from app.exports.csv_report import write_angles
from app.exports.csvw import METADATA, write_metadata
from app.exports.fitting_csv import MEANS as FITTING_MEANS
from app.exports.fitting_csv import fitting_means, write_fitting_strides
from app.exports.gait_csv import peak_table, write_gait
from app.exports.goals_csv import GOALS, goal_rows
from app.exports.goals_csv import HEADER as GOAL_COLUMNS
from app.exports.summary import FORMAT, write_summary
from app.exports.timed_csv import HEADER as TIMED_COLUMNS
from app.exports.timed_csv import TIMED, timed_rows
from app.summary.agreed import agreed_with
from app.summary.alignments import ALIGNMENTS, write_alignments
from app.summary.comparison import Comparison, Contrast, first_and_second
from app.summary.conditions import conditions_of
from app.summary.differences import (
    COMPARED_CYCLES,
    DIFFERENCES,
    SIDES,
    rows_along_chain,
    write_compared_cycles,
    write_differences,
    write_sides,
)
from app.summary.prosthesis_fitting import SET_ANGLES, fitting_of, write_set_angles
from app.summary.targets import HEADER as TARGET_COLUMNS
from app.summary.targets import TARGETS, target_rows
from app.system.tables import MOST_BYTES, is_free, read_json, write_table
from core.results import Analysis
from core.session import Session
from devices.files.refusal import FileRefusedError
from devices.files.session_toml import FILE_NAME as SESSION_FILE

SUMMARY = "summary.json"
ANGLES = "angles.csv"
PEAKS = "peaks.csv"
LOG = "session.rrd"
REPORT = "report.pdf"
WORKBOOK = "results.xlsx"  # beside each report
OWN_SESSION = "session"  # the demonstration's recordings, inside the folder of its results
VISITS, VISITS_CYCLES = "visits.csv", "visits_cycles.csv"  # where a report compares with an earlier visit
TAKEN = tuple(
    (name,)
    for name in (
        *(SUMMARY, LOG, REPORT, WORKBOOK, OWN_SESSION),
        *(PEAKS, FITTING_MEANS, ALIGNMENTS, SET_ANGLES, DIFFERENCES, COMPARED_CYCLES, SIDES, TARGETS, GOALS, TIMED),
        *(VISITS, VISITS_CYCLES, COLUMNS, METADATA),
    )
)


def write_results(session: Session, analysis: Analysis, folder: Path) -> None:
    """Write every table of an analysis and its summary into `folder`; raises FileRefusedError or OSError."""
    for recording in analysis.recordings:
        if PurePosixPath(recording.folder).parts[:1] in TAKEN:
            what = f"its folder {recording.folder} has the name of one of the results"
            raise FileRefusedError(recording.name, what, "Give this recording's folder another name")
        (folder / recording.folder).mkdir(parents=True, exist_ok=True)
        write_angles(recording, folder / recording.folder / ANGLES)
        write_gait(recording, folder / recording.folder)
        write_fitting_strides(recording, folder / recording.folder)
    if any(recording.gait for recording in analysis.recordings):
        write_table(*peak_table(analysis.recordings), folder / PEAKS)
        write_table(*fitting_means(analysis.recordings), folder / FITTING_MEANS)
    if goals := [*goal_rows(analysis, session.recordings, agreed_with(session))]:
        write_table(GOAL_COLUMNS, goals, folder / GOALS)
    if targets := [*target_rows(session.recordings)]:
        write_table(TARGET_COLUMNS, targets, folder / TARGETS)
    if tests := [*timed_rows(analysis, session.recordings)]:
        write_table(TIMED_COLUMNS, tests, folder / TIMED)
    _write_comparisons(session, analysis, folder)
    describe_tables(analysis, folder)
    write_summary(analysis, folder / SUMMARY, session.recordings, agreed_with(session))


def describe_tables(analysis: Analysis, folder: Path) -> None:
    """Write the meanings of the tables' columns, again after a table was added; raises OSError."""
    recordings = [recording.folder for recording in analysis.recordings]
    write_columns(folder, recordings)
    write_metadata(folder, recordings)


def _write_comparisons(session: Session, analysis: Analysis, folder: Path) -> None:
    """The conditions of the session, each against the first and the one it was changed from, and the legs of each."""
    parts = conditions_of(analysis, session.recordings, agreed=agreed_with(session))
    write_alignments(session.recordings, folder / ALIGNMENTS)
    write_set_angles(fitting_of(session, analysis), folder / SET_ANGLES)
    if len(parts) > 1:
        write_differences(rows_along_chain(Comparison(Contrast.CONDITIONS, parts)), folder / DIFFERENCES)
        write_compared_cycles(parts, folder / COMPARED_CYCLES)
    write_sides(parts, first_and_second(analysis.affected_side), folder / SIDES)


def check_place(out: Path, session: Path) -> None:
    """Raise FileRefusedError where the results of `session` may not stand at `out`."""
    out, session = out.resolve(), session.resolve()
    if out == session or session in out.parents:
        what = "this lies inside the session, which stays as it was recorded"
        raise FileRefusedError(str(out), what, "Choose a folder outside the session for --out")
    if is_free(out):
        return
    if read_json(out / SUMMARY, FORMAT) is None:
        raise FileRefusedError(str(out), "this already exists and is not an analysis", "Choose another --out")
    _refuse_recordings(out, out / OWN_SESSION if session == out / OWN_SESSION else None)


def check_demonstration_place(out: Path) -> None:
    """Raise FileRefusedError where anything but a demonstration is at `out`."""
    out = out.resolve()
    if is_free(out):
        return
    summary = read_json(out / SUMMARY, FORMAT)
    if summary is None or summary.get("simulated") is not True or not _is_simulated(out / OWN_SESSION):
        raise FileRefusedError(str(out), "this already exists and is not a demonstration", "Choose another --out")
    _refuse_recordings(out, out / OWN_SESSION)


def session_of(place: Path) -> Path:
    """Give the session folder of a place: itself, or the recordings inside the results that it holds.

    Raises
    ------
    FileRefusedError
        Results without their recordings: there are no angles in them to draw from.
    """
    if (place / SUMMARY).is_file() and not (place / SESSION_FILE).is_file():
        if (place / OWN_SESSION / SESSION_FILE).is_file():
            return place / OWN_SESSION
        what = "this holds results without the recordings they were made from"
        raise FileRefusedError(str(place), what, "Give the session folder instead")
    return place


@contextmanager
def written_beside(out: Path, *, keeps_session: bool = False, within: Path | None = None) -> Iterator[Path]:
    """Yield a folder to write into that replaces `out` at the end; an exception leaves `out` as it was.
    `keeps_session`: recordings in `out` stay; `within`: a folder of the same disk to write in meanwhile.
    """
    out = out.resolve()
    out.parent.mkdir(parents=True, exist_ok=True)
    beside = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=within or out.parent))
    new, old = beside / "new", beside / "old"
    try:
        new.mkdir()
        yield new
        _exchange(out, new, old, [OWN_SESSION] if keeps_session else [])
    finally:
        if out.exists() or not old.exists():  # else the old results could not be put back, and are left where they are
            shutil.rmtree(beside, ignore_errors=True)


def _exchange(out: Path, new: Path, old: Path, kept: list[str]) -> None:
    try:
        if out.exists():
            out.rename(old)
        for name in kept:
            (old / name).rename(new / name)
        new.rename(out)
    except BaseException:
        for name in kept:
            if (new / name).exists():
                (new / name).rename(old / name)
        if old.exists() and not out.exists():
            old.rename(out)
        raise


def _refuse_recordings(out: Path, own: Path | None) -> None:
    for file in sorted(out.rglob(SESSION_FILE)):
        if file.parent != own:
            what = "this holds recordings, which are never replaced"
            raise FileRefusedError(str(file.parent), what, "Choose another --out")


def _is_simulated(session: Path) -> bool:
    file = session / SESSION_FILE
    try:
        if file.stat().st_size > MOST_BYTES:
            return False
        about = tomllib.loads(file.read_text(encoding="utf-8")).get("session")
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(about, dict) and about.get("simulated") is True

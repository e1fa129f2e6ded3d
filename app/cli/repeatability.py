"""`gaitwright repeatability`: a clinic's own error figures, from healthy people whose sensors were attached twice."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from app.cli.arguments import LIBRARY
from app.cli.library import opened_library
from app.cohort.batch.found import FoundSession, find_sessions
from app.cohort.repeatability.people import CONDITION, StudyPeople
from app.cohort.repeatability.study import FIGURES, TABLE, Read, StudyResult, study, write_figures
from app.cohort.repeatability.table import RepeatabilityRow, rows_of
from app.exports.result_folder import written_beside
from app.importing.untrusted_files import read_foreign_session
from app.system.progress import Report
from app.wizard.resuming import sessions_of_condition
from core.analysis import analyse
from core.results import Analysis
from core.session import Session
from devices.files.refusal import FileRefusedError, one_line

TITLES = {
    "attached_again": "Standard deviation of one mean, sensors attached again",
    "between_legs": "Left against right: 95 of 100 healthy people differ by less",
}


def run(args: argparse.Namespace, report: Report) -> Iterator[str]:
    """Do the study and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        A session cannot be read, too few people were measured twice, or something else is at OUT.
    OSError
        OUT cannot be written.
    """
    if args.out is not None:
        _check_place(args.out)
    found = _found(args, report)
    if args.out is not None:
        with written_beside(args.out) as folder:
            write_figures(found.own, folder)
    yield from _lines(found)
    yield ""
    where = f"{one_line(str(args.out))}: repeatability.json and .csv. " if args.out is not None else ""
    yield f"{where}Research use. Not a medical device."


def _found(args: argparse.Namespace, report: Report) -> StudyResult:
    is_library = args.folder == LIBRARY
    people = StudyPeople(CONDITION if is_library else "")
    with _sessions(args, is_library=is_library) as (sessions, made_by):
        return study(str(args.library if is_library else args.folder), sessions, people, made_by, report)


@contextmanager
def _sessions(args: argparse.Namespace, *, is_library: bool) -> Iterator[tuple[list[tuple[str, Read]], str]]:
    if is_library:
        with opened_library(args) as opened:
            operator = opened.library.operator
            yield sessions_of_condition(opened, CONDITION), operator.code if operator is not None else ""
    else:
        yield [(one.name, _reading(one.folder)) for one in _folders(args)], ""


def _folders(args: argparse.Namespace) -> Iterator[FoundSession]:
    yield from find_sessions(args.folder, args.out if args.out is not None else args.folder / ".none")


def _reading(folder: Path) -> Read:
    def read(report: Report) -> tuple[Session, Analysis]:
        session = read_foreign_session(folder, lambda: report(0.0, str(folder)))
        return session, analyse(session, progress=report)

    return read


def _check_place(out: Path) -> None:
    """See whether a study may stand at `out`: nothing is there, or only a study."""
    if out.exists() and not (out.is_dir() and {path.name for path in out.iterdir()} <= {FIGURES, TABLE}):
        raise FileRefusedError(str(out), "this already exists and is not a study", "Choose another --out")


def _lines(found: StudyResult) -> Iterator[str]:
    own = found.own
    simulated = "SIMULATED. " if own.is_simulated else ""
    preliminary = " Preliminary: fewer than 10 people." if own.is_preliminary else ""
    between = "on days apart" if own.between == "days" else "sensors attached again, not always on another day"
    yield f"{simulated}Own error figures, {own.people} people, {between}.{preliminary}"
    rows = rows_of(own)
    for group, title in TITLES.items():
        yield from ("", title, _line("", "own", "95 % limits", "people", "published", ""))
        yield from (_of_row(row) for row in rows if row.group == group)
    yield from ("", *(f"- {note}" for note in found.notes)) if found.notes else ()


def _of_row(row: RepeatabilityRow) -> str:
    own, published = row.number(row.found.value), row.number(row.published)
    return _line(f"{row.title}, {row.unit}", own, row.limits, str(row.found.people), published, row.verdict)


def _line(name: str, own: str, limits: str, people: str, published: str, verdict: str) -> str:
    return f"  {name:46} {own:>7} {limits:>16} {people:>7} {published:>10}  {verdict}".rstrip()

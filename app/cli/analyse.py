"""`gaitwright analyse`: the angles of a session, as a folder of results."""

import argparse
from collections.abc import Iterator
from pathlib import Path

from app.cli.arguments import LOCALES, LibrarySession
from app.cli.places import read_session
from app.cli.progress import finding_lines
from app.cohort.batch.analysed_folder import AnalysisChoices, write_analysed
from app.exports.local_csv import CsvForm, rewrite_tables
from app.exports.result_folder import OWN_SESSION, check_place, written_beside
from app.review.installed import has_rerun
from app.system.progress import Report
from app.wording.body import name_of
from core.results import Analysis, Method
from devices.files.refusal import FileRefusedError


def run(args: argparse.Namespace, report: Report) -> Iterator[str]:
    """Write the results and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        The session cannot be read, or something else is at OUT.
    OSError
        OUT cannot be written.
    """
    form = form_of(args)
    place = args.library if isinstance(args.session, LibrarySession) else args.session
    check_place(args.out, place)
    session_is_inside = place.resolve() == args.out.resolve() / OWN_SESSION
    with written_beside(args.out, keeps_session=session_is_inside) as folder:
        report(0.0, str(args.session))
        analysis = write_analysed(read_session(args, args.session, report), folder, choices_of(args), report)
        rewrite_tables(folder, form)
    yield from lines_of(analysis, args.out)
    yield from lines_without_log(choices_of(args))


def lines_without_log(choices: AnalysisChoices) -> Iterator[str]:
    """Report that a log was asked for and cannot be written here."""
    if choices.has_log and not has_rerun():
        yield "session.rrd was not written: Rerun is not installed. Install rerun-sdk, or the package gaitwright-rerun."


def choices_of(args: argparse.Namespace) -> AnalysisChoices:
    """What of an analysis the command line decides, here and in a batch."""
    return AnalysisChoices(Method(args.method), args.tau, not args.no_report, not args.no_rrd)


def form_of(args: argparse.Namespace) -> CsvForm:
    """How tables are written; raises FileRefusedError where a comma would be both."""
    usual, decimal = LOCALES[args.locale]
    form = CsvForm(args.sep or usual, decimal)
    if form.separator == form.decimal:
        raise FileRefusedError(
            "--sep",
            "a comma cannot separate cells that have a decimal comma",
            "Choose --sep semicolon or tab, or leave it out",
        )
    return form


def lines_of(analysis: Analysis, out: Path) -> Iterator[str]:
    """Say where the results are and what needs a look."""
    joints = [joint for span in analysis.calibrations for joint in span.joints]
    names = ", ".join(name_of(joint) for joint in dict.fromkeys(joints)) or "no joint"
    count = len(analysis.recordings)
    yield f"{out}: {names}; {count} {'recording' if count == 1 else 'recordings'}."
    yield from finding_lines(analysis.findings, lowest="warning")

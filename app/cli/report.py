"""`gaitwright report`: what goes into the patient's file, as a PDF."""

import argparse
from datetime import datetime
from pathlib import Path

from app.cli.places import read_place
from app.exports.spreadsheet import workbook
from app.reports.patient.document import make_report
from app.reports.patient.report_file import check_report_place, chosen_walks, replace_report, workbook_beside
from app.summary.request import MAX_CONDITIONS, AnalysedVisit, ReportRequest
from app.system.logs import version_of
from app.system.progress import Report
from core.analysis import analyse
from devices.files.refusal import FileRefusedError


def run(args: argparse.Namespace, progress: Report) -> list[str]:
    """Write the report and give the line for the terminal.

    Raises
    ------
    FileRefusedError
        A session, walk or comment cannot be read, or something else than a report is at FILE.pdf.
    OSError
        The report cannot be written.
    """
    check_report_place(args.out)
    beside = workbook_beside(args.out)
    if len(args.walk) > MAX_CONDITIONS:
        what = f"{len(args.walk)} walks are too many for one report"
        raise FileRefusedError("--walk", what, f"Choose up to {MAX_CONDITIONS}")
    progress(0.0, str(args.session))
    comment = _comment(args.comment)
    session = read_place(args, args.session, progress)
    visit = AnalysedVisit(session, analyse(session, progress=progress))
    walks = chosen_walks(visit, args.walk, str(args.session))
    earlier = None
    if args.earlier is not None:
        before = read_place(args, args.earlier, progress)
        earlier = AnalysedVisit(before, analyse(before, progress=progress))
        chosen_walks(earlier, [], str(args.earlier))  # refuses a visit without a walk
        walks = walks if args.walk else walks[-1:]  # a visit is compared with a visit
    now, version = datetime.now().astimezone(), version_of("gaitwright")
    progress(1.0, "report")
    request = ReportRequest(visit, walks, now, version, comment, paper=args.paper, earlier=earlier)
    replace_report(make_report(request), args.out)
    replace_report(workbook(visit.session, visit.analysis, args.paper), beside)
    return [f"{args.out}: the report of {', '.join(walks)}.", f"{beside}: all figures of the session."]


def _comment(file: Path | None) -> str:
    if file is None:
        return ""
    try:
        return file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as problem:
        why = problem.strerror if isinstance(problem, OSError) else "it is no text in UTF-8"
        raise FileRefusedError(str(file), f"this cannot be read ({why})", "Give a text file for --comment") from problem

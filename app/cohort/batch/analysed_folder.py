"""What `analyse` writes of a session: one function, so that a batch writes the same bytes."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from app.exports.result_folder import LOG, write_results
from app.review.installed import has_rerun, write_log
from app.system.logs import version_of
from app.system.progress import Report
from core.analysis import analyse
from core.results import Analysis, Method
from core.session import Session


@dataclass(frozen=True, slots=True)
class AnalysisChoices:
    """How a session is analysed, and which files are written beside its tables."""

    method: Method
    tau_s: float
    has_report: bool = True
    has_log: bool = True


def write_analysed(session: Session, folder: Path, choices: AnalysisChoices, report: Report) -> Analysis:
    """Analyse `session` and write all results to the existing `folder`; raises FileRefusedError or OSError."""
    analysis = analyse(session, choices.method, choices.tau_s, report)
    report(1.0, "writing")
    write_results(session, analysis, folder)
    if choices.has_log and has_rerun():
        write_log(session, analysis, folder / LOG)
    if choices.has_report:
        from app.reports.patient.report_file import write_report  # Typst, and the pages

        report(1.0, "report")
        write_report(session, analysis, folder, datetime.now().astimezone(), version_of("gaitwright"))
    report(1.0, "writing")  # the last chance to be interrupted: what follows replaces the old results
    return analysis

"""Write a report to its place.

Beside its place first, so that it is whole or not there. Only a report replaces a report.
"""

import os
import tempfile
from datetime import datetime
from pathlib import Path

from app.exports.result_folder import REPORT, VISITS, VISITS_CYCLES, WORKBOOK, describe_tables
from app.exports.spreadsheet import is_own_workbook, write_spreadsheet
from app.reports.patient.comparison_page import comparison_of
from app.reports.patient.document import make_report
from app.summary.comparison import Contrast
from app.summary.differences import rows_of, write_compared_cycles, write_differences
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from core.results import Analysis
from core.session import Session
from devices.files.refusal import FileRefusedError

PDF = b"%PDF-"


def write_report(session: Session, analysis: Analysis, folder: Path, made_at: datetime, version: str) -> None:
    """Write `report.pdf` and `results.xlsx` into a results folder, nothing without a walk; raises OSError."""
    visit = AnalysedVisit(session, analysis)
    walks = default_walks(visit)
    if walks:
        request = ReportRequest(visit, walks, made_at, version)
        (folder / REPORT).write_bytes(make_report(request))
        write_spreadsheet(session, analysis, folder / WORKBOOK)


def write_visits(request: ReportRequest, folder: Path) -> None:
    """Write the tables of a comparison with an earlier visit, nothing without one; raises OSError."""
    comparison = comparison_of(request)
    if comparison is not None and comparison.kind is Contrast.VISITS:
        write_differences(rows_of(comparison), folder / VISITS)
        write_compared_cycles(comparison.parts, folder / VISITS_CYCLES)
        describe_tables(request.visit.analysis, folder)


def chosen_walks(visit: AnalysedVisit, required: list[str], session: str) -> tuple[str, ...]:
    """Give the walks asked for, else those a report shows; raises FileRefusedError where there is none."""
    names = visit.walk_names()
    for name in required:
        if name not in names:
            what = f"there is no kept walk named {name}"
            raise FileRefusedError(session, what, f"Choose of: {', '.join(names) or 'none'}")
    walks = tuple(required) or default_walks(visit)
    if not walks:
        raise FileRefusedError(
            session, "this contains no included walk, so there is nothing to report", "Record a walk first"
        )
    return walks


def check_report_place(out: Path) -> None:
    """Raise FileRefusedError where anything but a PDF is at `out`."""
    if out.is_dir():
        raise FileRefusedError(str(out), "this is a folder", "Give the report a file name, such as report.pdf")
    if out.exists() and not _is_pdf(out):
        raise FileRefusedError(str(out), "this already exists and is not a PDF", "Choose another --out")


def workbook_beside(out: Path) -> Path:
    """The workbook's place beside a report's; raises FileRefusedError where the report or another's file would be."""
    place = out.with_name(WORKBOOK) if out.name == REPORT else out.with_suffix(".xlsx")
    if place.name.casefold() == out.name.casefold():  # on some disks one file
        raise FileRefusedError(
            str(out),
            "this is the place of the workbook beside the report",
            "Give the report a file name, such as report.pdf",
        )
    if place.exists() and not is_own_workbook(place):
        raise FileRefusedError(
            str(place), "this already exists and is not a workbook of Gaitwright", "Choose another --out"
        )
    return place


def _is_pdf(place: Path) -> bool:
    with place.open("rb") as file:
        return file.read(len(PDF)) == PDF


def replace_report(content: bytes, out: Path) -> None:
    """Put a report or a workbook in its place, whole or not at all; raises OSError."""
    out.parent.mkdir(parents=True, exist_ok=True)
    handle, beside = tempfile.mkstemp(prefix=f".{out.name}-", dir=out.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        Path(beside).replace(out)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise

"""Spreadsheet of the results. Summary, strides, mean cycles and events of all recordings, one sheet each.

Rows and numbers are those of summary.json and the CSV files, with the recording before them. The first sheet holds
every verdict with its reasons. A column of numbers holds nothing else: the cell of a figure that is not reported is
empty and grey, and its status has a column of its own, in the words of the screen. What somebody typed is text
whatever it begins with, so that it is never worked out as a formula. Each sheet can be filtered and printed as it is.
"""

import datetime
import io
import re
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from openpyxl import Workbook
from openpyxl.cell import Cell, WriteOnlyCell
from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE
from openpyxl.styles import Alignment, Font, PatternFill
from openpyxl.utils import get_column_letter
from openpyxl.worksheet._write_only import WriteOnlyWorksheet
from openpyxl.worksheet.properties import PageSetupProperties

from app.exports.figures import DECIMALS_OF, SIMULATED, reason_of, software, unit_of, walk_figures
from app.exports.gait_csv import gait_tables
from app.exports.pseudonymised import what_is_stated
from app.summary.agreed import agreed_with
from app.summary.comparison import Comparison, Contrast, first_and_second
from app.summary.condition_figures import condition_figures
from app.summary.conditions import conditions_of
from app.summary.differences import HEADER, difference_cells, legs_table, rows_along_chain
from app.summary.status import all_that_is_stated, why
from app.system.tables import finite, typed_cell
from app.wording.alignment import since_in_words
from app.wording.findings import sentence
from app.wording.measures import measure_name
from app.wording.translation import PURPOSE, tr
from app.wording.verdicts import verdict_alone
from core.body import Side, hip_of
from core.results import Analysis, RecordingAnalysis
from core.session import Session
from core.verdicts.model import Assessment, Verdict, together
from core.verdicts.quantities import OF_HIPS, PARAMETERS, assessment_of
from core.verdicts.status import NO_ZERO, RANGE_ONLY


class EmptyCell(NamedTuple):
    """In place of a figure that is not reported."""


NO_FIGURE = EmptyCell()
Value = str | float | int | EmptyCell | None
OF_CONDITIONS = ("condition", "walks", "side", "parameter", "mean", "stride_sd", "error", "unit", "strides_used")
NUMBER = re.compile(r"-?\d+(\.\d+)?")
CREATOR = "gaitwright"
OWN = re.compile(rb"<(\w+:)?creator\b[^>]*>gaitwright</")
NO_TIME = datetime.datetime(1980, 1, 1)  # the first that a ZIP can hold: the same analysis gives the same bytes
MOST_PROPERTIES_BYTES = 100_000  # a page of text at most
PROPERTIES, MODIFIED = "docProps/core.xml", re.compile(rb"(<dcterms:modified[^>]*>)[^<]*")
NARROWEST, WIDEST = 10, 42  # letters
TYPED = ("recording", "condition", "name", "against_name", "walks", "against_walks", "what", "where", "text")
UNITLESS = "0.00###"
GREY = PatternFill("solid", fgColor="D9D9D9")
PAPERS = {"a4": 9, "letter": 1}  # as Office numbers them
LINE_POINTS, WRAPPED_EARLIER = 15, 6  # a line's height, and the letters that it loses as words stay whole
ON_A_PAGE = 13  # columns, as wide as these are


@dataclass(frozen=True, slots=True)
class PrintSetUp:
    """How each sheet is printed: whose it is, whether anybody was measured, and on which paper."""

    code: str
    mark: str
    paper: int

    def apply(self, sheet: Any, columns: int) -> None:
        """Landscape, as few pages across as can be read, the heading on each, and whose and which page it is."""
        sheet.page_setup.orientation, sheet.page_setup.paperSize = "landscape", self.paper
        sheet.sheet_properties.pageSetUpPr = PageSetupProperties(fitToPage=True)
        sheet.page_setup.fitToWidth, sheet.page_setup.fitToHeight = -(-columns // ON_A_PAGE), 0
        sheet.print_title_rows = "1:1"
        sheet.print_title_cols = "A:B" if columns > ON_A_PAGE else None
        sheet.page_margins.left = sheet.page_margins.right = 0.4  # inches
        sheet.oddHeader.left.text, sheet.oddHeader.right.text = self.code, self.mark
        sheet.oddFooter.left.text, sheet.oddFooter.right.text = PURPOSE, "&P / &N"


def write_spreadsheet(session: Session, analysis: Analysis, path: Path) -> None:
    """Write one workbook; raises OSError."""
    path.write_bytes(workbook(session, analysis))


def workbook(session: Session, analysis: Analysis, paper: str = "a4") -> bytes:
    """Make one workbook (Office Open XML), without sheets that would be empty; the same bytes for the same analysis."""
    book = Workbook(write_only=True)
    book.properties.creator, book.properties.created = CREATOR, NO_TIME
    book.properties.title = session.patient.code
    whose = session.patient.code.replace("&", "&&"), SIMULATED if analysis.is_simulated else ""
    add_sheet = partial(_add_sheet, book, PrintSetUp(*whose, PAPERS[paper]))
    add_sheet("About", ["what", "value"], _about(session, analysis))
    of_summary = ["recording", "condition", "side", "parameter", "mean", "stride_sd", "unit", "strides_used"]
    of_summary += ["error", "status", "reasons", "measure"]
    add_sheet("Summary", of_summary, _summary(session, analysis))
    add_sheet("Conditions", [*OF_CONDITIONS, "status", "measure"], _conditions(session, analysis))
    for title, (header, lines) in _compared(session, analysis).items():
        add_sheet(title, header, ([_value(*pair) for pair in zip(header, line, strict=True)] for line in lines))
    columns: dict[str, None] = dict.fromkeys(of_summary)
    for name in ("strides", "cycles", "events"):
        header, rows = _joined(analysis, name)
        add_sheet(name.capitalize(), header, rows)
        columns |= dict.fromkeys(header)
    add_sheet("Units", ["column", "unit"], ([column, unit] for column in columns if (unit := unit_of(column))))
    findings = ([str(f.severity), f.where, sentence(f)] for f in analysis.findings)
    columns_of_findings = ["severity", "where", "text"]
    add_sheet("Findings", columns_of_findings, findings)
    written = io.BytesIO()
    book.save(written)
    return _without_times(written.getvalue())


def is_own_workbook(path: Path) -> bool:
    """Whether this program made a workbook, by its properties, which other programs leave as they are."""
    try:
        with zipfile.ZipFile(path) as inside, inside.open(PROPERTIES) as properties:
            return OWN.search(properties.read(MOST_PROPERTIES_BYTES)) is not None
    except (OSError, KeyError, RuntimeError, zipfile.BadZipFile, zlib.error):  # RuntimeError: it is encrypted
        return False


def _about(session: Session, analysis: Analysis) -> list[list[Value]]:
    rows: list[list[Value]] = [[SIMULATED, None]] if analysis.is_simulated else []
    rows += [list(row) for row in what_is_stated(session)]
    rows += [[f"{one.name}, prosthesis", since_in_words(one.alignment)] for one in session.recordings if one.alignment]
    rows += [
        ["method", str(analysis.method)],
        ["software", software()],
        ["use", PURPOSE],
    ]
    reported = [row for row in rows if row[1] not in ("", None) or row[0] == SIMULATED]
    return [*reported, ["Data quality", None], *_verdicts(analysis)]


def _verdicts(analysis: Analysis) -> Iterator[list[Value]]:
    """Every verdict of every recording, and why it is no better."""
    for one in all_that_is_stated(analysis):
        verdict, reasons = verdict_alone(one.assessment.verdict), why(one.assessment)
        yield [f"{one.recording}, {one.subject}, {one.quantity}", f"{verdict}: {reasons}" if reasons else verdict]


def _summary(session: Session, analysis: Analysis) -> Iterable[list[Value]]:
    conditions = {recording.name: recording.condition for recording in session.recordings}
    for one in walk_figures(analysis):
        side = str(one.side) if one.side else "both"
        condition = conditions.get(one.walk, "")
        mean: Value = NO_FIGURE if one.assessment.verdict is Verdict.NOT_REPORTED else one.mean
        status, reasons = verdict_alone(one.assessment.verdict), reason_of(one.assessment) or None
        figures = [mean, finite(one.average.sd), unit_of(one.name), one.strides, finite(one.average.error)]
        yield [one.walk, condition, side, one.name, *figures, status, reasons, measure_name(one.name)]


def _conditions(session: Session, analysis: Analysis) -> Iterable[list[Value]]:
    """The figures of report and screen, over the strides of all walks of each condition."""
    for part in conditions_of(analysis, session.recordings):
        walks = ", ".join(walk.name for walk in part.walks)
        for one in condition_figures(part):
            is_reported = one.verdict is not Verdict.NOT_REPORTED
            mean: Value = one.found.mean if is_reported else NO_FIGURE
            figures: list[Value] = [mean, finite(one.found.sd), finite(one.error)]
            side = "both" if one.side is None else str(one.side)
            strides = one.found.n if is_reported else None
            status, measure = verdict_alone(one.verdict), measure_name(one.column)
            yield [part.name, walks, side, one.column, *figures, unit_of(one.column), strides, status, measure]


def _compared(session: Session, analysis: Analysis) -> dict[str, tuple[list[str], list[list[str]]]]:
    """The rows of sides.csv and differences.csv, where there are any."""
    parts = conditions_of(analysis, session.recordings, agreed=agreed_with(session))
    found = {"Left vs right": legs_table(parts, first_and_second(analysis.affected_side))}
    if len(parts) > 1:
        rows = rows_along_chain(Comparison(Contrast.CONDITIONS, parts))
        found["Differences"] = list(HEADER), list(map(difference_cells, rows))
    return {title: table for title, table in found.items() if table[1]}


def _joined(analysis: Analysis, name: str) -> tuple[list[str], Iterable[list[Value]]]:
    """One table of all recordings; a recording has empty cells where it lacks a column."""
    tables = [(recording, *gait_tables(recording)[name]) for recording in analysis.recordings]
    header = list(dict.fromkeys(column for _, columns, _ in tables for column in columns))

    def rows() -> Iterable[list[Value]]:
        for recording, columns, cells in tables:
            for row in cells:
                reported = dict(zip(columns, row, strict=True))
                not_reported = _not_reported_columns(recording, name, reported.get("side", ""))
                values = {column: _value(column, cell) for column, cell in reported.items()}
                values.update(dict.fromkeys(not_reported & set(header), NO_FIGURE))
                yield [recording.name, *(values.get(column) for column in header)]

    return ["recording", *header], rows()


def _not_reported_columns(recording: RecordingAnalysis, table: str, side: str) -> set[str]:
    """Columns of one row whose cells are empty in the CSV file because nothing may be stated about them."""
    if table == "strides":
        names = (*PARAMETERS, *OF_HIPS)
        return {name for name in names if _is_not_reported(assessment_of(recording.verdicts, Side(side), name))}
    found = set()
    for joint, stated in recording.verdicts.joints.items() if table == "cycles" else ():
        curve = together((stated.shape, stated.sign))
        found |= {f"{joint}_mean_deg"} if _is_not_reported(together((curve, stated.height))) else set()
        found |= {f"{joint}_shape_deg"} if _is_not_reported(curve) else set()
        found |= {f"{joint}_stride_sd_deg"} if _is_not_reported(stated.shape) else set()
    for leg in recording.verdicts.abduction if table == "cycles" else ():
        of_abduction = assessment_of(recording.verdicts, leg, "hip_abduction_peak_deg")
        found |= {f"{hip_of(leg)}_abduction_mean_deg"} if _is_not_reported(of_abduction) else set()
    return found


def _is_not_reported(found: Assessment) -> bool:
    return found.verdict is Verdict.NOT_REPORTED


def _value(column: str, cell: str) -> Value:
    """A cell of a CSV file as the number that it holds, or as text; a status in words."""
    if not cell:
        return None
    if column in ("status", "verdict") or column.endswith("_status"):
        return _status_words(cell)
    if column in TYPED:
        plain = cell.removeprefix("'")
        return plain if typed_cell(plain) == cell else cell  # text is text here: no ' goes before it
    if not NUMBER.fullmatch(cell):
        return cell
    return float(cell) if "." in cell else int(cell)


def _status_words(status: str) -> str:
    """A status of the files in the words of the screen."""
    if status == RANGE_ONLY:
        return tr("Range of motion only")
    if status == NO_ZERO:
        return tr("Curve shape only")
    return verdict_alone(Verdict(status)) if status in set(Verdict) else status


def _add_sheet(
    book: Workbook, print_set_up: PrintSetUp, title: str, header: Sequence[str], rows: Iterable[Sequence[Value]]
) -> None:
    table = list(rows)  # strides and events: thousands of rows, where angles are millions and stay in CSV
    if not table:
        return
    sheet = book.create_sheet(title)
    print_set_up.apply(sheet, len(header))  # before the first row, which ends what is written above it
    sheet.freeze_panes = "A2"
    sheet.auto_filter.ref = f"A1:{get_column_letter(len(header))}{len(table) + 1}"
    for number, name in enumerate(header, start=1):
        longest = max((len(text) for row in table if isinstance(text := row[number - 1], str)), default=0)
        sheet.column_dimensions[get_column_letter(number)].width = min(max(len(name), longest, NARROWEST) + 2, WIDEST)
    headings = [_text(sheet, name) for name in header]
    for heading in headings:
        heading.font = Font(name="Calibri", size=11, bold=True)
    sheet.append(headings)
    at = header.index("parameter") if "parameter" in header else None
    units = [unit_of(name) for name in header]
    for number, row in enumerate(table, start=2):
        longest = max((len(value) for value in row if isinstance(value, str)), default=0)
        if longest > WIDEST:  # programs make no room for wrapped text by themselves
            sheet.row_dimensions[number].height = LINE_POINTS * -(-longest // (WIDEST - WRAPPED_EARLIER))
        of_row = unit_of(str(row[at])) if at is not None else ""
        cells = [_cell(sheet, value, unit or of_row) for value, unit in zip(row, units, strict=True)]
        for cell in cells if longest > WIDEST else ():
            if isinstance(cell, Cell):
                cell.alignment = Alignment(wrap_text=True, vertical="top")
        sheet.append(cells)


def _cell(sheet: WriteOnlyWorksheet, value: Value, unit: str) -> Cell | int | None:
    if isinstance(value, str):
        return _text(sheet, value)
    if isinstance(value, EmptyCell):
        cell = WriteOnlyCell(sheet)
        cell.fill = GREY
        return cell
    if not isinstance(value, float):
        return value
    cell = WriteOnlyCell(sheet, value)
    cell.number_format = f"0.{'0' * DECIMALS_OF[unit]}" if unit in DECIMALS_OF else UNITLESS
    return cell


def _text(sheet: WriteOnlyWorksheet, value: str) -> Cell:
    cell = WriteOnlyCell(sheet, ILLEGAL_CHARACTERS_RE.sub("", value))
    cell.data_type = "s"  # or what begins with = would be a formula
    return cell


def _without_times(workbook: bytes) -> bytes:
    """The same ZIP without the times of writing."""
    again = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(workbook)) as old, zipfile.ZipFile(again, "w", zipfile.ZIP_DEFLATED) as new:
        for name in sorted(old.namelist(), key=lambda name: (name != "[Content_Types].xml", name)):
            info = zipfile.ZipInfo(name, NO_TIME.timetuple()[:6])
            info.compress_type = zipfile.ZIP_DEFLATED
            content = old.read(name)
            new.writestr(
                info,
                MODIFIED.sub(rb"\g<1>" + NO_TIME.isoformat().encode() + b"Z", content)
                if name == PROPERTIES
                else content,
            )
    return again.getvalue()

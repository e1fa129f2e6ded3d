"""Tests that the workbook can be worked with: numbers alone in their columns, filters, formats, and pages of paper."""

import re
import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from app.exports.result_folder import write_results
from app.exports.spreadsheet import workbook, write_spreadsheet
from core.session import Patient, RecordingKind
from core.verdicts.model import GateReason, JointVerdicts, Verdict, assess
from tests.app.exports.conftest import Visit
from tests.app.exports.written_tables import csv_rows

NUMBER = (int, float)
NUMERIC = re.compile(
    r"_(deg|m|s|percent|mm|m_s|steps_min)$|^(mean|stride_sd|error|sd|n|low|high|difference|strides_used)$"
)
CODE = "P-7 & Co"


@pytest.fixture(scope="module")
def doubtful(visit: Visit) -> Visit:
    """A visit whose joints are in doubt, with a condition called as a number, and one called as a formula."""
    session, analysis = visit
    no_zero, no_axis = (
        assess([GateReason("zero", Verdict.NOT_REPORTED)]),
        assess([GateReason("axis", Verdict.NOT_REPORTED)]),
    )
    walk = next(one for one in analysis.recordings if one.kind is RecordingKind.WALKING)
    joints = {
        joint: JointVerdicts(no_axis, no_axis, no_axis) if joint == "left_ankle" else replace(found, height=no_zero)
        for joint, found in walk.verdicts.joints.items()
    }
    doubted = replace(walk, verdicts=replace(walk.verdicts, joints=joints))
    other = replace(doubted, name="walk 2", folder="walk_2")
    recorded = next(one for one in session.recordings if one.name == walk.name)
    recordings = (
        *(replace(one, condition="2") if one is recorded else one for one in session.recordings),
        replace(recorded, name="walk 2", folder="walk_2", condition="=2+3"),
    )
    kept = tuple(doubted if one is walk else one for one in analysis.recordings)
    session = replace(session, recordings=recordings, patient=Patient(code=CODE))
    return session, replace(analysis, recordings=(*kept, other))


@pytest.fixture(scope="module")
def path(doubtful: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("xlsx") / "results.xlsx"
    write_spreadsheet(*doubtful, path)
    return path


@pytest.fixture(scope="module")
def book(path: Path) -> Any:
    return openpyxl.load_workbook(path)


def test_a_column_of_numbers_holds_nothing_else(book: Any) -> None:
    checked = 0
    for sheet in book.worksheets[1:]:
        for column in sheet.iter_cols():
            name = str(column[0].value)
            if NUMERIC.search(name):
                checked += 1
                strange = [
                    cell.value for cell in column[1:] if cell.value is not None and not isinstance(cell.value, NUMBER)
                ]
                assert strange == [], (sheet.title, name)
    assert checked > 50


def test_what_is_not_reported_is_grey_and_its_status_states_so(book: Any) -> None:
    header, *rows = book["Summary"].iter_rows()
    names = [cell.value for cell in header]
    states = set()
    for row in rows:
        mean, status = row[names.index("mean")], row[names.index("status")].value
        states.add(status)
        assert (mean.fill.fill_type == "solid") == (status == "Not reported") == (mean.value is None), status
    assert {"Good", "Not reported"} <= states <= {"Good", "Caution", "Not reported", "Not measured"}
    words = " ".join(str(cell) for sheet in book for row in sheet.iter_rows(values_only=True) for cell in row)
    assert "withheld" not in words  # a word of the files


def test_what_was_typed_stays_text_also_where_it_is_a_number(book: Any) -> None:
    for title, name in (("Summary", "condition"), ("Conditions", "condition"), ("Differences", "name")):
        column = next(one for one in book[title].iter_cols() if one[0].value == name)
        assert all(cell.data_type == "s" for cell in column[1:] if cell.value is not None), title
        assert "=2+3" in {cell.value for cell in column}
    assert "2" in {row[1] for row in book["Summary"].iter_rows(values_only=True)}


def test_every_sheet_can_be_filtered_over_all_its_rows(book: Any) -> None:
    for sheet in book:
        assert sheet.auto_filter.ref == sheet.dimensions, sheet.title


def test_every_sheet_is_printed_across_with_its_heading_and_whose_it_is(path: Path, book: Any) -> None:
    for sheet in book:
        assert (sheet.page_setup.orientation, sheet.page_setup.paperSize) == ("landscape", 9)
        assert sheet.sheet_properties.pageSetUpPr.fitToPage is True
        assert (sheet.page_setup.fitToWidth, sheet.page_setup.fitToHeight) == (-(-sheet.max_column // 13), 0)
        assert sheet.print_title_rows == "$1:$1"
        assert (sheet.print_title_cols is not None) == (sheet.max_column > 13)
    archive = zipfile.ZipFile(path)
    for name in (name for name in archive.namelist() if name.startswith("xl/worksheets/sheet")):
        text = archive.read(name).decode()
        assert "<oddHeader>&amp;LP-7 &amp;&amp; Co&amp;RSIMULATED: nobody was measured.</oddHeader>" in text
        assert "<oddFooter>&amp;LResearch use. Not a medical device.&amp;R&amp;P / &amp;N</oddFooter>" in text


def test_who_was_measured_has_no_mark_and_letter_paper_is_letter(doubtful: Visit, tmp_path: Path) -> None:
    session, analysis = doubtful
    measured = replace(session, is_simulated=False), replace(analysis, is_simulated=False)
    (tmp_path / "letter.xlsx").write_bytes(workbook(*measured, paper="letter"))
    found = openpyxl.load_workbook(tmp_path / "letter.xlsx")
    assert {sheet.page_setup.paperSize for sheet in found} == {1}
    assert b"SIMULATED" not in zipfile.ZipFile(tmp_path / "letter.xlsx").read("xl/worksheets/sheet1.xml")


def test_a_sheet_without_rows_is_left_out_where_its_table_is_a_file_all_the_same(visit: Visit, tmp_path: Path) -> None:
    """A session of free motion alone: no strides, no conditions, no events."""
    session, analysis = visit
    free = tuple(one for one in analysis.recordings if one.kind is RecordingKind.FREE_MOTION)
    alone = replace(analysis, recordings=free, findings=())
    write_spreadsheet(session, alone, tmp_path / "free.xlsx")
    assert openpyxl.load_workbook(tmp_path / "free.xlsx").sheetnames == ["About", "Units"]
    write_results(session, alone, tmp_path)
    for name in ("events", "strides", "cycles"):
        (file,) = tmp_path.glob(f"*/{name}.csv")
        assert len(file.read_text(encoding="utf-8").splitlines()) == 1  # its heading


def test_calamine_reads_the_numbers_of_every_csv_file(path: Path, doubtful: Visit, tmp_path: Path) -> None:
    calamine = pytest.importorskip("python_calamine", reason="python-calamine is not installed")
    write_results(*doubtful, tmp_path)
    read = calamine.CalamineWorkbook.from_path(str(path))
    assert read.sheet_names[0] == "About"
    numbers = 0
    for title in ("Strides", "Cycles", "Events"):
        header, *rows = read.get_sheet_by_name(title).to_python()
        for recording in doubtful[1].recordings:
            found = [dict(zip(header, row, strict=True)) for row in rows if row[0] == recording.name]
            written = csv_rows(tmp_path / recording.folder / f"{title.lower()}.csv")
            assert len(found) == len(written)
            for one, other in zip(found, written, strict=True):
                for name, text in other.items():
                    if NUMERIC.search(name) and text:
                        numbers += 1
                        assert one[name] == float(text), (title, name)
    assert numbers > 2000


def in_libreoffice(path: Path, kind: str, out: Path) -> Path:
    profile = f"-env:UserInstallation=file://{out / 'profile'}"
    command = ["soffice", profile, "--headless", "--convert-to", kind, "--outdir", str(out), str(path)]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    return out / f"{path.stem}.{kind}"


@pytest.mark.endurance
@pytest.mark.skipif(shutil.which("soffice") is None, reason="LibreOffice is not installed")
def test_libreoffice_opens_it_as_it_is_meant(path: Path, book: Any, tmp_path: Path) -> None:
    """Saved again by LibreOffice, every value, number format, filter and heading of pages is what it was."""
    again = openpyxl.load_workbook(in_libreoffice(path, "xlsx", tmp_path))
    assert again.sheetnames == book.sheetnames
    for sheet in book:
        other = again[sheet.title]
        assert other.auto_filter.ref == sheet.auto_filter.ref
        assert other.print_title_rows == sheet.print_title_rows
        assert other.page_setup.orientation == "landscape"
        for row, same in zip(sheet.iter_rows(), other.iter_rows(), strict=True):
            for cell, found in zip(row, same, strict=True):
                assert found.data_type == cell.data_type or cell.value is None, (sheet.title, cell.coordinate)
                if isinstance(cell.value, NUMBER):
                    assert found.value == pytest.approx(cell.value, rel=1e-12)
                    assert found.number_format == cell.number_format
                else:
                    assert found.value == cell.value


@pytest.mark.endurance
@pytest.mark.skipif(shutil.which("soffice") is None, reason="LibreOffice is not installed")
def test_libreoffice_prints_it_on_pages_that_name_the_patient(path: Path, tmp_path: Path) -> None:
    pypdf = pytest.importorskip("pypdf")
    pages = pypdf.PdfReader(in_libreoffice(path, "pdf", tmp_path)).pages
    assert len(pages) < 60
    for number, page in enumerate(pages, 1):
        text = page.extract_text()
        assert CODE in text
        assert f"{number} / {len(pages)}" in text
        assert page.mediabox.width > page.mediabox.height

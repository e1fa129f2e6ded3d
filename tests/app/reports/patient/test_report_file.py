"""Where a report may stand, what it is made from, and the subcommand that makes one."""

import os
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pypdf
import pytest
import typst

from app.cli import report
from app.cli.main import main
from app.exports.result_folder import session_of
from app.reports.patient.document import make_report
from app.reports.patient.report_file import check_report_place, chosen_walks, replace_report, workbook_beside
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from devices.files.refusal import FileRefusedError
from devices.files.session_folder import write_session
from tests.simulated import analysis_of


@pytest.fixture(scope="module")
def session(demonstration: AnalysedVisit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("visit") / "session"
    write_session(demonstration.session, folder)
    return folder


@pytest.fixture
def stored(monkeypatch: pytest.MonkeyPatch) -> None:
    """The subcommand finds the analysis of the session as other tests do."""
    monkeypatch.setattr(report, "analyse", lambda session, **_: analysis_of(session))


@pytest.mark.usefixtures("stored")
def test_the_subcommand_makes_a_report_with_the_clinicians_words(session: Path, tmp_path: Path) -> None:
    (tmp_path / "words.txt").write_text("Walks well with one crutch.", encoding="utf-8")
    out = tmp_path / "new" / "report.pdf"
    comment = ["--comment", str(tmp_path / "words.txt")]
    assert main(["report", str(session), "--out", str(out), "--paper", "letter", *comment]) == 0
    reader = pypdf.PdfReader(out)
    assert [float(side) for side in reader.pages[0].mediabox[2:]] == [612, 792]
    assert "Walks well with one crutch." in reader.pages[0].extract_text()
    assert sorted(out.parent.iterdir()) == [out, out.parent / "results.xlsx"]
    book = openpyxl.load_workbook(out.parent / "results.xlsx")
    assert (book["About"].page_setup.paperSize, "Summary" in book.sheetnames) == (1, True)


@pytest.mark.usefixtures("stored")
def test_the_workbook_has_the_name_of_the_report_and_replaces_only_a_workbook(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """So that the reports of two people in one folder do not share their figures."""
    command = ["report", str(session), "--out"]
    assert main([*command, str(tmp_path / "anna.pdf")]) == 0
    assert main([*command, str(tmp_path / "anna.pdf")]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["anna.pdf", "anna.xlsx"]
    assert f"{tmp_path / 'anna.xlsx'}: all figures of the session." in capsys.readouterr().out
    (tmp_path / "notes.xlsx").write_text("not a workbook")
    assert main([*command, str(tmp_path / "notes.pdf")]) == 2
    assert "notes.xlsx: this already exists and is not a workbook of Gaitwright" in capsys.readouterr().err
    assert (tmp_path / "notes.xlsx").read_text() == "not a workbook"
    assert not (tmp_path / "notes.pdf").exists()


def test_no_workbook_of_somebody_else_is_replaced(tmp_path: Path) -> None:
    place = tmp_path / "anna.xlsx"
    book = openpyxl.Workbook()
    book.properties.title = "gaitwright"
    book.save(place)
    with pytest.raises(FileRefusedError, match="not a workbook of Gaitwright"):
        workbook_beside(place.with_suffix(".pdf"))
    book.properties.creator = "gaitwright"
    book.save(place)
    assert workbook_beside(place.with_suffix(".pdf")) == place
    place.unlink()
    place.mkdir()
    with pytest.raises(FileRefusedError, match="not a workbook of Gaitwright"):
        workbook_beside(place.with_suffix(".pdf"))


@pytest.mark.parametrize("name", ["anna.xlsx", "anna.XLSX"])
def test_no_report_has_the_place_of_its_workbook(tmp_path: Path, name: str) -> None:
    with pytest.raises(FileRefusedError, match="the place of the workbook"):
        workbook_beside(tmp_path / name)


@pytest.mark.endurance
@pytest.mark.parametrize(
    ("arguments", "stated"),
    [
        (["--walk", "walk 9"], "there is no kept walk named walk 9. Choose of: walk 1."),
        (["--walk", "walk 1"] * 4, "4 walks are too many for one report"),
        (["--comment", "nowhere.txt"], "nowhere.txt: this cannot be read"),
    ],
)
def test_what_cannot_be_reported_is_refused_in_one_line(
    session: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], stated: str
) -> None:
    assert main(["report", str(session), "--out", str(tmp_path / "report.pdf"), *arguments]) == 2
    assert stated in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "report.pdf").exists()


def test_only_a_report_is_replaced(tmp_path: Path) -> None:
    letter, before = tmp_path / "letter.txt", tmp_path / "report.pdf"
    letter.write_text("Dear colleague")
    replace_report(b"%PDF-1.7 old", before)
    check_report_place(before)
    check_report_place(tmp_path / "none.pdf")
    for place in (letter, tmp_path):
        with pytest.raises(FileRefusedError):
            check_report_place(place)
    replace_report(b"%PDF-1.7 new", before)
    assert before.read_bytes() == b"%PDF-1.7 new"


def test_results_lead_to_the_session_inside_them(session: Path, tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text("{}")
    with pytest.raises(FileRefusedError, match="without the recordings"):
        session_of(tmp_path)
    shutil.copytree(session, tmp_path / "session")
    assert session_of(tmp_path) == tmp_path / "session"
    assert session_of(session) == session


def test_the_last_walk_of_each_condition_is_shown(alignments: AnalysedVisit) -> None:
    assert default_walks(alignments) == ("walk 1", "walk 2", "walk 3")
    recordings = tuple(replace(r, condition="") for r in alignments.session.recordings)
    alike = AnalysedVisit(replace(alignments.session, recordings=recordings), alignments.analysis)
    assert default_walks(alike) == ("walk 3",)
    assert chosen_walks(alike, ["walk 2", "walk 1"], "session") == ("walk 2", "walk 1")
    nothing = AnalysedVisit(alignments.session, replace(alignments.analysis, recordings=()))
    assert default_walks(nothing) == ()
    with pytest.raises(FileRefusedError, match="this contains no included walk, so there is nothing to report"):
        chosen_walks(nothing, [], "session")


def test_what_is_typed_reaches_the_template_as_data_in_memory_and_nothing_there_runs_or_reads(
    demo: ReportRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    came: list[tuple[bytes, dict[str, Any]]] = []

    def compiled(template: bytes, **options: Any) -> tuple[bytes, list[str]]:
        came.append((template, options))
        return b"", []

    monkeypatch.setattr(typst, "compile_with_warnings", compiled)
    make_report(replace(demo, comment='#eval("1") #image("/etc/passwd")'))
    ((template, options),) = came
    assert b"passwd" not in template
    assert "passwd" in options["sys_inputs"]["data"]
    assert re.findall(rb"\b(?:eval|read|plugin|csv|toml|xml|yaml|cbor)\(|#(?:include|import)\b", template) == []
    assert re.findall(rb"\b(?:image|json)\((?!bytes\()", template) == []


def test_a_report_is_on_the_disk_before_it_takes_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out, synced = tmp_path / "report.pdf", list[int]()
    out.write_bytes(b"%PDF- before")

    def noted(descriptor: int) -> None:
        assert out.read_bytes() == b"%PDF- before"
        synced.append(os.fstat(descriptor).st_size)

    monkeypatch.setattr(os, "fsync", noted)
    replace_report(b"%PDF- now", out)
    assert synced == [9]
    assert out.read_bytes() == b"%PDF- now"

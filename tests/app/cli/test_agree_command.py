"""Tests that `gaitwright agree` writes what it states, and refuses in one line."""

import csv
import json
from pathlib import Path

import pytest
from pypdf import PdfReader

from app.cli.main import main
from core.session import Session
from devices.files.session_folder import write_session
from tests.app.reports.agreement.agreement_material import made, rows_of, write_reference


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("agree")
    session, truth = made()
    assert isinstance(session, Session)
    write_session(session, root / "session")
    rows = [f"walk 1,{row}" for row in rows_of(truth, "walk 1")]
    write_reference(root / "ref.csv", rows, first="recording,")
    return root


@pytest.mark.endurance
def test_it_writes_tables_curves_figures_and_a_report(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = folder / "out"
    arguments = ["agree", "--reference", str(folder / "ref.csv"), str(folder / "session"), "--out", str(out)]
    assert main(arguments) == 0
    stated = capsys.readouterr().out
    assert "M: RMSE, mean removed, degrees" in stated
    assert "walk 2: no matching counterpart, so it was not compared" in stated
    assert stated.rstrip().endswith("1 recording compared. Research use. Not a medical device.")
    assert json.loads((out / "agreement.json").read_text(encoding="utf-8"))["format"] == "gaitwright-agreement/1"
    with (out / "agreement.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    with (out / "columns.csv").open(newline="") as file:
        reported = [(row["file"], row["column"]) for row in csv.DictReader(file)]
    assert [column for name, column in reported if name == "agreement.csv"] == list(rows[0])
    with (out / "walk_1" / "curves.csv").open(newline="") as file:
        header = next(csv.reader(file))
    assert {column for name, column in reported if name == "curves.csv"} <= set(header)
    assert (out / "figure_8_knee.svg").read_text(encoding="utf-8").startswith("<svg")
    pages = PdfReader(out / "agreement.pdf").pages
    words = pages[0].extract_text()
    assert "SIMULATED" in words
    assert "RMSE as measured" in words
    assert f"{float(rows[0]['m_rmse_deg']):.2f}" in words
    assert main([*arguments, "--no-report"]) == 0  # over an agreement
    assert not (out / "agreement.pdf").exists()


def test_what_is_no_agreement_is_never_replaced(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for place in (folder / "session", folder / "ref.csv"):
        arguments = ["agree", str(folder / "session"), "--reference", str(folder / "ref.csv"), "--out", str(place)]
        assert main(arguments) == 2
        assert "this already exists and is not a comparison with a reference" in capsys.readouterr().err
    assert (folder / "session" / "session.toml").is_file()


def test_a_file_that_is_no_reference_is_refused_in_one_line(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "x.csv").write_text("time_s,left_knee\n0.0,a\n", encoding="utf-8")
    required = [
        "agree",
        str(folder / "session"),
        "--reference",
        str(tmp_path / "x.csv"),
        "--out",
        str(tmp_path / "out"),
    ]
    assert main(required) == 2
    assert 'x.csv, line 2: "a" in column left_knee is not a number.' in capsys.readouterr().err
    assert not (tmp_path / "out").exists()

"""Tests that `gaitwright query` answers, writes what it states, and refuses in one line."""

from pathlib import Path

import pytest

from app.cli.main import main
from tests.app.cohort.study.study_tables import random_rows, row, write_rows

COUNT = "SELECT condition, count(*) AS n FROM parameters GROUP BY condition ORDER BY condition"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    rows = [row("a", 60.0), row("b", 61.0), row("c", None, condition="=shoes")]
    return write_rows(rows, tmp_path / "parameters.parquet")


def test_an_answer_is_csv_where_there_is_no_terminal(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["query", COUNT, "--in", str(path)]) == 0
    stated = capsys.readouterr()
    assert stated.out == "condition,n\n'=shoes,1\nbarefoot,2\n"
    assert stated.err == ""


def test_an_answer_is_aligned_on_a_terminal(
    path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert main(["query", COUNT, "--in", str(path)]) == 0
    assert capsys.readouterr().out.splitlines() == ["condition  n", "=shoes     1", "barefoot   2"]


def test_an_answer_is_written_to_a_file(path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "answer.csv"
    assert main(["query", COUNT, "--in", str(tmp_path), "--out", str(out)]) == 0
    assert out.read_text(encoding="utf-8") == "condition,n\n'=shoes,1\nbarefoot,2\n"
    assert capsys.readouterr().out == f"{out}: 2 rows. Research use.\n"


def test_the_columns_are_listed(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["query", "--in", str(path), "--columns"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "column_name,column_type"
    assert "knee_range_deg,DOUBLE" in lines


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["SELECT knee FROM parameters"], '"knee"'),
        (["SELECT * FROM read_csv('/etc/passwd')"], "/etc/passwd"),
        (["COPY parameters TO 'x.csv'"], "COPY is not allowed"),
        ([], "nothing is asked"),
        ([COUNT, "--columns"], "at once"),
        ([COUNT, "--out", "{table}"], "this already exists and is not a CSV file"),
        ([COUNT, "--out", "{folder}"], "this is a folder"),
    ],
)
def test_a_refusal_is_one_line_that_names_it(
    path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], named: str
) -> None:
    before = path.read_bytes()
    places = {"{table}": str(path), "{folder}": str(path.parent)}
    assert main(["query", *(places.get(one, one) for one in arguments), "--in", str(path)]) == 2
    stated = capsys.readouterr()
    assert stated.out == ""
    assert len(stated.err.splitlines()) == 1
    assert named in stated.err
    assert path.read_bytes() == before


def test_a_table_that_is_not_there_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["query", COUNT, "--in", str(tmp_path / "none.parquet")]) == 2
    assert "none.parquet: not found. Choose the parameters.parquet" in capsys.readouterr().err


def test_the_question_of_its_help_can_be_asked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from app.cli.arguments import EXAMPLE

    path = write_rows(random_rows(1, 5), tmp_path / "p.parquet")
    assert main(["query", EXAMPLE, "--in", str(path)]) == 0
    assert len(capsys.readouterr().out.splitlines()) > 2

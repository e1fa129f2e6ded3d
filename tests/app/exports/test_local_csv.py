"""Tests that tables for a spreadsheet of another country hold what those of the default form do."""

import csv
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli.main import main
from app.cohort.batch import analysed_folder
from app.exports.local_csv import CsvForm, rewrite_tables
from app.exports.result_folder import write_results
from devices.files.session_folder import write_session
from tests.app.cli.test_cli import analyse, files_in
from tests.app.exports.conftest import Visit
from tests.app.exports.written_tables import csv_rows
from tests.simulated import analysis_of

GERMAN = CsvForm(";", ",")
FIGURE = re.compile(r"-?\d+\.\d+")


@pytest.fixture(scope="module")
def typed(visit: Visit) -> Visit:
    """Conditions that look like figures, and hold what separates cells."""
    session, analysis = visit
    recordings = tuple(replace(one, condition="2.5; Müller, links") for one in session.recordings)
    return replace(session, recordings=recordings), analysis


@pytest.fixture(scope="module")
def as_ever(typed: Visit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("as_ever")
    write_results(*typed, folder)
    return folder


@pytest.fixture
def other(as_ever: Path, tmp_path: Path) -> Path:
    """A copy, to be written in another form."""
    return Path(shutil.copytree(as_ever, tmp_path / "other"))


@pytest.mark.parametrize("form", [GERMAN, CsvForm("\t", "."), CsvForm(";", "."), CsvForm("\t", ",")])
def test_every_cell_is_what_it_was_but_for_the_comma_of_figures(as_ever: Path, other: Path, form: CsvForm) -> None:
    rewrite_tables(other, form)
    figures = 0
    files = sorted(as_ever.rglob("*.csv"))
    assert len(files) > 10
    for file in files:
        rewritten = other / file.relative_to(as_ever)
        assert rewritten.read_bytes().startswith(b"\xef\xbb\xbf")  # or a spreadsheet takes an umlaut for two letters
        with file.open(encoding="utf-8", newline="") as one, rewritten.open(encoding="utf-8-sig", newline="") as two:
            rows, again = list(csv.reader(one)), list(csv.reader(two, delimiter=form.separator))
        assert again[0] == rows[0]
        for row, same in zip(rows[1:], again[1:], strict=True):
            for cell, found in zip(row, same, strict=True):
                is_figure = FIGURE.fullmatch(cell) is not None
                figures += is_figure
                assert found == (cell.replace(".", form.decimal) if is_figure else cell), (file.name, cell)
    assert figures > 5000
    names = {path.name for path in other.rglob("*")}
    assert not [name for name in names if name.startswith(".")]


def test_what_was_typed_stays_as_it_was_typed(visit: Visit, tmp_path: Path) -> None:
    """A condition of 2.5, as of degrees, is no figure of ours."""
    session, analysis = visit
    recordings = tuple(replace(one, condition="2.5") for one in session.recordings)
    write_results(replace(session, recordings=recordings), analysis, tmp_path)
    rewrite_tables(tmp_path, GERMAN)
    rows = csv_rows(tmp_path / "sides.csv", ";", "utf-8-sig")
    assert {row["name"] for row in rows} == {"2.5"}
    assert all("." not in row["left_mean"] for row in rows)


def test_the_metadata_states_what_separates_cells_and_fractions(as_ever: Path, other: Path) -> None:
    rewrite_tables(other, GERMAN)
    before, after = (json.loads((one / "csv-metadata.json").read_text(encoding="utf-8")) for one in (as_ever, other))
    for one, again in zip(before["tables"], after["tables"], strict=True):
        assert "dialect" not in one
        assert again["dialect"] == {"delimiter": ";"}
        for column, same in zip(one["tableSchema"]["columns"], again["tableSchema"]["columns"], strict=True):
            is_number = column["datatype"] == "number"
            expected = {"base": "number", "format": {"decimalChar": ","}} if is_number else column["datatype"]
            assert same == {**column, "datatype": expected}


def test_the_default_form_touches_nothing(other: Path) -> None:
    before = {path: path.read_bytes() for path in other.rglob("*") if path.is_file()}
    rewrite_tables(other, CsvForm())
    assert {path: path.read_bytes() for path in other.rglob("*") if path.is_file()} == before


def test_the_command_line_writes_the_form_asked_for(
    visit: Visit,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(analysed_folder, "analyse", lambda session, *_: analysis_of(session))
    session = tmp_path / "session"
    write_session(visit[0], session)
    bare = ("--no-report", "--no-rrd")
    assert analyse(session, tmp_path / "ever", *bare) == analyse(session, tmp_path / "en", *bare, "--locale", "en") == 0
    assert files_in(tmp_path / "ever") == files_in(tmp_path / "en")
    for name, options, start in (
        ("de", ("--locale", "de"), "time_s;left_knee_deg;"),
        ("tab", ("--sep", "tab"), "time_s\tleft_knee_deg\t"),
        ("both", ("--locale", "de", "--sep", "tab"), "time_s\tleft_knee_deg\t"),
    ):
        assert analyse(session, tmp_path / name, *bare, *options) == 0
        (angles,) = (tmp_path / name).glob("walk*/angles.csv")
        header, first, *_ = angles.read_text(encoding="utf-8-sig").splitlines()
        assert header.startswith(start)
        assert ("," in first) == (name != "tab")
    assert analyse(session, tmp_path / "none", *bare, "--locale", "de", "--sep", "comma") == 2
    assert "a comma cannot separate cells that have a decimal comma" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()
    with pytest.raises(SystemExit):
        main(["analyse", str(session), "--out", str(tmp_path / "none"), "--sep", "pipe"])
    assert "pipe is none of comma, semicolon, tab" in capsys.readouterr().err


@pytest.mark.endurance
def test_compare_writes_its_table_in_the_form_asked_for(visit: Visit, tmp_path: Path) -> None:
    for name, condition in (("one", "a"), ("other", "a")):
        recordings = tuple(replace(one, condition=condition) for one in visit[0].recordings)
        write_session(replace(visit[0], recordings=recordings), tmp_path / name)
    places = [str(tmp_path / name) for name in ("one", "other")]
    assert main(["compare", *places, "--out", str(tmp_path / "out"), "--locale", "de"]) == 0
    header = (tmp_path / "out" / "differences.csv").read_text(encoding="utf-8-sig").splitlines()[0]
    assert header.startswith("part;name;walks;")

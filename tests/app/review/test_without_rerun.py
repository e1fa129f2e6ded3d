"""Tests that where Rerun is not installed all else is written, and that a sentence states what is not."""

import sys
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.cli.main import main
from app.wizard.report.page import ReportPage
from tests.app.batch_material import write_swinging


@pytest.fixture
def _no_rerun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)


def analysed(place: Path, capsys: pytest.CaptureFixture[str], *options: str) -> tuple[set[str], str]:
    """Files of one session's results, and what the command printed."""
    write_swinging(place / "in", 1)
    (session,) = (place / "in").glob("*")
    assert main(["analyse", str(session), "--out", str(place / "out"), "--no-report", *options]) == 0
    return {path.name for path in (place / "out").iterdir()}, capsys.readouterr().out


@pytest.mark.usefixtures("_no_rerun")
def test_results_come_without_their_log_and_a_line_states_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files, printed = analysed(tmp_path, capsys)
    assert "summary.json" in files
    assert "session.rrd" not in files
    assert "Rerun is not installed on this computer: session.rrd was not written." in printed


@pytest.mark.usefixtures("_no_rerun")
def test_no_line_comes_where_no_log_is_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "Rerun" not in analysed(tmp_path, capsys, "--no-rrd")[1]


def test_with_rerun_the_log_is_written_and_no_such_line_comes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rerun")
    files, printed = analysed(tmp_path, capsys)
    assert "session.rrd" in files
    assert "not written" not in printed


@pytest.mark.usefixtures("_no_rerun")
def test_a_report_offers_no_log(qtbot: QtBot) -> None:
    page = ReportPage()
    qtbot.addWidget(page)
    assert tuple(page.formats.chosen) == ("csv",)
    assert "Rerun" not in [button.text() for button in page.formats.buttons]


def test_a_report_offers_a_log_with_rerun(qtbot: QtBot) -> None:
    pytest.importorskip("rerun")
    page = ReportPage()
    qtbot.addWidget(page)
    assert tuple(page.formats.chosen) == ("csv", "rrd")
    assert "Rerun" in [button.text() for button in page.formats.buttons]

"""Without Rerun every result is there but its log: stated where it was asked for, not offered where one chooses."""

import subprocess
import sys
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from app.cli.main import main
from app.review.installed import has_rerun
from app.wizard.report.page import ReportPage

ROOT = Path(__file__).parents[3]
WITHOUT = """
import sys

sys.modules |= {"rerun": None, "rerun_bindings": None, "rerun_cli": None}
from app.cli.main import main

sys.exit(main(["demo", "--out", sys.argv[1]]))
"""


def test_it_is_installed_with_the_tests() -> None:
    assert has_rerun()


@pytest.mark.endurance
def test_without_it_the_demonstration_lacks_the_log_alone_and_states_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["demo", "--out", str(tmp_path / "with")]) == 0
    assert "Rerun" not in capsys.readouterr().out
    command = [sys.executable, "-c", WITHOUT, str(tmp_path / "without")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert "session.rrd was not written: Rerun is not installed." in done.stdout
    names = [{one.name for one in (tmp_path / name).iterdir()} for name in ("with", "without")]
    assert names[0] - names[1] == {"session.rrd"}
    assert names[1] < names[0]


@pytest.mark.parametrize("is_installed", [True, False])
def test_the_log_is_offered_where_it_can_be_written(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, is_installed: bool
) -> None:
    monkeypatch.setattr("app.wizard.report.page.has_rerun", lambda: is_installed)
    page = ReportPage()
    qtbot.addWidget(page)
    assert ("Rerun" in [one.text() for one in page.formats.buttons]) is is_installed
    assert ("rrd" in page.formats.chosen) is is_installed

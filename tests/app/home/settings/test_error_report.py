"""An error report is saved where it is asked to be, holds what is known and no name, and states where it went."""

from pathlib import Path

import pytest
from PySide6.QtWidgets import QFileDialog, QWidget
from pytestqt.qtbot import QtBot

from app.home.settings.error_report import FILE_NAME, ErrorReport
from app.home.settings.settings_page import SettingsPage
from app.system.logs import version_of


@pytest.fixture
def report(qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ErrorReport:
    folder = tmp_path / "logs"
    folder.mkdir()
    (folder / "gaitwright.log").write_text("first line\nthe program ended early\n", encoding="utf-8")
    monkeypatch.setattr("app.home.settings.error_report.log_folder", lambda: folder)
    window = QWidget()
    qtbot.addWidget(window)
    return ErrorReport(window)


def test_it_holds_versions_and_the_logs_end(qtbot: QtBot, report: ErrorReport, tmp_path: Path) -> None:
    path = tmp_path / FILE_NAME
    with qtbot.waitSignal(report.written) as written:
        report.write(str(path))
    assert written.args == [str(path)]
    text = path.read_text(encoding="utf-8")
    assert f"gaitwright {version_of('gaitwright')}" in text
    assert text.endswith("first line\nthe program ended early\n")


def test_a_place_that_cannot_be_written_is_stated(qtbot: QtBot, report: ErrorReport, tmp_path: Path) -> None:
    stated: list[tuple[str, str]] = []
    report.reported.connect(lambda what, remedy: stated.append((what, remedy)))
    with qtbot.assertNotEmitted(report.written):
        report.write(str(tmp_path / "not there" / FILE_NAME))
    assert stated == [("The error report was not saved (No such file or directory).", "Choose another place.")]


def test_the_dialog_asks_and_writes_where_it_was_reported(qtbot: QtBot, report: ErrorReport, tmp_path: Path) -> None:
    report.save()
    window = report.parent()
    assert isinstance(window, QWidget)
    dialog = window.findChild(QFileDialog)
    assert isinstance(dialog, QFileDialog)
    assert dialog.selectedFiles()[0].endswith(FILE_NAME)
    with qtbot.waitSignal(report.written):
        dialog.fileSelected.emit(str(tmp_path / "a.txt"))
    dialog.reject()


def test_the_settings_offer_it_and_say_where_it_went(qtbot: QtBot) -> None:
    page = SettingsPage(12, [])
    qtbot.addWidget(page)
    assert page.report_error.isVisibleTo(page)
    assert page.trouble_stated == ""
    page.show_error_report("/a/b.txt")
    assert page.trouble_stated == "Saved as /a/b.txt."

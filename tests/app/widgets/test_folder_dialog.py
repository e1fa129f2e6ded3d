"""No dialog for folders or files leaves behind where somebody was: a folder may be named by a patient's code."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings

from app.widgets import folder_dialog

VISIT = """
import sys
from pathlib import Path
from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QApplication, QFileDialog, QWidget
from app.widgets.folder_dialog import ask_for_folder, keep_no_visited_folders

app, window, chosen = QApplication([]), QWidget(), []
if sys.argv[2] == "kept from it":
    keep_no_visited_folders()
dialog = ask_for_folder(window, "Which?", chosen.append)
dialog.setDirectory(sys.argv[1])
dialog.destroyed.connect(app.quit)
QTimer.singleShot(0, dialog.accept)
app.exec()
assert [Path(one) for one in chosen] == [Path(sys.argv[1])], chosen
"""


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="Qt keeps it in no file there")
def test_nothing_of_a_visited_folder_is_left_among_the_settings(tmp_path: Path) -> None:
    folder, kept = tmp_path / "P-0147_2026-05-20", tmp_path / "config"
    folder.mkdir()
    for how, is_left in (("as Qt does", True), ("kept from it", False)):
        subprocess.run(
            [sys.executable, "-c", VISIT, str(folder), how],
            env=os.environ | {"XDG_CONFIG_HOME": str(kept), "QT_QPA_PLATFORM": "offscreen"},
            check=True,
            capture_output=True,
        )
        left = [path for path in kept.rglob("*") if path.is_file()]
        assert any(b"P-0147" in path.read_bytes() for path in left) is is_left
        for path in left:
            path.unlink()


@pytest.mark.parametrize("platform", ["win32", "darwin"])
def test_where_qt_keeps_it_in_no_file_it_is_removed(
    platform: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    settings = QSettings(str(tmp_path / "registry.ini"), QSettings.Format.IniFormat)
    settings.setValue("FileDialog/history", ["file:///P-0147"])
    settings.setValue("FileDialog/lastVisited", "file:///P-0147")
    settings.setValue("FileDialog/viewMode", "Detail")

    def registry(_scope: QSettings.Scope, organisation: str) -> QSettings:
        assert organisation == "QtProject"
        return settings

    vars(registry)["Scope"] = QSettings.Scope
    monkeypatch.setattr(folder_dialog, "QSettings", registry)
    monkeypatch.setattr(sys, "platform", platform)
    folder_dialog.keep_no_visited_folders()
    assert settings.allKeys() == ["FileDialog/viewMode"]

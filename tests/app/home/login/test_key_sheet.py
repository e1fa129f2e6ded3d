"""The recovery key's dialogs are Qt's own, and work under the application's fonts."""

import datetime
import sys
from pathlib import Path

import pypdf
import pytest
from PySide6.QtCore import QTimer
from PySide6.QtGui import QPdfWriter
from PySide6.QtPrintSupport import QPrintDialog
from PySide6.QtWidgets import QAbstractButton, QApplication, QDialog, QWidget
from pytestqt.qtbot import QtBot

from app.home.login import recovery_key_sheet as key_sheet
from app.home.login.recovery_key_sheet import KeySheet, paint_sheet, sheet
from app.theme.current import set_scale
from app.wording.dates import date

KEY = "1234-5678-90AB-CDEF"


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere the system's own dialog opens, not Qt's")
def test_the_printers_properties_open_without_a_complaint_of_qt(qapp: QApplication, qtbot: QtBot) -> None:
    """Its drawn page takes a quarter of the font's size in points, of which a font in pixels has none."""
    set_scale(1.0)
    window = QWidget()
    qtbot.addWidget(window)
    KeySheet(window).print("0000", Path("clinic"))
    dialog = window.findChild(QPrintDialog)
    assert isinstance(dialog, QPrintDialog)
    qtbot.waitUntil(dialog.isVisible)
    properties = next(b for b in dialog.findChildren(QAbstractButton) if "roperties" in b.text())
    properties.setEnabled(True)  # a computer without a printer has none
    seen: list[str] = []

    def close() -> None:
        for opened in qapp.topLevelWidgets():
            if isinstance(opened, QDialog) and opened.isVisible() and opened is not dialog:
                opened.grab()
                seen.append(opened.windowTitle())
                opened.close()

    QTimer.singleShot(300, close)
    properties.click()
    qtbot.waitUntil(lambda: bool(seen))
    dialog.reject()


def test_the_saved_sheet_states_whose_key_it_is_and_since_when(
    qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window, file = QWidget(), tmp_path / "key.txt"
    qtbot.addWidget(window)
    saving = KeySheet(window)
    monkeypatch.setattr(key_sheet, "ask_for_new_file", lambda *_asked: saving.write(str(file)))
    saving.save(KEY, tmp_path / "clinic")
    words = file.read_text(encoding="utf-8")
    assert KEY in words.splitlines()
    assert f"Library: {tmp_path / 'clinic'}" in words.splitlines()
    assert f"Created on {date(datetime.date.today())}." in words
    saving.write(str(file))  # the key is not kept longer
    assert KEY not in file.read_text(encoding="utf-8")


def test_the_printed_sheet_holds_all_of_it_on_one_page(qapp: QApplication, tmp_path: Path) -> None:
    file = tmp_path / "key.pdf"
    words = sheet(
        KEY, Path("/a/long/way/to/the/folder/of/a/clinic's/library/of/recordings"), datetime.date(2026, 11, 26)
    )
    paint_sheet(QPdfWriter(str(file)), words)
    (page,) = pypdf.PdfReader(file).pages
    assert letters(page.extract_text()) == letters(words)


def letters(words: str) -> str:
    """Without digits and signs, which are drawn as glyphs that a PDF of Qt's does not name."""
    return "".join(one for one in words if one.isascii() and one.isalpha())

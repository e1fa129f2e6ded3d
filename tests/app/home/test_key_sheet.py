"""The recovery key's dialogs are Qt's own, and work under the application's fonts."""

import sys

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtPrintSupport import QPrintDialog
from PySide6.QtWidgets import QAbstractButton, QApplication, QDialog, QWidget
from pytestqt.qtbot import QtBot

from app.home.key_sheet import KeySheet
from app.theme import ThemeNotifier, load_fonts


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere the system's own dialog opens, not Qt's")
def test_the_printers_properties_open_without_a_complaint_of_qt(qapp: QApplication, qtbot: QtBot) -> None:
    """Its drawn page takes a quarter of the font's size in points, of which a font in pixels has none."""
    load_fonts()
    ThemeNotifier().set_scale(1.0)
    window = QWidget()
    qtbot.addWidget(window)
    KeySheet(window).print("0000")
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

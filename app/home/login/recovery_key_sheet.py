"""Take a recovery key away from this computer. It is printed, or saved on something that can be taken away."""

import datetime
from pathlib import Path

from PySide6.QtCore import QMarginsF, QObject, Qt, Signal
from PySide6.QtGui import QFont, QPageLayout, QPainter, QPdfWriter
from PySide6.QtPrintSupport import QPrintDialog, QPrinter
from PySide6.QtWidgets import QWidget

from app.widgets.folder_dialog import ask_for_new_file
from app.wording.dates import date
from app.wording.translation import tr

FILE_NAME = "gaitwright-recovery-key.txt"
MARGIN_MM = 25


class KeySheet(QObject):
    """Keeps the key, of the library in `folder`, no longer than its dialog is open."""

    reported = Signal(str, str)

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window, self._key, self._folder = window, "", Path()
        self._printer: QPrinter | None = None

    def print(self, key: str, folder: Path) -> None:
        self._key, self._folder, self._printer = key, folder, QPrinter()
        dialog = QPrintDialog(self._printer, self._window)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.setWindowModality(Qt.WindowModality.WindowModal)
        dialog.accepted.connect(self._on_print_accepted)
        dialog.show()

    def save(self, key: str, folder: Path) -> None:
        self._key, self._folder = key, folder
        ask_for_new_file(self._window, tr("Save the recovery key"), FILE_NAME, self.write)

    def write(self, path: str) -> None:
        """Write the sheet into a file."""
        key, self._key = self._key, ""
        try:
            Path(path).write_text(sheet(key, self._folder, datetime.date.today()), encoding="utf-8")
        except OSError as problem:
            why = problem.strerror or type(problem).__name__
            self.reported.emit(
                tr("The recovery key was not saved ({why}).").format(why=why), tr("Choose another place, or print it.")
            )

    def _on_print_accepted(self) -> None:
        key, self._key = self._key, ""
        if self._printer is not None:
            paint_sheet(self._printer, sheet(key, self._folder, datetime.date.today()))


def paint_sheet(device: QPrinter | QPdfWriter, words: str) -> None:
    device.setPageMargins(QMarginsF(MARGIN_MM, MARGIN_MM, MARGIN_MM, MARGIN_MM), QPageLayout.Unit.Millimeter)
    painter = QPainter(device)
    font = QFont(painter.font())
    font.setPointSize(14)
    painter.setFont(font)
    painter.drawText(painter.viewport(), int(Qt.TextFlag.TextWordWrap), words)
    painter.end()


def sheet(key: str, folder: Path, day: datetime.date) -> str:
    """The words of the sheet of a library's key: of two sheets, who looks for one knows which it is."""
    lead = tr("Gaitwright: recovery key of the library. Anyone with this key can read all patients' recordings.")
    library = tr("Library: {folder}").format(folder=folder)
    made = tr("Created on {day}. A newer recovery key replaces this one.")
    return f"{lead}\n\n{key}\n\n{library}\n{made.format(day=date(day))}\n"

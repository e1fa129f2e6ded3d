"""Bring what is known of an error to whoever mends it. A text that the operator saves, reads and sends."""

from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.system.logs import error_report, log_folder
from app.widgets.folder_dialog import ask_for_new_file
from app.wording.translation import tr

FILE_NAME = "gaitwright-error-report.txt"


class ErrorReport(QObject):
    """Asks where to, and writes it there. Nothing is sent."""

    reported = Signal(str, str)
    written = Signal(str)  # the file

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window

    def save(self) -> None:
        ask_for_new_file(self._window, tr("Save an error report"), FILE_NAME, self.write)

    def write(self, path: str) -> None:
        """Write versions, the kind of machine and the log's last lines into a file."""
        try:
            Path(path).write_text(error_report(log_folder()), encoding="utf-8")
        except OSError as problem:
            why = problem.strerror or type(problem).__name__
            self.reported.emit(
                tr("The error report was not saved ({why}).").format(why=why), tr("Choose another place.")
            )
        else:
            self.written.emit(path)

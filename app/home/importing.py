"""What comes in: a session folder is read, it is said whose it is, and then it is put into the library."""

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.foreign_files import read_foreign_session
from app.icons import Icon
from app.pages.import_page import ImportPage
from app.storage.exchange import import_session
from app.theme import ThemeNotifier
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_folder
from app.wording import tr
from app.workers.background import Report
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from app.storage.exchange import Imported
    from app.storage.opened import OpenedLibrary
    from core.samples import Session


class Importing(QObject):
    """What leads to the page that says what is in a folder, and on from it.

    Signals
    -------
    working
        Something takes a while: its title.
    progressed
        The share that is done, and what is being done.
    asked
        What was read is on the page, to be imported or not.
    left
        There is nothing more to be done here.
    imported
        The id of the patient, whose session is in the library now; None where only the list has to be read anew.
    told
        What came of it, and what to do.
    """

    working = Signal(str)
    progressed = Signal(float, str)
    asked = Signal()
    left = Signal()
    imported = Signal(object)
    told = Signal(str, str)

    def __init__(self, look: ThemeNotifier, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller
        self.page = ImportPage(look)
        self._folder = Path()
        self._read: Session | None = None
        self._code = ""
        self._dialog: QFileDialog | None = None
        self.page.code.line_edit.returnPressed.connect(self.take_in)

    @property
    def bar(self) -> BarState:
        """What can be done with what was read."""
        code = self.page.code.text.strip()
        words = tr("Import for {code}").format(code=code) if code else tr("Import")
        return BarState(BarAction(words, tr("Enter"), Icon.IMPORT, is_enabled=bool(code)))

    def choose_folder(self, window: QWidget, code: str) -> None:
        """Let somebody choose a folder. `code`: of the patient it is taken to be of where it names none."""
        self._code = code
        self._dialog = ask_for_folder(window, tr("Import a session folder"), self._on_folder_selected)

    def read_folder(self, folder: Path) -> None:
        """Read a session folder, to be imported once it is said whose it is."""

        def read(_opened: "OpenedLibrary", report: Report) -> "Session":
            report(0.0, folder.name)
            return read_foreign_session(folder, lambda: report(0.0, folder.name))

        self._folder = folder
        self.working.emit(tr("Reading {folder}").format(folder=folder.name))
        self._controller.run_long(read, self._on_read, self._on_read_refused, self._on_progressed, self)

    def take_in(self) -> None:
        """Put what was read into the library, as a session of the patient with the code that stands on the page."""
        session, code = self._read, self.page.code.text.strip()
        if session is None or not code:
            return

        def work(opened: "OpenedLibrary", report: Report) -> "Imported":
            return import_session(opened, session, report, code)

        self.working.emit(tr("Importing {folder}").format(folder=self._folder.name))
        self._controller.run_long(work, self._on_imported, self._on_import_refused, self._on_progressed, self)

    def stop(self) -> None:
        """Stop what runs: what was added is taken back."""
        if self._read is None:  # a folder was being read, and no more
            self._controller.stop_long()
            self.left.emit()
            self.told.emit(tr("This was stopped."), tr("Nothing was added to the library."))
        else:
            self._controller.stop_long(self._on_stopped)
            self.asked.emit()
            self.told.emit(tr("The import is being stopped."), tr("What was added of it is taken back."))

    def forget(self) -> None:
        """Import nothing of what was read."""
        self._read = None

    def _on_folder_selected(self, folder: str) -> None:
        self.read_folder(Path(folder))

    def _on_progressed(self, share: float, what: str) -> None:
        self.progressed.emit(share, what)

    def _on_read(self, session: "Session") -> None:
        self._read = session
        names = [recording.name for recording in session.recordings]
        code = session.patient.code or self._code
        self.page.show_session(str(self._folder), names, code, session.findings, is_simulated=session.is_simulated)
        self.asked.emit()

    def _on_read_refused(self, what: str, remedy: str) -> None:
        self.left.emit()
        self.told.emit(what, remedy)

    def _on_imported(self, imported: "Imported") -> None:
        self._read = None
        self.left.emit()
        if imported.differing:
            self.told.emit(
                tr("{code} is told of otherwise in the folder: {what}.").format(
                    code=imported.patient.details.code, what=", ".join(_named(name) for name in imported.differing)
                ),
                tr("The library keeps what it says."),
            )
        self.imported.emit(imported.patient.id)

    def _on_import_refused(self, what: str, remedy: str) -> None:
        self.asked.emit()
        self.told.emit(what, remedy)

    def _on_stopped(self, is_done: bool) -> None:
        if is_done:
            self._read = None
            self.left.emit()
            self.told.emit(tr("The import was done before it could be stopped."), tr("The session is in the library."))
        else:
            self.told.emit(tr("The import was stopped."), tr("No session was added to the library."))
        self.imported.emit(None)


def _named(name: str) -> str:
    """What is told of a patient, by the name that it has in the library."""
    return {
        "birth_year": tr("birth year"),
        "sex": tr("sex"),
        "height_m": tr("height"),
        "mass_kg": tr("mass"),
        "device": tr("device"),
        "aids": tr("aids"),
        "affected_side": tr("affected side"),
        "prosthetic_side": tr("prosthetic side"),
    }.get(name, name)

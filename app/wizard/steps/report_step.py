"""What goes into the patient's file: the results as files that other programs read."""

import logging
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog

from app.pages.sentence_page import SentencePage
from app.theme import Look
from app.widgets.action_bar import BarState, Verb
from app.widgets.icons import Icon
from app.widgets.step_rail import StepState
from app.wizard.keys import Action, Intent
from app.wizard.steps.step import Step
from app.wording import tr
from app.workers.background import Report
from app.workers.library_desk import LibraryDesk
from devices.files.refusal import FileRefusedError

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.wizard.visit import Visit

_log = logging.getLogger(__name__)


class ReportStep(Step):
    def __init__(self, look: Look, visit: "Visit", desk: LibraryDesk, parent: QObject | None = None) -> None:
        super().__init__(look, visit, parent)
        self._desk = desk
        self._page: SentencePage | None = None
        self._dialog: QFileDialog | None = None
        self._saved: Path | None = None
        self._is_saving = False
        visit.evaluation.done.connect(self._show)

    @property
    def page(self) -> SentencePage:
        if self._page is None:
            self._page = SentencePage(self._look)
            self._page.pressed.connect(self._on_open_pressed)
        return self._page

    @property
    def title(self) -> str:
        return tr("Report")

    @property
    def note(self) -> str:
        return tr("saved") if self._saved is not None else ""

    @property
    def state(self) -> StepState:
        return StepState.DONE if self._saved is not None else StepState.TODO

    @property
    def topic(self) -> str:
        return "report"

    def enter(self) -> None:
        self._show()

    def bar(self) -> BarState:
        verb = Verb(tr("Save the results"), tr("Ctrl S"), Icon.FOLDER, is_enabled=self._has_results())
        return BarState(primary=verb, note=tr("Without the patient's code and name."))

    def on_primary(self) -> None:
        if not self._has_results() or self._is_saving:
            return
        self._dialog = QFileDialog(self.page, tr("Save the results into a new folder"))
        self._dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        self._dialog.setFileMode(QFileDialog.FileMode.AnyFile)
        self._dialog.selectFile("gaitwright-results")
        self._dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._dialog.fileSelected.connect(self._on_folder_selected)
        self._dialog.open()

    def on_intent(self, intent: Intent) -> bool:
        if intent.action is Action.SAVE:
            self.on_primary()
            return True
        return False

    def _has_results(self) -> bool:
        evaluation = self._visit.evaluation
        return evaluation.analysis is not None and not evaluation.is_busy and bool(evaluation.analysis.recordings)

    def _show(self) -> None:
        if self._page is None:
            return
        if self._saved is not None:
            words = tr("The results are saved."), str(self._saved), tr("Open the folder")
        elif self._has_results():
            words = (
                tr("Curves, events, strides and figures, for the patient's file."),
                tr("CSV and JSON that any spreadsheet reads, and a recording that plays back in Rerun."),
                "",
            )
        else:
            words = tr("There are no results yet."), tr("Record a walk first."), ""
        self._page.show_sentence(*words)
        self.changed.emit()

    def _on_folder_selected(self, folder: str) -> None:
        session, analysis = self._visit.evaluation.session, self._visit.evaluation.analysis
        stored = self._visit.session
        if session is None or analysis is None or stored is None:
            return
        out, session_id = Path(folder), stored.id
        self._is_saving = True

        def save(opened: "OpenedLibrary", report: Report) -> Path:
            from app.reports.result_folder import check_place, write_results, written_beside
            from app.storage.audit import about
            from app.storage.stored import Action, LibraryError

            report(0.0, tr("writing"))
            try:
                check_place(out, opened.folder)
                opened.library.audit.note(Action.EXPORT, about("session", session_id), format="results")
                with written_beside(out) as beside:
                    write_results(session, analysis, beside, has_log=True)
            except FileRefusedError as refusal:
                raise LibraryError(refusal.what[:1].upper() + refusal.what[1:], refusal.remedy) from refusal
            except OSError as problem:
                what = tr("{folder} cannot be written").format(folder=out.name)
                raise LibraryError(what, tr("Choose another folder; nothing is lost")) from problem
            return out

        self._desk.run_long(save, self._on_saved, self._on_refused, None, self)

    def _on_saved(self, folder: Path) -> None:
        self._is_saving, self._saved = False, folder
        self._show()

    def _on_refused(self, what: str, remedy: str) -> None:
        self._is_saving = False
        self.told.emit(what, remedy)

    def _on_open_pressed(self) -> None:
        if self._saved is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._saved)))

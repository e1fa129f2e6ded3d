"""What fills the page of the clinic's own error figures, and lets them be used."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QFileDialog

from app.cohort.repeatability.people import CONDITION, StudyPeople
from app.cohort.repeatability.study import FIGURES, StudyResult, read_figures, study
from app.home.repeatability.repeatability_page import RepeatabilityPage
from app.storage.error_figures import choose_study, chosen_study, figures_of
from app.summary.error_figures import error_figures_in_words
from app.system.progress import Report
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.wizard.resuming import sessions_of_condition
from app.wording.translation import filled, tr
from app.workers.library_controller import LibraryController
from app.workers.long_work import LongWork
from core.verdicts.own_figures import OwnFigures
from core.verdicts.sigmas import in_use, use
from devices.files.refusal import FileRefusedError

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary


class Repeatability(LongWork):
    """One study at a time."""

    changed = Signal()  # the bar shows something else
    done = Signal()  # it ended
    chosen = Signal()  # differences are judged by other figures from now on

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(controller, parent)
        self._dialog: QFileDialog | None = None
        self._is_demonstration = False
        self.page = RepeatabilityPage()

    @property
    def bar(self) -> BarState:
        own, quiet = self.page.own, [BarAction(tr("Open a file"), self._choose_file, icon=Icon.FOLDER)]
        if in_use().study is not None:
            quiet.append(BarAction(tr("Use published figures"), self.use_published))
        calculate = BarAction(tr("Calculate from this library"), self.calculate, icon=Icon.PLAY)
        if own is None:
            return BarState(calculate, quiet=tuple(quiet))
        can_use = self._is_demonstration or not own.is_simulated
        chosen = BarAction(tr("Use these figures"), self.use_shown, icon=Icon.CHECK, is_enabled=can_use)
        return BarState(chosen, others=(calculate,), quiet=tuple(quiet))

    def begin(self, *, is_demonstration: bool) -> None:
        """Show the figures in use, with their study where they are the clinic's own."""
        self._is_demonstration = is_demonstration
        self.page.forget()
        self._show_used()
        self._controller.run(_chosen, self._on_read, self._on_refused, self)

    def forget(self) -> None:
        self.page.forget()

    def calculate(self) -> None:
        """Find the figures from the library's sessions."""
        self._begin(tr("Calculating repeatability"))
        self._controller.run_long(_studied, self._on_studied, self._on_refused, self._on_progressed, self)

    def stop(self) -> None:
        self._controller.stop_long()
        self._end()

    def open(self, path: Path) -> None:
        """Show the study of a file."""
        try:
            self.page.show_study(read_figures(path), ())
        except FileRefusedError as refusal:
            what, remedy = filled(refusal.what, refusal.values), filled(refusal.remedy, refusal.values)
            self.page.show_refused(f"{path.name}: {what}.", f"{remedy}.")
        self.changed.emit()

    def use_shown(self) -> None:
        """Judge by the study in sight from now on."""
        self._choose(self.page.own)

    def use_published(self) -> None:
        self._choose(None)

    def _choose(self, own: OwnFigures | None) -> None:
        self._controller.run(partial(_choose, own), self._on_chosen, self._on_refused, self)

    def _choose_file(self) -> None:
        self._dialog = QFileDialog(self.page.window(), tr("Choose a study"))
        self._dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        self._dialog.setNameFilters([f"{FIGURES} ({FIGURES})", "JSON (*.json)"])
        self._dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._dialog.fileSelected.connect(self._on_file_selected)
        self._dialog.open()

    def _on_file_selected(self, name: str) -> None:
        self.open(Path(name))

    def _on_read(self, own: OwnFigures | None) -> None:
        if own is not None and self.page.own is None:
            self.page.show_study(own, ())
        self.changed.emit()

    def _on_studied(self, found: StudyResult) -> None:
        self.page.show_study(found.own, found.notes)
        self._end()

    def _on_chosen(self, _nothing: None) -> None:
        self._show_used()
        self.changed.emit()
        self.chosen.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.page.show_refused(what, remedy)
        self._end()

    def _end(self) -> None:
        was_working, self.is_working = self.is_working, False
        self.changed.emit()
        if was_working:
            self.done.emit()

    def _show_used(self) -> None:
        self.page.show_used(error_figures_in_words())


def _chosen(opened: "OpenedLibrary") -> OwnFigures | None:
    return chosen_study(opened.library)


def _studied(opened: "OpenedLibrary", report: Report) -> StudyResult:
    operator = opened.library.operator
    made_by = operator.code if operator is not None else ""
    sessions = sessions_of_condition(opened, CONDITION)
    return study(str(opened.folder), sessions, StudyPeople(CONDITION), made_by, report)


def _choose(own: OwnFigures | None, opened: "OpenedLibrary") -> None:
    choose_study(opened.library, own)
    use(figures_of(opened.library))

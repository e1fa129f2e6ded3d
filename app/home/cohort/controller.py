"""What answers the page of questions: the table that was chosen is read and asked beside the screen."""

import logging
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QFileDialog

from app.cohort.study.found_csv import write_csv
from app.cohort.study.groups import GroupAnswer, Grouping, GroupQuestion, answer, groupings_of, measures_of, table_of
from app.cohort.study.parameter_table import PARQUET, ParameterTable
from app.home.cohort.cohort_page import QuestionsPage
from app.system.progress import Report
from app.system.settings import Settings
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_new_file
from app.wording.translation import filled, tr
from app.workers.background import Background, Work
from devices.files.refusal import FileRefusedError

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class _ReadTable:
    """What a table can be asked, before anything is."""

    path: Path
    measures: tuple[str, ...]
    groupings: tuple[Grouping, ...]


@dataclass(frozen=True, slots=True)
class _Written:
    path: Path


class Questions(QObject):
    """One thing at a time: a question that comes while another is answered waits, and only the last does."""

    changed = Signal()  # the bar may show something else
    again_requested = Signal()  # sessions are to be analysed again
    repeatability_requested = Signal()  # the clinic's own error figures are asked for
    making_requested = Signal()  # a table is to be made from this library
    reported = Signal(str, str)  # what came of it, and what to do

    def __init__(self, settings: Settings, parent: QObject) -> None:
        super().__init__(parent)
        self._settings = settings
        self._background, self._writing = Background(self), Background(self)
        self._path: Path | None = None
        self._asked: GroupQuestion | None = None
        self._dialog: QFileDialog | None = None
        self.page = QuestionsPage()
        self._background.done.connect(self._on_done)
        self._background.failed.connect(self._on_failed)
        self._writing.done.connect(self._on_written)
        self._writing.failed.connect(self._on_write_failed)
        self.page.table_requested.connect(self.choose_table)
        self.page.making_requested.connect(self.making_requested)
        self.page.question_changed.connect(self._on_question_changed)

    @property
    def bar(self) -> BarState:
        """What can be done with what is shown."""
        again = (
            BarAction(tr("Analyse sessions again"), self.again_requested.emit, icon=Icon.PLAY),
            BarAction(tr("Repeatability"), self.repeatability_requested.emit, icon=Icon.GROUPS),
        )
        if self.page.found is None:
            return BarState(quiet=again)
        save = BarAction(tr("Save as CSV"), self.save, tr("Ctrl S"), Icon.IMPORT, is_requested=False)
        return BarState(save, quiet=again)

    def begin(self) -> None:
        """Show the table that was asked last, where it is still there."""
        latest = self._settings.latest_table
        if self._path is None and latest and Path(latest).is_file():
            self.open(Path(latest))

    def open(self, path: Path) -> None:
        """Read what this table can be asked, and ask it."""
        self._path, self._asked = path, None
        self.page.forget_table()
        self.page.show_reading(_short(path))
        self.changed.emit()
        self._background.start(_reading(path))

    def choose_table(self) -> None:
        self._dialog = QFileDialog(self.page.window(), tr("Choose a batch table"))
        self._dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        self._dialog.setNameFilters([tr("Batch tables") + f" ({PARQUET})", tr("Parquet") + " (*.parquet)"])
        self._dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._dialog.fileSelected.connect(self._on_table_selected)
        self._dialog.open()

    def save(self) -> None:
        """Ask where the groups in sight are to be written."""
        if self.page.found is None:
            return
        question = self.page.found.question
        proposed = f"{question.measure}_by_{question.grouping}.csv"
        self._dialog = ask_for_new_file(
            self.page.window(), tr("Save the groups"), proposed, self._on_file_selected, ["CSV (*.csv)"]
        )

    def write(self, path: Path) -> None:
        """Write the groups in sight."""
        if self.page.found is not None:
            self._writing.start(_writing(self.page.found, path))

    def forget(self) -> None:
        """Show nothing of any table, for whoever comes next."""
        self._background.stop()
        self._path, self._asked = None, None
        self.page.forget_table()

    def finish(self) -> None:
        """Wait for what runs, when the window was closed."""
        self._background.finish()
        self._writing.finish()

    def _on_table_selected(self, name: str) -> None:
        self.open(Path(name))

    def _on_file_selected(self, name: str) -> None:
        self.write(Path(name))

    def _on_question_changed(self, question: GroupQuestion) -> None:
        if self._path is not None and not self._background.is_busy:
            self._ask(self._path, question)

    def _ask(self, path: Path, question: GroupQuestion) -> None:
        self._asked = question
        self._background.start(_asking(path, question))

    def _on_done(self, found: object) -> None:
        if isinstance(found, _ReadTable):
            self._settings.latest_table = str(found.path)
            self.page.show_table(_short(found.path), found.measures, found.groupings)
        elif isinstance(found, GroupAnswer):
            self.page.show_answer(found)
        question = self.page.question
        if self._path is not None and question is not None and question != self._asked:
            self._ask(self._path, question)
        self.changed.emit()

    def _on_failed(self, error: Exception) -> None:
        if self._asked is None:  # it could not even be read
            self._path = None
        if isinstance(error, FileRefusedError):
            what, remedy = filled(error.what, error.values), filled(error.remedy, error.values)
            where = tr("Where: {place}.").format(place=error.where)
            self.page.show_refused(f"{Path(error.where).name}: {what}.", f"{remedy}. {where}")
        else:
            _log.error("a question was not answered", exc_info=error)
            self.page.show_refused(tr("The table cannot be evaluated."), tr("See the log for details."))
        self.changed.emit()

    def _on_written(self, written: object) -> None:
        assert isinstance(written, _Written)
        self.reported.emit(tr("Groups saved."), str(written.path))

    def _on_write_failed(self, error: Exception) -> None:
        if not isinstance(error, OSError):
            _log.error("groups were not written", exc_info=error)
        why = getattr(error, "strerror", None) or type(error).__name__
        self.reported.emit(tr("The groups could not be saved ({why}).").format(why=why), tr("Choose another folder."))


def _reading(path: Path) -> Work:
    def work(report: Report) -> object:
        report(0.0, path.name)
        with ParameterTable.opened(path) as table:
            return _ReadTable(path, measures_of(table), groupings_of(table))

    return work


def _asking(path: Path, question: GroupQuestion) -> Work:
    def work(report: Report) -> object:
        report(0.0, path.name)
        with ParameterTable.opened(path) as table:
            return answer(table, question)

    return work


def _writing(found: GroupAnswer, path: Path) -> Work:
    def work(_report: Report) -> object:
        write_csv(*table_of(found), path)
        return _Written(path)

    return work


def _short(path: Path) -> str:
    """A table as it is called on the page: its folder identifies it better than its name."""
    return f"{path.parent.name}/{path.name}"

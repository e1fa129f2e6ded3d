"""What leads to the page on which sessions are analysed again, and what is done with those that are ticked."""

import datetime
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.cohort.batch.again import analyse_again
from app.cohort.batch.executors import of_this_computer, processors
from app.cohort.batch.spread import SelectionResult
from app.home.again.analyse_again_page import AgainLine, AnalyseAgainPage
from app.storage.kept_analyses import algorithm
from app.system.progress import Report
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_new_folder
from app.wizard.resuming import session_to_analyse
from app.wording.patients import when
from app.wording.recordings import name_in_words
from app.wording.translation import tr, tr_n
from app.workers.library_controller import LibraryController
from app.workers.long_work import LongWork

if TYPE_CHECKING:
    from app.cohort.batch.run import BatchResult
    from app.storage.opened import OpenedLibrary

TABLE = "parameters.parquet"  # as app.cohort.batch.table has it


class AnalysingAgain(LongWork):
    """One selection at a time."""

    changed = Signal()  # the bar shows something else
    done = Signal(str, str)  # it ended: what came of it, and what to do
    table_made = Signal(object)  # the path of a table over many sessions, to be asked

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(controller, parent)
        self._dialog: QFileDialog | None = None
        self._failures: dict[UUID, str] = {}
        self._required: UUID | None = None
        self._out = Path()
        self.is_of_library = False  # what was asked for last: a table over all sessions, from the page that asks it
        self.page = AnalyseAgainPage()
        self.page.changed.connect(self.changed)

    @property
    def bar(self) -> BarState:
        count = len(self.page.ticked)
        words = tr_n("Analyse {count} session", "Analyse {count} sessions", count).format(count=count)
        analyse = BarAction(words, self.analyse, icon=Icon.PLAY, is_enabled=bool(count))
        words = tr("Analyse to a folder, with table")
        folder = BarAction(words, self._choose_folder, icon=Icon.FOLDER, is_requested=False, is_enabled=bool(count))
        return BarState(analyse, others=(folder,))

    def begin(self, patient_id: UUID | None) -> None:
        """Show all sessions, with those of this patient ticked, else those that this version has not analysed."""
        self._required, self._failures, self.is_of_library = patient_id, {}, False
        self.page.forget()
        self._read()

    def analyse(self) -> None:
        """Analyse those that are ticked, and keep what comes of them."""
        ids = self.page.ticked
        if not ids:
            return

        def work(opened: "OpenedLibrary", report: Report) -> SelectionResult[UUID]:
            with of_this_computer(processors()) as workers:
                return analyse_again(ids, lambda session_id: session_to_analyse(opened, session_id), workers, report)

        self._begin(tr("Analysing again"))
        self._controller.run_long(work, self._on_analysed, self._on_refused, self._on_progressed, self)

    def _choose_folder(self) -> None:
        self._dialog = ask_for_new_folder(
            self.page.window(), tr("Choose a folder for results and table"), _proposed, self._on_folder
        )

    def make_table(self) -> None:
        """Ask for a folder, then analyse all sessions of the library into it, with a table over them."""
        self._dialog = ask_for_new_folder(
            self.page.window(), tr("Choose a folder for results and table"), _proposed, self._on_table_folder
        )

    def write(self, out: Path, ids: Collection[UUID] | None) -> None:
        """Analyse these sessions, or all, into a folder of their own each, with a table over all of them."""
        self._out, self.is_of_library = out, ids is None

        def work(opened: "OpenedLibrary", report: Report) -> "BatchResult":
            from app.cohort.batch.of_library import analysed_into  # Arrow, and what a table is written with

            return analysed_into(out, opened, ids, report)

        self._begin(tr("Analysing to a folder"))
        self._controller.run_long(work, self._on_written, self._on_refused, self._on_progressed, self)

    def stop(self) -> None:
        """End it; what was done until now is kept."""
        self._controller.stop_long()
        self._end(tr("Stopped."), tr("Sessions analysed so far are kept."))
        if not self.is_of_library:
            self._read()

    def _end(self, what: str, then: str) -> None:
        self.is_working = False
        self.done.emit(what, then)

    def _read(self) -> None:
        self._controller.run(self._lines, self._on_read, self._on_refused, self)

    def _lines(self, opened: "OpenedLibrary") -> tuple[tuple[AgainLine, ...], tuple[UUID, ...]]:
        now = datetime.datetime.now().astimezone()
        listed = [one for one in opened.library.sessions.list() if one.recordings]
        current = opened.library.results.analysed_by(algorithm())
        lines = tuple(
            AgainLine(
                one.id,
                one.patient_code,
                when(one.started, now),
                "; ".join(map(name_in_words, one.conditions)),
                one.id in current,
                self._failures.get(one.id, ""),
            )
            for one in listed
        )
        of_patient = [one.id for one in listed if one.patient_id == self._required]
        return lines, tuple(of_patient or [line.id for line in lines if not line.is_current])

    def _on_read(self, found: tuple[Sequence[AgainLine], Sequence[UUID]]) -> None:
        self.page.show_lines(*found)
        self.page.focus()

    def _on_analysed(self, result: SelectionResult[UUID]) -> None:
        self._failures, self._required = dict(result.failures), None
        stated = tr_n(
            "{count} session was analysed with this version.",
            "{count} sessions were analysed with this version.",
            result.analysed,
        ).format(count=result.analysed)
        then = []
        if result.as_before:
            before = tr_n(
                "{count} was analysed with it before.", "{count} were analysed with it before.", result.as_before
            )
            then.append(before.format(count=result.as_before))
        if result.failures:
            then.append(_failed(len(result.failures)))
        self._end(stated, " ".join(then))
        self._read()

    def _on_written(self, result: "BatchResult") -> None:
        stated = tr("Results and table saved in {folder}.").format(folder=self._out)
        self._end(stated, _failed(len(result.failures)) if result.failures else "")
        self.table_made.emit(self._out / TABLE)

    def _on_refused(self, what: str, remedy: str) -> None:
        self._end(what, remedy)

    def _on_folder(self, folder: str) -> None:
        self.write(Path(folder), frozenset(self.page.ticked))

    def _on_table_folder(self, folder: str) -> None:
        self.write(Path(folder), None)


def _proposed(place: Path) -> str:
    name, number = "gaitwright-sessions", 2
    while (place / name).exists():
        name, number = f"gaitwright-sessions-{number}", number + 1
    return name


def _failed(count: int) -> str:
    stated = tr_n(  # alike in English only
        "{count} could not be analysed. The list shows why.",
        "{count} could not be analysed. The list shows why.",
        count,
    )
    return stated.format(count=count)

"""What comes in: files of other programs and session folders are read, confirmed, and put into the library."""

import re
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.home.importing.explaining import Explaining, OpenTable
from app.home.importing.found import FilesRead, Found, HowRead, read_files
from app.home.importing.import_page import ImportPage
from app.home.importing.import_words import program_name
from app.home.importing.table_words import refused_line
from app.importing.import_drafts import SessionDraft, chains_of_motion, session_of, split_draft
from app.storage.exchange import import_session
from app.system.progress import Report
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_files, ask_for_folder
from app.wording.translation import tr, tr_n
from app.workers.background import Background
from app.workers.library_controller import LibraryController
from app.workers.long_work import LongWork
from app.workers.refusals import refusal_of
from devices.files.refusal import FileRefusedError, one_line
from devices.files.trial import PROGRAMS

if TYPE_CHECKING:
    from app.storage.exchange import Imported
    from app.storage.opened import OpenedLibrary
    from core.placement.chains import Chains

MOST_SENTENCES = 8


class Importing(LongWork):
    """What leads to the page that shows what is in files, and on from it: one session after the other.

    `imported`: the id of the patient, whose session is in the library now; None where only the list has to be read
    again.
    """

    asked = Signal()  # something is on the page, to be imported or not
    left = Signal()  # there is nothing more to be done here
    imported = Signal(object)
    reported = Signal(str, str)  # what came of it, and what to do

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(controller, parent)
        self._dialog: QFileDialog | None = None
        self._waiting: deque[Found] = deque()
        self.shown: Found | None = None
        """What is on the page, to be confirmed."""
        self._number = self._count = 0
        self._paths: tuple[Path, ...] = ()  # that were asked for
        self._how = HowRead()
        self._read = FilesRead((), (), (), ())
        self._is_placing_asked = False  # by somebody, not only tried
        self._unsplit: SessionDraft | None = None  # as it was read, of what is shown
        self._is_importing = False
        self._placing = Background(self)
        self._placing.done.connect(self._on_placed)
        self._placing.failed.connect(self._on_placing_failed)
        self.page = ImportPage()
        self._explaining = Explaining(controller, self.page.table, self)
        self._explaining.asked.connect(self._on_table_asked)
        self._explaining.changed.connect(self.page.changed)
        self._explaining.ended.connect(self._on_explained)
        self._explaining.reported.connect(self.reported)
        self.page.code.line_edit.returnPressed.connect(self.take_in)
        self.page.choose_files.clicked.connect(self._choose_files)
        self.page.choose_folder.clicked.connect(self._choose_folder)
        self.page.reading_requested.connect(self._on_reading_requested)
        self.page.explaining_requested.connect(self._on_explaining_requested)
        self.page.draft.placing_requested.connect(self._on_placing_requested)
        self.page.draft.columns_requested.connect(self._on_columns_requested)
        self.page.draft.combining_requested.connect(self._on_combining_requested)
        self.page.draft.split_requested.connect(self._on_split_requested)
        self.page.draft.joining_requested.connect(self._on_joining_requested)

    @property
    def bar(self) -> BarState:
        """What can be done with what is shown."""
        if self._explaining.is_on:
            return self._explaining.bar
        if self.shown is None:
            return BarState()
        code = self.page.code.text.strip()
        words = tr("Import for {code}").format(code=code) if code else tr("Import")
        is_ready = bool(code) and (not self._is_draft or self._is_draft_ready)
        take_in = BarAction(words, self.take_in, tr("Enter"), Icon.IMPORT, is_enabled=is_ready)
        return BarState(take_in, quiet=(BarAction(tr("Skip this one"), self.leave_out),) if self._waiting else ())

    def begin(self) -> None:
        """Show how to begin."""
        self.forget()
        self.page.show_nothing([program_name(key) for key in PROGRAMS])
        self.page.show_unread((), can_try_again=False)
        self.asked.emit()

    def read(self, paths: Sequence[Path], rate_hz: float | None = None) -> None:
        """Read files and folders, to be imported once it is stated whose they are."""
        self._read_as(paths, HowRead(rate_hz))

    def _read_as(self, paths: Sequence[Path], how: HowRead) -> None:
        def work(_opened: "OpenedLibrary", report: Report) -> FilesRead:
            return read_files(paths, how, report)

        self.forget()
        self._paths, self._how = tuple(paths), how
        name = paths[0].name if len(paths) == 1 else tr_n("{count} file", "{count} files", len(paths))
        self.working.emit(tr("Reading {folder}").format(folder=name.format(count=len(paths))))
        self._controller.run_long(work, self._on_read, self._on_read_refused, self._on_progressed, self)

    def take_in(self) -> None:
        """Put what is shown into the library, as a session of the patient with the code that is on the page."""
        code, shown = self.page.code.text.strip(), self.shown
        if shown is None or not code or (self._is_draft and not self._is_draft_ready):
            return
        kinds, sites, day = self.page.draft.kinds, self.page.draft.sites, self.page.day or ""
        is_one_receiver = self.page.draft.is_one_receiver

        def work(opened: "OpenedLibrary", report: Report) -> "Imported":
            session = shown.session
            if shown.draft is not None:
                session = session_of(shown.draft, kinds, sites, day, is_one_receiver=is_one_receiver)
            assert session is not None  # it is one or the other
            return import_session(opened, session, report, code)

        self._is_importing = True
        self.working.emit(tr("Importing {folder}").format(folder=Path(shown.where).name))
        self._controller.run_long(work, self._on_imported, self._on_import_refused, self._on_progressed, self)

    def leave_out(self) -> None:
        """Go on to the next session that was read."""
        self._show_next()

    def stop(self) -> None:
        """Stop what runs: what was added is taken back."""
        if not self._is_importing:  # something was being read, and no more
            self._controller.stop_long()
            self.left.emit()
            self.reported.emit(tr("Stopped."), tr("Nothing was added to the library."))
        else:
            self._controller.stop_long(self._on_stopped)
            self.asked.emit()
            self.reported.emit(tr("The import is being stopped."), tr("Any part of it already added is removed."))

    def forget(self) -> None:
        """Import nothing of what was read."""
        self._waiting.clear()
        self._explaining.forget()
        self._placing.stop()
        self.shown, self._is_importing = None, False

    def finish(self) -> None:
        """Wait for what runs, when the window was closed."""
        self._placing.finish()

    @property
    def _is_draft(self) -> bool:
        return self.shown is not None and self.shown.draft is not None

    @property
    def _is_draft_ready(self) -> bool:
        return not self.page.draft.what_is_wrong and self.page.day is not None

    def _choose_files(self) -> None:
        self._dialog = ask_for_files(self.page.window(), tr("Import recordings"), self._on_files_selected)

    def _choose_folder(self) -> None:
        self._dialog = ask_for_folder(self.page.window(), tr("Import a folder"), self._on_folder_selected)

    def _on_files_selected(self, files: list[str]) -> None:
        self.read([Path(file) for file in files])

    def _on_folder_selected(self, folder: str) -> None:
        self.read([Path(folder)])

    def _on_reading_requested(self, rate_hz: float) -> None:
        self._read_as(self._read.again, replace(self._how, rate_hz=rate_hz))

    def _on_explaining_requested(self) -> None:
        self._explain(self._read.tables)

    def _on_columns_requested(self) -> None:
        if self.shown is not None:
            self._explain([Path(file) for file in self.shown.files])

    def _on_combining_requested(self) -> None:
        self._read_as(self._paths, replace(self._how, are_one=True))

    def _explain(self, tables: Sequence[Path]) -> None:
        """Ask what the columns of these tables mean, one after the other."""
        whys = {path: _why(path, self._read.refused) for path in tables}
        self._explaining.begin([OpenTable(path, why) for path, why in whys.items()])

    def _on_table_asked(self) -> None:
        self.page.show_table(self._explaining.where)
        self.asked.emit()

    def _on_explained(self) -> None:
        """Read again with what is known now; where nothing is, go back to what was shown."""
        choices = dict(self._explaining.choices)
        self._explaining.forget()
        if choices:
            self._read_as(self._paths, replace(self._how, choices={**self._how.choices, **choices}))
            return
        self._show_unread()
        if self.shown is not None:
            self._show(self.shown)
        else:
            self.page.show_nothing([program_name(key) for key in PROGRAMS])
            self.asked.emit()

    def _on_read(self, read: FilesRead) -> None:
        self._read = read
        if not read.found:
            self.page.show_nothing([program_name(key) for key in PROGRAMS])
        self._show_unread()
        self._waiting.extend(read.found)
        self._number, self._count = 0, len(read.found)
        if read.found:
            self._show_next()
        elif read.tables and not self._how.choices:
            self._explain(read.tables)
        else:
            self.asked.emit()

    def _show_unread(self) -> None:
        sentences = [refused_line(refusal) for refusal in self._read.refused]
        more = len(sentences) - MOST_SENTENCES
        if more > 0:
            stated = tr_n("And {count} more file.", "And {count} more files.", more)
            sentences = [*sentences[:MOST_SENTENCES], stated.format(count=more)]
        self.page.show_unread(sentences, can_try_again=bool(self._read.again), can_explain=bool(self._read.tables))

    def _show_next(self) -> None:
        """Show the next session, or leave where there is none."""
        if not self._waiting:
            self.forget()
            self.left.emit()
            return
        if self.shown is not None:
            self._how = replace(self._how, done=self._how.done | set(self.shown.files))
        self.shown = self._waiting.popleft()
        self._number += 1
        self._show(self.shown)

    def _show(self, shown: Found) -> None:
        which = tr("Session {number} of {count}: ").format(number=self._number, count=self._count)
        where = f"{which if self._count > 1 else ''}{shown.where}"
        self._placing.stop()
        if (session := shown.session) is not None:
            names = [recording.name for recording in session.recordings]
            code = session.patient.code
            self.page.show_session(where, names, code, session.findings, is_simulated=session.is_simulated)
        elif shown.draft is not None:
            self._unsplit = shown.draft
            program = program_name(shown.draft.recordings[0].trial.format)
            parts = [one for one in (shown, *self._waiting) if one.is_part and shown.is_part]
            can_be_combined = len({Path(file).parent for one in parts for file in one.files}) < len(parts)
            self.page.show_draft(
                where, program, shown.draft, has_columns=shown.are_tables, can_be_combined=can_be_combined
            )
            if self.page.draft.can_be_placed:
                self._place(is_asked=False)
        self.asked.emit()

    def _on_split_requested(self, number: int, at_s: float) -> None:
        if self.shown is None or (draft := self.shown.draft) is None:
            return

        def work(_opened: "OpenedLibrary") -> tuple[SessionDraft, SessionDraft, int]:
            return draft, split_draft(draft, number, at_s), number

        self._controller.run(work, self._on_split, self._on_split_refused, self)

    def _on_split(self, split: tuple[SessionDraft, SessionDraft, int]) -> None:
        before, after, number = split
        if self.shown is not None and self.shown.draft is before:
            self.shown = replace(self.shown, draft=after)
            self.page.draft.show_split(after, number)

    def _on_split_refused(self, what: str, remedy: str) -> None:
        self.reported.emit(what, remedy)

    def _on_joining_requested(self) -> None:
        if self.shown is not None and self._unsplit is not None:
            self.shown = replace(self.shown, draft=self._unsplit)
            self.page.draft.show_joined(self._unsplit)

    def _on_placing_requested(self) -> None:
        self._place(is_asked=True)

    def _place(self, *, is_asked: bool) -> None:
        """Look in the motion for where the sensors of the draft that is shown were worn."""
        draft, worn = self.shown.draft if self.shown is not None else None, self.page.draft.worn

        def work(_report: Report) -> "Chains | None":
            return chains_of_motion(draft, worn) if draft is not None else None

        self._is_placing_asked = is_asked
        self._placing.start(work)

    def _on_placed(self, chains: "Chains | None") -> None:
        if not self._is_placing_asked:  # only what is certain is proposed to those who did not ask
            if chains is not None and chains.is_certain and self.page.draft.can_be_placed:
                self.page.draft.show_chains(chains, takes_focus=False)
        elif chains is None:
            self.reported.emit(
                tr("Sensor positions could not be detected."),
                tr("Use a recording in which all sensors move, or enter the positions."),
            )
        elif not self.page.draft.show_chains(chains, takes_focus=True):
            self.reported.emit(
                tr("The movement does not fit the entered sensor positions."),
                tr("Two to seven sensors on legs and pelvis are needed. Check the sensor positions."),
            )

    def _on_placing_failed(self, error: Exception) -> None:
        if self._is_placing_asked:
            self.reported.emit(*refusal_of(error))

    def _on_read_refused(self, what: str, remedy: str) -> None:
        self.left.emit()
        self.reported.emit(what, remedy)

    def _on_imported(self, imported: "Imported") -> None:
        self._is_importing = False
        self._show_next()
        if imported.differing:
            self.reported.emit(
                tr("{code}: details in the folder differ from the library ({what}).").format(
                    code=imported.patient.details.code, what=", ".join(_named(name) for name in imported.differing)
                ),
                tr("The library's details are kept."),
            )
        self.imported.emit(imported.patient.id)

    def _on_import_refused(self, what: str, remedy: str) -> None:
        self._is_importing = False
        self.asked.emit()
        self.reported.emit(what, remedy)

    def _on_stopped(self, is_done: bool) -> None:
        self._is_importing = False
        if is_done:
            self._show_next()
            self.reported.emit(
                tr("The import finished before it could be stopped."), tr("The session is in the library.")
            )
        else:
            self.reported.emit(tr("The import was stopped."), tr("No session was added to the library."))
        self.imported.emit(None)


def _why(path: Path, refused: Sequence[FileRefusedError]) -> FileRefusedError | None:
    """Why a file was not read; None where that is not what was refused."""
    name = re.compile(rf"(^|, ){re.escape(one_line(path.name))}(, |$)")  # of several files, or with a line
    return next((one for one in refused if name.search(one.where)), None)


def _named(name: str) -> str:
    """What a patient's data are called, by the name that each has in the library."""
    return {
        "birth_year": tr("birth year"),
        "sex": tr("sex"),
        "height_m": tr("height"),
        "mass_kg": tr("weight"),
        "device": tr("device"),
        "aids": tr("aids"),
        "affected_side": tr("affected side"),
        "prosthetic_side": tr("prosthetic side"),
        "prostheses": tr("prosthesis"),
        "goals": tr("goals"),
    }.get(name, name)

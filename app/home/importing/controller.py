"""What comes in: files of other programs and session folders are read, confirmed, and put into the library."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.home.importing.import_page import ImportPage
from app.home.importing.import_words import program_name
from app.importing.import_drafts import SessionDraft, chains_of_motion, drafts_of, session_of
from app.importing.untrusted_files import gather_foreign, read_foreign_session, read_foreign_trial
from app.storage.exchange import import_session
from app.system.progress import Report
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_files, ask_for_folder
from app.wording.translation import tr, tr_n
from app.workers.library_controller import LibraryController
from app.workers.long_work import LongWork
from devices.files.refusal import FileRefusedError
from devices.files.trial import PROGRAMS, SESSION

if TYPE_CHECKING:
    from app.storage.exchange import Imported
    from app.storage.opened import OpenedLibrary
    from core.placement.chains import Chains
    from core.session import Session
    from devices.files.trial import ImportedTrial

MOST_SENTENCES = 8


@dataclass(frozen=True, slots=True)
class _Found:
    """One session that was read, and where: that of a session folder, or a draft of one."""

    where: str
    session: "Session | None"
    draft: SessionDraft | None = None


@dataclass(frozen=True, slots=True)
class _Read:
    """What came of reading: `again`: the files of known programs that could not be read."""

    found: tuple[_Found, ...]
    refused: tuple[FileRefusedError, ...]
    again: tuple[Path, ...]


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
        self._waiting: deque[_Found] = deque()
        self._shown: _Found | None = None
        self._number = self._count = 0
        self._again: tuple[Path, ...] = ()
        self._placing: SessionDraft | None = None
        self._is_importing = False
        self.page = ImportPage()
        self.page.code.line_edit.returnPressed.connect(self.take_in)
        self.page.choose_files.clicked.connect(self._choose_files)
        self.page.choose_folder.clicked.connect(self._choose_folder)
        self.page.reading_requested.connect(self._on_reading_requested)
        self.page.draft.placing_requested.connect(self._on_placing_requested)

    @property
    def bar(self) -> BarState:
        """What can be done with what is shown."""
        if self._shown is None:
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

        def work(_opened: "OpenedLibrary", report: Report) -> _Read:
            return _read(paths, rate_hz, report)

        self.forget()
        name = paths[0].name if len(paths) == 1 else tr_n("{count} file", "{count} files", len(paths))
        self.working.emit(tr("Reading {folder}").format(folder=name.format(count=len(paths))))
        self._controller.run_long(work, self._on_read, self._on_read_refused, self._on_progressed, self)

    def take_in(self) -> None:
        """Put what is shown into the library, as a session of the patient with the code that is on the page."""
        code, shown = self.page.code.text.strip(), self._shown
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
        self._shown, self._is_importing = None, False

    @property
    def _is_draft(self) -> bool:
        return self._shown is not None and self._shown.draft is not None

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
        self.read(self._again, rate_hz)

    def _on_read(self, read: _Read) -> None:
        self._again = read.again
        if not read.found:
            self.page.show_nothing([program_name(key) for key in PROGRAMS])
        sentences = [str(refusal) for refusal in read.refused]
        more = len(sentences) - MOST_SENTENCES
        if more > 0:
            stated = tr_n("And {count} more file.", "And {count} more files.", more)
            sentences = [*sentences[:MOST_SENTENCES], stated.format(count=more)]
        self.page.show_unread(sentences, can_try_again=bool(read.again))
        self._waiting.extend(read.found)
        self._number, self._count = 0, len(read.found)
        if read.found:
            self._show_next()
        else:
            self.asked.emit()

    def _show_next(self) -> None:
        """Show the next session, or leave where there is none."""
        if not self._waiting:
            self.forget()
            self.left.emit()
            return
        shown = self._shown = self._waiting.popleft()
        self._number += 1
        which = tr("Session {number} of {count}: ").format(number=self._number, count=self._count)
        where = f"{which if self._count > 1 else ''}{shown.where}"
        if (session := shown.session) is not None:
            names = [recording.name for recording in session.recordings]
            code = session.patient.code
            self.page.show_session(where, names, code, session.findings, is_simulated=session.is_simulated)
        elif shown.draft is not None:
            program = program_name(shown.draft.recordings[0].trial.format)
            self.page.show_draft(where, program, shown.draft)
            if self.page.draft.can_be_placed:
                self._place(self._on_proposed, self._on_not_proposed)
        self.asked.emit()

    def _on_placing_requested(self) -> None:
        self._place(self._on_placed, self._on_placing_refused)

    def _place(self, on_placed: "Callable[[Chains | None], None]", on_refused: Callable[[str, str], None]) -> None:
        """Look in the motion for where the sensors of the draft that is shown were worn."""
        draft, worn = self._shown.draft if self._shown is not None else None, self.page.draft.worn

        def work(_opened: "OpenedLibrary") -> "Chains | None":
            return chains_of_motion(draft, worn) if draft is not None else None

        self._placing = draft
        self._controller.run(work, on_placed, on_refused, self)

    def _on_proposed(self, chains: "Chains | None") -> None:
        """Propose positions that nobody asked for: only certain ones, of the draft that is still shown."""
        is_shown = self._shown is not None and self._shown.draft is self._placing
        if chains is not None and chains.is_certain and is_shown and self.page.draft.can_be_placed:
            self.page.draft.show_chains(chains, takes_focus=False)

    def _on_not_proposed(self, _what: str, _remedy: str) -> None:
        """Nobody asked: the positions stay open."""

    def _on_placed(self, chains: "Chains | None") -> None:
        if chains is None:
            self.reported.emit(
                tr("Sensor positions could not be detected."),
                tr("Use a recording in which all sensors move, or enter the positions."),
            )
        elif not self.page.draft.show_chains(chains, takes_focus=True):
            self.reported.emit(
                tr("The movement does not fit the entered sensor positions."),
                tr("Two to seven sensors on legs and pelvis are needed. Check the sensor positions."),
            )

    def _on_placing_refused(self, what: str, remedy: str) -> None:
        self.reported.emit(what, remedy)

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


def _read(paths: Sequence[Path], rate_hz: float | None, report: Report) -> _Read:
    """All that can be read of these files and folders, put together to sessions."""
    report(0.0, paths[0].name)
    gathered = gather_foreign(paths, lambda: report(0.0, paths[0].name))
    refused, again = list(gathered.refused), []
    folders: list[_Found] = []
    trials: list[tuple[str, ImportedTrial]] = []
    places: dict[int, str] = {}  # by the trial's identity: where its files are
    for number, one in enumerate(gathered.trials):
        share, files = number / len(gathered.trials), [Path(file) for file in one.files]

        def waiting(share: float = share, name: str = one.name) -> None:
            report(share, name)

        waiting()
        try:
            if one.format == SESSION:
                folders.append(_Found(str(files[0]), read_foreign_session(files[0], waiting)))
            else:
                trial = read_foreign_trial(one.format, files, rate_hz, waiting)
                trials.append((one.name, trial))
                places[id(trial)] = str(files[0].parent if len(files) > 1 else files[0])
        except FileRefusedError as refusal:
            refused.append(refusal)
            again += files if one.format != SESSION else []
    drafts = [_Found(places[id(draft.recordings[0].trial)], None, draft) for draft in drafts_of(trials)]
    if len(paths) == 1 and len(refused) == 1 and not folders and not drafts and not again:
        raise refused[0]
    return _Read((*folders, *drafts), tuple(refused), tuple(again))


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

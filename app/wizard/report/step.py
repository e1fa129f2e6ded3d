"""What goes into the patient's file: the report as it will print, and the results as other programs read them."""

import logging
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog

from app.exports.proposed_names import free_name, session_name
from app.storage.audit import LETTER_FORMAT, REPORT_FORMAT, about
from app.storage.operators import CLINIC
from app.storage.stored import Action
from app.summary.course_lanes import CourseVisit
from app.summary.report_dates import day
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from app.system.logs import version_of
from app.system.progress import Report
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_new_file, ask_for_new_folder
from app.widgets.rail_row import StepState
from app.wizard.keys import Intent, KeyAction
from app.wizard.report.comment_control import CommentControl
from app.wizard.report.frame import ReportFrame
from app.wizard.report.leaving_dialog import LeavingDialog
from app.wizard.report.page import LETTER
from app.wizard.report.printing import PRINTED_PPI, ReportPrinter
from app.wizard.report.saving import OTHERS, Export, file_name
from app.wizard.report.thin_line import ThinLineSource
from app.wizard.resuming import course_to, courses_before, read_analysed
from app.wizard.step import Step, StepId
from app.wording.recordings import name_in_words
from app.wording.translation import tr
from app.workers.background import Work
from app.workers.library_controller import LibraryController
from core.session import RecordingKind
from core.video.key_frames import KeyFrame, key_frames

if TYPE_CHECKING:
    from app.reports.patient.document import ReportPreview
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import SessionSummary
    from app.wizard.report.leaving_dialog import Rows
    from app.wizard.report.writing import Documents
    from app.wizard.visit import Visit
    from core.video.clip import Clip

_log = logging.getLogger(__name__)

MOST_LINES = 3  # of what was not written: a banner holds no more


class ReportStep(Step):
    id = StepId.REPORT

    def __init__(self, visit: "Visit", controller: LibraryController, parent: QObject | None = None) -> None:
        super().__init__(visit, parent)
        self._controller = controller
        self._frame: ReportFrame | None = None
        self.dialog: QFileDialog | None = None
        self.saved: Path | None = None  # the report
        self.exported: Path | None = None  # the folder of the data
        self.written: Path | None = None  # the latest of them
        self.is_saving = False
        self._kept: frozenset[str] = frozenset()  # of what was typed freely: leaves with the files without a name
        self._clinic = ""
        self._earlier: tuple[UUID, AnalysedVisit] | None = None  # as was read last
        self._before: tuple[CourseVisit, ...] = ()  # earlier visits of the course, in order of time
        self._has_failed = False  # the preview, so that no page is in sight
        self._preview: ReportPreview | None = None
        self._preview_lock = Lock()
        self.comments = CommentControl(visit, self)
        self.comments.changed.connect(self._on_comment_changed)
        visit.preview.done.connect(self._on_previewed)
        visit.preview.failed.connect(self._on_preview_failed)
        visit.evaluation.done.connect(self._show)
        visit.clips.opened.connect(self._on_clips_opened)
        self._clips: tuple[Clip, ...] = ()
        self._thin = ThinLineSource(visit, self)
        self._thin.changed.connect(self._show)

    @property
    def page(self) -> "ReportFrame":
        if self._frame is None:
            self._frame = ReportFrame()
            self.comments.show_on(self._frame.report.editor)
            self._frame.report.options_changed.connect(self._on_options_changed)
            self._frame.report.sharper_required.connect(self._draw)
            self.printer = ReportPrinter(self._frame, tr("Print the report"), REPORT_FORMAT)
            self.letter_printer = ReportPrinter(self._frame, tr("Print the patient letter"), LETTER_FORMAT)
            for printer in (self.printer, self.letter_printer):
                printer.confirmed.connect(self._on_print_confirmed)
        return self._frame

    @property
    def title(self) -> str:
        return tr("Report")

    @property
    def note(self) -> str:
        return tr("saved") if self.saved is not None else ""

    @property
    def state(self) -> StepState:
        return StepState.DONE if self.saved is not None else StepState.TODO

    @property
    def topic(self) -> str:
        return "report"

    @property
    def comment(self) -> str:
        return self.comments.words

    def enter(self) -> None:
        self.comments.begin()
        self._read_choices()
        self._visit.clips.open()
        self._show()

    def leave(self) -> None:
        self.comments.flush()
        self._visit.preview.stop()

    def bar(self) -> BarState:
        can = self.can_save()
        save = BarAction(tr("Save report"), self._save, tr("Ctrl S"), Icon.FOLDER, is_enabled=can)
        export = BarAction(tr("Export data"), self._export, is_requested=False, is_enabled=can)
        letter = BarAction(tr("Patient letter"), self.print_letter, "", Icon.PRINT, is_enabled=can)
        put = BarAction(tr("Print"), self.print, tr("Ctrl P"), Icon.PRINT, is_enabled=can)
        quiet, written = (put, letter), self.written
        if written is None:
            return BarState(primary=save, others=(export,), quiet=quiet, note=self._note())
        show = BarAction(tr("Open the folder"), self._open_folder)
        note = tr("Saved as {folder}.").format(folder=written.name)
        is_first = self.saved is None
        return BarState(primary=replace(save, is_requested=is_first), others=(export,), quiet=(*quiet, show), note=note)

    @cached_property
    def _documents(self) -> "Documents":
        from app.wizard.report.writing import Documents  # Typst, Arrow and all formats, once they are asked for

        return Documents()

    def _report_preview(self) -> "ReportPreview":
        """Give the one preview of this step; called by the threads that work for it."""
        from app.reports.patient.document import ReportPreview  # Typst alone: no page waits for the formats

        with self._preview_lock:
            if self._preview is None:
                self._preview = ReportPreview()
            return self._preview

    def _note(self) -> str:
        if self.comments.is_unconfirmed:
            return tr("The clinical comment is not confirmed, so it is not printed.")
        return tr("The report shows the patient code only, no name.")

    def _save(self) -> None:
        """Ask where the report's PDF is to be."""
        if not self.can_save() or self.is_saving or self._visit.session is None:
            return
        self.comments.flush()
        self.dialog = ask_for_new_file(self.page, tr("Save report"), self._file_proposed_in, self.save_report)

    def _file_proposed_in(self, place: Path) -> str:
        return free_name(place, self._proposed_name(), ".pdf")

    def save_report(self, file: str) -> None:
        """Write the report as one PDF; `saved` names it once it is there."""
        request, stored = self.request(), self._visit.session
        if request is not None and stored is not None:
            self.is_saving = True
            session_id = stored.id

            def work(opened: "OpenedLibrary", report: Report) -> Path:
                return self._documents.write_report(opened, report, request, session_id, Path(file))

            self._controller.run_long(work, self._on_saved, self._on_refused, None, self)

    def _export(self) -> None:
        if not self.can_save() or self.is_saving:
            return
        self.comments.flush()
        session = self._visit.session
        if session is None or not set(OTHERS) & set(self.page.report.formats.chosen):
            self._ask_where()
            return
        session_id = session.id

        def work(opened: "OpenedLibrary") -> "dict[frozenset[str], Rows]":
            return self._documents.previews(opened, session_id)

        self._controller.run(work, self._on_previews, self._on_refused, self)

    def _on_previews(self, previews: "Mapping[frozenset[str], Rows]") -> None:
        """Show what leaves without the name before anybody states where to."""
        dialog = LeavingDialog(previews, self.page)
        dialog.confirmed.connect(self._on_leaving_confirmed)
        dialog.open()

    def _on_leaving_confirmed(self, kept: frozenset[str]) -> None:
        self._kept = kept
        self._ask_where()

    def _ask_where(self) -> None:
        title = tr("Export report and results into a new folder")
        self.dialog = ask_for_new_folder(self.page, title, self._proposed_in, self.save_in)

    def _proposed_in(self, place: Path) -> str:
        return free_name(place, self._proposed_name())

    def _proposed_name(self) -> str:
        if self._visit.session is None:
            return ""
        reported = self._visit.session.details
        return session_name(reported.patient.code, reported.started)

    def _open_folder(self) -> None:
        if (written := self.written) is not None:
            folder = written if written == self.exported else written.parent
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))

    def on_intent(self, intent: Intent) -> bool:
        if intent.action is KeyAction.SAVE:
            self._save()
            return True
        if intent.action is KeyAction.PRINT:
            self.print()
            return True
        return False

    def print(self) -> None:
        """Ask for a printer, and put the pages on it as they are shown."""
        self._ask_printer(self.printer)

    def print_letter(self) -> None:
        """Ask for a printer, and put the patient letter on it."""
        self._ask_printer(self.letter_printer, LETTER)

    def _ask_printer(self, printer: ReportPrinter, what: str = "") -> None:
        if self.can_save() and self._visit.session is not None:
            self.comments.flush()
            name = file_name(self._visit.session, what).removesuffix(".pdf")
            printer.ask(name, self.page.report.paper.choice)

    def _on_print_confirmed(self) -> None:
        printer, request, stored = self.sender(), self.request(), self._visit.session
        if request is None or stored is None or not isinstance(printer, ReportPrinter):
            return
        session_id, document, language = stored.id, printer.document, self.page.report.language.choice

        def work(opened: "OpenedLibrary", _report: Report) -> tuple[str, list[bytes]]:
            opened.library.audit.note(Action.PRINT, about("session", session_id), format=document)
            return document, self._documents.printed_pages(document, request, language, PRINTED_PPI)

        self._controller.run_long(work, self._on_printable, self._on_refused, None, self)

    def _on_printable(self, found: tuple[str, list[bytes]]) -> None:
        document, pages = found
        printer = self.printer if document == REPORT_FORMAT else self.letter_printer
        if not printer.put(pages):
            self.reported.emit(
                tr("The printer did not accept the pages."), tr("Save or export them, then print the file.")
            )

    def can_save(self) -> bool:
        return self._has_results() and not self._lacks_earlier

    def _has_results(self) -> bool:
        """Whether there is a walk to report: of a free motion alone no report can be made."""
        evaluation = self._visit.evaluation
        if evaluation.analysis is None or evaluation.is_busy:
            return False
        return any(recording.kind is RecordingKind.WALKING for recording in evaluation.analysis.recordings)

    def _show(self) -> None:
        if self._frame is None or not self._frame.isVisible():
            return
        if self._has_results():
            self._frame.setCurrentWidget(self._frame.report)
            self._offer_video()  # the results may have come after the videos
            self._draw()
        else:
            self._frame.sentence.show_sentence(tr("There are no results yet."), tr("Record a walk first."))
            self._frame.setCurrentWidget(self._frame.sentence)
        self.changed.emit()

    def request(self) -> ReportRequest | None:
        """What the report shows now; None where there is no walk, or the visit to compare with is not read."""
        evaluation = self._visit.evaluation
        if evaluation.session is None or evaluation.analysis is None or self._lacks_earlier:
            return None
        visit = AnalysedVisit(evaluation.session, evaluation.analysis)
        walks = default_walks(visit)
        if not walks:
            return None
        chosen, (comment, comment_by) = self.page.report.added.chosen, self.comments.printed
        course = self._course(visit)
        return ReportRequest(
            visit=visit,
            walks=walks,
            made_at=datetime.now().astimezone(),
            software_version=version_of("gaitwright"),
            comment=comment,
            comment_by=comment_by,
            operator=evaluation.session.operator,
            clinic=self._clinic,
            earlier=self._earlier_chosen(),
            course=course,
            has_course_page="course" in chosen,
            thin=self._thin.line(visit, walks, course),
            paper=self.page.report.paper.choice,
            key_frames=self._key_frames(visit, walks[-1]) if self.page.report.video.isChecked() else (),
        )

    def _key_frames(self, visit: AnalysedVisit, name: str) -> tuple[KeyFrame, ...]:
        """Pictures of the typical stride, from the first camera whose times are known; none of a damaged video."""
        with suppress(OSError):
            for clip in self._clips:
                if clip.recording == name and (
                    frames := key_frames(clip, visit.walk(name), visit.analysis.affected_side)
                ):
                    return frames
        return ()

    def _on_clips_opened(self, clips: "tuple[Clip, ...]") -> None:
        self._clips = clips
        self._offer_video()

    def _offer_video(self) -> None:
        """Offer pictures of the video once both the results and the videos are there."""
        if self._frame is None:
            return
        evaluation = self._visit.evaluation
        walks: Sequence[str] = ()
        if evaluation.session is not None and evaluation.analysis is not None:
            walks = default_walks(AnalysedVisit(evaluation.session, evaluation.analysis))
        is_offered = any(clip.recording in walks[-1:] and clip.is_synchronised for clip in self._clips)
        self._frame.report.offer_video(is_offered=is_offered)

    def _course(self, visit: AnalysedVisit) -> tuple[CourseVisit, ...]:
        """The patient's visits up to this one, as far as their figures are known."""
        stored = self._visit.session
        return course_to(self._before, stored, visit.session, visit.analysis) if stored is not None else ()

    def _draw(self) -> None:
        """Set the pages again, beside the screen."""
        request = self.request()
        if request is not None:
            self._visit.preview.start(self._previewing(request, self.page.report.pages_ppi, not self.comment))

    def _previewing(self, request: ReportRequest, ppi: float, is_draft_required: bool) -> Work:
        def work(_report: Report) -> object:
            preview = self._report_preview()
            return preview.pages(request, ppi), preview.comment_draft(request) if is_draft_required else ""

        return work

    def _on_previewed(self, found: tuple[list[bytes], str]) -> None:
        pages, draft = found
        self.page.report.show_pages(pages)
        self.comments.take_draft(draft)
        if self._has_failed:
            self._has_failed = False
            self.reported.emit("", "")

    def _on_preview_failed(self, error: Exception) -> None:
        """Show no page rather than those of what was chosen before."""
        _log.error("the report could not be set", exc_info=error)
        self._has_failed = True
        self.page.report.show_pages([])
        self.reported.emit(tr("The report cannot be shown."), tr("See the log for details."))

    def _on_comment_changed(self) -> None:
        if self._frame is not None and self._frame.isVisible():
            self._draw()
        self.changed.emit()

    def _on_options_changed(self) -> None:
        chosen = self.page.report.chosen_visit
        if chosen is not None and self._earlier_chosen() is None:
            self._read_earlier(chosen)
        else:
            self._draw()

    # the clinic's name, and earlier visits

    def _read_choices(self) -> None:
        session = self._visit.session
        if session is None:
            return
        current = session

        def read(opened: "OpenedLibrary") -> "tuple[str, list[SessionSummary], tuple[CourseVisit, ...]]":
            lines = opened.library.sessions.list(current.patient_id)  # latest first
            before = [line for line in lines if line.id != current.id and line.started < current.details.started]
            return str(opened.library.settings.get(CLINIC, "")), before, courses_before(opened, current)

        self._controller.run(read, self._on_choices, self._on_refused, self)

    def _on_choices(self, found: "tuple[str, list[SessionSummary], tuple[CourseVisit, ...]]") -> None:
        clinic, lines, before = found
        self.page.report.show_visits([(line.id, _words_of(line)) for line in lines])
        if (clinic, before) != (self._clinic, self._before):
            self._clinic, self._before = clinic, before
            self._show()
        if before:
            self._thin.read()

    def _earlier_chosen(self) -> AnalysedVisit | None:
        """The earlier visit to compare with, once it is read."""
        chosen = self.page.report.chosen_visit
        return self._earlier[1] if self._earlier is not None and self._earlier[0] == chosen else None

    @property
    def _lacks_earlier(self) -> bool:
        """Whether a visit is chosen to compare with that is not read yet, or cannot be."""
        return self.page.report.chosen_visit is not None and self._earlier_chosen() is None

    def _read_earlier(self, session_id: UUID) -> None:
        def read(opened: "OpenedLibrary", report: Report) -> tuple[UUID, AnalysedVisit]:
            return session_id, AnalysedVisit(*read_analysed(opened, session_id, report))

        self._controller.run_long(read, self._on_earlier_read, self._on_earlier_refused, None, self)
        self.changed.emit()

    def _on_earlier_read(self, found: tuple[UUID, AnalysedVisit]) -> None:
        self._earlier = found
        self._on_options_changed()  # another one may have been chosen meanwhile
        self.changed.emit()

    def _on_earlier_refused(self, what: str, remedy: str) -> None:
        self.page.report.show_pages([])  # those in sight are of what was chosen before
        self._on_refused(what, remedy)
        self.changed.emit()

    def save_in(self, folder: str) -> None:
        """Write the report and the chosen files into a new folder; `exported` names it once they are there."""
        session, analysis = self._visit.evaluation.session, self._visit.evaluation.analysis
        stored = self._visit.session
        if session is None or analysis is None or stored is None:
            return
        page = self.page.report
        chosen, language = tuple(page.formats.chosen), page.language.choice
        export = Export(session, analysis, self.request(), chosen, self._kept, language)
        self.is_saving = True

        def work(opened: "OpenedLibrary", report: Report) -> tuple[Path, list[str]]:
            return self._documents.write_export(opened, report, export, stored, Path(folder))

        self._controller.run_long(work, self._on_exported, self._on_refused, None, self)

    def _on_saved(self, file: Path) -> None:
        self.is_saving = False
        self.saved = self.written = file
        self.reported.emit("", "")
        self.changed.emit()

    def _on_exported(self, found: tuple[Path, list[str]]) -> None:
        self.is_saving = False
        self.exported, lines = found
        self.written = self.exported
        self.reported.emit(tr("Not every file was written.") if lines else "", "\n".join(lines[:MOST_LINES]))
        self.changed.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.is_saving = False
        self.reported.emit(what, remedy)


def _words_of(line: "SessionSummary") -> str:
    """A visit in a list: its day, and under which conditions the patient walked."""
    return ", ".join([day(line.started), *filter(None, dict.fromkeys(map(name_in_words, line.conditions)))])

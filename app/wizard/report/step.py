"""What goes into the patient's file: the report as it will print, and the results as other programs read them."""

import logging
from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog, QStackedWidget

from app.exports.proposed_names import free_name, session_name
from app.storage.audit import REPORT_FORMAT, about
from app.storage.operators import CLINIC
from app.storage.pseudonyms import Typed
from app.storage.stored import Action, LibraryError
from app.summary.course_lanes import CourseVisit
from app.summary.report_dates import day
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from app.system.logs import version_of
from app.system.progress import Report
from app.theme.icons import Icon
from app.theme.notifier import ThemeNotifier
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_new_folder
from app.widgets.rail_row import StepState
from app.widgets.sentence_page import SentencePage
from app.wizard.keys import Intent, KeyAction
from app.wizard.report.leaving_dialog import LeavingDialog
from app.wizard.report.page import ReportPage
from app.wizard.report.printing import PRINTED_PPI, ReportPrinter
from app.wizard.resuming import course_to, courses_before, read_analysed
from app.wizard.step import Step, StepId
from app.wording.translation import capitalised, filled, tr
from app.workers.background import Work
from app.workers.library_controller import LibraryController
from core.session import RecordingKind
from devices.decoders import DECODERS
from devices.files.refusal import FileRefusedError

if TYPE_CHECKING:
    from app.reports.patient.document import ReportPreview
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import SessionSummary
    from app.wizard.report.leaving_dialog import Rows
    from app.wizard.visit import Visit

_log = logging.getLogger(__name__)

MOST_LINES = 3  # of what was not written: a banner holds no more
OTHERS = ("xlsx", "c3d", "mot", "fhir")


class ReportStep(Step):
    id = StepId.REPORT

    def __init__(
        self, look: ThemeNotifier, visit: "Visit", controller: LibraryController, parent: QObject | None = None
    ) -> None:
        super().__init__(look, visit, parent)
        self._controller = controller
        self._frame: _ReportFrame | None = None
        self.dialog: QFileDialog | None = None
        self.saved: Path | None = None
        self.is_saving = False
        self._kept: frozenset[str] = frozenset()  # of what was typed freely: leaves with the files without a name
        self._shown_comment = ""  # as it was last shown on the page, or passed on from there
        self._clinic = ""
        self._earlier: tuple[UUID, AnalysedVisit] | None = None  # as was read last
        self._before: tuple[CourseVisit, ...] = ()  # earlier visits of the course, in order of time
        self._has_failed = False  # the preview, so that no page is in sight
        self._preview: ReportPreview | None = None  # of its threads
        visit.preview.done.connect(self._on_previewed)
        visit.preview.failed.connect(self._on_preview_failed)
        visit.evaluation.done.connect(self._show)
        visit.changed.connect(self._on_visit_changed)

    @property
    def page(self) -> "_ReportFrame":
        if self._frame is None:
            self._frame = _ReportFrame(self._look)
            self._frame.report.comment_edited.connect(self._on_comment_edited)
            self._frame.report.options_changed.connect(self._on_options_changed)
            self._frame.report.sharper_required.connect(self._draw)
            self.printer = ReportPrinter(self._frame)
            self.printer.confirmed.connect(self._on_print_confirmed)
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
        return self._visit.record.comment

    def enter(self) -> None:
        self._show_comment()
        self._read_choices()
        self._show()

    def leave(self) -> None:
        self.page.report.flush()
        self._visit.preview.stop()

    def bar(self) -> BarState:
        can_save = self.can_save()
        save = BarAction(tr("Save the report"), self._save, tr("Ctrl S"), Icon.FOLDER, is_enabled=can_save)
        put = BarAction(tr("Print"), self.print, tr("Ctrl P"), Icon.PRINT, is_requested=False, is_enabled=can_save)
        if self.saved is None:
            return BarState(primary=save, others=(put,), note=tr("The report shows the patient code only, no name."))
        note = tr("Saved as {folder}. Saving again asks for the folder.").format(folder=self.saved.name)
        show = BarAction(tr("Open the folder"), self._open_folder, is_requested=False)
        return BarState(primary=replace(save, is_requested=False), others=(put, show), note=note)

    def _save(self) -> None:
        if not self.can_save() or self.is_saving:
            return
        self.page.report.flush()
        session = self._visit.session
        if session is None or not set(OTHERS) & set(self.page.report.formats.chosen):
            self._ask_where()
            return
        session_id = session.id
        self._controller.run(lambda opened: _previews(opened, session_id), self._on_previews, self._on_refused, self)

    def _on_previews(self, previews: "Mapping[frozenset[str], Rows]") -> None:
        """Show what leaves without the name before anybody states where to."""
        dialog = LeavingDialog(self._look, previews, self.page)
        dialog.confirmed.connect(self._on_leaving_confirmed)
        dialog.open()

    def _on_leaving_confirmed(self, kept: frozenset[str]) -> None:
        self._kept = kept
        self._ask_where()

    def _ask_where(self) -> None:
        title = tr("Save the report and the results in a new folder")
        self.dialog = ask_for_new_folder(self.page, title, self._proposed_in, self.save_in)

    def _proposed_in(self, place: Path) -> str:
        if self._visit.session is None:
            return ""
        reported = self._visit.session.details
        return free_name(place, session_name(reported.patient.code, reported.started))

    def _open_folder(self) -> None:
        if self.saved is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self.saved)))

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
        if not self.can_save() or self._visit.session is None:
            return
        self.page.report.flush()
        reported = self._visit.session.details
        self.printer.ask(session_name(reported.patient.code, reported.started), self.page.report.paper.choice)

    def _on_print_confirmed(self) -> None:
        request, stored = self._request(), self._visit.session
        if request is None or stored is None:
            return
        session_id = stored.id

        def work(opened: "OpenedLibrary", _report: Report) -> list[bytes]:
            from app.reports.patient.document import ReportPreview

            opened.library.audit.note(Action.PRINT, about("session", session_id), format=REPORT_FORMAT)
            return ReportPreview().pages(request, PRINTED_PPI)

        self._controller.run_long(work, self._on_printable, self._on_refused, None, self)

    def _on_printable(self, pages: list[bytes]) -> None:
        if not self.printer.put(pages):
            self.reported.emit(
                tr("The printer did not accept the report."), tr("Save the report, then print the file.")
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
            self._draw()
        else:
            self._frame.sentence.show_sentence(tr("There are no results yet."), tr("Record a walk first."))
            self._frame.setCurrentWidget(self._frame.sentence)
        self.changed.emit()

    def _request(self) -> ReportRequest | None:
        evaluation = self._visit.evaluation
        if evaluation.session is None or evaluation.analysis is None or self._lacks_earlier:
            return None
        visit = AnalysedVisit(evaluation.session, evaluation.analysis)
        walks = default_walks(visit)
        if not walks:
            return None
        chosen = self.page.report.added.chosen
        return ReportRequest(
            visit=visit,
            walks=walks,
            made_at=datetime.now().astimezone(),
            software_version=version_of("gaitwright"),
            comment=self.comment,
            operator=evaluation.session.operator,
            clinic=self._clinic,
            earlier=self._earlier_chosen(),
            course=self._course(visit) if "course" in chosen else (),
            patient_language=self.page.report.patient_language,
            paper=self.page.report.paper.choice,
        )

    def _course(self, visit: AnalysedVisit) -> tuple[CourseVisit, ...]:
        """The patient's visits up to this one, as far as their figures are known."""
        stored = self._visit.session
        return course_to(self._before, stored, visit.session, visit.analysis) if stored is not None else ()

    def _draw(self) -> None:
        """Set the pages again, beside the screen."""
        request = self._request()
        if request is not None:
            self._visit.preview.start(self._previewing(request, self.page.report.pages_ppi))

    def _previewing(self, request: ReportRequest, ppi: float) -> Work:
        def work(_report: Report) -> object:
            from app.reports.patient.document import ReportPreview

            self._preview = self._preview or ReportPreview()
            return self._preview.pages(request, ppi)

        return work

    def _on_previewed(self, pages: list[bytes]) -> None:
        self.page.report.show_pages(pages)
        if self._has_failed:
            self._has_failed = False
            self.reported.emit("", "")

    def _on_preview_failed(self, error: Exception) -> None:
        """Show no page rather than those of what was chosen before."""
        _log.error("the report could not be set", exc_info=error)
        self._has_failed = True
        self.page.report.show_pages([])
        self.reported.emit(tr("The report cannot be shown."), tr("See the log for details."))

    def _on_comment_edited(self, comment: str) -> None:
        shown, self._shown_comment = self._shown_comment, comment
        self._visit.record.set_comment(comment, shown)
        self._draw()

    def _show_comment(self) -> None:
        self._shown_comment = self.comment
        self.page.report.show_comment(self.comment)

    def _on_visit_changed(self) -> None:
        """Show the words of another station, unless somebody types."""
        frame = self._frame
        if frame is not None and self.comment != self._shown_comment and not frame.report.is_typing:
            self._show_comment()
            if frame.isVisible():
                self._draw()

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
        """Write the report and the results into a new folder; `saved` names it once they are there."""
        session, analysis = self._visit.evaluation.session, self._visit.evaluation.analysis
        stored, request = self._visit.session, self._request()
        if session is None or analysis is None or stored is None:
            return
        out, session_id = Path(folder), stored.id
        chosen, kept = self.page.report.formats.chosen, self._kept
        name = f"{session_name(stored.details.patient.code, stored.details.started)}.pdf"
        self.is_saving = True

        def save(opened: "OpenedLibrary", report: Report) -> tuple[Path, list[str]]:
            from app.exports.exports import Format, export_from_library
            from app.exports.result_folder import LOG, check_place, write_results, written_beside
            from app.reports.patient.document import make_report
            from app.reports.patient.report_file import write_visits

            typed, lines = [Typed(one) for one in sorted(kept)], list[str]()
            report(0.0, tr("writing"))
            try:
                check_place(out, opened.folder)
                subject, is_document = about("session", session_id), request is not None
                exporting = opened.library.audit.exporting(subject, format=REPORT_FORMAT, is_document=is_document)
                with exporting, written_beside(out) as beside:
                    if "csv" in chosen or "rrd" in chosen:
                        write_results(session, analysis, beside)
                    if "rrd" in chosen:
                        from app.review.rerun_log import write_log  # Rerun takes longer to load than to write

                        write_log(session, analysis, beside / LOG)
                    if request is not None:
                        (beside / name).write_bytes(make_report(request))
                        if "csv" in chosen:
                            write_visits(request, beside)
                    formats = [Format(name) for name in OTHERS if name in chosen]
                    if formats:
                        lines = export_from_library(
                            opened,
                            session_id,
                            formats,
                            beside,
                            DECODERS,
                            report,
                            analysed=lambda _session: analysis,
                            kept=typed,
                        )
            except FileRefusedError as refusal:
                what, remedy = (filled(stated, refusal.values) for stated in (refusal.what, refusal.remedy))
                raise LibraryError(capitalised(what), remedy) from refusal
            except OSError as problem:
                what = tr("{folder} is not writable").format(folder=out.name)
                raise LibraryError(what, tr("Choose another folder; the recordings are unchanged")) from problem
            return out, lines

        self._controller.run_long(save, self._on_saved, self._on_refused, None, self)

    def _on_saved(self, found: tuple[Path, list[str]]) -> None:
        self.is_saving, (self.saved, lines) = False, found
        self.reported.emit(tr("Not every file was written.") if lines else "", "\n".join(lines[:MOST_LINES]))
        self.changed.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.is_saving = False
        self.reported.emit(what, remedy)


def _previews(opened: "OpenedLibrary", session_id: UUID) -> "dict[frozenset[str], Rows]":
    """For each choice of what was typed freely all that then leaves without the name, beside the figures."""
    from app.exports.exports import preview_from_library

    choices = [chosen for count in range(len(Typed) + 1) for chosen in combinations(Typed, count)]
    return {
        frozenset(map(str, chosen)): [
            (name, str(value)) for name, value in preview_from_library(opened, session_id, chosen)
        ]
        for chosen in choices
    }


def _words_of(line: "SessionSummary") -> str:
    """A visit in a list: its day, and under which conditions the patient walked."""
    return ", ".join([day(line.started), *filter(None, dict.fromkeys(line.conditions))])


class _ReportFrame(QStackedWidget):
    """The report, or what is in its place."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self.sentence = SentencePage(look)
        self.report = ReportPage(look)
        for page in (self.sentence, self.report):
            self.addWidget(page)

    def set_room(self, width: float, height: float) -> None:
        self.report.set_room(width, height)

    def focus(self) -> None:
        if self.currentWidget() is self.report:
            self.report.focus()

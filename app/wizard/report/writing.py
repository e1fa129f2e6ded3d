"""Documents of the report step, set and written: with Typst, Arrow and the formats, which nothing before it needs."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import combinations
from pathlib import Path
from uuid import UUID

from app.exports.exports import Format, export_from_library, preview_from_library
from app.exports.result_folder import LOG, WORKBOOK, check_place, write_results, written_beside
from app.exports.spreadsheet import workbook
from app.reports.patient.document import ReportPreview, make_report
from app.reports.patient.letter import letter_pages, make_letter
from app.reports.patient.report_file import check_report_place, replace_report, write_visits
from app.review.installed import has_rerun, write_log
from app.storage.audit import LETTER_FORMAT, REPORT_FORMAT, about
from app.storage.opened import OpenedLibrary
from app.storage.pseudonyms import Typed
from app.storage.stored import LibraryError, StoredSession
from app.summary.request import ReportRequest
from app.system.progress import Report
from app.wizard.report.leaving_dialog import Rows
from app.wizard.report.page import LETTER
from app.wizard.report.saving import OTHERS, Export, file_name
from app.wording.translation import capitalised, filled, later, tr
from devices.decoders import DECODERS
from devices.files.refusal import FileRefusedError


class Documents:
    """All of it by one name, which the step imports where it is asked for; nothing is kept."""

    def write_report(
        self, opened: OpenedLibrary, report: Report, request: ReportRequest, session_id: UUID, out: Path
    ) -> Path:
        """Write the report's PDF to `out`, which only a PDF may be at."""
        report(0.0, tr("writing"))
        with _refusals_in_words(out):
            if opened.folder.resolve() in out.resolve().parents:
                raise FileRefusedError(
                    str(out), later("this lies inside the library"), later("Choose a folder outside the library")
                )
            check_report_place(out)
            with opened.library.audit.exporting(about("session", session_id), format=REPORT_FORMAT, is_document=True):
                replace_report(make_report(request), out)
        return out

    def write_export(
        self, opened: OpenedLibrary, report: Report, export: Export, stored: StoredSession, out: Path
    ) -> tuple[Path, list[str]]:
        """Write the report and the chosen files into the new folder `out`."""
        chosen, request, lines = export.chosen, export.request, list[str]()
        report(0.0, tr("writing"))
        with _refusals_in_words(out):
            check_place(out, opened.folder)
            subject, is_document = about("session", stored.id), request is not None
            noted = opened.library.audit.exporting(subject, format=REPORT_FORMAT, is_document=is_document)
            with noted, written_beside(out) as beside:
                if "csv" in chosen or "rrd" in chosen:
                    write_results(export.session, export.analysis, beside)
                if "rrd" in chosen and has_rerun():
                    write_log(export.session, export.analysis, beside / LOG)
                if request is not None:
                    (beside / file_name(stored)).write_bytes(make_report(request))
                    (beside / WORKBOOK).write_bytes(workbook(export.session, export.analysis, request.paper))
                    if LETTER in chosen:
                        (beside / file_name(stored, LETTER)).write_bytes(make_letter(request, export.letter_language))
                    if "csv" in chosen:
                        write_visits(request, beside)
                formats = [Format(name) for name in OTHERS if name in chosen]
                formats += [Format.STO] if Format.MOT in formats else []  # both are OpenSim's
                if formats:
                    lines = export_from_library(
                        opened,
                        stored.id,
                        formats,
                        beside,
                        DECODERS,
                        report,
                        analysed=lambda _session: export.analysis,
                        kept=[Typed(one) for one in sorted(export.kept)],
                    )
        return out, lines

    def previews(self, opened: OpenedLibrary, session_id: UUID) -> dict[frozenset[str], Rows]:
        """For each choice of what was typed freely all that then leaves without the name, beside the figures."""
        choices = [chosen for count in range(len(Typed) + 1) for chosen in combinations(Typed, count)]
        return {
            frozenset(map(str, chosen)): [
                (name, str(value)) for name, value in preview_from_library(opened, session_id, chosen)
            ]
            for chosen in choices
        }

    def printed_pages(self, document: str, request: ReportRequest, language: str, ppi: float) -> list[bytes]:
        """Draw the report, or the letter in a language, as fine as it is printed."""
        if document == LETTER_FORMAT:
            return letter_pages(request, language, ppi)
        return ReportPreview().pages(request, ppi)


@contextmanager
def _refusals_in_words(out: Path) -> Iterator[None]:
    try:
        yield
    except FileRefusedError as refusal:
        what, remedy = (filled(stated, refusal.values) for stated in (refusal.what, refusal.remedy))
        raise LibraryError(capitalised(what), remedy) from refusal
    except OSError as problem:
        what = tr("{folder} is not writable").format(folder=out.name)
        raise LibraryError(what, tr("Choose another folder; the recordings are unchanged")) from problem

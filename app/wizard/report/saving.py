"""What is written from the report step: the report alone, or the results as other programs read them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from app.exports.proposed_names import session_name
from app.storage.audit import REPORT_FORMAT, about
from app.storage.pseudonyms import Typed
from app.storage.stored import LibraryError
from app.summary.request import ReportRequest
from app.system.progress import Report
from app.wizard.report.page import LETTER
from app.wording.translation import capitalised, filled, later, tr
from core.results import Analysis
from core.session import Session
from devices.decoders import DECODERS
from devices.files.refusal import FileRefusedError

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import StoredSession
    from app.wizard.report.leaving_dialog import Rows

OTHERS = ("xlsx", "c3d", "mot", "fhir")  # without the patient's name


@dataclass(frozen=True, slots=True)
class Export:
    """What is exported of a session: files by their keys on the page; `kept` of what was typed freely."""

    session: Session
    analysis: Analysis
    request: ReportRequest | None
    chosen: tuple[str, ...]
    kept: frozenset[str]
    letter_language: str


def file_name(stored: "StoredSession", what: str = "") -> str:
    """A document's name: the patient's code and the day, and what it is where it is not the report."""
    return f"{session_name(stored.details.patient.code, stored.details.started, what)}.pdf"


def saving_report(
    request: ReportRequest, session_id: UUID, out: Path
) -> "Callable[[OpenedLibrary, Report], tuple[Path, list[str]]]":
    """Give the work that writes the report's PDF to `out`, which only a PDF may be at."""

    def save(opened: "OpenedLibrary", report: Report) -> tuple[Path, list[str]]:
        from app.reports.patient.document import make_report
        from app.reports.patient.report_file import check_report_place, replace_report

        report(0.0, tr("writing"))
        with _refusals_in_words(out):
            if opened.folder.resolve() in out.resolve().parents:
                raise FileRefusedError(
                    str(out), later("this lies inside the library"), later("Choose a folder outside the library")
                )
            check_report_place(out)
            with opened.library.audit.exporting(about("session", session_id), format=REPORT_FORMAT, is_document=True):
                replace_report(make_report(request), out)
        return out, []

    return save


def exporting(
    export: Export, stored: "StoredSession", out: Path
) -> "Callable[[OpenedLibrary, Report], tuple[Path, list[str]]]":
    """Give the work that writes the report and the chosen files into the new folder `out`."""
    session_id, chosen, request = stored.id, export.chosen, export.request

    def save(opened: "OpenedLibrary", report: Report) -> tuple[Path, list[str]]:
        from app.exports.exports import Format, export_from_library
        from app.exports.result_folder import LOG, check_place, write_results, written_beside
        from app.reports.patient.document import make_report
        from app.reports.patient.letter import make_letter
        from app.reports.patient.report_file import write_visits

        typed, lines = [Typed(one) for one in sorted(export.kept)], list[str]()
        report(0.0, tr("writing"))
        with _refusals_in_words(out):
            check_place(out, opened.folder)
            subject, is_document = about("session", session_id), request is not None
            noted = opened.library.audit.exporting(subject, format=REPORT_FORMAT, is_document=is_document)
            with noted, written_beside(out) as beside:
                if "csv" in chosen or "rrd" in chosen:
                    write_results(export.session, export.analysis, beside)
                if "rrd" in chosen:
                    from app.review.rerun_log import write_log  # Rerun takes longer to load than to write

                    write_log(export.session, export.analysis, beside / LOG)
                if request is not None:
                    (beside / file_name(stored)).write_bytes(make_report(request))
                    if LETTER in chosen:
                        letter = make_letter(request, export.letter_language)
                        (beside / file_name(stored, LETTER)).write_bytes(letter)
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
                        analysed=lambda _session: export.analysis,
                        kept=typed,
                    )
        return out, lines

    return save


def previews(opened: "OpenedLibrary", session_id: UUID) -> "dict[frozenset[str], Rows]":
    """For each choice of what was typed freely all that then leaves without the name, beside the figures."""
    from app.exports.exports import preview_from_library

    choices = [chosen for count in range(len(Typed) + 1) for chosen in combinations(Typed, count)]
    return {
        frozenset(map(str, chosen)): [
            (name, str(value)) for name, value in preview_from_library(opened, session_id, chosen)
        ]
        for chosen in choices
    }


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

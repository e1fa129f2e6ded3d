"""Turn the pages into a document. One JSON for the template, one PDF/A-2a and PDF/UA-1 out of memory."""

import json
from datetime import datetime, timedelta, timezone
from importlib.resources import files
from threading import Lock
from typing import Any

import typst

from app.reports.blocks import Block
from app.reports.patient.comparison_page import comparison_of, comparison_page, not_compared_page
from app.reports.patient.curves_page import curves_page
from app.reports.patient.first_page import comment, first_page
from app.reports.patient.fitting_page import fitting_page
from app.reports.patient.key_frames_page import key_frames_page
from app.reports.patient.method_page import words_page
from app.reports.patient.time_page import time_page
from app.reports.patient.timed_page import timed_page
from app.reports.patient.trend_page import trend_page
from app.summary.comment_draft import comment_draft
from app.summary.facts import Facts
from app.summary.plain_text import isolated, plain, shortened
from app.summary.prosthesis_fitting import fitting_of
from app.summary.report_dates import day
from app.summary.request import ReportRequest
from app.wording.translation import spoken_language, tr
from core.body import JointKind

PAGES = files("resources") / "report" / "pages.typ"  # what all documents share
TEMPLATE = files("resources") / "report" / "report.typ"
CODE_LENGTH = 16  # of the running head
TITLE_CODE_LENGTH = 24


def make_report(request: ReportRequest) -> bytes:
    """Make the report's PDF, the same bytes for the same request; raises KeyError for an unanalysed walk."""
    return set_pages(PAGES.read_bytes() + TEMPLATE.read_bytes(), report_data(request), request.made_at)


def set_pages(template: bytes, data: dict[str, Any], made_at: datetime) -> bytes:
    """Set a document's data by a template that begins with PAGES; the same give the same bytes."""
    pdf, _ = typst.compile_with_warnings(
        template,
        format="pdf",
        font_paths=_fonts(),
        ignore_system_fonts=True,
        sys_inputs={"data": json.dumps(data, ensure_ascii=False)},
        pdf_standards=["a-2a", "ua-1"],
        timestamp=_whole_seconds(made_at),
    )
    return pdf


def draw_pages(template: bytes, data: dict[str, Any], made_at: datetime, ppi: float) -> list[bytes]:
    """The same pages as PNG, of so many px an inch."""
    pages: Any = typst.compile(  # annotated as bytes; for PNG, it is a list with one for each page
        template,
        format="png",
        ppi=ppi,
        font_paths=_fonts(),
        ignore_system_fonts=True,
        sys_inputs={"data": json.dumps(data, ensure_ascii=False)},
        timestamp=_whole_seconds(made_at),
    )
    return list(pages) if isinstance(pages, list) else [pages]


class ReportPreview:
    """The pages for a look before, again and again while somebody types: what the words do not change is kept."""

    def __init__(self) -> None:
        self._lock = Lock()  # a look that nobody waits for any more may not have ended when the next begins
        self._template = PAGES.read_bytes() + TEMPLATE.read_bytes()
        self._compiler = typst.Compiler(self._template, font_paths=_fonts(), ignore_system_fonts=True)
        self._known: tuple[ReportRequest, Facts, dict[str, Any]] | None = None

    def pages(self, request: ReportRequest, ppi: float) -> list[bytes]:
        """Give the report's pages as PNG, as they will print; errors as in `make_report`."""
        with self._lock:
            pages: Any = self._compiler.compile(  # annotated as bytes; for PNG, it is a list with one for each page
                self._template,
                format="png",
                ppi=ppi,
                sys_inputs={"data": json.dumps(self._data(request), ensure_ascii=False)},
                timestamp=_whole_seconds(request.made_at),
            )
        return list(pages)

    def comment_draft(self, request: ReportRequest) -> str:
        """Draft a clinical comment from what the pages show."""
        with self._lock:
            self._data(request)
            assert self._known is not None  # just made
            return comment_draft(self._known[1], comparison_of(request))

    def _data(self, request: ReportRequest) -> dict[str, Any]:
        if self._known is None or not _differ_in_words_only(self._known[0], request):
            self._known = request, facts_of(request), report_data(request)
        _, facts, data = self._known
        comparison = comparison_of(request)
        pages, at = data["pages"], data["pages_of_walk"]
        return data | {
            "first_page": data["first_page"] | {"comment": comment(request)},
            "pages": [*pages[:at], words_page(request, facts, comparison), *pages[at + 1 :]],
        }


def _differ_in_words_only(one: ReportRequest, other: ReportRequest) -> bool:
    are_same = one.visit.session is other.visit.session and one.visit.analysis is other.visit.analysis
    if not (are_same and one.earlier is other.earlier and one.made_at.date() == other.made_at.date()):
        return False
    named = ("walks", "software_version", "operator", "clinic", "paper", "course", "has_course_page", "key_frames")
    return one.thin is other.thin and all(getattr(one, name) == getattr(other, name) for name in named)


def _whole_seconds(moment: datetime) -> datetime:
    """As a document's properties hold it, with a fixed offset."""
    return moment.replace(microsecond=0).astimezone(timezone(moment.utcoffset() or timedelta(0)))


def report_data(request: ReportRequest) -> dict[str, Any]:
    """Give all that the template sets: words and figures, in the order they are read."""
    facts = facts_of(request)
    comparison = comparison_of(request)
    session = request.visit.session
    code = plain(session.patient.code)
    recorded = day(request.visit.recording(request.shown).started or session.started)
    fitting = fitting_of(session, request.visit.analysis)
    pictures, condition = key_frames_page(request.key_frames), facts.condition
    of_walk = [*pages_of_walk(facts), *([pictures] if pictures else [])]
    pages: list[list[Block]] = [
        *of_walk,
        words_page(request, facts, comparison),
        *([tests] if (tests := timed_page(request, facts)) else []),
        *([fitting_page(fitting, facts)] if fitting is not None else []),
        *([comparison_page(comparison, facts, has_fitting=fitting is not None)] if comparison is not None else []),
        *([alone] if (alone := not_compared_page(request)) else []),
        *([course] if request.has_course_page and (course := trend_page(request.course, condition, facts)) else []),
    ]
    title = ", ".join(
        filter(
            None,
            [
                tr("Gait report {code}").format(code=isolated(shortened(code, TITLE_CODE_LENGTH))).strip(),
                recorded if session.started else "",
                tr("SIMULATED") if facts.is_simulated else "",
            ],
        )
    )
    return {
        "paper": "us-letter" if request.paper == "letter" else "a4",
        "language": spoken_language(),
        "title": title,
        "subject": _subject(facts),
        "head": {
            "brand": "Gaitwright",
            "kind": tr("Gait report"),
            "simulated": tr("SIMULATED DATA, not a person") if facts.is_simulated else "",
            "code": isolated(shortened(code, CODE_LENGTH)) or tr("no patient code"),
            "date": recorded if session.started else "",
        },
        "foot": foot(request.software_version),
        "first_page": first_page(request, facts, comparison),
        "pages": pages,
        "pages_of_walk": len(of_walk),
    }


def foot(version: str) -> dict[str, str]:
    """What every page ends with."""
    return {
        "use": tr("Research use. Not a medical device."),
        "software": f"Gaitwright {plain(version)[:CODE_LENGTH]}",
        "page": tr("Page {page} of {pages}"),
    }


def pages_of_walk(facts: Facts) -> list[list[Block]]:
    """All figures of the walk, as far as there are some; for one without a stride, page one states why."""
    has_joint = any(map(facts.has_joint, JointKind))
    return [*([curves_page(facts)] if has_joint else []), *([time_page(facts)] if facts.gait else [])]


def facts_of(request: ReportRequest) -> Facts:
    return Facts(request.visit, request.visit.walk(request.shown), request.walks, request.course)


def _subject(facts: Facts) -> str:
    stated = (
        tr("Hip, knee and ankle angles during walking, from inertial sensors. Research use. Not a medical device.")
        if facts.has_joint(JointKind.HIP)
        else tr("Knee and ankle angles during walking, from inertial sensors. Research use. Not a medical device.")
    )
    return " ".join([tr("SIMULATED DATA, not a person.")] * facts.is_simulated + [stated])


_font_book: typst.Fonts | None = None


def _fonts() -> typst.Fonts:
    """The bundled fonts alone, so that a page looks the same on every machine; read once."""
    global _font_book
    if _font_book is None:
        folder = files("resources") / "fonts"
        _font_book = typst.Fonts(include_system_fonts=False, include_embedded_fonts=False, font_paths=[str(folder)])
    return _font_book

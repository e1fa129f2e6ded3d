"""Tests that no typed text prevents a report or changes a number in it."""

import io
from dataclasses import replace

import pypdf
import pytest

from app.reports.patient.document import make_report
from app.summary.plain_text import BOX, MAX_MARKS, breakable, isolated, plain, plain_lines
from app.summary.request import AnalysedVisit, ReportRequest
from tests.safety.hostile_names import try_names

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

HOSTILE = (
    '#image("/etc/passwd") $x^2$ *bold* _it_ @ref <label> // comment \\ #eval("1")',
    "<script>alert(1)</script>&amp;<svg/>",
    "\u202eevil\u202c \u2066x\u2069 \u200f\u061c",
    "מטופל 123, דוד",
    "مريض ١٢٣ محمد",
    "W" * 200,
    "a\x00b\x1bc\x07\ud800\ue000\ufffe",
    "😀漢字 e" + "\u0301\u0323" * 20,
    "",
    " \t\u00a0\u3000 ",
    "= Heading\n== Another\n- list\n+ enum",
    "]]}}))\"\"''``{{[[((",
    "x" * 5000,
)


def with_text(request: ReportRequest, text: str) -> ReportRequest:
    """Put the text into every place that somebody can type into, but for names of recordings."""
    session = request.visit.session
    patient = replace(session.patient, code=text, sex=text, device=text, aids=text)
    sensors = {site: replace(sensor, model=text) for site, sensor in session.sensors.items()}
    recordings = tuple(replace(recording, condition=text) for recording in session.recordings)
    session = replace(
        session, patient=patient, sensors=sensors, recordings=recordings, surface=text, started=text, notes=text
    )
    visit = AnalysedVisit(session, request.visit.analysis)
    return replace(request, visit=visit, comment=text, operator=text, clinic=text, software_version=text[:20] or "1")


def figures_of(pdf: bytes) -> tuple[int, list[str]]:
    """Give the pages' count, and the words of the table on the second but for head and foot."""
    pages = pypdf.PdfReader(io.BytesIO(pdf)).pages
    lines = pages[1].extract_text().splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("Measure, °"))
    last = next(k for k, line in enumerate(lines) if "Windows in brackets" in line)
    return len(pages), lines[first:last]


@pytest.mark.parametrize("text", HOSTILE)
def test_a_typed_text_prevents_no_report_and_moves_no_number(
    demo: ReportRequest, demo_report: bytes, text: str
) -> None:
    pages, figures = figures_of(make_report(with_text(demo, text)))
    expected_pages, expected = figures_of(demo_report)
    assert figures == expected
    assert pages == expected_pages or len(text) == 5000  # a comment is printed whole, however long


def test_no_name_lives_in_a_report_or_becomes_a_formula() -> None:
    trial = try_names(21)
    assert trial.count["names"] == 21
    assert trial.faults == []


def test_a_direction_stays_within_its_own_text(demo: ReportRequest) -> None:
    """A Hebrew code may not turn round the date beside it in the head."""
    patient = replace(demo.visit.session.patient, code="אבג 1")
    session = replace(demo.visit.session, patient=patient, started="2026-11-20T09:42:00+01:00")
    pdf = make_report(replace(demo, visit=AnalysedVisit(session, demo.visit.analysis)))
    reader = pypdf.PdfReader(io.BytesIO(pdf))
    assert reader.metadata is not None
    assert reader.metadata.title == "Gait report \u2068אבג 1\u2069, 20 Nov 2026, SIMULATED"
    shown = reader.pages[0].extract_text().replace("\u2068", "").replace("\u2069", "")
    assert "20 Nov 2026" in shown


def test_what_no_font_shows_becomes_a_box_and_what_nobody_sees_is_dropped() -> None:
    assert plain("Zoë\u200b \x00漢 \ue000x\u202e") == f"Zoë {BOX} x"
    assert plain("e\u0301") == "é"
    assert plain("c\u0349") == "c"  # else every c of the report would be read aloud with it
    assert plain("\u05d3\u05d5\u05d3 (1)") == "\u05d3\u05d5\u05d3 1"  # else ( would be ) in every word of the report
    assert plain("David (1)") == "David (1)"
    assert plain("\u05e9\u05b8") == "\u05e9\u05b8"
    assert len(plain("x" + "\u0301" * 9)) <= 1 + MAX_MARKS
    assert plain(" \t a \n b ") == "a b"
    assert plain_lines("one\n\n\n\ntwo\n") == ["one", "", "two"]
    assert isolated("") == ""
    assert plain("a:\u034fb") == "a:b"  # an unseen mark: every colon of the report would be copied with it


def test_only_long_words_may_break_within() -> None:
    assert breakable("short words stay as they are") == "short words stay as they are"
    assert breakable("W" * 23).replace("\u200b", "") == "W" * 23
    assert breakable("W" * 23).count("\u200b") == 3

"""Tests that everybody can read the report, now and in thirty years. It is the same document each time."""

import io
import re
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import pikepdf
import pypdf
import pytest

from app.reports.patient.comparison_page import comparison_of
from app.reports.patient.document import ReportPreview, make_report
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from core.alignment import AlignmentChange, PartChange, ProsthesisPart

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three


def texts(pdf: bytes) -> list[str]:
    return [page.extract_text() for page in pypdf.PdfReader(io.BytesIO(pdf)).pages]


def first_page(request: ReportRequest) -> str:
    """The words of page one, as they are read: in lines of one space, without marks of direction."""
    return re.sub("[\u2066-\u2069]", "", " ".join(texts(make_report(request))[0].split()))


def method_page(request: ReportRequest) -> str:
    """The same of the page that states what was measured and how."""
    page = next(page for page in texts(make_report(request)) if "Method and accuracy" in page)
    return re.sub("[\u2066-\u2069]", "", " ".join(page.split()))


def elements(node: pikepdf.Object) -> Iterator[pikepdf.Object]:
    """Walk the structure tree from the root down."""
    if isinstance(node, pikepdf.Array):
        for part in node:
            yield from elements(part)
    elif isinstance(node, pikepdf.Dictionary):
        yield node
        if "/K" in node:
            yield from elements(node.K)


@pytest.fixture(scope="module")
def report(alignments: AnalysedVisit) -> bytes:
    made_at = datetime.fromisoformat("2026-11-21T22:15:30+01:00")
    return make_report(ReportRequest(alignments, default_walks(alignments), made_at, "1.2.3"))


def test_it_is_tagged_titled_and_shows_its_language(report: bytes) -> None:
    with pikepdf.open(io.BytesIO(report)) as pdf:
        assert pdf.Root.MarkInfo.Marked
        assert "/StructTreeRoot" in pdf.Root
        assert str(pdf.Root.Lang) == "en-GB"
        assert pdf.Root.ViewerPreferences.DisplayDocTitle
        with pdf.open_metadata() as metadata:
            assert metadata["pdfuaid:part"] == "1"
            assert (metadata["pdfaid:part"], metadata["pdfaid:conformance"]) == ("2", "A")
            assert "20 Nov 2026" in metadata["dc:title"]
            assert "SIMULATED" in metadata["dc:title"]
            assert "SIMULATED" in metadata["dc:description"]
        assert [str(intent.S) for intent in pdf.Root.OutputIntents] == ["/GTS_PDFA1"]


def test_every_figure_has_words_with_numbers_in_them(report: bytes) -> None:
    with pikepdf.open(io.BytesIO(report)) as pdf:
        figures = [node for node in elements(pdf.Root.StructTreeRoot.K) if node.get("/S") == "/Figure"]
        alts = [str(figure.get("/Alt", "")) for figure in figures]
    names = {"left", "right", "beyond error"}  # chips and marks beside numbers
    # page one, overlays with definitions, phases with rails and single strides, comparison
    assert len([alt for alt in alts if alt not in names and alt != "beyond 95 of 100"]) == 2 + (2 + 2) + (1 + 2 + 4) + 4
    assert {alt for alt in alts if not any(character.isdigit() for character in alt)} <= names


def test_column_headings_are_tagged_as_such(report: bytes) -> None:
    with pikepdf.open(io.BytesIO(report)) as pdf:
        kinds = [str(node.get("/S")) for node in elements(pdf.Root.StructTreeRoot.K)]
    assert kinds.count("/Table") == 9
    assert kinds.count("/TH") > 20
    assert "/H1" in kinds


def test_every_font_is_embedded(report: bytes) -> None:
    with pikepdf.open(io.BytesIO(report)) as pdf:
        described = [
            o for o in pdf.objects if isinstance(o, pikepdf.Dictionary) and o.get("/Type") == "/FontDescriptor"
        ]
        assert described
        for font in described:
            assert {"/FontFile", "/FontFile2", "/FontFile3"} & set(font.keys())
            assert "Inter" in str(font.FontName)


def test_the_same_request_gives_the_same_bytes(demo: ReportRequest) -> None:
    first = make_report(demo)
    assert first == make_report(demo)
    assert str(Path(__file__).parents[4]).encode() not in first


@pytest.mark.parametrize("paper", ["a4", "letter"])
@pytest.mark.parametrize("language", ["en", "pseudo"])
def test_page_one_stays_one_page(
    aligned: ReportRequest, paper: str, language: str, request: pytest.FixtureRequest
) -> None:
    """Its fields two lines long, its box with three sentences, on either paper, in a language as long as German."""
    if language == "pseudo":
        request.getfixturevalue("pseudo_language")
    visit = aligned.visit
    patient = replace(visit.session.patient, device="W" * 200, aids="two crutches", code="W" * 60)
    session = replace(visit.session, patient=patient, surface="corridor " * 40)
    required = replace(
        aligned,
        visit=AnalysedVisit(session, visit.analysis),
        paper=paper,
        operator="W" * 200,
        clinic="W " * 200,
    )
    reader = pypdf.PdfReader(io.BytesIO(make_report(required)))
    pages = [reader.get_destination_page_number(entry) for entry in reader.outline if not isinstance(entry, list)]
    assert pages[:2] == [0, 1]  # the summary; then all curves


def test_the_pages_stand_in_their_order(report: bytes) -> None:
    headings = (
        "Summary",
        "All curves and peaks",
        "Time, distance and strides",
        "Data quality",
        "Comparison of conditions",
    )
    pages = texts(report)
    assert len(pages) == len(headings)
    for page, heading in zip(pages, headings, strict=True):
        assert heading in page
        assert "SIMULATED DATA, not a person" in page
        assert "Research use. Not a medical device." in page
        assert "Gaitwright 1.2.3" in page


def test_one_walk_takes_four_pages(demo: ReportRequest) -> None:
    assert len(texts(make_report(demo))) == 4


@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_the_comment_is_on_page_one_and_the_signature_on_the_page_of_the_method(
    demo: ReportRequest, paper: str
) -> None:
    commented = replace(demo, paper=paper, comment="Walk again in May.", comment_by="M. Weber")
    pages = texts(make_report(commented))
    assert "Walk again in May." in pages[0]
    assert "M. Weber" in pages[0]
    assert "Signature" in pages[3]
    assert sum("Clinical comment" in page for page in pages) == 1
    assert not any("Clinical comment" in page for page in texts(make_report(demo)))


@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_nothing_of_a_page_is_left_for_the_next(aligned: ReportRequest, demo: ReportRequest, paper: str) -> None:
    """Every page holds its heading and all that belongs to it: conditions or visits compared, peaks with windows."""
    before = walked_under(aligned.visit, demo)
    two_visits = replace(demo, earlier=before, paper=paper)
    for required in (replace(aligned, paper=paper), two_visits):
        pages = texts(make_report(required))
        assert len(pages) == 5
        assert "Where values are measured" in pages[1]
        assert "the first curve is thin and pale" in " ".join(pages[4].split())


@pytest.mark.usefixtures("pseudo_language")
def test_what_explains_the_peaks_takes_no_page_of_its_own(demo: ReportRequest) -> None:
    """A longer language makes the table longer: what explains it is then left away, not put behind it alone."""
    assert len(texts(make_report(demo))) == 4


def test_a_walk_is_called_as_on_the_screen(aligned: ReportRequest) -> None:
    assert "walk: C alignment C" in method_page(aligned)
    assert "alignment C" in first_page(aligned)
    two = replace(aligned, walks=("walk 2", "walk 3"))
    assert "Compared: B alignment B · C alignment C (shown: C)" in method_page(two)
    visit = aligned.visit
    reported = visit.session.recordings
    alike = tuple(replace(one, condition="shoes" if one.name.startswith("walk") else "") for one in reported)
    same = AnalysedVisit(replace(visit.session, recordings=alike), visit.analysis)
    first = method_page(replace(two, visit=same))
    assert "walk: A3 shoes" in first
    assert "Compared: A2 shoes · A3 shoes (shown: A3)" in first
    unnamed = tuple(replace(one, condition="") for one in reported)
    bare = AnalysedVisit(replace(visit.session, recordings=unnamed), visit.analysis)
    assert "walk: walk 3" in method_page(replace(two, visit=bare, walks=("walk 3",)))


def test_page_one_states_what_differs_and_the_page_of_the_method_what_was_measured(
    aligned: ReportRequest, request_of_one_leg: ReportRequest
) -> None:
    method = method_page(aligned)
    assert "Knee and ankle of both legs · 6 motion sensors" in method
    assert "Compared: A alignment A · B alignment B · C alignment C (shown: C)" in method
    first = first_page(aligned)
    assert "Right ankle plantarflexes 9° at push-off, 17° less than the left." in first
    assert "95 of 100 healthy people differ by less." in first
    assert "prosthetic side: right · alignment C" in first
    first = first_page(request_of_one_leg)
    assert "Left knee flexes 61° from stance to swing." in first
    assert "Stance symmetry" not in first
    assert "R − L" not in first
    assert not re.search(r"\b(right|Right|differ)\b", first)
    assert "Knee and ankle of the left leg · 3 motion sensors" in method_page(request_of_one_leg)


def test_two_visits_are_compared_by_the_error_of_a_new_attachment(
    aligned: ReportRequest, alignments: AnalysedVisit
) -> None:
    page = texts(make_report(replace(aligned, earlier=alignments)))[4]
    assert "Comparison of visits" in page
    assert "Two visits, sensors reattached" in page
    # 1.96 x sqrt(2) x hypot(1.2, 0.043 x 60)
    assert "Differences between walks alone account for 7.9° of knee range of motion" in " ".join(page.split())


def test_a_visit_of_another_alignment_is_not_compared_and_the_report_states_so(
    aligned: ReportRequest, alignments: AnalysedVisit
) -> None:
    """C of this visit is reported against C of the earlier one; where that has only A, against nothing."""
    recordings = alignments.session.recordings[:-2]  # up to alignment A
    before = AnalysedVisit(
        replace(alignments.session, recordings=recordings),
        replace(alignments.analysis, recordings=alignments.analysis.recordings[:-2]),
    )
    request = replace(aligned, earlier=before)
    assert comparison_of(request) is None
    pages = texts(make_report(request))
    stated = "has no walk in this condition (alignment C), so it is not compared. Its conditions: alignment A."
    assert sum(stated in " ".join(page.split()) for page in pages) == 1
    assert not any("Two visits, sensors reattached" in page for page in pages)
    same = comparison_of(replace(request, earlier=alignments))
    assert same is not None
    assert [[walk.name for walk in part.walks] for part in same.parts] == [["walk 3"], ["walk 3"]]
    assert not any("so it is not compared" in page for page in texts(make_report(replace(request, earlier=alignments))))


def walked_under(visit: AnalysedVisit, request: ReportRequest) -> AnalysedVisit:
    """A visit whose last walk is of the condition that a report shows."""
    condition = request.visit.recording(request.shown).condition
    *others, last = visit.session.recordings
    return AnalysedVisit(
        replace(visit.session, recordings=(*others, replace(last, condition=condition))), visit.analysis
    )


def test_a_long_comment_is_printed_whole(demo: ReportRequest) -> None:
    comment = "\n".join(f"Line {k} of what the clinician says." for k in range(150))
    pages = texts(make_report(replace(demo, comment=comment)))
    assert len(pages) > 4
    assert any("Line 0 of" in page for page in pages)
    assert any("Line 149 of" in page for page in pages)
    assert re.search(r"Whole comment: page \d", pages[0])


def test_a_request_without_time_zone_or_walk_is_refused(demonstration: AnalysedVisit) -> None:
    with pytest.raises(ValueError, match="time zone"):
        ReportRequest(demonstration, ("walk 1",), datetime(2026, 11, 21), "1.2.3")
    with pytest.raises(ValueError, match="0 walks"):
        ReportRequest(demonstration, (), datetime.fromisoformat("2026-11-21T12:00+00:00"), "1.2.3")


def test_a_look_again_is_as_if_it_were_the_first(alignments: AnalysedVisit) -> None:
    """What is kept of the last look must not stand where something else was asked for."""
    asked = ReportRequest(alignments, ("walk 1",), datetime.fromisoformat("2026-11-21T22:15:30+01:00"), "1.2.3")
    changes = ({"comment": "Knee was tender."}, {"comment": ""}, {"walks": ("walk 1", "walk 2")}, {"paper": "letter"})
    preview, before = ReportPreview(), list[bytes]()
    for change in changes:
        asked = replace(asked, **change)
        pages = preview.pages(asked, 40.0)
        assert pages == ReportPreview().pages(asked, 40.0)
        assert pages != before
        before = pages


def test_the_page_of_conditions_states_what_was_turned_and_against_which(aligned: ReportRequest) -> None:
    visit = aligned.visit
    changes = {
        "walk 2": AlignmentChange("alignment A", (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, turns=0.5),)),
        "walk 3": AlignmentChange("alignment B", (PartChange(ProsthesisPart.PYLON, height_mm=3.0),)),
    }
    turned = tuple(replace(one, alignment=changes.get(one.name)) for one in visit.session.recordings)
    reported = replace(aligned, visit=AnalysedVisit(replace(visit.session, recordings=turned), visit.analysis))
    without, page = (
        re.sub("[\u2066-\u2069]", "", " ".join(" ".join(texts(make_report(one))[-2:]).split()))
        for one in (aligned, reported)
    )
    assert "Foot, anterior screw ½ turn out" in page
    assert "Pylon +3 mm" in page
    assert "Jonkergouw" in page
    assert "C vs B" in page
    assert "C vs A" in without
    assert not any(words in without for words in ("Jonkergouw", "turn out", "Changed from"))

"""Tests that everybody can read the report, now and in thirty years. It is the same document each time."""

import io
import re
from collections.abc import Callable, Iterator
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
from core.session import Recording

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three


def texts(pdf: bytes) -> list[str]:
    return [page.extract_text() for page in pypdf.PdfReader(io.BytesIO(pdf)).pages]


def words(page: str) -> str:
    """As they are read: in lines of one space, without marks of direction."""
    return re.sub("[\u2066-\u2069]", "", " ".join(page.split()))


def method_page(pages: list[str]) -> str:
    """The words of the page that states what was measured and how."""
    return words(next(page for page in pages if "Method and accuracy" in page))


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
def report(aligned: ReportRequest) -> bytes:
    assert aligned.walks == default_walks(aligned.visit)
    return make_report(aligned)


@pytest.fixture(scope="module")
def pages(report: bytes) -> list[str]:
    return texts(report)


@pytest.fixture(scope="module")
def two_visits(aligned: ReportRequest, alignments: AnalysedVisit) -> list[str]:
    return texts(make_report(replace(aligned, earlier=alignments)))


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


def test_the_same_request_gives_the_same_bytes(demo: ReportRequest, demo_report: bytes) -> None:
    assert demo_report == make_report(demo)
    assert str(Path(__file__).parents[4]).encode() not in demo_report


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


def test_the_pages_stand_in_their_order(pages: list[str]) -> None:
    headings = (
        "Summary",
        "All curves and peaks",
        "Time, distance and strides",
        "Data quality",
        "Comparison of conditions",
    )
    assert len(pages) == len(headings)
    for page, heading in zip(pages, headings, strict=True):
        assert heading in page
        assert "SIMULATED DATA, not a person" in page
        assert "Research use. Not a medical device." in page
        assert "Gaitwright 1.2.3" in page


def test_one_walk_takes_four_pages(demo_report: bytes) -> None:
    assert len(texts(demo_report)) == 4


@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_the_comment_is_on_page_one_and_the_signature_on_the_page_of_the_method(
    demo: ReportRequest, demo_report: bytes, paper: str
) -> None:
    commented = replace(demo, paper=paper, comment="Walk again in May.", comment_by="M. Weber")
    pages = texts(make_report(commented))
    assert "Walk again in May." in pages[0]
    assert "M. Weber" in pages[0]
    assert "Signature" in pages[3]
    assert sum("Clinical comment" in page for page in pages) == 1
    assert not any("Clinical comment" in page for page in texts(demo_report))


@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_nothing_of_a_page_is_left_for_the_next(
    aligned: ReportRequest, pages: list[str], demo: ReportRequest, paper: str
) -> None:
    """Every page holds its heading and all that belongs to it: conditions or visits compared, peaks with windows."""
    before = walked_under(aligned.visit, demo)
    visits = texts(make_report(replace(demo, earlier=before, paper=paper)))
    conditions = pages if paper == aligned.paper else texts(make_report(replace(aligned, paper=paper)))
    for found in (conditions, visits):
        assert len(found) == 5
        assert "Where values are measured" in found[1]
        assert "the first curve is thin and pale" in words(found[4])


@pytest.mark.usefixtures("pseudo_language")
def test_what_explains_the_peaks_takes_no_page_of_its_own(demo: ReportRequest) -> None:
    """A longer language makes the table longer: what explains it is then left away, not put behind it alone."""
    assert len(texts(make_report(demo))) == 4


def test_a_walk_is_called_as_on_the_screen(aligned: ReportRequest, pages: list[str]) -> None:
    def method(*walks: str, conditions: Callable[[Recording], str]) -> str:
        visit = aligned.visit
        recordings = tuple(replace(one, condition=conditions(one)) for one in visit.session.recordings)
        named = AnalysedVisit(replace(visit.session, recordings=recordings), visit.analysis)
        return method_page(texts(make_report(replace(aligned, walks=walks, visit=named))))

    assert "walk: C alignment C" in method_page(pages)
    assert "alignment C" in words(pages[0])
    two = method("walk 2", "walk 3", conditions=lambda one: one.condition)
    assert "Compared: B alignment B · C alignment C (shown: C)" in two
    alike = method("walk 2", "walk 3", conditions=lambda one: "shoes" if one.name.startswith("walk") else "")
    assert "walk: A3 shoes" in alike
    assert "Compared: A2 shoes · A3 shoes (shown: A3)" in alike
    assert "walk: walk 3" in method("walk 3", conditions=lambda _: "")


def test_page_one_states_what_differs_and_the_page_of_the_method_what_was_measured(
    pages: list[str], request_of_one_leg: ReportRequest
) -> None:
    method = method_page(pages)
    assert "Knee and ankle of both legs · 6 motion sensors" in method
    assert "Compared: A alignment A · B alignment B · C alignment C (shown: C)" in method
    first = words(pages[0])
    assert "Right ankle plantarflexes 9° at push-off, 17° less than the left." in first
    assert "95 of 100 healthy people differ by less." in first
    assert "prosthetic side: right · alignment C" in first
    one_leg = texts(make_report(request_of_one_leg))
    first = words(one_leg[0])
    assert "Left knee flexes 61° from stance to swing." in first
    assert "Stance symmetry" not in first
    assert "R − L" not in first
    assert not re.search(r"\b(right|Right|differ)\b", first)
    assert "Knee and ankle of the left leg · 3 motion sensors" in method_page(one_leg)


def test_two_visits_are_compared_by_the_error_of_a_new_attachment(two_visits: list[str]) -> None:
    page = words(two_visits[4])
    assert "Comparison of visits" in page
    assert "Two visits, sensors reattached" in page
    # 1.96 x sqrt(2) x hypot(1.2, 0.043 x 60)
    assert "Differences between walks alone account for 7.9° of knee range of motion" in page


def test_a_visit_of_another_alignment_is_not_compared_and_the_report_states_so(
    aligned: ReportRequest, alignments: AnalysedVisit, two_visits: list[str]
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
    assert not any("so it is not compared" in page for page in two_visits)


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


def test_the_page_of_conditions_states_what_was_turned_and_against_which(
    aligned: ReportRequest, pages: list[str]
) -> None:
    visit = aligned.visit
    changes = {
        "walk 2": AlignmentChange("alignment A", (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, turns=0.5),)),
        "walk 3": AlignmentChange("alignment B", (PartChange(ProsthesisPart.PYLON, height_mm=3.0),)),
    }
    turned = tuple(replace(one, alignment=changes.get(one.name)) for one in visit.session.recordings)
    reported = replace(aligned, visit=AnalysedVisit(replace(visit.session, recordings=turned), visit.analysis))
    without, page = (words(" ".join(one[-2:])) for one in (pages, texts(make_report(reported))))
    assert "Foot, anterior screw ½ turn out" in page
    assert "Pylon +3 mm" in page
    assert "Jonkergouw" in page
    assert "C vs B" in page
    assert "C vs A" in without
    assert not any(words in without for words in ("Jonkergouw", "turn out", "Changed from"))

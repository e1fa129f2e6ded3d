"""Page one: what is on it at a first visit, at a return, of one leg, and where something is not good."""

import datetime
import io
import math
from dataclasses import replace
from typing import Any
from uuid import UUID

import pypdf
from syrupy.assertion import SnapshotAssertion

from app.reports.patient.document import facts_of, make_report, report_data
from app.reports.patient.first_page import first_page
from app.summary.course import course_of
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.joint_panels import thin_part
from app.summary.request import AnalysedVisit, ReportRequest
from core.body import Joint, Side
from core.prosthesis import AmputationLevel, FootKind, Prosthesis
from core.session import Patient
from tests.app.changed_analysis import recalibrated, with_few_strides
from tests.app.reports.patient.test_what_stands_out import with_more

SMALLEST = 9.0  # points
LAST = datetime.date(2026, 10, 7)


def page(request: ReportRequest) -> Any:
    return first_page(request, facts_of(request), None)


def plain(typed: str) -> str:
    """Without the marks of direction about what was typed."""
    return typed.replace("\u2068", "").replace("\u2069", "")


def changed(request: ReportRequest, **change: Any) -> ReportRequest:
    """With the left knee's axis changed."""
    visit = request.visit
    analysis = recalibrated(visit.analysis, [Joint.LEFT_KNEE], **change)
    return replace(request, visit=AnalysedVisit(visit.session, analysis))


def returned(request: ReportRequest, more_deg: float) -> ReportRequest:
    """The same patient again: at the last visit the left knee had so much more."""
    session, analysis = request.visit.session, request.visit.analysis
    before = with_more(analysis, Side.LEFT, "knee_stance_to_swing_rad", more_deg)
    visits = ((LAST, before), (datetime.date(2026, 11, 23), analysis))
    course = tuple(
        CourseVisit(UUID(int=k), day, course_of(found, session.recordings)) for k, (day, found) in enumerate(visits)
    )
    walk = before.recordings[-1]
    thin = replace(Facts(AnalysedVisit(session, before), walk).part, day=LAST)
    return replace(request, course=course, thin=thin)


def test_a_first_visit_has_no_change_and_a_return_has_its_change_day_and_thin_line(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    first, again = page(demo), page(returned(demo, -20.0))
    assert {
        name: {
            "first": found["summary"]["first"],
            "tiles": [" | ".join((tile["name"], tile["change"], tile["then"])) for tile in found["tiles"]],
            "since": found["table"]["since"],
            "rows": [f"{row['name']} | {row['since']}" for row in found["table"]["rows"]],
            "strips": [bool(row["strip"]) for row in found["table"]["rows"]],
        }
        for name, found in (("first visit", first), ("return", again))
    } == snapshot
    assert "7 Oct" not in str(first)
    assert "7 Oct" in again["charts"][0][0]["picture"]["svg"]


def test_the_thin_line_is_the_visit_that_the_headline_names(demo: ReportRequest) -> None:
    request = returned(demo, -20.0)
    session, analysis = request.visit.session, request.visit.analysis
    before = AnalysedVisit(replace(session, started=f"{LAST.isoformat()}T09:00:00"), analysis)
    other = AnalysedVisit(replace(session, started="2026-09-02T09:00:00"), analysis)
    line = thin_part(facts_of(request), [other, before])
    assert line is not None
    assert (line.day, line.short_name) == (LAST, "7 Oct")
    assert thin_part(facts_of(request), [other]) is None
    assert thin_part(facts_of(demo), [other, before]) is None


def test_page_one_has_what_changed_over_the_course_also_without_its_own_page(demo: ReportRequest) -> None:
    request = returned(demo, -20.0)
    with_page, without = (
        report_data(replace(request, thin=None, has_course_page=has_page)) for has_page in (True, False)
    )
    assert len(with_page["pages"]) == len(without["pages"]) + 1
    assert with_page["first_page"] == without["first_page"]


def test_the_amber_box_comes_only_where_something_is_not_good(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    pages = {"good": page(demo), "doubtful": page(changed(demo, axis_sd_rad=math.radians(9.8)))}
    assert pages["good"]["caution"] is None
    assert {name: (one["caution"], one["quality"]) for name, one in pages.items()} == snapshot


def test_a_knee_that_is_not_reported_has_no_figure_and_a_box_in_place_of_its_curve(demo: ReportRequest) -> None:
    found = page(changed(demo, axis_sd_rad=math.radians(9.8)))
    knee = found["tiles"][2]
    assert [value["text"] for value in knee["values"]] == ["–", "62°"]
    assert knee["change"] == "First visit"
    (row,) = [row for row in found["table"]["rows"] if row["name"] == "Knee flexion, stance to swing"]
    assert (row["values"], row["why"], row["difference"]) == (["–", "62.0°"], "L not reported", "–")
    svg = found["charts"][0][0]["picture"]["svg"]
    assert "Not reported" in svg
    assert ">R 61°<" in svg
    assert ">L 59°<" not in svg


def test_one_leg_has_its_tiles_curves_and_values_only(request_of_one_leg: ReportRequest) -> None:
    found = page(request_of_one_leg)
    assert [tile["name"] for tile in found["tiles"]] == ["Walking speed", "Cadence", "Knee, stance to swing"]
    assert found["table"]["heads"] == []
    assert found["table"]["marks"] == []
    assert all(len(row["values"]) == 1 and row["values"] != ["–"] for row in found["table"]["rows"])
    assert not any(">R " in chart["picture"]["svg"] for chart in found["charts"][0])


def test_without_a_mean_there_is_no_table(demo: ReportRequest) -> None:
    visit = demo.visit
    few = with_few_strides(visit.analysis, left=2, right=2)
    assert page(replace(demo, visit=AnalysedVisit(visit.session, few)))["table"] is None
    assert len(page(demo)["table"]["rows"]) == 5


def test_a_comment_is_beside_the_summary_with_who_wrote_it_and_a_long_one_states_where_it_goes_on(
    demo: ReportRequest,
) -> None:
    assert page(demo)["comment"] is None
    commented = replace(demo, comment="Walks well.", comment_by="M. Weber, physiotherapist")
    found = page(commented)["comment"]
    assert (found["lines"], plain(found["by"]), found["is_long"], found["rest"]) == (
        ["Walks well."],
        "M. Weber, physiotherapist",
        False,
        "",
    )
    longer = page(replace(commented, comment="Walks well today. " * 15))["comment"]
    assert (longer["is_long"], longer["rest"]) == (True, "")
    assert page(replace(commented, comment="Walks well today. " * 40))["comment"]["rest"]


def test_who_was_measured_and_how_is_beside_the_code(demo: ReportRequest, snapshot: SnapshotAssertion) -> None:
    """A stated prosthesis takes the place of its side."""
    session = demo.visit.session
    shoes = tuple(replace(one, condition="shoes") for one in session.recordings)
    transtibial = {Side.LEFT: Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.ENERGY_STORING)}
    alone = Patient(code="P-1", prosthetic_side="left", device="own socket")
    known = {
        "no prosthesis": replace(
            session,
            patient=Patient("P-1", birth_year=1961, sex="female", affected_side="left", device="left knee replaced"),
            recordings=shoes,
        ),
        "a prosthetic side": replace(session, patient=alone),
        "a stated prosthesis": replace(session, patient=replace(alone, prostheses=transtibial)),
        "two sides, one of them stated": replace(
            session, patient=replace(alone, prosthetic_side="both", prostheses=transtibial)
        ),
    }
    requests = {name: replace(demo, visit=AnalysedVisit(one, demo.visit.analysis)) for name, one in known.items()}
    assert {name: plain(page(request)["who"]) for name, request in requests.items()} == snapshot


def test_no_letter_of_page_one_is_smaller_than_nine_points(demo: ReportRequest) -> None:
    request = replace(returned(demo, -20.0), comment="Walks well.", comment_by="M. Weber")
    sizes: list[float] = []

    def seen(text: str, matrix: list[float], transform: list[float], _font: object, size: float) -> None:
        if text.strip():
            height = abs(transform[3]) + abs(transform[2])  # a turned one is as large
            sizes.append(round(size * height * (abs(matrix[3]) + abs(matrix[2])), 2))

    pypdf.PdfReader(io.BytesIO(make_report(request))).pages[0].extract_text(visitor_text=seen)
    assert len(sizes) > 100
    assert min(sizes) >= SMALLEST - 0.01

"""One measure has one value and one judgement, wherever a patient's knee is given of."""

import datetime
import json
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import openpyxl
import pytest
from pytestqt.qtbot import QtBot

from app.exports.spreadsheet import write_spreadsheet
from app.exports.summary import write_summary
from app.reports.patient.comparison_page import comparison_of
from app.reports.patient.document import facts_of
from app.reports.patient.first_page import first_page
from app.reports.patient.letter import letter_data
from app.results.result_page import ResultPage
from app.summary.course import course_of
from app.summary.course_lanes import CourseVisit
from app.summary.facts import Facts
from app.summary.headline import headline_of
from app.summary.request import AnalysedVisit, ReportRequest, default_walks
from app.summary.trend_lines import trend_lines
from app.summary.what_differs import what_differs
from core.body import Side
from core.goals import NO_GOALS
from core.parameters import KNEE
from core.session import Patient, Session
from tests.app.course_material import analysis, recordings, walked

MADE_AT = datetime.datetime(2026, 11, 27, tzinfo=datetime.UTC)
FIRST, NOW = datetime.date(2026, 7, 1), datetime.date(2026, 11, 26)
SHOES = "shoes"


def visit_on(day: datetime.date, *knees: tuple[float, int]) -> AnalysedVisit:
    """A visit whose walks in shoes each have a left knee and so many strides."""
    walks = [
        (walked(f"walk {number}", knee_deg=knee_deg, strides=strides), SHOES)
        for number, (knee_deg, strides) in enumerate(knees, start=1)
    ]
    session = Session(tuple(recordings(*walks)), patient=Patient(code="P-1"), started=f"{day}T10:00:00+00:00")
    return AnalysedVisit(session, analysis(*(one for one, _ in walks)))


def course_over(*visits: AnalysedVisit) -> tuple[CourseVisit, ...]:
    return tuple(
        CourseVisit(
            UUID(int=number),
            datetime.date.fromisoformat(one.session.started[:10]),
            course_of(one.analysis, one.session.recordings),
        )
        for number, one in enumerate(visits)
    )


def request_of(*visits: AnalysedVisit, earlier: AnalysedVisit | None = None) -> ReportRequest:
    """The report of the last of some visits, with their course and a page for the patient."""
    now = visits[-1]
    course = course_over(*visits)
    return ReportRequest(now, default_walks(now), MADE_AT, "1", earlier=earlier, course=course)


@pytest.fixture
def now() -> AnalysedVisit:
    """Of 10 strides of 50 degrees and 15 of 54 the mean is 52.4; a mean of the walks would be 52."""
    return visit_on(NOW, (54.0, 15), (50.0, 10))


def test_the_walk_shown_is_the_one_with_most_usable_strides_of_the_latest_condition(now: AnalysedVisit) -> None:
    assert default_walks(now) == ("walk 1",)
    stick = walked("walk 3", strides=20), "stick"
    reported = [*((now.walk(name), SHOES) for name in ("walk 1", "walk 2")), stick]
    session = replace(now.session, recordings=tuple(recordings(*reported)))
    assert default_walks(AnalysedVisit(session, analysis(*(one for one, _ in reported)))) == ("walk 1", "walk 3")


def test_a_knee_has_one_value_on_screen_report_course_and_in_files(now: AnalysedVisit, tmp_path: Path) -> None:
    before = visit_on(FIRST, (34.0, 12))
    request = request_of(before, now, earlier=before)
    shown = facts_of(request)
    comparison = comparison_of(request)
    assert comparison is not None
    (line,) = [one for one in trend_lines(request.course, SHOES, [KNEE], NO_GOALS) if one.side is Side.LEFT]
    (compared,) = [row for row in comparison.rows if (row.measure.column, row.side) == (KNEE, Side.LEFT)]
    (key_row,) = [row for row in what_differs(shown) if row.column == KNEE]
    values = [
        *(Facts(now, now.walk(name)).value(Side.LEFT, KNEE).mean for name in ("walk 1", "walk 2")),  # on the screen
        shown.value(Side.LEFT, KNEE).mean,
        compared.value.mean,
        key_row.values[Side.LEFT].mean,
        line.values[-1].value,
    ]
    write_summary(now.analysis, tmp_path / "summary.json", now.session.recordings)
    reported = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["conditions"]
    values += [one["left"][f"{KNEE}_mean"] for one in reported if one["condition"] == SHOES]
    write_spreadsheet(now.session, now.analysis, tmp_path / "results.xlsx")
    rows = openpyxl.load_workbook(tmp_path / "results.xlsx")["Conditions"].iter_rows(values_only=True)
    values += [float(str(row[4])) for row in rows if (row[0], row[2], row[3]) == (SHOES, "left", KNEE)]
    assert values == pytest.approx([52.4] * 8, abs=0.02)
    summary = first_page(request, shown, comparison)["summary"]
    assert isinstance(summary, dict)
    assert "Left knee flexes 52°" in summary["first"]
    letter = letter_data(request, "en")
    assert letter["number"] == "Your left knee now bends 52\N{NO-BREAK SPACE}degrees."
    assert letter["beside"][0] == "In July it was 34 degrees."  # type: ignore[index]  # it is a list of sentences


def test_two_walks_of_one_condition_that_are_laid_side_by_side_stand_alone(now: AnalysedVisit) -> None:
    chosen = ("walk 2", "walk 1")
    values = [Facts(now, now.walk(name), chosen).value(Side.LEFT, KNEE).mean for name in chosen]
    assert values == pytest.approx([50.0, 54.0], abs=0.02)


@pytest.mark.parametrize(("first_deg", "is_real"), [(34.0, True), (50.0, False)])
def test_page_one_and_the_letter_judge_the_knee_alike(now: AnalysedVisit, first_deg: float, is_real: bool) -> None:
    request = request_of(visit_on(FIRST, (first_deg, 12)), now)
    facts = facts_of(request)
    page_one, patient = headline_of(facts), str(letter_data(request, "en"))
    assert ("The change is larger than our measuring error." in patient) is is_real
    assert ("up 18° since 1 Jul" in page_one.first) is is_real
    assert ("within measurement error" in page_one.then) is not is_real


@pytest.mark.parametrize("first_deg", [34.0, 50.0])
def test_the_screen_states_first_what_a_report_states_first(qtbot: QtBot, now: AnalysedVisit, first_deg: float) -> None:
    request = request_of(visit_on(FIRST, (first_deg, 12)), now)
    facts = facts_of(request)
    summary = first_page(request, facts, comparison_of(request))["summary"]
    assert isinstance(summary, dict)
    page = ResultPage()
    qtbot.addWidget(page)
    page.show_visit(now, course=request.course)
    assert summary["first"] in page.headline.text
    assert page.recordings.currentData() == request.shown
    assert [cycle.mean.n for cycle in page.cycles.charts.knee.chart.cycles.values()] == [25, 25]

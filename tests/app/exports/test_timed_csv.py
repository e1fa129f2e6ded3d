"""timed_test.csv, the summary and the report's page: what a test gave, nothing of walks that are none."""

import datetime
import math
from dataclasses import replace
from uuid import UUID

import pytest
from syrupy.assertion import SnapshotAssertion

from app.exports.summary import summarise
from app.exports.timed_csv import HEADER, timed_rows
from app.reports.patient.document import facts_of, make_report, report_data
from app.reports.patient.timed_page import timed_page
from app.reports.patient.trend_page import charts_of_tests
from app.summary.course import Course
from app.summary.course_lanes import CourseVisit
from app.summary.request import AnalysedVisit, ReportRequest
from core.alignment import AlignmentChange
from core.body import Side, Site
from core.results import Analysis
from core.session import RecordingKind, Session
from core.timed.found import (
    NotMeasured,
    NotValid,
    PartOfUpAndGo,
    Rise,
    Silence,
    Sitting,
    StairStride,
    TimedPart,
    TimedTest,
    Turn,
    UpAndGoPart,
)
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import DEMONSTRATION, Standing, Walk
from tests.app.course_material import course as course_of_walks
from tests.app.course_material import timed
from tests.app.reports.patient.conftest import MADE_AT
from tests.simulated import analysis_of, session_of

TWO = TimedTest(
    protocol=TimedProtocol.TWO_MINUTES,
    start_s=3.0,
    end_s=123.0,
    is_start_by_key=True,
    is_end_by_key=False,
    distance_m=132.4,
    sensor_distance_m=132.4,
    cadence_steps_min=104.0,
    turns=(Turn(30.0, 33.0, -math.pi),),
    pauses_s=((40.0, 43.5),),
    laps=(TimedPart(3.0, 31.5, 30.0, 30.0 / 28.5, 104.0), TimedPart(31.5, 123.0, math.nan, math.nan, 103.0)),
    thirds=tuple(TimedPart(3.0 + 40.0 * k, 43.0 + 40.0 * k, 44.0 - k, 1.1 - 0.025 * k, 104.0) for k in range(3)),
    rises=(Rise(1.0, 2.0),),
    silences=(Silence(Site.LEFT_FOOT, 50.0, 52.0),),
    missing=(NotMeasured.SILENT,),
    stairs=(StairStride(Side.LEFT, 13.0, 14.5, 0.34),),
)


@pytest.fixture(scope="module")
def visit() -> AnalysedVisit:
    """Two walks of the demonstration, the second a test."""
    walks = (Walk(strides=12, standing_before_s=2.0), Walk("walk 2", strides=14, standing_before_s=2.0))
    session = session_of(replace(DEMONSTRATION, recordings=(Standing(), *walks)))
    reported = tuple(
        replace(one, condition="=shoes", test=PlannedTest(TimedProtocol.TEN_METRES) if one.name == "walk 2" else None)
        for one in session.recordings
    )
    session = replace(session, recordings=reported)
    return AnalysedVisit(session, analysis_of(session))


def with_test(visit: AnalysedVisit, test: TimedTest | None) -> tuple[Session, Analysis]:
    found = tuple(replace(one, timed=test if one.name == "walk 2" else None) for one in visit.analysis.recordings)
    return visit.session, replace(visit.analysis, recordings=found)


def rows(visit: AnalysedVisit, test: TimedTest | None) -> list[dict[str, str]]:
    session, analysis = with_test(visit, test)
    return [dict(zip(HEADER, row, strict=True)) for row in timed_rows(analysis, session.recordings)]


def filled(found: list[dict[str, str]]) -> list[str]:
    """The cells that hold something, row by row."""
    return [", ".join(f"{name} {cell}" for name, cell in row.items() if cell) for row in found]


def test_a_walk_that_is_a_test_is_timed_by_the_analysis_and_no_other_is(visit: AnalysedVisit) -> None:
    first, second = [one for one in visit.analysis.recordings if one.kind is RecordingKind.WALKING]
    assert first.timed is None
    assert second.timed is not None
    assert second.timed.distance_m == 10.0
    assert second.timed.missing == ()
    assert not {"halves", "halves_time", "drift"} & {
        reason.gate for one in second.verdicts.legs.values() for reason in one.timing.reasons
    }


def test_the_table_has_a_row_for_everything_that_was_found(visit: AnalysedVisit, snapshot: SnapshotAssertion) -> None:
    assert filled(rows(visit, TWO)) == snapshot
    assert rows(visit, None) == []


def test_what_is_new_comes_after_what_was_there(visit: AnalysedVisit, snapshot: SnapshotAssertion) -> None:
    assert HEADER[:19][-1] == "missing"  # no column of earlier versions has moved
    parts = (UpAndGoPart(PartOfUpAndGo.RISE, 3.0, 4.25), UpAndGoPart(PartOfUpAndGo.WALK_OUT, 4.25, math.nan))
    chair = replace(
        TWO,
        protocol=TimedProtocol.UP_AND_GO,
        parts=parts,
        sittings=(Sitting(20.0, 21.5),),
        course_m=3.0,
        course_found_m=4.12,
        not_valid=(NotValid.COURSE_LONGER, NotValid.MORE_TURNS),
    )
    found, unmeasured = rows(visit, chair), rows(visit, replace(TWO, distance_m=math.nan))
    assert [one["row"] for one in found][-4:] == ["silence", "part", "part", "sitting"]
    assert {"up and go": filled([found[0], *found[-3:]]), "not measured": filled(unmeasured[:1])} == snapshot


def test_of_five_rises_each_the_mean_and_the_slowest_have_a_row(visit: AnalysedVisit) -> None:
    rises = tuple(Rise(3.0 + 3.0 * k, 4.0 + 3.1 * k) for k in range(5))
    sittings = tuple(Sitting(4.5 + 3.0 * k, 5.5 + 3.0 * k) for k in range(4))
    five = replace(TWO, protocol=TimedProtocol.SIT_TO_STAND, rises=rises, sittings=sittings)
    found = {one["row"]: one for one in rows(visit, five)}  # the last of each kind
    assert [one["row"] for one in rows(visit, five)].count("rise") == 5
    assert (found["rise_mean"]["time_s"], found["rise_mean"]["start_s"]) == ("1.200", "")
    assert (found["rise_slowest"]["time_s"], found["rise_slowest"]["start_s"]) == ("1.400", "12.000")
    assert found["sitting_mean"]["time_s"] == "1.000"
    once = replace(five, protocol=TimedProtocol.UP_AND_GO)
    assert not any("mean" in one["row"] for one in rows(visit, once))


def test_the_summary_shows_the_test_under_its_walk_and_of_no_other(
    visit: AnalysedVisit, snapshot: SnapshotAssertion
) -> None:
    def reported(test: TimedTest) -> object:
        session, analysis = with_test(visit, test)
        walks = summarise(analysis, session.recordings)["walks"]
        assert "timed_test" not in walks["walk 1"]
        return walks["walk 2"]["timed_test"]

    parts = (UpAndGoPart(PartOfUpAndGo.TURN, 9.0, math.nan),)
    chair = replace(TWO, parts=parts, sittings=(Sitting(20.0, 21.5),), not_valid=(NotValid.NO_TURN,), course_m=3.0)
    assert {"no distance": reported(replace(TWO, distance_m=math.nan)), "not valid": reported(chair)} == snapshot


@pytest.mark.endurance
def test_the_report_has_a_page_of_tests_where_there_were_some(visit: AnalysedVisit) -> None:
    unknown = replace(TWO, distance_m=math.nan)
    whole = ReportRequest(AnalysedVisit(*with_test(visit, TWO)), ("walk 2",), MADE_AT, "1.2.3")
    request = ReportRequest(AnalysedVisit(*with_test(visit, unknown)), ("walk 2",), MADE_AT, "1.2.3")
    assert "2-minute walk: 132 m, 1.10 m/s." in str(timed_page(whole, facts_of(whole)))
    stated = str(timed_page(request, facts_of(request)))
    for words in (
        "2-minute walk: distance not measured.",
        "Speed: 1.10 m/s in the first third, 1.05 m/s in the last third.",
        "1 pause, 3.5 s.",
        "Distance not reported",
        "Third 3",
        "Lap 2",
        "start: first step after standing still for 1 s",
    ):
        assert words in stated
    without = ReportRequest(AnalysedVisit(*with_test(visit, None)), ("walk 2",), MADE_AT, "1.2.3")
    assert timed_page(without, facts_of(without)) == []
    assert len(report_data(request)["pages"]) == len(report_data(without)["pages"]) + 1
    assert make_report(request).startswith(b"%PDF")


def test_the_page_of_tests_shows_the_course_of_those_that_two_visits_have(visit: AnalysedVisit) -> None:
    course = tuple(
        CourseVisit(UUID(int=number), datetime.date(2026, 9 + number, 2), found)
        for number, found in enumerate(
            (
                with_tests((TimedProtocol.TEN_METRES, 14.0), (TimedProtocol.UP_AND_GO, 30.0)),
                with_tests((TimedProtocol.TEN_METRES, 10.0), (TimedProtocol.SIT_TO_STAND, 20.0)),
            )
        )
    )
    request = ReportRequest(AnalysedVisit(*with_test(visit, TWO)), ("walk 2",), MADE_AT, "1.2.3", course=course)
    facts = facts_of(request)
    assert list(charts_of_tests(course, "=shoes", facts)) == [TimedProtocol.TEN_METRES]
    stated = str(timed_page(request, facts))
    assert "10-metre walk, m/s" in stated
    assert "half the measurement error of a speed change. That error is 0.18 m/s." in stated
    assert "they are not judged" not in stated
    assert charts_of_tests(course, "barefoot", facts) == {}
    alone = replace(request, course=course[1:])
    assert "Progress by visit" not in str(timed_page(alone, facts))


def test_a_test_after_the_return_to_an_alignment_is_compared_with_that_alignment(visit: AnalysedVisit) -> None:
    session, analysis = with_test(visit, TWO)
    again = AlignmentChange("Alignment B", (), returns_to="=shoes")
    recordings = tuple(
        replace(one, condition="=shoes again", alignment=again) if one.name == "walk 2" else one
        for one in session.recordings
    )
    course = tuple(
        CourseVisit(
            UUID(int=number), datetime.date(2026, 9 + number, 2), with_tests((TimedProtocol.TEN_METRES, time_s))
        )
        for number, time_s in enumerate((14.0, 10.0))
    )
    of = AnalysedVisit(replace(session, recordings=recordings), analysis)
    request = ReportRequest(of, ("walk 2",), MADE_AT, "1.2.3", course=course)
    assert "Progress by visit" in str(timed_page(request, facts_of(request)))


def with_tests(*tests: tuple[TimedProtocol, float]) -> Course:
    walks = [(timed(one, time_s=time_s, name=f"walk {k}"), "=shoes") for k, (one, time_s) in enumerate(tests)]
    return course_of_walks(*walks)

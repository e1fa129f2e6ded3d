"""The page of the course: values and errors are those of the visits, and a sentence comes beyond the error only."""

import datetime
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from uuid import UUID

import pytest
from syrupy.assertion import SnapshotAssertion

from app.reports.blocks import Block
from app.reports.patient.comparison_page import not_compared_page
from app.reports.patient.document import facts_of, report_data
from app.reports.patient.trend_chart import trend_chart
from app.reports.patient.trend_page import trend_page
from app.summary.course import Course
from app.summary.course_lanes import CourseVisit
from app.summary.request import AnalysedVisit, ReportRequest
from app.summary.trend_lines import TrendValue
from app.wording.timed_tests import name_of_test
from core.alignment import AlignmentChange
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from core.parameters import KNEE
from core.timed.protocols import TimedProtocol
from tests.app.course_material import course, timed, unsure, walked

LEGS = (GoalOf.LEFT, GoalOf.RIGHT)
DAYS = ("2026-09-02", "2026-09-16", "2026-09-30", "2026-10-28", "2026-11-25")


def visits(*courses: Course | None) -> list[CourseVisit]:
    return [
        CourseVisit(UUID(int=number), datetime.date.fromisoformat(day), found)
        for number, (day, found) in enumerate(zip(DAYS, courses, strict=False))
    ]


def walk(
    knee_deg: float = 50.0, speed_m_s: float = 1.0, condition: str = "", *, is_not_reported: bool = False
) -> Course:
    reported = unsure(Joint.LEFT_KNEE) if is_not_reported else None
    return course((walked(knee_deg=knee_deg, speed_m_s=speed_m_s, reported=reported), condition), reported=reported)


def page(request: ReportRequest, seen: Sequence[CourseVisit], condition: str = "") -> list[Block]:
    return trend_page(seen, condition, facts_of(request))


def sentences(blocks: list[Block]) -> list[str]:
    (found,) = (block["said"] for block in blocks if block["kind"] == "bullets")
    assert isinstance(found, list)
    return [str(one).replace("\u2212", "-").replace("\u00a0", " ") for one in found]


def rows(blocks: list[Block]) -> dict[tuple[str, str], list[str]]:
    (table,) = (block for block in blocks if block["kind"] == "table")
    found = table["rows"]
    assert isinstance(found, list)
    cells = [[cell["said"].replace("\u2212", "-") for cell in row["cells"]] for row in found]
    return {(name, side): rest for name, side, *rest in cells}


def test_one_visit_or_two_without_a_common_condition_make_no_page(demo: ReportRequest) -> None:
    assert page(demo, visits(walk())) == []
    assert page(demo, visits(walk(condition="stick"), walk(condition="shoes")), "shoes") == []
    assert page(demo, visits(None, walk())) == []


def test_changes_are_stated_by_their_error_and_from_the_first_visit_that_is_reported(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    def shown(*courses: Course) -> tuple[str, list[str]]:
        blocks = page(demo, visits(*courses))
        return " | ".join(rows(blocks)["Knee flexion, stance to swing, °", "L"]), sentences(blocks)

    gated = [walk(knee_deg, is_not_reported=True) for knee_deg in (20, 35, 52)]
    found = {
        "beyond the error": shown(walk(31), walk(36), walk(52)),
        "within the error": shown(walk(50), walk(54)),
        "the first and the fourth are gaps": shown(gated[0], walk(31), walk(33), gated[1], walk(52)),
        "the last is not reported": shown(walk(31), walk(52), gated[2]),
    }
    assert found == snapshot
    assert not any("knee" in one for one in found["the last is not reported"][1])


def test_of_many_visits_the_table_has_the_first_and_the_latest(demo: ReportRequest) -> None:
    days = [datetime.date(2026, 1, 1) + datetime.timedelta(weeks=k) for k in range(9)]
    seen = [CourseVisit(UUID(int=k), day, walk(30 + k)) for k, day in enumerate(days)]
    (table,) = (block for block in page(demo, seen) if block["kind"] == "table")
    columns = table["columns"]
    assert isinstance(columns, list)
    assert [column["title"] for column in columns[2:8]] == ["1", "5", "6", "7", "8", "9"]


def test_the_page_is_in_the_report_where_visits_were_given(demo: ReportRequest) -> None:
    seen = visits(walk(31), walk(52))
    without, with_it = (report_data(replace(demo, course=tuple(course))) for course in ((), seen))
    assert len(with_it["pages"]) == len(without["pages"]) + 1
    assert with_it["pages"][-1][0]["said"].startswith("Progress over 2 visits, 2 Sep 2026 to 16 Sep 2026")


def returned_to_a(demo: ReportRequest) -> AnalysedVisit:
    """Its visit, whose walk shown is alignment A again."""
    again = AlignmentChange("Alignment B", (), returns_to="Alignment A")
    session = demo.visit.session
    recordings = tuple(
        replace(one, condition="Alignment A again", alignment=again) if one.name == demo.shown else one
        for one in session.recordings
    )
    return AnalysedVisit(replace(session, recordings=recordings), demo.visit.analysis)


def test_the_page_of_a_return_to_an_alignment_is_that_alignments(demo: ReportRequest) -> None:
    visit = returned_to_a(demo)
    seen = visits(walk(31, condition="Alignment A"), walk(52, condition="Alignment A"))
    pages = report_data(replace(demo, visit=visit, course=tuple(seen)))["pages"]
    assert pages[-1][0]["said"].startswith("Progress over 2 visits, 2 Sep 2026 to 16 Sep 2026")


def test_an_earlier_visit_without_the_alignment_that_was_returned_to_is_stated_with_that_alignment(
    demo: ReportRequest,
) -> None:
    visit = returned_to_a(demo)
    (_, paragraph) = not_compared_page(replace(demo, visit=visit, earlier=demo.visit))
    assert "has no walk in this condition (\u2068Alignment A\u2069)" in str(paragraph["said"])


@pytest.mark.parametrize("value", [0.7, 31.0, 60.0])
def test_a_chart_states_its_values_and_joins_none_over_a_gap(value: float) -> None:
    days = [datetime.date(2026, 9, 1), datetime.date(2026, 9, 8), datetime.date(2026, 9, 15)]
    whole = [TrendValue(k, value * (1 + 0.1 * k), 0.05 * value) for k in range(3)]
    gap = [whole[0], TrendValue(1, math.nan, math.nan), whole[2]]
    drawn, broken = (trend_chart("Knee", 1, days, {Side.LEFT: values}, is_simulated=False) for values in (whole, gap))
    assert f"1: {value:.1f}" in drawn.alt
    assert "not reported" in broken.svg
    assert "not reported" not in drawn.svg
    joins = [svg.count('stroke-width="1.2"') for svg in (drawn.svg, broken.svg)]
    assert joins == [2, 0]


def with_goals(request: ReportRequest, *goals: Goal) -> ReportRequest:
    """Of a visit on the last of the days."""
    session = replace(request.visit.session, started=DAYS[-1])
    reported = replace(session, patient=replace(session.patient, goals=goals))
    return replace(request, visit=AnalysedVisit(reported, request.visit.analysis))


def knee_goal(value: float, agreed: str = DAYS[1]) -> Goal:
    return Goal(KNEE, GoalOf.LEFT, value, datetime.date.fromisoformat(agreed), "H. Keller")


def test_a_goal_is_dotted_with_who_and_when_and_a_sentence_states_how_the_last_visit_is(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    """But not of one that was agreed on its day, nor where it is not reported."""

    def stated(blocks: list[Block]) -> list[str]:
        return [one for one in sentences(blocks) if one.startswith("Goal")]

    seen = visits(*(walk(knee_deg=knee_deg) for knee_deg in (31.0, 36.0, 39.0, 45.0, 52.0)))
    gated = visits(*(walk(knee_deg=52.0, is_not_reported=number == 4) for number in range(5)))
    reached, late = (page(with_goals(demo, knee_goal(41.0, day)), seen) for day in (DAYS[1], DAYS[-1]))
    assert {
        "reached": stated(reached),
        "missed by less than the error": stated(page(with_goals(demo, knee_goal(55.0)), seen)),
        "agreed on the day of the visit": stated(late),
        "not reported": stated(page(with_goals(demo, knee_goal(41.0)), gated)),
    } == snapshot
    (drawn,) = (block["pictures"] for block in reached if block["kind"] == "figures")
    assert "goal L 41°, agreed 16 Sep" in str(drawn)
    assert "Keller" in str(drawn)
    assert "goal L 41°" in str(late)


def test_a_measure_with_a_goal_has_a_chart_of_its_own_and_no_more_than_four_are_drawn(demo: ReportRequest) -> None:
    seen = visits(walk(), walk())
    stride = Goal("stride_length_m", GoalOf.RIGHT, 1.3, datetime.date.fromisoformat(DAYS[0]))
    (drawn,) = (block["pictures"] for block in page(with_goals(demo, stride), seen) if block["kind"] == "figures")
    assert isinstance(drawn, list)
    assert len(drawn) <= 4
    assert "Stride length, m" in str(drawn)
    assert "Stride length" not in str(page(demo, seen))


def test_two_goals_of_one_chart_have_a_line_each_and_of_many_five_are_stated(demo: ReportRequest) -> None:
    seen = visits(walk(), walk(), walk())
    agreed = datetime.date.fromisoformat(DAYS[0])
    every = [Goal(column, of, 20.0, agreed) for column in (KNEE, "knee_range_deg", "ankle_range_deg") for of in LEGS]
    blocks = page(with_goals(demo, *every), seen)
    assert sum(one.startswith("Goal") for one in sentences(blocks)) == 5
    (drawn,) = (block["pictures"] for block in blocks if block["kind"] == "figures")
    lines = re.findall(r'y="([\d.]+)"[^>]*>· · · goal ([LR]) 20', str(drawn))
    assert lines[:2] == [("17.00", "L"), ("27.00", "R")]


def with_test(time_s: float, speed_m_s: float = 1.0, protocol: TimedProtocol = TimedProtocol.TEN_METRES) -> Course:
    return course((walked(speed_m_s=speed_m_s), ""), (timed(protocol, time_s=time_s), ""))


def test_timed_tests_stand_in_the_table_and_speed_is_reported_once(
    demo: ReportRequest, snapshot: SnapshotAssertion
) -> None:
    def shown(name: str, *courses: Course) -> tuple[str, list[str]]:
        blocks = page(demo, visits(*courses))
        return " | ".join(rows(blocks)[name, ""]), sentences(blocks)

    chair = [with_test(time_s, protocol=TimedProtocol.SIT_TO_STAND) for time_s in (30.0, 12.0)]
    metres = shown("10-metre walk, m/s", with_test(20.0, 0.6), with_test(8.0, 1.0))
    found = {"10 metres": metres, "chair": shown(f"{name_of_test(TimedProtocol.SIT_TO_STAND)}, s", *chair)}
    assert found == snapshot
    assert len([one for one in metres[1] if "m/s" in one]) == 1
    assert not any("10-metre" in name for name, _ in rows(page(demo, visits(walk(), walk()))))

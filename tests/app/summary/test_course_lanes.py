"""The course over visits: what is a point, what is a gap, what has changed since when, and every sentence of it."""

import datetime
import math
from dataclasses import replace
from uuid import UUID

import pytest
from syrupy.assertion import SnapshotAssertion

from app.summary.course import Course
from app.summary.course_lanes import (
    KNEE_LANE,
    SPEED_LANE,
    STANCE_LANE,
    CourseLane,
    CourseVisit,
    LaneKind,
    conditions_of_visits,
    kinds_of_tests,
    lane_kinds,
    lanes,
    usual_condition,
    without_lane,
)
from app.summary.course_words import (
    LatestVisit,
    change_in_figures,
    changes_since_in_words,
    judged_in_words,
    key_in_words,
    lane_in_words,
    last_in_words,
    next_step,
    nothing_between,
    undecided_step,
    visit_in_words,
)
from app.summary.goals import reached_at
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from core.timed.measures import COLUMNS
from core.timed.protocols import TimedProtocol
from core.verdicts.measurement_error import Difference, ErrorSource, Judgement
from core.verdicts.model import Verdict
from tests.app.course_material import course, timed, unsure, walked

SHOES, STICK = "shoes", "shoes, stick"
TODAY = datetime.date(2026, 11, 23)


def visit(number: int, found: Course | None, year: int = 2026) -> CourseVisit:
    return CourseVisit(UUID(int=number), datetime.date(year, number + 1, 20), found)


def shoes(knee_deg: float = 50.0, speed_m_s: float = 1.0, stance_percent: float = 60.0, strides: int = 12) -> Course:
    walk = walked(knee_deg=knee_deg, speed_m_s=speed_m_s, stance_percent=stance_percent, strides=strides)
    return course((walk, SHOES))


def gated() -> Course:
    reported = unsure(Joint.LEFT_KNEE)
    return course((walked(reported=reported), SHOES), reported=reported)


def lane(found: tuple[CourseLane, ...], kind: LaneKind) -> CourseLane:
    return next(one for one in found if one.kind is kind)


def test_a_course_is_of_one_condition_and_by_itself_of_one_that_the_latest_visit_has() -> None:
    both = course((walked(speed_m_s=0.8), SHOES), (walked("walk 2", speed_m_s=0.9), STICK))
    visits = [visit(1, both), visit(2, shoes(speed_m_s=1.0)), visit(3, both)]
    assert conditions_of_visits(visits) == {SHOES: 3, STICK: 2}
    speed = lane(lanes(visits), SPEED_LANE)
    assert [[point.visit for point in line.points] for line in speed.lines] == [[0, 1, 2]]
    only = lane(lanes(visits, STICK), SPEED_LANE)
    assert [[point.visit for point in line.points] for line in only.lines] == [[0, 2]]
    with_stick = course((walked(), STICK))
    assert usual_condition(visits) == SHOES
    assert usual_condition([*visits, visit(4, with_stick), visit(5, None)]) == STICK
    assert usual_condition([visit(1, None)]) == ""


def test_values_are_whole_unless_they_would_not_give_the_change() -> None:
    even = lane(lanes([visit(1, shoes(40.2)), visit(2, shoes(49.8))]), KNEE_LANE)
    assert (last_in_words(even, even.changes[0]), change_in_figures(even, even.changes[0])) == ("50°", "+10°")
    odd = lane(lanes([visit(1, shoes(34.6)), visit(2, shoes(53.4))]), KNEE_LANE)  # 35, 53 and +19
    assert (last_in_words(odd, odd.changes[0]), change_in_figures(odd, odd.changes[0])) == ("53.4°", "+18.8°")
    slow, fast = shoes(speed_m_s=0.704), shoes(speed_m_s=1.126)
    speed = lane(lanes([visit(1, slow), visit(2, fast)]), SPEED_LANE)
    assert (last_in_words(speed, speed.changes[0]), change_in_figures(speed, speed.changes[0])) == ("1.13", "+0.43")


def test_what_healthy_legs_differ_by_is_known_of_stance_between_the_legs_only() -> None:
    found = lanes([visit(1, shoes())])
    low, high = lane(found, STANCE_LANE).healthy or (math.nan, math.nan)
    assert low == -high
    assert high == pytest.approx(4.0, abs=0.3)
    assert lane(found, KNEE_LANE).healthy is None


def test_the_knee_is_the_affected_sides_else_each_sides() -> None:
    affected = lane(lanes([visit(1, shoes())]), KNEE_LANE)
    assert [line.side for line in affected.lines] == [Side.LEFT]
    nobody = course((walked(), SHOES), affected=None)
    each = lane(lanes([visit(1, nobody), visit(2, nobody)]), KNEE_LANE)
    assert [line.side for line in each.lines] == [Side.LEFT, Side.RIGHT]


def test_a_visit_that_cannot_be_read_is_a_gap_and_the_change_counts_from_the_first_that_can() -> None:
    visits = [visit(1, gated()), visit(2, shoes(40.0)), visit(3, gated()), visit(4, shoes(60.0))]
    knee = lane(lanes(visits), KNEE_LANE)
    points = knee.lines[0].points
    assert [point.is_reported for point in points] == [False, True, False, True]
    assert points[0].verdict is Verdict.NOT_REPORTED
    (change,) = knee.changes
    assert (change.first, change.since_last) == (1, None)
    assert change.since_first is not None
    assert change.since_first.difference == pytest.approx(20.0)


def test_a_last_visit_that_cannot_be_read_has_no_difference() -> None:
    visits = [visit(1, shoes(40.0)), visit(2, gated())]
    knee = lane(lanes(visits), KNEE_LANE)
    (change,) = knee.changes
    assert change.since_first is None
    assert last_in_words(knee, change) == "not reported"


def test_a_visit_that_is_not_computed_is_no_point() -> None:
    found = lanes([visit(1, shoes()), visit(2, None), visit(3, shoes())])
    assert [[point.visit for point in line.points] for one in found for line in one.lines] == [[0, 2]] * 3
    (change,) = lane(lanes([visit(1, shoes())]), SPEED_LANE).changes
    assert (change.since_first, change.since_last) == (None, None)


def test_why_there_is_no_trend_is_stated(snapshot: SnapshotAssertion) -> None:
    assert {
        "one visit": nothing_between([visit(1, shoes())]),
        "two visits have one": nothing_between([visit(1, shoes()), visit(2, shoes())]),
        "one is not calculated": nothing_between([visit(1, shoes()), visit(2, None), visit(3, shoes())]),
        "two are not calculated": nothing_between([visit(1, None), visit(2, None)]),
        "no walks": nothing_between([visit(1, Course(None, ()))]),
    } == snapshot


def test_a_lane_states_every_value_with_its_day_unit_change_and_goal(snapshot: SnapshotAssertion) -> None:
    two = [visit(5, shoes(speed_m_s=0.71, stance_percent=56.0)), visit(10, shoes(speed_m_s=1.12))]
    gaps = [visit(1, gated()), visit(2, shoes(40.0)), visit(3, gated()), visit(4, shoes(60.0))]
    uncounted = [visit(1, shoes()), visit(2, None), visit(3, shoes())]
    years = [visit(1, shoes(), 2025), visit(1, shoes(), 2026)]
    bent = [visit(1, shoes(knee_deg=40.0)), visit(2, shoes(knee_deg=50.0))]
    right = goal(KNEE_LANE.column, GoalOf.RIGHT, 72.0)
    day_before, same_day = (replace(right, agreed=datetime.date(2026, 3, day)) for day in (19, 20))

    def stated(visits: list[CourseVisit], kind: LaneKind, *goals: Goal) -> str:
        return lane_in_words(lane(lanes(visits, goals=goals), kind), visits)

    assert {
        "speed": stated(two, SPEED_LANE),
        "stance between the legs": stated(two, STANCE_LANE),
        "gaps: the change counts from the first that can be read": stated(gaps, KNEE_LANE),
        "the last cannot be read: no change": stated([visit(1, shoes(40.0)), visit(2, gated())], KNEE_LANE),
        "no value": stated([visit(1, None)], SPEED_LANE),
        "several years": stated(years, SPEED_LANE),
        "a goal agreed later": stated(bent, KNEE_LANE, right),
        "a goal agreed on the day of the last visit": stated(bent, KNEE_LANE, same_day),
        "a goal agreed the day before": stated(bent, KNEE_LANE, day_before),
        "one visit": visit_in_words(0, lanes(two), two),
        "one that is not calculated": visit_in_words(1, lanes(uncounted), uncounted),
    } == snapshot


def difference(judgement: Judgement, error: float = 9.2, *, is_unverified: bool = False) -> Difference:
    return Difference(3.0, error, judgement, (ErrorSource.CHANCE, ErrorSource.AXIS), is_unverified=is_unverified)


def test_each_judgement_has_its_words(snapshot: SnapshotAssertion) -> None:
    found = {
        "beyond": difference(Judgement.EXCEEDS_ERROR),
        "within": difference(Judgement.INSIDE_ERROR),
        "within, of unknown sources": Difference(3.0, 9.2, Judgement.INSIDE_ERROR),
        "within, not verified": difference(Judgement.INSIDE_ERROR, is_unverified=True),
        "no published figure": difference(Judgement.NO_PUBLISHED_FIGURE, math.nan),
        "too few strides": difference(Judgement.TOO_FEW_STRIDES, math.nan),
    }
    assert {case: judged_in_words(one, KNEE_LANE) for case, one in found.items()} == snapshot


def test_what_is_drawn_is_explained_and_nothing_else(snapshot: SnapshotAssertion) -> None:
    goals = [goal(SPEED_LANE.column, GoalOf.WALK, 1.0)]
    assert {
        "two visits have an arrow": key_in_words(lanes([visit(1, shoes(40.0)), visit(2, shoes(60.0))])),
        "one visit": key_in_words(lanes([visit(1, shoes())])),
        "a goal": key_in_words(lanes([visit(1, shoes())], goals=goals)),
    } == snapshot


def latest(days_ago: int = 1, *not_reported: Joint, has_walk: bool = True, has_report: bool = True) -> LatestVisit:
    day = TODAY - datetime.timedelta(days=days_ago)
    return LatestVisit(UUID(int=1), day, "yesterday", not_reported, has_walk, has_report)


def test_what_is_next_is_the_first_that_holds(snapshot: SnapshotAssertion) -> None:
    recovered = undecided_step(UUID(int=7), datetime.date(2026, 11, 2))
    gated_and_unwritten = latest(1, Joint.LEFT_KNEE, Joint.LEFT_ANKLE, has_report=False)
    reached = {
        value: reached_at([goal(SPEED_LANE.column, GoalOf.WALK, value)], shoes(speed_m_s=1.0))
        for value in (0.7, 0.95, 1.05)
    }
    assert reached[1.05] == ()
    assert {
        "a recovered walk": next_step(recovered, latest(90, Joint.LEFT_KNEE, has_report=False), TODAY),
        "a recovered walk of an unknown day": undecided_step(UUID(int=7), None),
        "joints are not reported": next_step(None, gated_and_unwritten, TODAY),
        "no report": next_step(None, latest(90, has_report=False), TODAY),
        "a goal is reached, the report comes before": next_step(
            None, replace(latest(has_report=False), reached=reached[0.7]), TODAY
        ),
        "a goal is reached, long ago": next_step(None, replace(latest(90), reached=reached[0.7]), TODAY),
        "a goal is reached within error": next_step(None, replace(latest(), reached=reached[0.95]), TODAY),
        "eight weeks ago": next_step(None, latest(56), TODAY),
        "a day less": next_step(None, latest(55), TODAY),
        "no walk": next_step(None, latest(1, has_walk=False, has_report=False), TODAY),
        "no visit": next_step(None, None, TODAY),
    } == snapshot


def goal(column: str, of: GoalOf, value: float, day: datetime.date = TODAY) -> Goal:
    return Goal(column, of, value, day, is_at_most=of is GoalOf.BETWEEN)


def test_lanes_with_goals_come_first_and_the_usual_ones_fill_the_room() -> None:
    assert lane_kinds() == (SPEED_LANE, KNEE_LANE, STANCE_LANE)
    stride = goal("stride_length_m", GoalOf.RIGHT, 1.3)
    assert lane_kinds([stride]) == (LaneKind("stride_length_m"), SPEED_LANE, KNEE_LANE)
    assert lane_kinds([replace(stride, ended=TODAY)]) == lane_kinds()
    both = [goal(KNEE_LANE.column, GoalOf.LEFT, 55.0), goal(SPEED_LANE.column, GoalOf.WALK, 1.2)]
    assert lane_kinds(both) == (SPEED_LANE, KNEE_LANE, STANCE_LANE)
    many = [goal(f"{name}_deg", GoalOf.LEFT, 20.0) for name in ("knee_range", "ankle_range", "ankle_rocker")]
    assert len(lane_kinds([*both, *many])) == 4
    assert without_lane([*both, *many]) == (many[-1],)


def test_a_lane_holds_its_goals_and_the_leg_that_they_are_of() -> None:
    visits = [visit(1, shoes(knee_deg=40.0)), visit(2, shoes(knee_deg=50.0))]
    right = goal(KNEE_LANE.column, GoalOf.RIGHT, 72.0)
    knee = lane(lanes(visits, goals=[right]), KNEE_LANE)
    assert (knee.goals, knee.goal_values) == ((right,), [72.0])
    assert max(knee.values) == 72.0
    assert [line.side for line in knee.lines] == [Side.LEFT, Side.RIGHT]
    apart = goal(STANCE_LANE.column, GoalOf.BETWEEN, 2.0)
    stance = lane(lanes(visits, goals=[apart]), STANCE_LANE)
    assert stance.goal_values == [2.0, -2.0]
    assert lane(lanes(visits), KNEE_LANE).goals == ()


TEN_METRES, UP_AND_GO = (LaneKind(COLUMNS[one]) for one in (TimedProtocol.TEN_METRES, TimedProtocol.UP_AND_GO))


def with_tests(time_s: float, up_and_go_s: float = math.nan) -> Course:
    tests = [(timed(TimedProtocol.TEN_METRES, time_s=time_s), SHOES)]
    if math.isfinite(up_and_go_s):
        tests.append((timed(TimedProtocol.UP_AND_GO, time_s=up_and_go_s, name="walk 8"), SHOES))
    return course(*tests)


def test_a_test_that_was_done_once_has_a_lane_and_one_that_a_goal_is_of() -> None:
    visits = [visit(1, shoes()), visit(2, with_tests(12.5, 30.0)), visit(3, with_tests(10.0))]
    assert kinds_of_tests(visits, ()) == (TEN_METRES, UP_AND_GO)
    assert kinds_of_tests(visits[:1], ()) == ()
    required = Goal(COLUMNS[TimedProtocol.SIX_MINUTES], GoalOf.WALK, 400.0, TODAY)
    assert kinds_of_tests(visits[:1], [required]) == (LaneKind(required.column),)
    assert lane_kinds([required]) == lane_kinds()
    assert without_lane([required]) == ()


def test_the_lane_of_a_test_has_a_verdict_where_an_error_is_known_only(snapshot: SnapshotAssertion) -> None:
    visits = [visit(1, with_tests(12.5, 30.0)), visit(2, with_tests(11.0, 24.0)), visit(3, with_tests(8.0, 20.0))]
    ten, up = lanes(visits, kinds=(TEN_METRES, UP_AND_GO))
    assert [point.value for point in ten.lines[0].points] == pytest.approx([0.8, 0.909, 1.25], abs=1e-3)
    once = visits[:1]
    assert {
        "10 metres": changes_since_in_words(ten, visits),
        "from a chair nobody knows the error": changes_since_in_words(up, visits),
        "once": changes_since_in_words(lanes(once, kinds=(UP_AND_GO,))[0], once),
        "values": lane_in_words(up, visits),
    } == snapshot


def test_a_goal_of_a_test_is_reached_where_the_test_was_done_and_reported_of_speed_alone() -> None:
    both = course((walked(), STICK), (timed(TimedProtocol.TEN_METRES, time_s=8.0), SHOES))
    ten = goal(TEN_METRES.column, GoalOf.WALK, 1.0)
    (reached,) = reached_at([ten], both)
    assert reached.value == pytest.approx(1.25)
    assert reached.error == pytest.approx(0.18017, abs=1e-4)  # 1.96 sqrt(2) 0.065
    assert reached_at([replace(ten, value=1.3)], both) == ()
    up = Goal(UP_AND_GO.column, GoalOf.WALK, 40.0, ten.agreed, is_at_most=True)
    assert reached_at([up], with_tests(8.0, 30.0)) == ()  # nobody knows by how much a time from a chair is off

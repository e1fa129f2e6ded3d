"""The course over visits: what is a point, what is a gap, what has changed since when, and every sentence of it."""

import datetime
import math
from dataclasses import replace
from uuid import UUID

import pytest

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
    NextKind,
    NextStep,
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
    assert lane_in_words(knee, visits).startswith(
        "Knee flexion, stance to swing, left: not reported on 20 Feb, 40 degrees on 20 Mar, not reported on 20 Apr, "
        "60 degrees on 20 May. +20° since 20 Mar, beyond error (7."
    )


def test_a_last_visit_that_cannot_be_read_has_no_difference() -> None:
    visits = [visit(1, shoes(40.0)), visit(2, gated())]
    knee = lane(lanes(visits), KNEE_LANE)
    (change,) = knee.changes
    assert change.since_first is None
    assert last_in_words(knee, change) == "not reported"
    assert "since" not in lane_in_words(knee, visits)


def test_a_visit_that_is_not_computed_is_no_point_and_is_counted() -> None:
    visits = [visit(1, shoes()), visit(2, None), visit(3, shoes())]
    found = lanes(visits)
    assert [[point.visit for point in line.points] for one in found for line in one.lines] == [[0, 2]] * 3
    assert nothing_between(visits) == "1 visit is not calculated yet."
    assert nothing_between([visit(1, None), visit(2, None)]) == "2 visits are not calculated yet."
    assert visit_in_words(1, found, visits) == "20 Mar. not calculated yet."


def test_one_visit_makes_no_trend_and_two_do() -> None:
    assert nothing_between([visit(1, shoes())]) == "A trend needs a second visit."
    assert nothing_between([visit(1, shoes()), visit(2, shoes())]) == ""
    assert nothing_between([visit(1, Course(None, ()))]) == "No visit has a walk yet."
    (change,) = lane(lanes([visit(1, shoes())]), SPEED_LANE).changes
    assert (change.since_first, change.since_last) == (None, None)


def test_a_lane_states_every_value_with_its_day_and_unit() -> None:
    visits = [visit(5, shoes(speed_m_s=0.71, stance_percent=56.0)), visit(10, shoes(speed_m_s=1.12))]
    found = lanes(visits)
    stated = lane_in_words(lane(found, SPEED_LANE), visits)
    assert stated == (
        "Walking speed: 0.71 metres per second on 20 Jun, 1.12 metres per second on 20 "
        "Nov. +0.41 since 20 Jun, beyond error (0.18)."
    )
    stance = lane_in_words(lane(found, STANCE_LANE), visits)
    assert stance == (
        "Stance, left minus right: \N{MINUS SIGN}4.0 percent of the gait cycle on 20 Jun,"
        " 0.0 percent of the gait cycle on 20 Nov. +4.0 since 20 Jun, within error (5.2)."
    )
    assert visit_in_words(0, found, visits) == (
        "20 Jun. Walking speed: 0.71 metres per second. Knee flexion, stance to swing, "
        "left: 50 degrees. Stance, left minus right: \N{MINUS SIGN}4.0 percent of the "
        "gait cycle."
    )


def test_a_lane_without_a_value_states_that() -> None:
    nothing = lane_in_words(lane(lanes([visit(1, None)]), SPEED_LANE), [visit(1, None)])
    assert nothing == "Walking speed: no value."


def test_visits_of_several_years_have_them_in_their_days() -> None:
    visits = [visit(1, shoes(), 2025), visit(1, shoes(), 2026)]
    assert "on 20 Feb 2025" in lane_in_words(lane(lanes(visits), SPEED_LANE), visits)


def difference(
    judgement: Judgement, error: float = 9.2, sources: tuple[ErrorSource, ...] = (), *, is_unverified: bool = False
) -> Difference:
    return Difference(3.0, error, judgement, sources, is_unverified=is_unverified)


@pytest.mark.parametrize(
    ("found", "stated"),
    [
        (difference(Judgement.EXCEEDS_ERROR), "beyond error (9.2)"),
        (difference(Judgement.INSIDE_ERROR, is_unverified=True), "within error (9.2 \u2020)"),
        (
            difference(Judgement.INSIDE_ERROR, sources=(ErrorSource.CHANCE, ErrorSource.AXIS)),
            "within error (9.2)",
        ),
        (difference(Judgement.NO_PUBLISHED_FIGURE, math.nan), "not judged"),
        (difference(Judgement.TOO_FEW_STRIDES, math.nan), "too few strides to judge"),
    ],
)
def test_each_judgement_has_its_words(found: Difference, stated: str) -> None:
    assert judged_in_words(found, KNEE_LANE) == stated


def test_what_is_drawn_is_explained_and_nothing_else() -> None:
    two = lanes([visit(1, shoes(40.0)), visit(2, shoes(60.0))])
    assert key_in_words(two) == (
        "Means of the strides used at each visit. Filled arrow: beyond measurement error. Outlined: within. Grey: 95 "
        "of 100 healthy people."
    )
    assert "arrow" not in key_in_words(lanes([visit(1, shoes())]))
    goals = [goal(SPEED_LANE.column, GoalOf.WALK, 1.0)]
    assert "Dotted: goal." in key_in_words(lanes([visit(1, shoes())], goals=goals))


def latest(days_ago: int = 1, *not_reported: Joint, has_walk: bool = True, has_report: bool = True) -> LatestVisit:
    day = TODAY - datetime.timedelta(days=days_ago)
    return LatestVisit(UUID(int=1), day, "yesterday", not_reported, has_walk, has_report)


def test_what_is_next_is_the_first_that_holds() -> None:
    recovered = undecided_step(UUID(int=7), datetime.date(2026, 11, 2))
    gated_and_unwritten = latest(90, Joint.LEFT_KNEE, has_report=False)
    assert next_step(recovered, gated_and_unwritten, TODAY) == NextStep(
        NextKind.REVIEW, "Review walk of 2 Nov", "Recovered. Include or exclude it.", UUID(int=7)
    )
    assert undecided_step(UUID(int=7), None).verb == "Review last walk"
    assert next_step(None, latest(1, Joint.LEFT_KNEE, Joint.LEFT_ANKLE, has_report=False), TODAY) == NextStep(
        NextKind.REVIEW,
        "Review visit of 22 Nov",
        "Left knee and left ankle: not reported. Repeat at the next walk.",
        UUID(int=1),
    )
    assert next_step(None, latest(90, has_report=False), TODAY) == NextStep(
        NextKind.REPORT, "Write report of 25 Aug", "Not written yet. Measured yesterday.", UUID(int=1)
    )
    assert next_step(None, latest(56), TODAY) == NextStep(
        NextKind.SESSION, "Begin next visit", "Last visit 8 weeks ago."
    )
    assert next_step(None, latest(55), TODAY) is None
    assert next_step(None, latest(1, has_walk=False, has_report=False), TODAY) is None
    assert next_step(None, None, TODAY) is None


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
    assert lane_in_words(knee, visits).endswith("Goal: Knee flexion, stance to swing, right: at least 72°.")
    before = replace(right, agreed=datetime.date(2026, 3, 19))  # the day before the last visit
    reported = lane_in_words(lane(lanes(visits, goals=[before]), KNEE_LANE), visits)
    assert reported.endswith("right: at least 72°. Not reached; the difference is beyond measurement error (±8.0°).")
    same_day = replace(right, agreed=datetime.date(2026, 3, 20))
    assert "Not reached" not in lane_in_words(lane(lanes(visits, goals=[same_day]), KNEE_LANE), visits)
    apart = goal(STANCE_LANE.column, GoalOf.BETWEEN, 2.0)
    stance = lane(lanes(visits, goals=[apart]), STANCE_LANE)
    assert stance.goal_values == [2.0, -2.0]
    assert lane(lanes(visits), KNEE_LANE).goals == ()


def test_a_goal_that_is_reached_is_next_after_the_report_and_before_a_long_time() -> None:
    reached = reached_at([goal(SPEED_LANE.column, GoalOf.WALK, 0.7)], shoes(speed_m_s=1.0))
    found = next_step(None, replace(latest(90), reached=reached), TODAY)
    assert found == NextStep(
        NextKind.GOALS,
        "Agree next goal",
        "Goal reached: Walking speed: at least 0.70\N{NO-BREAK SPACE}m/s; measured 1.00\N{NO-BREAK SPACE}m/s, beyond "
        "error.",
    )
    near = reached_at([goal(SPEED_LANE.column, GoalOf.WALK, 0.95)], shoes(speed_m_s=1.0))
    stated = next_step(None, replace(latest(), reached=near), TODAY)
    assert stated is not None
    assert stated.reason.endswith("measured 1.00\N{NO-BREAK SPACE}m/s, within measurement error, so not certain.")
    unwritten = next_step(None, replace(latest(has_report=False), reached=reached), TODAY)
    assert unwritten is not None
    assert unwritten.kind is NextKind.REPORT
    assert reached_at([goal(SPEED_LANE.column, GoalOf.WALK, 1.05)], shoes(speed_m_s=1.0)) == ()


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


def test_the_lane_of_a_test_has_a_verdict_where_an_error_is_known_only() -> None:
    visits = [visit(1, with_tests(12.5, 30.0)), visit(2, with_tests(11.0, 24.0)), visit(3, with_tests(8.0, 20.0))]
    ten, up = lanes(visits, kinds=(TEN_METRES, UP_AND_GO))
    assert [point.value for point in ten.lines[0].points] == pytest.approx([0.8, 0.909, 1.25], abs=1e-3)
    space = "\N{NO-BREAK SPACE}"
    assert changes_since_in_words(ten, visits) == (
        f"+0.34{space}m/s since 20 Mar, beyond error (0.18). +0.45{space}m/s since 20 Feb, beyond error (0.18)."
    )
    minus = "\N{MINUS SIGN}"
    assert changes_since_in_words(up, visits) == (
        f"{minus}4.0{space}s since 20 Mar, not judged. {minus}10.0{space}s since 20 Feb, not judged."
    )
    assert changes_since_in_words(lanes(visits[:1], kinds=(UP_AND_GO,))[0], visits[:1]) == ""
    assert lane_in_words(up, visits).startswith("Timed Up and Go: 30.0 seconds on 20 Feb, 24.0 seconds on 20 Mar")


def test_a_goal_of_a_test_is_reached_where_the_test_was_done_and_reported_of_speed_alone() -> None:
    both = course((walked(), STICK), (timed(TimedProtocol.TEN_METRES, time_s=8.0), SHOES))
    ten = goal(TEN_METRES.column, GoalOf.WALK, 1.0)
    (reached,) = reached_at([ten], both)
    assert reached.value == pytest.approx(1.25)
    assert reached.error == pytest.approx(0.18017, abs=1e-4)  # 1.96 sqrt(2) 0.065
    assert reached_at([replace(ten, value=1.3)], both) == ()
    up = Goal(UP_AND_GO.column, GoalOf.WALK, 40.0, ten.agreed, is_at_most=True)
    assert reached_at([up], with_tests(8.0, 30.0)) == ()  # nobody knows by how much a time from a chair is off

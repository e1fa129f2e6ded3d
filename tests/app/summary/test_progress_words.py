"""The sentence of what has changed: which change leads, when there is none, and what a list has of it."""

import datetime
from uuid import UUID

from syrupy.assertion import SnapshotAssertion

from app.summary.course import Course
from app.summary.course_lanes import CourseVisit
from app.summary.progress_words import ProgressWords, progress_words
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from tests.app.course_material import course, unsure, walked

SHOES = "shoes"
LEFT, RIGHT = Side.LEFT, Side.RIGHT
EARLY = datetime.date(2026, 1, 1)


def visit(month: int, found: Course | None, year: int = 2026) -> CourseVisit:
    return CourseVisit(UUID(int=month), datetime.date(year, month, 3), found)


def shoes(
    knee_deg: float = 50.0,
    speed_m_s: float = 1.0,
    stance_percent: float = 60.0,
    affected: Side | None = LEFT,
    strides: int = 12,
) -> Course:
    walk = walked(knee_deg=knee_deg, speed_m_s=speed_m_s, stance_percent=stance_percent, strides=strides)
    return course((walk, SHOES), affected=affected)


def words(*visits: CourseVisit, goals: tuple[Goal, ...] = ()) -> ProgressWords:
    return progress_words(visits, SHOES, goals)


def two(before: Course | None, after: Course | None, *goals: Goal) -> ProgressWords:
    return words(visit(7, before), visit(11, after), goals=goals)


def test_changes_are_stated_by_their_error(snapshot: SnapshotAssertion) -> None:
    goal = Goal("knee_stance_to_swing_deg", GoalOf.LEFT, 70.0, EARLY)
    assert {
        "since the last visit before one since the first": words(
            visit(7, shoes(35.0)), visit(9, shoes(40.0)), visit(11, shoes(53.0))
        ),
        "since the first visit where the last changed little": words(
            visit(7, shoes(35.0, 0.7)), visit(9, shoes(50.0, 1.08)), visit(11, shoes(53.0, 1.13))
        ),
        "within its error": two(shoes(50.0), shoes(52.0)),
        "between one error and what page one asks for": two(shoes(50.0), shoes(58.0)),
        "the same with a goal": two(shoes(50.0), shoes(58.0), goal),
        "of few strides: values, no change": two(shoes(35.0, strides=5), shoes(55.0, strides=5)),
        "days of several years": words(visit(7, shoes(35.0), 2025), visit(1, shoes(53.0))),
        "stance in points": two(shoes(stance_percent=66.0), shoes(stance_percent=60.0)),
        "stance where no side is affected": two(
            shoes(stance_percent=66.0, affected=None), shoes(stance_percent=60.0, affected=None)
        ),
    } == snapshot


def test_one_visit_states_its_values(snapshot: SnapshotAssertion) -> None:
    assert {
        "beyond healthy people": words(visit(7, shoes(35.0))),
        "within them": words(visit(7, shoes(52.0))),
        "the other side is affected": words(visit(7, shoes(35.0, affected=RIGHT))),
        "alike, no side affected": words(visit(7, shoes(59.0, affected=None))),
        "two strides": words(visit(7, shoes(strides=2))),
        "nothing reported": words(visit(7, None)),
    } == snapshot


def test_a_joint_that_is_not_reported_is_in_no_sentence(snapshot: SnapshotAssertion) -> None:
    reported = unsure(Joint.LEFT_KNEE)
    gated = course((walked(speed_m_s=1.3, reported=reported), SHOES), reported=reported)
    found = two(shoes(35.0), gated)
    assert "knee" not in found.sentence + found.second
    assert {"since a visit that reports it": found, "alone": words(visit(7, gated))} == snapshot


def test_goals_agreed_before_the_visit_are_in_the_second_line(snapshot: SnapshotAssertion) -> None:
    def found(agreed: datetime.date) -> ProgressWords:
        goals = (
            Goal("speed_m_s", GoalOf.WALK, 0.9, agreed),
            Goal("knee_stance_to_swing_deg", GoalOf.LEFT, 55.0, agreed),
        )
        return two(shoes(35.0, 0.7), shoes(53.0, 1.13), *goals)

    assert {"agreed before": found(EARLY), "agreed on the day": found(datetime.date(2026, 11, 3))} == snapshot

"""The sentence of what has changed: which change leads, when there is none, and what a list has of it."""

import datetime
from uuid import UUID

import pytest

from app.summary.course import Course
from app.summary.course_lanes import CourseVisit
from app.summary.progress_words import Arrow, ProgressWords, progress_words
from core.body import Joint, Side
from core.goals import Goal, GoalOf
from tests.app.course_material import course, unsure, walked

SHOES = "shoes"
LEFT = Side.LEFT
NB = "\N{NO-BREAK SPACE}"
MINUS = "\N{MINUS SIGN}"
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


def test_a_change_since_the_last_visit_comes_before_one_since_the_first() -> None:
    found = words(visit(7, shoes(35.0)), visit(9, shoes(40.0)), visit(11, shoes(53.0)))
    assert found.sentence == "Since 3 September: knee +13°."
    assert found.second.startswith("Likely between ")
    assert (found.brief, found.arrow) == ("knee +13° since 3 Sep", Arrow(is_up=True, is_filled=True))


def test_a_change_since_the_first_visit_is_stated_where_the_last_changed_little() -> None:
    found = words(visit(7, shoes(35.0, 0.7)), visit(9, shoes(50.0, 1.08)), visit(11, shoes(53.0, 1.13)))
    assert found.sentence == f"Since 3 July: knee +18°, speed +0.43{NB}m/s."
    assert found.second == "Both beyond measurement error. Since 3 September: knee +3°, within measurement error."


def test_a_change_within_its_error_is_no_statement_but_has_its_interval() -> None:
    found = words(visit(7, shoes(50.0)), visit(11, shoes(52.0)))
    assert found.sentence == "Since 3 July: knee +2°, within measurement error."
    assert found.second.startswith(f"Anything from {MINUS}5° to +9° fits. Left knee flexes 52° ")
    assert "Both" not in found.second
    assert found.arrow == Arrow(is_up=True, is_filled=False)


def test_a_change_between_one_error_and_what_page_one_asks_for_names_its_error() -> None:
    found = words(visit(7, shoes(50.0)), visit(11, shoes(58.0)))
    assert found.sentence == "Since 3 July: knee +8° (error ±7.4°)."
    goal = Goal("knee_stance_to_swing_deg", GoalOf.LEFT, 70.0, EARLY)
    assert words(visit(7, shoes(50.0)), visit(11, shoes(58.0)), goals=(goal,)).sentence == "Since 3 July: knee +8°."


def test_stance_is_in_points_and_names_the_side_that_is_not_the_affected_one() -> None:
    found = words(visit(7, shoes(stance_percent=66.0)), visit(11, shoes(stance_percent=60.0)))
    assert found.sentence == f"Since 3 July: stance {MINUS}6.0{NB}points."
    assert found.brief == f"stance {MINUS}6.0 since 3 Jul"
    nobody = [shoes(stance_percent=one, affected=None) for one in (66.0, 60.0)]
    assert words(visit(7, nobody[0]), visit(11, nobody[1])).sentence.startswith("Since 3 July: left stance ")


@pytest.mark.parametrize(
    ("knee_deg", "affected", "stated", "second"),
    [
        (35.0, LEFT, "Left knee flexes 35° from stance to swing, 25° less than the right.", "95 of 100 healthy people"),
        (52.0, LEFT, "Left knee flexes 52° from stance to swing, 8° less than the right.", "Many healthy people"),
        (35.0, Side.RIGHT, "Right knee flexes 60° from stance to swing, 25° more than the left.", "95 of 100"),
        (59.0, None, "Left and right are similar: knee 59° and 60° from stance to swing.", "Walking"),
    ],
)
def test_one_visit_states_its_values(knee_deg: float, affected: Side | None, stated: str, second: str) -> None:
    found = words(visit(7, shoes(knee_deg, affected=affected)))
    assert found.sentence == stated
    assert found.second.startswith(f"Walking speed 1.00{NB}m/s.")
    assert second in found.second
    assert (found.brief, found.arrow) == ("", None)


def test_a_joint_that_is_not_reported_is_in_no_sentence() -> None:
    reported = unsure(Joint.LEFT_KNEE)
    gated = course((walked(speed_m_s=1.3, reported=reported), SHOES), reported=reported)
    found = words(visit(7, shoes(35.0)), visit(11, gated))
    assert found.sentence == f"Since 3 July: speed +0.30{NB}m/s."
    assert "knee" not in found.second
    assert words(visit(7, gated)).sentence == "Right knee flexes 60° from stance to swing."


def test_few_strides_state_values_and_no_change() -> None:
    found = words(visit(7, shoes(35.0, strides=5)), visit(11, shoes(55.0, strides=5)))
    assert found.sentence == "Knee from stance to swing: left 55°, right 60°."
    assert found.arrow is None
    assert words(visit(7, shoes(strides=2))).sentence == "No values were reported on 3 July."
    assert words(visit(7, None)) == ProgressWords("", "")


def test_goals_agreed_before_the_visit_are_in_the_second_line() -> None:
    goals = (
        Goal("speed_m_s", GoalOf.WALK, 0.9, EARLY),
        Goal("knee_stance_to_swing_deg", GoalOf.LEFT, 55.0, EARLY),
    )
    found = words(visit(7, shoes(35.0, 0.7)), visit(11, shoes(53.0, 1.13)), goals=goals)
    assert found.second == "Both beyond measurement error. Speed goal reached; knee 2° below its goal, within error."
    late = tuple(Goal(one.column, one.of, one.value, datetime.date(2026, 11, 3)) for one in goals)
    assert "goal" not in words(visit(7, shoes(35.0, 0.7)), visit(11, shoes(53.0, 1.13)), goals=late).second


def test_days_of_several_years_have_them() -> None:
    found = words(visit(7, shoes(35.0), 2025), visit(1, shoes(53.0)))
    assert found.sentence.startswith("Since 3 July 2025: ")
    assert found.brief == "knee +18° since 3 Jul 2025"

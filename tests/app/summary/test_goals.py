"""How walks stand to goals: each sentence has a walk for which it must come, and one for which it must not.

Errors by hand: strides alike but for 0.25 deg. A knee of 50 deg has a sigma of hypot(1.2, 2.15) = 2.46 deg, and the
error of a difference is 1.96 sqrt(2) 2.46 = 6.8 deg and a little; speed's is 1.96 sqrt(2) 0.065 = 0.18 m/s.
"""

import csv
import datetime
import json
import math
from dataclasses import replace
from pathlib import Path

import pytest
from syrupy.assertion import SnapshotAssertion

from app.exports.fhir_bundle import bundle
from app.exports.goals_csv import GOALS, HEADER, goal_figures, goal_rows
from app.exports.result_folder import write_results
from app.summary.agreed import agreed_with
from app.summary.conditions import Part
from app.summary.course import Course, CourseCondition
from app.summary.goals import (
    GoalFigure,
    goal_mark,
    goal_sentence,
    in_course,
    measured,
    of_part,
    reached_at,
    value_in_words,
)
from app.wording.measures import goal_in_words, required, spoken_value
from core.body import Joint, Side
from core.goals import NO_GOALS, Goal, GoalOf, agreed_by
from core.results import RecordingAnalysis
from core.session import Patient, Session
from core.timed.protocols import TimedProtocol
from core.verdicts.goals import GoalStanding
from core.verdicts.model import Verdict
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk
from tests.app.course_material import analysis, course, recordings, timed, unsure, walked
from tests.core.verdicts.built_walk import judged_walk
from tests.simulated import analysis_of, session_of

KNEE, SPEED, STANCE = "knee_stance_to_swing_deg", "speed_m_s", "stance_percent"
DAY = datetime.date(2026, 9, 30)
NEXT = datetime.date(2026, 10, 28)


def knee(value: float, of: GoalOf = GoalOf.LEFT) -> Goal:
    return Goal(KNEE, of, value, DAY, "H. Keller")


def part(walk: RecordingAnalysis, *goals: Goal, day: datetime.date = NEXT) -> Part:
    found = analysis(walk)
    return Part("A", walk.name, (walk,), found.calibrated_for(walk), agreed=agreed_by(goals, day))


def only(found: Course) -> CourseCondition:
    (condition,) = found.conditions
    return condition


@pytest.mark.parametrize(
    ("goal", "standing"),
    [
        (60.0, GoalStanding.SHORT),
        (55.0, GoalStanding.SHORT_INSIDE),
        (50.0, GoalStanding.REACHED_INSIDE),
        (45.0, GoalStanding.REACHED_INSIDE),
        (40.0, GoalStanding.REACHED),
    ],
)
def test_a_knee_of_50_degrees_is_to_its_goal_as_the_error_between_visits_allows(
    goal: float, standing: GoalStanding
) -> None:
    walk = walked(knee_deg=50.0)
    found = measured(knee(goal), part(walk))
    assert found.standing is standing
    assert found.error == pytest.approx(6.9, abs=0.1)
    kept = in_course(knee(goal), only(course((walk, "shoes"))))
    assert (kept.standing, kept.value) == (standing, found.value)


def test_a_goal_of_the_walk_and_one_between_the_legs() -> None:
    walk = walked(speed_m_s=1.0, stance_percent=63.0)
    speed = measured(Goal(SPEED, GoalOf.WALK, 0.7, DAY), part(walk))
    assert (speed.standing, round(speed.value, 3)) == (GoalStanding.REACHED, 1.0)
    apart = Goal(STANCE, GoalOf.BETWEEN, 0.2, DAY, is_at_most=True)
    walk = walked(speed_m_s=1.0, stance_percent=64.0)
    found = measured(apart, part(walk))
    assert (found.standing, round(found.value, 1)) == (GoalStanding.SHORT, 4.0)
    assert found.error == pytest.approx(3.05, abs=0.1)  # 1.96 sqrt(2) 1.1
    inside = measured(replace(apart, value=2.0), part(walk))
    assert inside.standing is GoalStanding.SHORT_INSIDE
    kept = in_course(apart, only(course((walk, "shoes"))))
    assert kept.standing is found.standing
    assert kept.value == pytest.approx(found.value)


def test_a_gated_figure_is_in_no_goal_statement() -> None:
    reported = unsure(Joint.LEFT_KNEE)
    walk = walked(knee_deg=70.0, reported=reported)
    found = measured(knee(50.0), replace(part(walk), calibrated=reported))
    assert (found.standing, found.verdict) == (GoalStanding.UNKNOWN, Verdict.NOT_REPORTED)
    assert math.isnan(found.value)
    assert goal_sentence(found) == ""
    kept = course((walk, "shoes"), reported=reported)
    assert in_course(knee(50.0), only(kept)).standing is GoalStanding.UNKNOWN
    apart = Goal(KNEE, GoalOf.BETWEEN, 5.0, DAY, is_at_most=True)
    assert in_course(apart, only(kept)).standing is GoalStanding.UNKNOWN
    assert measured(apart, part(walk)).standing is GoalStanding.UNKNOWN
    assert reached_at([knee(50.0)], kept) == ()
    assert reached_at([knee(50.0)], course((walked(knee_deg=70.0), "shoes"))) != ()


@pytest.mark.parametrize("is_biased", [True, False])
def test_stance_that_ends_with_a_biased_toe_off_is_held_against_no_goal(is_biased: bool) -> None:
    """And what needs no toe-off is."""
    walk = walked(stance_percent=70.0)
    left = replace(walk.gait[Side.LEFT], is_toe_off_biased=is_biased)
    walk = judged_walk(replace(walk, gait={**walk.gait, Side.LEFT: left}))
    stance = Goal(STANCE, GoalOf.LEFT, 55.0, DAY)
    apart = Goal(STANCE, GoalOf.BETWEEN, 2.0, DAY, is_at_most=True)
    kept = only(course((walk, "shoes")))
    for found in (measured(stance, part(walk)), in_course(stance, kept)):
        assert (found.standing is GoalStanding.NOT_JUDGED) is is_biased
    assert (measured(apart, part(walk)).standing is GoalStanding.UNKNOWN) is is_biased
    assert measured(knee(40.0), part(walk)).standing is GoalStanding.REACHED


def test_few_strides_have_a_value_and_no_statement() -> None:
    found = measured(knee(40.0), part(walked(knee_deg=60.0, strides=6)))
    assert (found.standing, goal_sentence(found)) == (GoalStanding.NOT_JUDGED, "")
    assert found.value == pytest.approx(60.0, abs=0.3)


def test_what_is_reached_in_every_condition_is_stated_once_and_the_surest_first() -> None:
    goals = [knee(45.0), Goal(SPEED, GoalOf.WALK, 0.7, DAY), knee(75.0, GoalOf.RIGHT)]
    found = reached_at(goals, course((walked(knee_deg=60.0), "shoes"), (walked("walk 2", knee_deg=46.0), "stick")))
    assert [one.goal for one in found] == [goals[1], goals[0]]
    assert round(found[1].value) == 46  # as where it is reached by least
    assert found[1].standing is GoalStanding.REACHED_INSIDE
    with_stick_alone = course((walked(knee_deg=40.0), "shoes"), (walked("walk 2", knee_deg=60.0), "stick"))
    assert [one.goal for one in reached_at(goals, with_stick_alone)] == [goals[1]]
    assert reached_at(goals, course((walked(knee_deg=30.0, speed_m_s=0.4), "shoes"))) == ()


def test_a_sentence_states_goal_value_error_standing_and_how_often_it_is_so(snapshot: SnapshotAssertion) -> None:
    """An error of 9.2° is of two means, so that one has an SD of 3.3°: 1° is 0.30 of it, which 62 of 100 are below."""
    assert {
        f"at least 50°, measured {value}°": goal_sentence(GoalFigure(knee(50.0), value, 9.2, Verdict.READ))
        for value in (40.0, 49.0, 51.0, 60.0)
    } == snapshot


def test_goals_are_called_by_whose_they_are_and_by_their_limit(snapshot: SnapshotAssertion) -> None:
    goals = {
        "between the legs": Goal(STANCE, GoalOf.BETWEEN, 2.5, DAY, is_at_most=True),
        "of a leg, at most": Goal(STANCE, GoalOf.RIGHT, 62.0, DAY, is_at_most=True),
        "of the walk": Goal(SPEED, GoalOf.WALK, 1.2, DAY),
        "of a leg": knee(55.0),
    }
    assert {
        case: {"mark": goal_mark(goal), "required": required(goal), "in words": goal_in_words(goal)}
        for case, goal in goals.items()
    } == snapshot
    assert spoken_value("cadence_steps_min", "104") == "104 steps per minute"


def rows(walk: RecordingAnalysis, *goals: Goal, day: datetime.date = NEXT) -> list[dict[str, str]]:
    found = goal_rows(analysis(walk), recordings((walk, "shoes")), agreed_by(goals, day))
    return [dict(zip(HEADER, row, strict=True)) for row in found]


def test_the_table_judges_only_what_was_agreed_before_the_day() -> None:
    (row,) = rows(walked(knee_deg=60.0), knee(45.0))
    assert {name: row[name] for name in ("measure", "side", "limit", "goal", "unit", "agreed_before", "standing")} == {
        "measure": KNEE,
        "side": "left",
        "limit": "at_least",
        "goal": "45.00000",
        "unit": "deg",
        "agreed_before": "true",
        "standing": "reached",
    }
    assert float(row["value"]) == pytest.approx(60.0, abs=0.3)
    (same_day,) = rows(walked(knee_deg=60.0), knee(45.0), day=DAY)
    assert (same_day["agreed_before"], same_day["standing"]) == ("false", "not_judged")
    assert rows(walked(), knee(45.0), day=DAY - datetime.timedelta(days=1)) == []


def test_a_not_reported_value_is_an_empty_cell() -> None:
    (row,) = rows(walked(knee_deg=60.0, reported=unsure(Joint.LEFT_KNEE)), knee(45.0))
    assert (row["value"], row["error"], row["status"], row["standing"]) == ("", "", "withheld", "unknown")


@pytest.fixture(scope="module")
def agreed() -> Session:
    recordings = (Standing(), FreeMotion(), Walk(strides=13, speed_m_s=0.95))
    session = session_of(replace(DEMONSTRATION, recordings=recordings))
    goals = (knee(45.0), Goal(SPEED, GoalOf.WALK, 3.0, DAY, "H. Keller", until=NEXT, note="for the ferry"))
    patient = replace(session.patient, goals=goals)
    return replace(session, patient=patient, started="2026-11-21T10:00:00+01:00")


def test_folder_and_summary_show_the_same_and_who_agreed_stays_away(agreed: Session, tmp_path: Path) -> None:
    write_results(agreed, analysis_of(agreed), tmp_path)
    with (tmp_path / GOALS).open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    reported = json.loads((tmp_path / "summary.json").read_text())["walks"]["walk 1"]["goals"]
    assert [row["standing"] for row in table] == [one["standing"] for one in reported] == ["reached", "short"]
    assert [float(row["value"]) for row in table] == pytest.approx([one["value"] for one in reported], abs=1e-5)
    whole = (tmp_path / GOALS).read_text() + (tmp_path / "summary.json").read_text()
    assert "Keller" not in whole
    assert "ferry" not in whole
    without = replace(agreed, patient=Patient())
    (tmp_path / "without").mkdir()
    write_results(without, analysis_of(without), tmp_path / "without")
    assert not (tmp_path / "without" / GOALS).exists()
    assert "goals" not in json.loads((tmp_path / "without" / "summary.json").read_text())["walks"]["walk 1"]


def test_a_bundle_holds_what_had_been_agreed_and_does_not_say_whether_it_is_reached(agreed: Session) -> None:
    found = [one["resource"] for one in bundle(agreed, analysis_of(agreed))["entry"]]
    first, second = (one for one in found if one["resourceType"] == "Goal")
    assert first["target"][0]["detailQuantity"] == {
        "value": 45.0,
        "unit": "°",
        "system": "http://unitsofmeasure.org",
        "code": "deg",
        "comparator": ">=",
    }
    assert (first["lifecycleStatus"], first["startDate"]) == ("active", "2026-09-30")
    assert second["target"][0]["dueDate"] == NEXT.isoformat()
    assert second["note"] == [{"text": "for the ferry"}]
    assert "achievementStatus" not in first
    before = replace(agreed, started="2026-09-01T10:00:00+02:00")
    assert not any(one["resource"]["resourceType"] == "Goal" for one in bundle(before, analysis_of(before))["entry"])


def test_the_day_of_a_session_decides(agreed: Session) -> None:
    assert len(agreed_with(agreed).reported) == 2
    assert agreed_with(replace(agreed, started="")).held == ()
    assert agreed_with(replace(agreed, started="2026-09-30T23:00:00+02:00")).reported == ()
    assert of_part(part(walked())) == ()


@pytest.mark.parametrize("side", Side)
def test_a_leg_that_was_not_worn_has_no_value(side: Side) -> None:
    walk = walked()
    alone = replace(walk, gait={side: walk.gait[side]})
    other = GoalOf.RIGHT if side is Side.LEFT else GoalOf.LEFT
    assert measured(knee(50.0, other), part(alone)).verdict is Verdict.NOT_MEASURED
    assert measured(Goal(STANCE, GoalOf.BETWEEN, 2.0, DAY, is_at_most=True), part(alone)).standing is (
        GoalStanding.UNKNOWN
    )


def test_a_goal_of_a_timed_test_is_held_against_the_tests_of_the_walks_and_no_other() -> None:
    ten = Goal("ten_metres_speed_m_s", GoalOf.WALK, 1.0, DAY)
    up = Goal("up_and_go_time_s", GoalOf.WALK, 12.0, DAY, is_at_most=True)
    walk = timed(TimedProtocol.TEN_METRES, time_s=8.0)
    reported, other = measured(ten, part(walk)), measured(up, part(walk))
    assert reported.value == pytest.approx(1.25)
    assert (reported.standing, reported.verdict) == (GoalStanding.REACHED, Verdict.READ)
    assert (other.standing, other.verdict) == (GoalStanding.UNKNOWN, Verdict.NOT_MEASURED)
    assert measured(ten, part(walked())).verdict is Verdict.NOT_MEASURED
    risen = measured(up, part(timed(TimedProtocol.UP_AND_GO, time_s=9.0)))
    assert risen.value == pytest.approx(9.0)
    assert risen.standing is GoalStanding.NOT_JUDGED
    assert [goal_figures(one, NO_GOALS)["unit"] for one in (reported, risen)] == ["m/s", "s"]
    assert value_in_words(reported) == "1.25\N{NO-BREAK SPACE}m/s"
    assert goal_mark(up) == "goal \N{LESS-THAN OR EQUAL TO}12\N{NO-BREAK SPACE}s"

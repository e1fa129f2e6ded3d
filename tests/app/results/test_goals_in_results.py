"""Where a measure is shown its goal is, and only where it had been agreed by the walk's day."""

import datetime
import math
from dataclasses import replace

import pytest

from app.results.compared_table import comparison_table
from app.summary.agreed import agreed_with
from app.summary.comparison import Comparison, Contrast
from app.summary.facts import Facts
from app.summary.request import AnalysedVisit
from app.summary.tiles import tiles_of
from app.summary.visits import WalkedVisit, visits_by_condition
from app.summary.what_differs import what_differs
from app.widgets.table_cells import TextCell
from app.widgets.trend_cell import TrendCell
from core.body import Joint
from core.goals import Goal, GoalOf
from core.results import Analysis
from core.session import Session
from devices.simulation.walker import DEMONSTRATION
from tests.app.changed_analysis import recalibrated, walk_of
from tests.simulated import analysis_of, session_of

DAY = datetime.date(2026, 9, 30)
GOALS = (
    Goal("speed_m_s", GoalOf.WALK, 1.2, DAY),
    Goal("ankle_push_off_deg", GoalOf.RIGHT, 30.0, DAY),
    Goal("ankle_rocker_deg", GoalOf.LEFT, 12.0, DAY),
    Goal("stance_percent", GoalOf.BETWEEN, 2.0, DAY, is_at_most=True),
)
SPACE = "\N{NO-BREAK SPACE}"


@pytest.fixture(scope="module")
def visit() -> tuple[Session, Analysis]:
    session = session_of(DEMONSTRATION)
    return session, analysis_of(session)


def on(day: str, visit: tuple[Session, Analysis]) -> Session:
    return replace(visit[0], started=f"{day}T10:00:00+01:00", patient=replace(visit[0].patient, goals=GOALS))


def facts(day: str, visit: tuple[Session, Analysis]) -> Facts:
    return Facts(AnalysedVisit(on(day, visit), visit[1]), walk_of(visit[1]))


def test_a_tile_has_its_goal_at_its_scale_and_read_out(visit: tuple[Session, Analysis]) -> None:
    tiles = {one.column: one for one in tiles_of(facts("2026-11-21", visit))}
    speed, stance = tiles["speed_m_s"], tiles["stance_percent"]
    assert (speed.goal, speed.goals) == ("goal 1.20", (1.2,))
    assert "goal" in speed.in_words
    assert stance.goals == (2.0, -2.0)  # either leg may be the longer
    assert stance.goal.startswith("goal")
    assert not any(tiles[column].goal for column in ("cadence_steps_min", "knee_stance_to_swing_deg"))
    assert not any(one.goal or one.goals for one in tiles_of(facts("2026-09-29", visit)))


def test_a_figure_that_is_not_reported_has_its_reason_and_no_goal(visit: tuple[Session, Analysis]) -> None:
    """And nothing is stated about it; a joint that cannot be read does not touch the goal of another figure."""
    reported = facts("2026-11-21", visit)
    gated = recalibrated(visit[1], (Joint.RIGHT_ANKLE,), axis_sd_rad=None)
    found = Facts(AnalysedVisit(reported.visit.session, gated), walk_of(gated))
    values = {one.goal.column: one.value for one in found.goals}
    assert math.isnan(values["ankle_push_off_deg"])
    assert values["speed_m_s"] == pytest.approx(1.18, abs=0.01)


def test_measures_with_goals_come_first_in_what_differs(
    visit: tuple[Session, Analysis],
) -> None:
    rows = what_differs(facts("2026-11-21", visit))
    assert {row.column for row in rows[:3]} == {"ankle_push_off_deg", "ankle_rocker_deg", "stance_percent"}
    assert all(row.goals for row in rows[:3])
    assert not any(row.goals for row in rows[3:])
    assert not any(row.goals for row in what_differs(facts("2026-09-29", visit)))


def test_between_visits_the_goal_is_behind_the_name_and_is_dotted_in_the_trend(
    visit: tuple[Session, Analysis],
) -> None:
    days = ("2026-10-02", "2026-11-21")
    named = [
        WalkedVisit(day, visit[1], visit[0].recordings, datetime.date.fromisoformat(day), agreed_with(on(day, visit)))
        for day in days
    ]
    (compared,) = visits_by_condition(named)
    _, few = comparison_table(Comparison(Contrast.VISITS, compared.parts), 5, is_brief=True)
    brief = [row.cells[1].stated for row in few]
    assert any(name.startswith("Ankle dorsiflexion, stance") for name in brief)  # what a goal is of is never left out
    assert not any(name.startswith("Knee range") for name in brief)
    _, rows = comparison_table(Comparison(Contrast.VISITS, compared.parts), 5)
    marked: dict[str, tuple[float, ...]] = {}
    for row in rows:
        name = row.cells[1]
        assert isinstance(name, TextCell)
        trend = next(cell for cell in row.cells if isinstance(cell, TrendCell))
        if name.small:
            marked[f"{name.text} {name.small}"] = trend.goals
            assert trend.edges[0] <= trend.goals[0] <= trend.edges[1]
        else:
            assert trend.goals == ()
    assert marked == {
        f"Walking speed, m/s goal 1.20{SPACE}m/s": (1.2,),
        "Ankle plantarflexion, push-off goal R 30°": (30.0,),
        "Ankle dorsiflexion, stance goal L 12°": (12.0,),
    }

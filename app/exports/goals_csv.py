"""What had been agreed by the day of each walk, and how the walk compares: `goals.csv`, and in `summary.json`.

Who agreed on a goal and what was typed about it is in the library and in an identified export alone.
"""

from collections.abc import Iterator, Sequence

from app.summary.conditions import Part
from app.summary.goals import GoalFigure, of_part
from app.system.tables import finite, typed_cell
from core.goals import AgreedGoals
from core.parameters import unit_of
from core.results import Analysis, RecordingAnalysis
from core.session import Recording, RecordingKind
from core.verdicts.goals import GoalStanding

GOALS = "goals.csv"
HEADER = (
    *("recording", "condition", "measure", "side", "limit", "goal", "unit", "agreed", "until"),
    *("agreed_before", "value", "error", "status", "standing"),
)


def goal_rows(analysis: Analysis, recordings: Sequence[Recording], agreed: AgreedGoals) -> Iterator[tuple[str, ...]]:
    """Give a row for each goal of each walk."""
    conditions = {one.name: one.condition for one in recordings}
    for walk in analysis.recordings:
        if walk.kind is RecordingKind.WALKING and walk.gait:
            for one in goals_of_walk(analysis, walk, agreed):
                reported = goal_figures(one, agreed)
                cells = (_cell(reported[name]) for name in HEADER[2:])
                yield typed_cell(walk.folder), typed_cell(conditions.get(walk.name, "")), *cells


def goals_of_walk(analysis: Analysis, walk: RecordingAnalysis, agreed: AgreedGoals) -> tuple[GoalFigure, ...]:
    """How one walk compares with what had been agreed by its day."""
    return of_part(Part("", walk.name, (walk,), analysis.calibrated_for(walk), agreed=agreed))


def goal_figures(found: GoalFigure, agreed: AgreedGoals) -> dict[str, str | float | bool | None]:
    """Give a goal and its measured figure by table column; one agreed too late has standing NOT_JUDGED."""
    goal, is_before = found.goal, found.goal in agreed.reported
    return {
        "measure": goal.column,
        "side": str(goal.of),
        "limit": "at_most" if goal.is_at_most else "at_least",
        "goal": goal.value,
        "unit": unit.in_files if (unit := unit_of(goal.column)) is not None else "",
        "agreed": goal.agreed.isoformat(),
        "until": goal.until.isoformat() if goal.until is not None else None,
        "agreed_before": is_before,
        "value": finite(found.value),
        "error": finite(found.error),
        "status": str(found.verdict),
        "standing": str(found.standing if is_before else GoalStanding.NOT_JUDGED),
    }


def _cell(value: str | float | bool | None) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.5f}"
    return value or ""

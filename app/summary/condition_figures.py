"""The key figures of each condition of a session: those of report, screen and course, for files that leave."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from app.summary.comparison import compare_legs, first_and_second
from app.summary.conditions import Part, conditions_of
from app.summary.differences import likely_figures
from app.summary.measures import MEASURES
from app.system.tables import finite
from core.body import Side
from core.gait.spatiotemporal import MeanAndSd
from core.goals import NO_GOALS, AgreedGoals
from core.parameters import BETWEEN_LEGS
from core.results import Analysis
from core.session import Recording
from core.verdicts.measurement_error import whisker
from core.verdicts.model import Verdict
from core.verdicts.sigmas import ComparisonKind


@dataclass(frozen=True, slots=True)
class ConditionFigure:
    """One mean over the strides of a condition; `side` None: of the walk. NaN where it is not reported or not known.

    `error` is half of what the difference of two visits has to exceed.
    """

    column: str
    side: Side | None
    found: MeanAndSd
    error: float
    verdict: Verdict


def condition_figures(part: Part) -> Iterator[ConditionFigure]:
    """Every measure that is compared, of each leg or of the walk, as far as it was measured."""
    for measure in MEASURES:
        column = measure.column
        for side in part.sides:
            if measure.is_of_walk and side is not part.sides[0]:
                continue
            found, verdict = part.figure(measure, side)
            if verdict is Verdict.NOT_MEASURED:
                continue
            kind = ComparisonKind.VISITS
            mean = part.of_walk(column, kind) if measure.is_of_walk else part.mean(side, column, kind)
            of = None if measure.is_of_walk else side
            yield ConditionFigure(column, of, found, whisker(column, kind, mean, part.speed_m_s), verdict)


def summarise_conditions(
    analysis: Analysis, recordings: Sequence[Recording], agreed: AgreedGoals = NO_GOALS
) -> list[dict[str, Any]]:
    """Give what `summary.json` has of each condition: its walks, and the figures of each leg and of both."""
    reported = []
    for part in conditions_of(analysis, recordings, agreed=agreed):
        sides: dict[str, dict[str, Any]] = {str(side): {"strides_used": part.strides(side)} for side in part.sides}
        sides["both"] = {}
        for one in condition_figures(part):
            sides["both" if one.side is None else str(one.side)] |= {
                f"{one.column}_mean": finite(one.found.mean),
                f"{one.column}_sd": finite(one.found.sd),
                f"{one.column}_error": finite(one.error),
                f"{one.column}_status": str(one.verdict),
            }
        sides["both"] |= {"legs": _legs(part, analysis)} if len(part.sides) == len(Side) else {}
        walks = [walk.name for walk in part.walks]
        reported.append({"letter": part.letter, "condition": part.name, "walks": walks, **sides})
    return reported


def _legs(part: Part, analysis: Analysis) -> dict[str, Any]:
    """By how much the legs differ in each measure that is compared between them, the affected or left one first."""
    sides = first_and_second(analysis.affected_side)
    found = {column: compare_legs(part, column, sides) for column in BETWEEN_LEGS}
    return {
        column: {
            "difference": finite(one.difference),
            **{key: finite(value) for key, value in likely_figures(one).items()},
            "mark": str(one.mark),
        }
        for column, one in found.items()
        if one.is_reported
    }

"""What was measured beside the goals agreed with a patient, and how each value compares with its goal."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from app.summary.comparison import compare_legs
from app.summary.conditions import Part
from app.summary.course import Course, CourseCondition, CourseTest, timed_test_of
from app.summary.numbers_in_words import fixed
from app.wording.measures import decimals, goal_in_words, limit, short_unit
from app.wording.translation import tr, tr_n
from core.body import Side
from core.goals import Goal, GoalOf
from core.parameters import QuantityKind
from core.timed.measures import PROTOCOLS
from core.verdicts.attempts import error_between_visits
from core.verdicts.goals import GoalStanding, beyond, error_of_visit, share_at_goal, standing
from core.verdicts.measurement_error import Difference
from core.verdicts.model import Assessment, Verdict
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN
from core.verdicts.sigmas import KINDS, ComparisonKind
from core.verdicts.stride_means import MeanOfStrides


@dataclass(frozen=True, slots=True)
class GoalFigure:
    """A goal and what was measured of it. Where not reported, `value` and `error` are NaN and nothing is stated."""

    goal: Goal
    value: float
    error: float
    verdict: Verdict

    @property
    def standing(self) -> GoalStanding:
        return standing(self.goal, self.value, self.error)


def measured(goal: Goal, part: Part) -> GoalFigure:
    """What the walks of a part say of a goal."""
    if goal.of is GoalOf.BETWEEN:
        has_both = all(part.is_measured(side, goal.column) for side in Side)
        between = compare_legs(part, goal.column, (Side.LEFT, Side.RIGHT)) if has_both else None
        stated = [part.assessment(side, goal.column).verdict for side in Side] if has_both else [Verdict.NOT_MEASURED]
        return _between(goal, between, Verdict.CARE if Verdict.CARE in stated else stated[0])
    if goal.column in PROTOCOLS:
        return _of_test(goal, timed_test_of(goal.column, part.walks))
    if goal.of is GoalOf.WALK:
        if not part.sides:
            return _nothing(goal, Verdict.NOT_MEASURED)
        found = part.of_walk(goal.column, ComparisonKind.VISITS)
        return _figure(goal, found, part.assessment_of_walk(goal.column), part.speed_m_s)
    side = goal.of.side
    assert side is not None  # the other two are handled above
    if not part.is_measured(side, goal.column):
        return _nothing(goal, Verdict.NOT_MEASURED)
    found = part.mean(side, goal.column, ComparisonKind.VISITS)
    return _figure(goal, found, part.assessment(side, goal.column), part.speed_m_s)


def in_course(goal: Goal, walked: CourseCondition) -> GoalFigure:
    """The goal's figure, from what is kept of a visit's condition."""
    if goal.of is GoalOf.BETWEEN:
        between = walked.between_legs(goal.column)
        return _between(goal, between, Verdict.READ)
    if goal.column in PROTOCOLS:
        return _of_test(goal, walked.test(goal.column))
    figure = walked.figure(goal.column, goal.of.side)
    return (
        _figure(goal, figure.found, figure.assessment, walked.speed_m_s)
        if figure
        else _nothing(goal, Verdict.NOT_MEASURED)
    )


def reached_at(goals: Sequence[Goal], course: Course) -> tuple[GoalFigure, ...]:
    """Give goals reached in every condition that has their figures, with the least favourable value, surest first."""
    found = []
    for goal in goals:
        is_of_test = goal.column in PROTOCOLS
        own = [one for one in course.conditions if (one.test(goal.column) if is_of_test else one.figures)]
        figures = [in_course(goal, walked) for walked in own]
        if figures and all(one.standing.is_reached for one in figures):
            found.append(min(figures, key=lambda one: beyond(goal, one.value) - one.error))
    return tuple(sorted(found, key=lambda one: one.standing is not GoalStanding.REACHED))


def _between(goal: Goal, found: Difference | None, verdict: Verdict) -> GoalFigure:
    if found is None or not found.is_reported:
        return _nothing(goal, Verdict.NOT_MEASURED if found is None else Verdict.NOT_REPORTED)
    return GoalFigure(goal, found.difference, found.error, verdict)


def _figure(goal: Goal, found: MeanOfStrides, assessment: Assessment, speed_m_s: float) -> GoalFigure:
    if not (assessment.is_reported and found.n >= MIN_STRIDES_FOR_MEAN and math.isfinite(found.mean)):
        return _nothing(goal, assessment.verdict)
    is_biased = (
        KINDS.get(goal.column) is QuantityKind.STANCE and assessment.is_toe_off_biased
    )  # by how much, nobody knows
    error = math.nan if is_biased else error_of_visit(goal.column, found, speed_m_s)
    return GoalFigure(goal, found.mean, error, assessment.verdict)


def _of_test(goal: Goal, test: CourseTest | None) -> GoalFigure:
    if test is None or not test.is_reported:
        return _nothing(goal, Verdict.NOT_MEASURED if test is None else test.verdict)
    return GoalFigure(goal, test.found.mean, error_between_visits(goal.column), test.verdict)


def _nothing(goal: Goal, verdict: Verdict) -> GoalFigure:
    return GoalFigure(goal, math.nan, math.nan, verdict)


def of_part(part: Part) -> tuple[GoalFigure, ...]:
    """What had been agreed by the day of a part's walks, and how these stand to it."""
    return tuple(measured(goal, part) for goal in part.agreed.held)


# in words


def value_in_words(found: GoalFigure) -> str:
    """The value with its unit, with as many decimals as the goal has or one more."""
    places = _places(found.goal.column)
    size = abs(found.value) if found.goal.of is GoalOf.BETWEEN else found.value
    return fixed(size, places) + short_unit(found.goal.column)


def standing_in_words(found: GoalFigure) -> str:
    """How a value compares with its goal, after the goal was named."""
    error = fixed(found.error, _places(found.goal.column)) + short_unit(found.goal.column)
    stated = {
        GoalStanding.SHORT: tr("not reached; the difference is beyond measurement error (±{error})"),
        GoalStanding.SHORT_INSIDE: tr("not reached; the difference is within measurement error (±{error})"),
        GoalStanding.REACHED_INSIDE: tr("reached; the difference is within measurement error (±{error})"),
        GoalStanding.REACHED: tr("reached; the difference is beyond measurement error (±{error})"),
        GoalStanding.NOT_JUDGED: tr("not judged: measurement error not known"),
        GoalStanding.UNKNOWN: tr("no value reported"),
    }
    return stated[found.standing].format(error=error)


def beyond_in_words(found: GoalStanding) -> str:
    """Of a goal that is reached, whether that is more than the error."""
    return tr("beyond error") if found is GoalStanding.REACHED else tr("within measurement error, so not certain")


def goal_sentence(found: GoalFigure) -> str:
    """A goal that was agreed before, what was measured, and how they compare; nothing where no value is judged."""
    if found.standing in (GoalStanding.UNKNOWN, GoalStanding.NOT_JUDGED):
        return ""
    stated = tr("Goal: {goal}; measured {value}, {standing}.")
    sentence = stated.format(
        goal=goal_in_words(found.goal), value=value_in_words(found), standing=standing_in_words(found)
    )
    return f"{sentence} {often_at_goal(found)}"


def often_at_goal(found: GoalFigure) -> str:
    """In how many of 10 such measurements the true value is at the goal or beyond it."""
    tenths = round(10 * share_at_goal(found.goal, found.value, found.error))
    if tenths in (0, 10):
        often = tr("Fewer than 1 of 10 such measurements are at the goal.")
        return tr("More than 9 of 10 such measurements are at the goal.") if tenths else often
    return tr_n(
        "{count} of 10 such measurements is at the goal.", "{count} of 10 such measurements are at the goal.", tenths
    ).format(count=tenths)


def goal_mark(goal: Goal) -> str:
    """A goal in a narrow place: "goal L 60°", "goal ±2 %"."""
    letter = goal.of.side.letter if goal.of.side is not None else ""
    sign = (
        "\N{PLUS-MINUS SIGN}" if goal.of is GoalOf.BETWEEN else "\N{LESS-THAN OR EQUAL TO}" if goal.is_at_most else ""
    )
    return " ".join(filter(None, [tr("goal"), letter, sign + limit(goal)]))


def _places(column: str) -> int:
    """Decimals, one more than a goal usually has."""
    if column in PROTOCOLS:
        return decimals(column)
    return 2 if column.endswith(("_m", "_m_s")) else 1

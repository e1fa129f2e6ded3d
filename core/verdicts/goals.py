"""How a value compares with its goal, and whether by more than its error: a goal is a number and has none itself.

The error is that of a difference from a mean as sure: between visits for a figure of one leg or of the walk, between
the legs for what they differ by. It is shown beside each value that is reported, so that who reads both can follow;
for a goal, which is without error itself, it is more than is needed, by up to the root of two.
"""

import math
from enum import StrEnum
from statistics import NormalDist

from core.goals import Goal, GoalOf
from core.verdicts.measurement_error import Z95, whisker
from core.verdicts.sigmas import ComparisonKind
from core.verdicts.stride_means import MeanOfStrides


class GoalStanding(StrEnum):
    """How a value compares with a goal; the words of goals.csv.

    SHORT: short of it by more than the error. SHORT_INSIDE and REACHED_INSIDE: short of it, or at it and beyond, and
    inside the error, so that the value is not distinguished from the goal. REACHED: at it or beyond it by more than
    the error. NOT_JUDGED: the value is reported and its error is not. UNKNOWN: there is no value that may be reported.
    """

    SHORT = "short"
    SHORT_INSIDE = "short_inside_error"
    REACHED_INSIDE = "reached_inside_error"
    REACHED = "reached"
    NOT_JUDGED = "not_judged"
    UNKNOWN = "unknown"

    @property
    def is_reached(self) -> bool:
        """Whether the value is at the goal or beyond it, judged against an error."""
        return self in (GoalStanding.REACHED, GoalStanding.REACHED_INSIDE)


def beyond(goal: Goal, value: float) -> float:
    """Give how far a value is beyond its goal, negative if short; between legs the difference's size counts."""
    measured = abs(value) if goal.of is GoalOf.BETWEEN else value
    return goal.value - measured if goal.is_at_most else measured - goal.value


def standing(goal: Goal, value: float, error: float) -> GoalStanding:
    """Compare a value with its goal; NaN value: none may be reported, NaN error: not known."""
    if not math.isfinite(value):
        return GoalStanding.UNKNOWN
    if not (math.isfinite(error) and error > 0):
        return GoalStanding.NOT_JUDGED
    more = beyond(goal, value)
    if abs(more) > error:
        return GoalStanding.REACHED if more > 0 else GoalStanding.SHORT
    return GoalStanding.REACHED_INSIDE if more >= 0 else GoalStanding.SHORT_INSIDE


def share_at_goal(goal: Goal, value: float, error: float) -> float:
    """Give the share (0 to 1) at or beyond the goal, flat prior; the value's SD is `error` / (1.96 sqrt(2))."""
    if not (math.isfinite(value) and error > 0):
        return math.nan
    return NormalDist().cdf(
        beyond(goal, value) / (error / (Z95 * (1.0 if goal.of is GoalOf.BETWEEN else math.sqrt(2))))
    )


def error_of_visit(column: str, found: MeanOfStrides, speed_m_s: float = math.nan) -> float:
    """Give what a change between visits has to exceed, from a mean as sure as this one; NaN if not known."""
    return 2.0 * whisker(column, ComparisonKind.VISITS, found, speed_m_s)

"""Tests of whether a goal was reached. Each answer has a value for which it must come and one for which it must not.

Errors are worked out by hand: a mean of strides that are all alike has none but the table's.
"""

import datetime
import math

import numpy as np
import pytest

from core.goals import Goal, GoalOf
from core.verdicts.goals import GoalStanding, beyond, error_of_visit, share_at_goal, standing
from core.verdicts.stride_means import mean_of_strides

KNEE, SPEED, STANCE = "knee_stance_to_swing_deg", "speed_m_s", "stance_percent"
DAY = datetime.date(2026, 9, 30)
AT_LEAST = Goal(KNEE, GoalOf.LEFT, 60.0, DAY)
AT_MOST = Goal(STANCE, GoalOf.RIGHT, 65.0, DAY, is_at_most=True)
APART = Goal(STANCE, GoalOf.BETWEEN, 2.0, DAY, is_at_most=True)


@pytest.mark.parametrize(
    ("goal", "value", "error", "required"),
    [
        (AT_LEAST, 50.7, 9.2, GoalStanding.SHORT),
        (AT_LEAST, 50.9, 9.2, GoalStanding.SHORT_INSIDE),
        (AT_LEAST, 59.9, 9.2, GoalStanding.SHORT_INSIDE),
        (AT_LEAST, 60.0, 9.2, GoalStanding.REACHED_INSIDE),
        (AT_LEAST, 69.1, 9.2, GoalStanding.REACHED_INSIDE),
        (AT_LEAST, 69.3, 9.2, GoalStanding.REACHED),
        (AT_MOST, 71.1, 6.0, GoalStanding.SHORT),
        (AT_MOST, 70.9, 6.0, GoalStanding.SHORT_INSIDE),
        (AT_MOST, 65.0, 6.0, GoalStanding.REACHED_INSIDE),
        (AT_MOST, 58.9, 6.0, GoalStanding.REACHED),
        (APART, -4.6, 2.5, GoalStanding.SHORT),
        (APART, 4.6, 2.5, GoalStanding.SHORT),
        (APART, -4.4, 2.5, GoalStanding.SHORT_INSIDE),
        (APART, -1.9, 2.5, GoalStanding.REACHED_INSIDE),
        (APART, 1.9, 2.5, GoalStanding.REACHED_INSIDE),
        (APART, 0.0, 1.5, GoalStanding.REACHED),
        (AT_LEAST, 80.0, math.nan, GoalStanding.NOT_JUDGED),
        (AT_LEAST, 80.0, 0.0, GoalStanding.NOT_JUDGED),
        (AT_LEAST, math.nan, 9.2, GoalStanding.UNKNOWN),
    ],
)
def test_a_value_is_to_its_goal_as_its_error_allows(
    goal: Goal, value: float, error: float, required: GoalStanding
) -> None:
    assert standing(goal, value, error) is required


def test_reached_is_stated_of_a_judged_value_at_the_goal_or_beyond_and_of_no_other() -> None:
    stated = {one for one in GoalStanding if one.is_reached}
    assert stated == {GoalStanding.REACHED, GoalStanding.REACHED_INSIDE}


def test_beyond_counts_towards_the_goal() -> None:
    assert beyond(AT_LEAST, 62.0) == 2.0
    assert beyond(AT_MOST, 62.0) == 3.0
    assert beyond(APART, -5.0) == -3.0


def test_the_error_of_a_visit_is_that_of_a_change_between_visits() -> None:
    """7.8871 of a knee of 60 deg; of speed 0.1802; of stance 1.96 x sqrt 2 x 1.1. Nine strides are too few for any."""
    for column, value, error in ((KNEE, 60.0, 7.8871), (SPEED, 1.2, 0.1802), (STANCE, 60.0, 3.0490)):
        assert error_of_visit(column, mean_of_strides(np.full(12, value))) == pytest.approx(error, abs=1e-4)
    assert math.isnan(error_of_visit(KNEE, mean_of_strides(np.full(9, 60.0))))
    assert math.isnan(error_of_visit("knee_swing_peak_percent", mean_of_strides(np.full(12, 60.0))))


@pytest.mark.parametrize(
    ("goal", "value", "error", "share"),
    [
        (AT_LEAST, 60.0, 7.8871, 0.5),
        # 4 deg beyond, one SD 7.8871 / 2.77186 = 2.84542: Phi(1.40577) = 0.92010
        (AT_LEAST, 64.0, 7.8871, 0.92010),
        (AT_LEAST, 56.0, 7.8871, 0.07990),
        (AT_LEAST, 56.0, math.nan, math.nan),
        (AT_LEAST, math.nan, 7.8871, math.nan),
    ],
)
def test_a_goal_is_answered_in_how_many_measurements_the_true_value_is_there(
    goal: Goal, value: float, error: float, share: float
) -> None:
    assert share_at_goal(goal, value, error) == pytest.approx(share, abs=1e-4, nan_ok=True)

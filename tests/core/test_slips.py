"""Tests of finding a slipped strap, from turns written by hand.

Whole walks are in `test_strap.py`, which takes minutes.
"""

import numpy as np
import pytest

from core.body import Joint, Side, Site, ankle_of, knee_of
from core.calibration.strap import Slip, Turns, slips

WINDOWS, WINDOW_S, JUMP = 10, 5.0, 6  # the sensor turns at the beginning of the seventh window
WALKING_DEG = (0.6, -0.4, 0.9, -0.8, 0.3, -0.6, 0.8, -0.2, 0.5, -0.7)  # what walking alone turns


def turns(jump_deg: float) -> Turns:
    """A joint's turn since the calibration, window by window: steady, and by `jump_deg` more from the jump on."""
    reported_deg = np.array(WALKING_DEG)
    reported_deg[JUMP:] += jump_deg
    return Turns(WINDOW_S * np.arange(WINDOWS), np.deg2rad(reported_deg))


def found(side: Side, knee_deg: float, ankle_deg: float) -> list[Slip]:
    return slips({knee_of(side): turns(knee_deg), ankle_of(side): turns(ankle_deg)})


@pytest.mark.parametrize("side", Side)
@pytest.mark.parametrize(
    ("knee_deg", "ankle_deg", "segment"), [(-15.0, 0.0, "thigh"), (15.0, -15.0, "shank"), (0.0, 15.0, "foot")]
)
def test_a_strap_that_slipped_is_named_with_its_time_and_turn(
    side: Side, knee_deg: float, ankle_deg: float, segment: str
) -> None:
    (slip,) = found(side, knee_deg, ankle_deg)
    assert slip.site is Site(f"{side}_{segment}")
    assert slip.from_s == WINDOW_S * JUMP
    assert np.rad2deg(slip.turn_rad) == pytest.approx(15.0, abs=1.5)


def test_steady_walking_and_a_turn_of_three_degrees_are_no_slip() -> None:
    assert found(Side.LEFT, 0.0, 0.0) == []
    assert found(Side.LEFT, 3.0, -3.0) == []


def test_one_window_that_leaves_the_others_is_a_turn_and_no_slip() -> None:
    turning = turns(0.0)
    turning.turn_rad[JUMP] += np.deg2rad(25.0)
    assert slips({Joint.LEFT_KNEE: turning}) == []


def test_a_slip_of_one_leg_states_nothing_of_the_other() -> None:
    both = {Joint.LEFT_KNEE: turns(0.0), Joint.RIGHT_KNEE: turns(20.0)}
    assert [slip.site for slip in slips(both)] == [Site.RIGHT_THIGH]


def test_what_was_turned_from_the_beginning_slipped_before_the_walk() -> None:
    first = Turns(np.array([0.0, 5.0, 10.0]), np.deg2rad([20.0, 21.0, 19.0]))
    (slip,) = slips({Joint.RIGHT_KNEE: first})
    assert (slip.site, slip.from_s) == (Site.RIGHT_THIGH, 0.0)
    assert slips({Joint.RIGHT_KNEE: first}, np.inf) == []  # where the axes are not to be trusted so far


def test_too_little_walking_shows_nothing() -> None:
    assert slips({Joint.LEFT_KNEE: Turns(np.array([0.0]), np.deg2rad([40.0]))}) == []

"""While no sensor is received, time goes on on the screen, and nothing is made up."""

import math

import numpy as np

from app.wizard.walking.readout import LiveLane, LiveTrace, PhaseSpan, WalkingReadout
from core.body import Joint, Side, Site
from core.gait.phases import Phase

SEEN = WalkingReadout(
    now_s=12.0,
    joints={Joint.LEFT_KNEE: LiveTrace(np.array([11.9, 12.0]), np.array([0.1, 0.2]))},
    lanes={
        Side.LEFT: LiveLane((PhaseSpan(Phase.LOADING, 11.0, 11.4), PhaseSpan(Phase.FOOT_FLAT, 11.4, None))),
        Side.RIGHT: LiveLane((), ((9.0, None),)),
    },
    strides={Side.LEFT: 7},
    cadence_steps_min=104.0,
)
SITES = (Site.LEFT_FOOT, Site.LEFT_SHANK)


def test_time_goes_on_and_what_lasted_ends_when_it_was_last_received() -> None:
    shown = SEEN.while_silent(14.5, SITES)
    assert shown.now_s == 14.5
    assert shown.lanes[Side.LEFT].spans[-1] == PhaseSpan(Phase.FOOT_FLAT, 11.4, 12.0)
    assert shown.lanes[Side.LEFT].silent_s == ((12.0, None),)
    assert shown.lanes[Side.RIGHT].silent_s == ((9.0, None),)  # silent before, once
    assert math.isnan(shown.cadence_steps_min)
    assert set(shown.missing) == set(SITES)
    assert shown.joints is SEEN.joints
    assert shown.strides == {Side.LEFT: 7}


def test_nothing_changes_before_the_first_sample_or_without_time_passing() -> None:
    assert SEEN.while_silent(12.0, SITES) is SEEN
    nothing = WalkingReadout()
    assert nothing.while_silent(3.0, SITES) is nothing

"""Tests of when an offset between both legs' clocks may be used."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Side, Site
from core.hip.leg_clock import ThighClock, leg_clock
from core.hip.results import ClockStatus
from tests.core.hip.hip_sessions import analysed

GOOD = ThighClock(lag_s=0.01, halves_s=0.002, margin=4.0, moving_s=25.0, is_at_border=False)
LATE = replace(GOOD, lag_s=-0.03)


def test_the_offset_is_how_much_later_the_right_leg_s_stamps_are() -> None:
    found = leg_clock(GOOD, LATE, is_proven=False)
    assert (found.status, found.sd_s) == (ClockStatus.FOUND, 0.005)
    assert found.offset_s == pytest.approx(0.04)
    assert found.applied_s == pytest.approx(0.04)
    assert leg_clock(replace(GOOD, moving_s=41.0), replace(LATE, moving_s=41.0), is_proven=False).sd_s == 0.002


@pytest.mark.parametrize(
    "doubt",
    [
        replace(LATE, moving_s=19.9),
        replace(LATE, margin=1.4),
        replace(LATE, halves_s=0.009),
        replace(LATE, is_at_border=True),
    ],
    ids=["short", "another heading", "halves apart", "at the border"],
)
@pytest.mark.parametrize("side", Side)
def test_a_doubt_about_either_leg_withholds_it(doubt: ThighClock, side: Side) -> None:
    found = leg_clock(doubt, GOOD, is_proven=False) if side is Side.LEFT else leg_clock(GOOD, doubt, is_proven=False)
    assert found.status is ClockStatus.NOT_REPORTED
    assert np.isnan(found.sd_s)
    assert found.applied_s == 0.0


@pytest.mark.parametrize("offset_s", [0.009, 0.04])
def test_what_tissue_may_be_and_what_is_proven_common_is_not_moved(offset_s: float) -> None:
    late = replace(GOOD, lag_s=GOOD.lag_s - offset_s)
    proven = leg_clock(GOOD, late, is_proven=True)
    assert (proven.status, proven.applied_s) == (ClockStatus.PROVEN, 0.0)
    assert (leg_clock(GOOD, late, is_proven=False).applied_s == 0.0) == (offset_s < 0.01)


def test_clocks_that_are_reported_to_be_two_are_not_proven_by_their_stamps() -> None:
    made, _ = analysed()
    hips = (Site.PELVIS, Site.LEFT_THIGH, Site.RIGHT_THIGH)
    sensors = {
        site: replace(made.session.sensors[site], clock="right" if site.side is Side.RIGHT else "left") for site in hips
    }
    recordings = tuple(replace(one, imu={site: one.imu[site] for site in hips}) for one in made.session.recordings)
    clock = analyse(replace(made.session, sensors=sensors, recordings=recordings)).recordings[-1].leg_clock
    assert clock is not None
    assert clock.status is ClockStatus.FOUND
    assert abs(clock.offset_s) < 0.001

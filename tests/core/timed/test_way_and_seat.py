"""Turns, pauses and starts of made-up ways, rises of made-up tilts: what must be reported, and what must not."""

from dataclasses import replace

import numpy as np
import pytest

from core.body import Side, Site
from core.samples import FloatArray
from core.timed.found import Silence
from core.timed.protocols import PlannedTest, TimedProtocol
from core.timed.seat import NO_SEAT, motions_of_tilt
from core.timed.timing import timed
from core.timed.way import BodyWay, FootSteps, pauses_of, start_of, turns_of

TIME_S = np.arange(0.0, 30.0, 0.02)


def steps(contact_s: FloatArray) -> FootSteps:
    return FootSteps(contact_s - 0.4, contact_s, np.full(len(contact_s), 1.2), np.zeros(len(contact_s)))


def way_with(
    heading_rad: FloatArray, contacts_s: FloatArray | None = None, silences: tuple[Silence, ...] = ()
) -> BodyWay:
    contact_s = np.arange(1.5, 29.0, 0.6) if contacts_s is None else contacts_s
    feet = {side: steps(contact_s[k::2]) for k, side in enumerate((Side.LEFT, Side.RIGHT))}
    return BodyWay(TIME_S, 1.0 * TIME_S, heading_rad, feet, silences)


def ramp(at_s: float, lasts_s: float, angle_deg: float) -> FloatArray:
    return np.deg2rad(angle_deg) * np.clip((TIME_S - at_s) / lasts_s, 0.0, 1.0)


@pytest.mark.parametrize(("protocol", "strides"), [(TimedProtocol.STAIRS, 2), (TimedProtocol.UP_AND_GO, 0)])
def test_a_single_high_step_of_each_foot_is_on_stairs_only_in_the_test_on_stairs(
    protocol: TimedProtocol, strides: int
) -> None:
    way = way_with(np.zeros_like(TIME_S))
    feet = {
        side: replace(foot, climb_m=np.where(np.arange(len(foot.climb_m)) == 7, 0.2, 0.0))
        for side, foot in way.feet.items()
    }
    found = timed(replace(way, feet=feet), NO_SEAT, PlannedTest(protocol, 1.0, 28.0))
    assert len(found.stairs) == strides


@pytest.mark.parametrize("angle_deg", [180.0, -180.0, 90.0])
def test_a_turn_is_reported_with_its_side_and_angle(angle_deg: float) -> None:
    (turn,) = turns_of(way_with(ramp(10.0, 2.5, angle_deg)))
    assert np.rad2deg(turn.angle_rad) == pytest.approx(angle_deg, abs=1.0)
    assert turn.middle_s == pytest.approx(11.25, abs=0.1)
    assert turn.is_about == (abs(angle_deg) > 120.0)


def test_drift_and_a_gentle_bend_are_no_turns() -> None:
    assert turns_of(way_with(ramp(0.0, 30.0, 200.0))) == ()  # a treadmill's clock, or a round corridor
    assert turns_of(way_with(ramp(10.0, 1.0, 45.0))) == ()


def test_turns_to_either_side_stay_apart_and_halves_of_one_are_joined() -> None:
    apart = turns_of(way_with(ramp(8.0, 2.0, 180.0) + ramp(11.0, 2.0, -180.0)))
    assert [np.sign(turn.angle_rad) for turn in apart] == [1.0, -1.0]
    stood = way_with(ramp(8.0, 1.2, 90.0) + ramp(11.0, 1.2, 90.0))
    still = BodyWay(TIME_S, np.minimum(TIME_S, 8.0), stood.heading_rad, stood.feet, ())
    (turn,) = turns_of(still)
    assert np.rad2deg(turn.angle_rad) == pytest.approx(180.0, abs=1.0)


def test_a_second_with_both_feet_down_is_a_pause_and_less_is_none() -> None:
    straight = np.zeros_like(TIME_S)
    contacts = np.concatenate([np.arange(2.0, 10.0, 0.6), np.arange(12.0, 20.0, 0.6)])
    (pause,) = pauses_of(way_with(straight, contacts))
    assert pause == pytest.approx((contacts[13], 11.6))
    hesitating = np.concatenate([np.arange(2.0, 10.0, 0.6), np.arange(11.0, 20.0, 0.6)])
    assert pauses_of(way_with(straight, hesitating)) == ()


def test_feet_that_turn_on_the_spot_are_in_no_pause() -> None:
    contacts = np.concatenate([np.arange(2.0, 10.0, 0.6), np.arange(12.0, 20.0, 0.6)])
    way = way_with(np.zeros_like(TIME_S), contacts)
    left = replace(way.feet[Side.LEFT], turned_s=np.array([[10.4, 11.0]]), heading_rad=np.array([[0.0, 0.7]]))
    assert pauses_of(replace(way, feet={**way.feet, Side.LEFT: left})) == ()
    late = replace(left, turned_s=np.array([[11.0, 11.4]]))
    (pause,) = pauses_of(replace(way, feet={**way.feet, Side.LEFT: late}))
    assert pause == pytest.approx((contacts[13], 11.0))


def test_no_pause_is_invented_where_a_foot_was_not_received() -> None:
    contacts = np.concatenate([np.arange(2.0, 10.0, 0.6), np.arange(12.0, 20.0, 0.6)])
    silence = Silence(Site.LEFT_FOOT, 10.0, 11.5)
    assert pauses_of(way_with(np.zeros_like(TIME_S), contacts, (silence,))) == ()


def test_the_start_needs_a_still_second() -> None:
    straight = np.zeros_like(TIME_S)
    assert start_of(way_with(straight, np.arange(3.0, 20.0, 0.6))) == pytest.approx((3.0, 2.6))
    assert np.isnan(start_of(way_with(straight, np.arange(1.0, 20.0, 0.6)))[0])
    # a step onto the line does not start the clock
    onto_the_line = np.concatenate([[0.6, 1.1], np.arange(4.0, 20.0, 0.6)])
    assert start_of(way_with(straight, onto_the_line))[0] == pytest.approx(4.0)


def tilt(levels_deg: list[tuple[float, float]]) -> FloatArray:
    """Through (s, deg), evenly."""
    at, values = np.array(levels_deg).T
    return np.deg2rad(np.interp(TIME_S, at, values))


def test_a_rise_and_a_sitting_are_timed_by_tenths_of_the_way() -> None:
    found = motions_of_tilt(TIME_S, tilt([(4, 90), (6, 0), (15, 0), (17, 90)]))
    ((rise,), (sitting,)) = found.rises, found.sittings
    assert (rise.left_seat_s, rise.upright_s) == pytest.approx((4.2, 5.8), abs=0.04)
    assert (sitting.left_upright_s, sitting.seated_s) == pytest.approx((15.2, 16.8), abs=0.04)
    assert (rise.time_s, sitting.time_s) == pytest.approx((1.6, 1.6), abs=0.05)


def test_walking_and_half_a_rise_are_no_rise() -> None:
    walking = np.deg2rad(15.0 + 12.0 * np.sin(TIME_S * 10.0))
    assert motions_of_tilt(TIME_S, walking).rises == ()
    tried = motions_of_tilt(TIME_S, tilt([(4, 90), (5, 60), (6, 90)]))
    assert (tried.rises, tried.sittings) == ((), ())

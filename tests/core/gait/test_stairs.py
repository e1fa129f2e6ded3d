"""Strides on stairs and level ones, whatever a sensor makes of single strides."""

from dataclasses import replace

import numpy as np
import pytest

from core import analyse
from core.body import Side, Site
from core.gait.stairs import FootClimbs, on_stairs
from core.gait.strides import Reason, strides_of, strides_of_feet
from core.samples import FloatArray
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import Standing, Treadmill, Walk, WalkerSettings
from tests.core.gait.test_strides import feet_events
from tests.simulated import session_of

FEET = (Site.LEFT_FOOT, Site.RIGHT_FOOT)
LEVEL_M, TREADS_M = 1.25, 0.6
RNG = np.random.default_rng(3)
CLIMBS = [
    (0.34, 0.6, 1),
    (-0.34, 0.6, -1),
    (0.15, 0.3, 1),  # both feet on each tread
    (0.17, 1.0, 1),  # the first swing onto stairs comes from the level floor
    (0.05, 0.2, 0),  # a kerb's edge, or what the height is off
    (0.12, 1.2, 0),  # a ramp of 10 %
    (-0.16, 1.35, 0),  # and down one of 12 %
    (np.nan, np.nan, 0),  # from a shank
]
FLIGHT = [0.17, 0.34, 0.34, 0.34, 0.17]  # by one foot; the other climbs two steps at a time from the start


def foot(climb_m: list[float], late_s: float = 0.0, error_m: float = 0.0, scatter_m: float = 0.01) -> FootClimbs:
    """A foot whose strides climb so, besides what its sensor adds to each and what scatters."""
    true_m = np.array(climb_m)
    length_m = np.select([np.abs(true_m) > 0.3, np.abs(true_m) > 0.1], [TREADS_M, 0.9], LEVEL_M)
    reported_m = true_m + error_m + RNG.normal(0.0, scatter_m, len(true_m))
    return FootClimbs(2.0 + late_s + 1.2 * np.arange(len(true_m)), length_m, reported_m)


def ways(*feet: FootClimbs) -> list[list[int]]:
    return [found.tolist() for found in on_stairs(feet, are_declared=False)]


def level(strides: int) -> list[float]:
    return [0.0] * strides


def signs(*climbs_m: list[float]) -> list[list[int]]:
    return [np.sign(climb_m).astype(int).tolist() for climb_m in climbs_m]


def down(climb_m: list[float]) -> list[float]:
    return [-one for one in climb_m]


@pytest.mark.parametrize(("climb_m", "length_m", "way"), CLIMBS)
def test_where_stairs_are_declared_each_stride_is_judged_by_itself(climb_m: float, length_m: float, way: int) -> None:
    one = FootClimbs(np.array([2.0]), np.array([length_m]), np.array([climb_m]))
    assert on_stairs([one], are_declared=True)[0].tolist() == [way]


@pytest.mark.parametrize(("climb_m", "length_m", "way"), CLIMBS)
def test_no_single_stride_makes_stairs_of_a_level_walk(climb_m: float, length_m: float, way: int) -> None:
    climbs_m, lengths_m = RNG.normal(0.0, 0.01, 9), np.full(9, LEVEL_M)
    climbs_m[4], lengths_m[4] = climb_m, length_m
    odd = FootClimbs(1.2 * np.arange(9.0), lengths_m, climbs_m)
    assert ways(odd, foot(level(9))) == [level(9), level(9)]
    assert ways(odd, odd) == [level(9), level(9)]  # nor where both feet have one


@pytest.mark.parametrize("error_m", [-0.14, -0.1, 0.0, 0.07, 0.12, 0.2])
def test_what_a_sensor_adds_to_every_stride_makes_and_hides_no_stairs(error_m: float) -> None:
    for strides in (6, 16):
        assert ways(foot(level(strides), error_m=error_m), foot(level(strides))) == [level(strides), level(strides)]
    left = [*level(5), *FLIGHT, *level(3), *down(FLIGHT), *level(4)]
    right = [*level(5), 0.34, 0.34, 0.34, 0.34, *level(4), *down([0.34, 0.34, 0.34, 0.34]), *level(5)]
    assert ways(foot(left, error_m=error_m), foot(right, late_s=0.6)) == signs(left, right)


def test_a_flight_up_is_stairs_without_a_way_back() -> None:
    left = [*level(6), *FLIGHT, *level(2)]
    right = [*level(6), 0.34, 0.34, 0.34, 0.34, *level(3)]
    assert ways(foot(left), foot(right, late_s=0.6)) == signs(left, right)


def test_stairs_of_three_steps_are_stairs() -> None:
    left = [*level(4), 0.17, 0.34, *level(3), -0.17, -0.34, *level(3)]
    right = [*level(4), 0.34, 0.17, *level(3), -0.34, -0.17, *level(3)]
    assert ways(foot(left), foot(right, late_s=0.6)) == signs(left, right)


def test_a_run_that_the_other_foot_does_not_share_is_none() -> None:
    """A strap slips for some strides."""
    odd = [*level(5), 0.34, 0.34, 0.34, *level(4)]
    opposite = [*level(5), -0.34, -0.34, -0.34, *level(4)]
    later = [*level(30), 0.34, 0.34, 0.34, *level(4)]
    for other in (level(12), opposite, later):
        assert not np.any(np.concatenate(ways(foot(odd), foot(other, late_s=0.6)))), other


def test_a_run_of_long_strides_is_no_flight() -> None:
    """Both sensors are off while the patient walks faster: higher than any step, but not as steep as stairs."""
    feet = [foot([*level(5), 0.2, 0.2, 0.2, *level(4)]) for _ in FEET]
    long = [replace(one, length_m=np.full(12, LEVEL_M)) for one in feet]
    assert ways(*long) == [level(12), level(12)]


def test_strides_that_scatter_as_much_as_steps_rise_show_no_stairs() -> None:
    for _ in range(20):
        feet = [foot(level(16), scatter_m=0.1) for _ in FEET]
        short = [replace(one, length_m=np.full(16, 0.35)) for one in feet]
        assert ways(*short) == [level(16), level(16)]


def test_a_foot_alone_is_on_stairs_only_there_and_back() -> None:
    there = [*level(5), *FLIGHT, *level(3)]
    back = [*there, *down(FLIGHT), *level(4)]
    unknown = FootClimbs(1.2 * np.arange(9.0), np.full(9, np.nan), np.full(9, np.nan))  # from a shank
    assert ways(foot(back)) == signs(back)
    assert ways(foot(back), unknown) == [*signs(back), level(9)]
    assert ways(foot(there)) == [level(len(there))]


def test_a_walk_without_strides_has_no_stairs() -> None:
    nothing = FootClimbs(*(np.empty(0) for _ in range(3)))
    assert ways(nothing, nothing) == [[], []]
    assert ways() == []


def climbing(*, of_feet: tuple[Side, ...] = tuple(Side)) -> dict[Side, tuple[Reason, ...]]:
    """The reasons of two feet that go up and down three strides each, and are doubtful in the first of them."""
    climb_m: FloatArray = np.array([*level(5), 0.34, 0.34, 0.34, *level(3), -0.34, -0.34, -0.34, *level(4)])
    events = feet_events(len(climb_m))
    certain = np.arange(len(climb_m)) != 5
    climbing = replace(
        events, climb_m=climb_m, length_m=np.where(climb_m == 0.0, events.length_m, TREADS_M), is_certain=certain
    )
    return {side: strides.reason for side, strides in strides_of_feet({one: [climbing] for one in of_feet}).items()}


def test_strides_on_stairs_are_left_out_with_their_reason() -> None:
    for reasons in climbing().values():
        assert [k for k, one in enumerate(reasons) if one is Reason.STAIRS_UP] == [4, 5, 6]
        assert [k for k, one in enumerate(reasons) if one is Reason.STAIRS_DOWN] == [10, 11, 12]
    assert not {Reason.STAIRS_UP, Reason.STAIRS_DOWN} & set(strides_of([feet_events()]).reason)


def test_a_climb_in_every_stride_is_stairs_only_where_they_are_declared() -> None:
    made = session_of(
        WalkerSettings(recordings=(Standing(), Walk(strides=6, treadmill=Treadmill(slope=0.16))), sites=FEET)
    )
    declared = replace(made.recordings[-1], test=PlannedTest(TimedProtocol.STAIRS))
    other = replace(made.recordings[-1], test=PlannedTest(TimedProtocol.TEN_METRES))
    found = []
    for walk in (made.recordings[-1], other, declared):
        gait = analyse(replace(made, recordings=(made.recordings[0], walk))).recordings[-1].gait
        found.append(sum(one is Reason.STAIRS_UP for side in gait.values() for one in side.strides.reason))
    assert found[:2] == [0, 0]
    assert found[2] >= 5

"""Tests of the one figure of each timed test in the course, and of what it rests on."""

import math
from dataclasses import replace

import pytest

from core.goals import OF_TESTS, GoalOf, whose
from core.timed.found import DistanceSource, NotValid, TimedPart
from core.timed.measures import (
    COLUMNS,
    PROTOCOLS,
    counted_figure,
    figure_of,
    have_one_course,
    mean_of_attempts,
    mean_pace,
    on_one_course,
    pace_of,
    rests_on_feet,
)
from core.timed.protocols import TimedProtocol
from tests.core.timed.built_tests import built_test


def test_every_test_but_stairs_has_a_figure_that_goals_can_be_of() -> None:
    assert set(TimedProtocol) - set(COLUMNS) == {TimedProtocol.STAIRS}
    assert set(COLUMNS.values()) == set(OF_TESTS)
    assert all(PROTOCOLS[column] is protocol for protocol, column in COLUMNS.items())
    assert {whose(column) for column in OF_TESTS} == {(GoalOf.WALK,)}


@pytest.mark.parametrize(
    ("protocol", "figure"),
    [
        (TimedProtocol.TEN_METRES, 0.8),
        (TimedProtocol.TWO_MINUTES, 10.0),
        (TimedProtocol.SIX_MINUTES, 10.0),
        (TimedProtocol.UP_AND_GO, 12.5),
        (TimedProtocol.SIT_TO_STAND, 12.5),
    ],
)
def test_speed_distance_or_time_by_the_test(protocol: TimedProtocol, figure: float) -> None:
    test = built_test(protocol, time_s=12.5)
    assert figure_of(test) == pytest.approx(figure)
    assert not math.isfinite(figure_of(replace(test, end_s=math.nan, distance_m=math.nan)))


def test_only_a_way_that_the_feet_show_rests_on_them() -> None:
    by_feet = {TimedProtocol.TEN_METRES, TimedProtocol.TWO_MINUTES, TimedProtocol.SIX_MINUTES}
    for protocol in TimedProtocol:
        test = built_test(protocol)
        assert rests_on_feet(test) is (protocol in by_feet)
    at_the_tape = built_test(TimedProtocol.TEN_METRES, is_end_by_key=True)
    assert not rests_on_feet(at_the_tape)
    typed = replace(built_test(TimedProtocol.SIX_MINUTES), distance_source=DistanceSource.TYPED)
    assert not rests_on_feet(typed)


def test_the_mean_is_of_attempts_that_were_measured() -> None:
    found = mean_of_attempts([10.0, math.nan, 12.0])
    assert (found.mean, found.attempts) == (11.0, 2)
    assert not math.isfinite(mean_of_attempts([math.nan]).mean)


def test_a_test_that_is_not_valid_counts_in_no_mean() -> None:
    valid, longer = (built_test(TimedProtocol.UP_AND_GO, time_s=time_s) for time_s in (10.0, 16.0))
    other = replace(longer, not_valid=(NotValid.COURSE_LONGER,))
    assert mean_of_attempts(map(counted_figure, (valid, other))) == mean_of_attempts([10.0])
    assert figure_of(other) == pytest.approx(16.0)  # it is shown, with its reason


def test_pace_is_over_the_whole_and_over_thirds_of_valid_attempts() -> None:
    thirds = tuple(TimedPart(k, k + 1.0, 1.0, speed, 100.0) for k, speed in enumerate((1.2, 1.1, math.nan)))
    one = replace(built_test(TimedProtocol.SIX_MINUTES, time_s=10.0, distance_m=10.0), thirds=thirds)
    other = replace(built_test(TimedProtocol.SIX_MINUTES, time_s=10.0, distance_m=12.0), thirds=thirds)
    wrong = replace(other, distance_m=30.0, not_valid=(NotValid.LAP_DIFFERS,))
    assert pace_of(one).speed_m_s == pytest.approx(1.0)
    mean = mean_pace([one, other, wrong])
    assert mean.speed_m_s == pytest.approx(1.1)
    assert mean.thirds_m_s[:2] == pytest.approx((1.2, 1.1))
    assert math.isnan(mean.thirds_m_s[2])
    assert mean_pace([]).thirds_m_s == ()


def test_times_of_two_courses_have_no_mean_and_distances_of_two_laps_have() -> None:
    near, far = (replace(built_test(TimedProtocol.UP_AND_GO), course_m=length_m) for length_m in (3.0, 5.0))
    assert on_one_course([near, far, near]) == [near, near]
    assert on_one_course([near, far]) == [far]
    laps = [replace(built_test(TimedProtocol.SIX_MINUTES), course_m=length_m) for length_m in (20.0, 30.0)]
    assert on_one_course(laps) == laps
    assert on_one_course([]) == []
    assert [have_one_course(3.0, other_m) for other_m in (3.0, 2.44, math.nan)] == [True, False, True]

"""The one figure of each timed test that is shown in a patient's course: what it is made for.

Strides on stairs are distinguished and have none: how long they take depends on the stairs.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from core.timed.found import DistanceSource, TimedTest
from core.timed.protocols import TimedProtocol

COLUMNS: Mapping[TimedProtocol, str] = {
    TimedProtocol.TEN_METRES: "ten_metres_speed_m_s",
    TimedProtocol.TWO_MINUTES: "two_minutes_distance_m",
    TimedProtocol.SIX_MINUTES: "six_minutes_distance_m",
    TimedProtocol.UP_AND_GO: "up_and_go_time_s",
    TimedProtocol.SIT_TO_STAND: "sit_to_stand_time_s",
}
SAME_COURSE_M = 0.005  # lengths are entered to a centimetre
PROTOCOLS: Mapping[str, TimedProtocol] = {column: protocol for protocol, column in COLUMNS.items()}


@dataclass(frozen=True, slots=True)
class MeanOfAttempts:
    """The mean of one test over the valid attempts of a visit that have its figure; NaN without any."""

    mean: float
    attempts: int


@dataclass(frozen=True, slots=True)
class WalkingPace:
    """Walking speed, m/s, over a whole test and over each third of it, pauses included; NaN where not measured."""

    speed_m_s: float
    thirds_m_s: tuple[float, ...]


def figure_of(test: TimedTest) -> float:
    """Give speed between tapes, distance in a set time or time from the chair; NaN where not measured."""
    if test.protocol is TimedProtocol.TEN_METRES:
        return test.speed_m_s
    return test.distance_m if test.definition.duration_s is not None else test.time_s


def rests_on_feet(test: TimedTest) -> bool:
    """Whether the figure is as sure as the way that the feet show: no tape, no chair marks where it ends."""
    if test.definition.duration_s is not None:
        return test.distance_source is DistanceSource.FEET
    return test.definition.length_m is not None and not test.is_end_by_key


def counted_figure(test: TimedTest) -> float:
    """Give the figure that counts in a mean of attempts; NaN also where the test is not valid."""
    return figure_of(test) if test.is_valid else math.nan


def length_of(test: TimedTest) -> float:
    """Give the length that the figure belongs to, m; NaN of a test of a set time, in which any length may be walked."""
    return test.course_m if test.definition.duration_s is None else math.nan


def on_one_course(tests: Iterable[TimedTest]) -> list[TimedTest]:
    """Leave those that were walked on the course of the last: times of 3 m and of 5 m have no mean."""
    every = list(tests)
    return [test for test in every if have_one_course(length_of(test), length_of(every[-1]))]


def have_one_course(one_m: float, other_m: float) -> bool:
    """Return whether two figures may be compared; where a length is not known they are."""
    return not abs(one_m - other_m) > SAME_COURSE_M


def pace_of(test: TimedTest) -> WalkingPace:
    """Give the speed over a walked test and its thirds; NaN of rises, which lead nowhere."""
    return WalkingPace(test.speed_m_s, tuple(one.speed_m_s for one in test.thirds))


def mean_pace(tests: Iterable[TimedTest]) -> WalkingPace:
    """Average the pace of the attempts that are valid, each third over those that have it."""
    paces = [pace_of(test) for test in tests if test.is_valid]
    thirds = zip(*(pace.thirds_m_s for pace in paces if pace.thirds_m_s), strict=False)
    return WalkingPace(
        mean_of_attempts(pace.speed_m_s for pace in paces).mean,
        tuple(mean_of_attempts(values).mean for values in thirds),
    )


def mean_of_attempts(values: Iterable[float]) -> MeanOfAttempts:
    """Average the values that were measured; NaN where none was."""
    known = [value for value in values if math.isfinite(value)]
    return MeanOfAttempts(float(np.mean(known)) if known else math.nan, len(known))

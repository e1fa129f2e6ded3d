"""The one figure of each timed test that is shown in a patient's course: what it is made for.

Strides on stairs are distinguished and have none: how long they take depends on the stairs.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from core.timed.found import TimedTest
from core.timed.protocols import TimedProtocol

COLUMNS: Mapping[TimedProtocol, str] = {
    TimedProtocol.TEN_METRES: "ten_metres_speed_m_s",
    TimedProtocol.TWO_MINUTES: "two_minutes_distance_m",
    TimedProtocol.SIX_MINUTES: "six_minutes_distance_m",
    TimedProtocol.UP_AND_GO: "up_and_go_time_s",
    TimedProtocol.SIT_TO_STAND: "sit_to_stand_time_s",
}
PROTOCOLS: Mapping[str, TimedProtocol] = {column: protocol for protocol, column in COLUMNS.items()}


@dataclass(frozen=True, slots=True)
class MeanOfAttempts:
    """The mean of one test over the attempts of a visit that have its figure; NaN without any."""

    mean: float
    attempts: int


def figure_of(test: TimedTest) -> float:
    """Give speed between tapes, distance in a set time or time from the chair; NaN where not measured."""
    if test.protocol is TimedProtocol.TEN_METRES:
        return test.speed_m_s
    return test.distance_m if test.definition.duration_s is not None else test.time_s


def rests_on_feet(test: TimedTest) -> bool:
    """Whether the figure is as sure as the way that the feet show: no tape, no chair marks where it ends."""
    if test.definition.duration_s is not None:
        return True
    return test.definition.length_m is not None and not test.is_end_by_key


def mean_of_attempts(values: Iterable[float]) -> MeanOfAttempts:
    """Average the values that were measured; NaN where none was."""
    known = [value for value in values if math.isfinite(value)]
    return MeanOfAttempts(float(np.mean(known)) if known else math.nan, len(known))

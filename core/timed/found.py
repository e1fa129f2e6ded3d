"""What a timed test has given: times, distance, laps, turns, pauses, rises, and what was not measured, and why."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from core.body import Side, Site
from core.timed.protocols import DEFINITIONS, Definition, TimedProtocol

ABOUT_RAD = np.deg2rad(120.0)  # from here on, a turn ends a lap


class NotMeasured(StrEnum):
    """Why a value is missing. The values are the words of timed_test.csv."""

    NO_FEET = "no_foot_sensors"
    NO_THIGHS = "no_thigh_sensors_or_no_standing"
    NO_START = "no_still_second_before_a_step"
    NO_RISE = "no_rise"
    NOT_FINISHED = "not_finished"
    SILENT = "foot_sensor_silent"


@dataclass(frozen=True, slots=True)
class Turn:
    """A turn of the body: when, and how far, positive to the left."""

    start_s: float
    end_s: float
    angle_rad: float

    @property
    def is_about(self) -> bool:
        return abs(self.angle_rad) >= ABOUT_RAD

    @property
    def middle_s(self) -> float:
        return 0.5 * (self.start_s + self.end_s)


@dataclass(frozen=True, slots=True)
class Silence:
    """A sensor that gave no samples, and when."""

    site: Site
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class StairStride:
    """A stride of one foot onto a higher or a lower step: from contact to contact, seconds, and how much higher, m."""

    side: Side
    start_s: float
    end_s: float
    climb_m: float

    @property
    def is_up(self) -> bool:
        return self.climb_m > 0.0


@dataclass(frozen=True, slots=True)
class Rise:
    """The thighs left the seat, and were upright, seconds."""

    left_seat_s: float
    upright_s: float


@dataclass(frozen=True, slots=True)
class TimedPart:
    """A lap or a third of a test; NaN where not measured. The speed is over the whole part, pauses included."""

    start_s: float
    end_s: float
    distance_m: float
    speed_m_s: float
    cadence_steps_min: float


@dataclass(frozen=True, slots=True)
class TimedTest:
    """What one test gives; NaN where not measured, and `missing` names the reason.

    `start_s`, `end_s`: on the recording's clock.
    `distance_m`: what counts: where a key ends a walk between tapes the tapes', else the sensors', turns included.
    """

    protocol: TimedProtocol
    start_s: float
    end_s: float
    is_start_by_key: bool
    is_end_by_key: bool
    distance_m: float
    sensor_distance_m: float  # by the feet between start and end
    cadence_steps_min: float
    turns: tuple[Turn, ...]
    pauses_s: tuple[tuple[float, float], ...]  # from contact to toe-off, wherever both feet stood for a second
    laps: tuple[TimedPart, ...]
    thirds: tuple[TimedPart, ...]
    rises: tuple[Rise, ...]
    silences: tuple[Silence, ...]
    missing: tuple[NotMeasured, ...]
    stairs: tuple[StairStride, ...] = ()

    @property
    def time_s(self) -> float:
        """How long it took, NaN where start or end is missing."""
        return self.end_s - self.start_s

    @property
    def speed_m_s(self) -> float:
        """Distance over time, pauses included."""
        return self.distance_m / self.time_s if self.time_s > 0 else math.nan

    @property
    def tape_difference_m(self) -> float:
        """The sensors' distance less the tapes'; NaN unless a key marked where the tape is."""
        is_taped = self.definition.length_m is not None and self.is_end_by_key
        return self.sensor_distance_m - self.distance_m if is_taped else math.nan

    @property
    def definition(self) -> Definition:
        """What starts and ends it, and what is known of its error."""
        return DEFINITIONS[self.protocol]

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


class NotValid(StrEnum):
    """Why a test that was timed is not the test that it is called. The values are the words of timed_test.csv."""

    COURSE_SHORTER = "course_shorter_than_entered"
    COURSE_LONGER = "course_longer_than_entered"
    NO_RISE = "no_rise"
    NO_TURN = "no_turn_at_the_cone"
    NO_TURN_TO_SIT = "no_turn_before_sitting"
    MORE_TURNS = "more_turns_than_the_course_has"
    ELSEWHERE = "not_back_at_the_chair"
    LAP_DIFFERS = "lap_length_differs_from_feet"
    DISTANCE_DIFFERS = "typed_distance_differs_from_feet"
    OTHER_TIME = "not_the_time_of_the_test"
    FEWER_RISES = "fewer_rises_than_the_test_has"


class Validity(StrEnum):
    """Whether a test was walked as it asks for. The values are the words of timed_test.csv."""

    VALID = "valid"
    NOT_VALID = "not_valid"
    NOT_CHECKED = "not_checked"  # nothing to hold it against, or no foot sensor that shows it


class DistanceSource(StrEnum):
    """Where the distance that counts is from. The values are the words of timed_test.csv."""

    FEET = "feet"
    TAPE = "tape"  # set by the test, between two marks
    TYPED = "typed"  # laps and the rest, as they were entered
    FOUND_LAPS = "found_laps"  # laps that the turns show, of the length that was entered


class PartOfUpAndGo(StrEnum):
    """The parts of an up and go, in order. The values are the words of timed_test.csv."""

    RISE = "rise"
    WALK_OUT = "walk_out"
    TURN = "turn"
    WALK_BACK = "walk_back"
    TURN_TO_SIT = "turn_to_sit"
    SIT = "sit"


@dataclass(frozen=True, slots=True)
class UpAndGoPart:
    """One part of an up and go, on the recording's clock; NaN where a border was not found."""

    part: PartOfUpAndGo
    start_s: float
    end_s: float

    @property
    def time_s(self) -> float:
        return self.end_s - self.start_s


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

    @property
    def time_s(self) -> float:
        return self.upright_s - self.left_seat_s


@dataclass(frozen=True, slots=True)
class Sitting:
    """The thighs left standing, and came to rest on the seat, seconds."""

    left_upright_s: float
    seated_s: float

    @property
    def time_s(self) -> float:
        return self.seated_s - self.left_upright_s


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
    `distance_m`: what counts, and `distance_source` where it is from.
    `parts`: of an up and go all six, in order; of any other test none.
    `course_m`: from the chair to the cone, between the tapes, or of a lap, as entered or as the test has it; NaN where
    there is nothing to hold it against. `course_found_m`: the same by the feet.
    `not_valid`: in what it was not the test that it is called; see `core.timed.validity`.
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
    parts: tuple[UpAndGoPart, ...] = ()
    sittings: tuple[Sitting, ...] = ()
    course_m: float = math.nan
    course_found_m: float = math.nan
    not_valid: tuple[NotValid, ...] = ()
    distance_source: DistanceSource = DistanceSource.FEET

    @property
    def validity(self) -> Validity:
        if self.not_valid:
            return Validity.NOT_VALID
        return Validity.VALID if math.isfinite(self.course_found_m) else Validity.NOT_CHECKED

    @property
    def is_valid(self) -> bool:
        """Whether nothing shows that it was another test; also where nothing could be checked."""
        return not self.not_valid

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

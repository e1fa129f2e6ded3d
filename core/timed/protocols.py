"""What each timed test is, where it begins and ends, and what is known of its error."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum


class TimedProtocol(StrEnum):
    """The tests; the values are the words of session.toml and timed_test.csv."""

    TEN_METRES = "10 m"
    TWO_MINUTES = "2 min"
    SIX_MINUTES = "6 min"
    UP_AND_GO = "up and go"
    SIT_TO_STAND = "sit to stand 5"
    STAIRS = "stairs"

    @property
    def is_on_stairs(self) -> bool:
        return self is TimedProtocol.STAIRS


class KeyMeaning(StrEnum):
    """What a key that was pressed marked; the values are those in a recording's journal."""

    START = "start"
    END = "end"


@dataclass(frozen=True, slots=True)
class PlannedTest:
    """That a walk is a test, and what was entered about it; None where nothing was.

    `start_key_s`, `end_key_s`: when a key was pressed at its start and its end, on the recording's clock.
    `course_m`: of the course as it is laid out: from the chair to the cone, or between the tapes.
    `lap_m`: from one turn to the next in a test of a set time; `typed_laps`: how many such laps were completed;
    `rest_m`: how far the patient came in the lap after them.

    Raises
    ------
    ValueError
        A time or a length that is none, a length or a number below zero, or an end that is not after its start.
    """

    protocol: TimedProtocol
    start_key_s: float | None = None
    end_key_s: float | None = None
    course_m: float | None = None
    lap_m: float | None = None
    typed_laps: int | None = None
    rest_m: float | None = None

    def __post_init__(self) -> None:
        for name in ("start_key_s", "end_key_s", "course_m", "lap_m", "typed_laps", "rest_m"):
            value = getattr(self, name)
            if value is not None and not math.isfinite(value):
                raise ValueError(f"{name} is {value}, expected a figure or None")
        for name in ("course_m", "lap_m"):
            value = getattr(self, name)
            if value is not None and value <= 0.0:
                raise ValueError(f"{name} is {value}, expected more than 0 m")
        for name in ("typed_laps", "rest_m"):
            value = getattr(self, name)
            if value is not None and value < 0:
                raise ValueError(f"{name} is {value}, expected 0 or more")
        if self.start_key_s is not None and self.end_key_s is not None and self.end_key_s <= self.start_key_s:
            raise ValueError(f"the end {self.end_key_s} is not after the start {self.start_key_s}")


TABLE_KEYS = (
    *("test", "test_start_s", "test_end_s"),
    *("test_course_m", "test_lap_m", "test_laps", "test_rest_m"),
)


def planned_table(planned: PlannedTest | None) -> dict[str, object]:
    """The keys of session.toml that say of a recording which test it is; none where it is no test."""
    if planned is None:
        return {}
    keys_s, course_m = (planned.start_key_s, planned.end_key_s), planned.course_m
    values = (str(planned.protocol), *keys_s, course_m, planned.lap_m, planned.typed_laps, planned.rest_m)
    return {key: value for key, value in zip(TABLE_KEYS, values, strict=True) if value is not None}


def planned_of_table(table: Mapping[str, object]) -> PlannedTest | None:
    """What `planned_table` wrote; None where it contains nothing, or something that no test of ours is."""
    protocol, *figures = (table.get(key) for key in TABLE_KEYS)
    if not isinstance(protocol, str) or protocol not in set(TimedProtocol):
        return None
    start_s, end_s, course_m, lap_m, laps, rest_m = (_figure(value) for value in figures)
    if laps is not None and not laps.is_integer():
        return None
    count = None if laps is None else int(laps)
    try:
        return PlannedTest(TimedProtocol(protocol), start_s, end_s, course_m, lap_m, count, rest_m)
    except ValueError:
        return None


def _figure(value: object) -> float | None:
    """A figure, NaN where it is something else, None where there is none."""
    if value is None:
        return None
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else math.nan


def planned_text(planned: PlannedTest | None) -> str:
    """The same in one line, for a row of a database; empty where it is no test."""
    return json.dumps(planned_table(planned)) if planned is not None else ""


def planned_of_text(text: str) -> PlannedTest | None:
    """What `planned_text` wrote; None of an empty text, and of one that contains something else."""
    try:
        table = json.loads(text) if text else None
    except (ValueError, RecursionError):
        return None
    return planned_of_table(table) if isinstance(table, dict) else None


@dataclass(frozen=True, slots=True)
class KnownError:
    """How far off a quantity may be, `low` to `high` in the unit of its name, and who reports it.

    `is_verified`: the source was read, or it was measured here; where not, what rests on it prints a dagger.
    `how` it was measured in `paper`; or, of so many simulated `courses`, `high` is the worst.
    """

    quantity: str
    low: float
    high: float
    how: str = ""
    paper: str = ""
    courses: int = 0
    is_verified: bool = False

    @property
    def source(self) -> str:
        """Who reports it, in English, as files have it."""
        simulated = f"the worst of {self.courses} simulated courses" if self.courses else ""
        return ", ".join(filter(None, [self.how, self.paper, simulated]))


@dataclass(frozen=True, slots=True)
class Definition:
    """One test.

    `starts`, `ends`: what starts and ends the clock where no key does.
    `tape_m`: where a set distance begins and ends, from where the patient is standing at first.
    """

    starts: str
    ends: str
    duration_s: float | None = None  # of a test of a set time
    tape_m: tuple[float, float] | None = None
    rises: int = 0  # how often the patient rises
    course_m: float | None = None  # from the chair to the cone
    is_walked: bool = True  # whether there are strides in it: a patient who rises and sits makes none
    errors: tuple[KnownError, ...] = ()

    @property
    def length_m(self) -> float | None:
        """Between the tapes, where the distance is set."""
        return None if self.tape_m is None else self.tape_m[1] - self.tape_m[0]

    @property
    def is_from_chair(self) -> bool:
        return self.rises > 0


_FIRST_CONTACT = "first initial contact after both feet stood for 1 s"
_LEFT_SEAT = "the thighs have come a tenth of the way from the seat to standing"
_STUDY = "mean absolute error in healthy people on tracks of 10 and 30 m (BMC Digital Health 2023, 1:48)"
# doi 10.1186/s44247-023-00038-9: below 13 m by insoles (n = 32), 16.24 m (30 m) and 38.88 m (10 m) by a rater (n = 33)
_FEET = KnownError("distance_m", 0.0, 13.0, "six minutes by sensors in insoles", _STUDY, is_verified=True)
_RATER = KnownError("distance_m", 16.0, 39.0, "six minutes by a rater", _STUDY, is_verified=True)


def _worst(quantity: str, error: float, courses: int) -> KnownError:
    return KnownError(quantity, 0.0, error, courses=courses, is_verified=True)


DEFINITIONS: Mapping[TimedProtocol, Definition] = {
    TimedProtocol.TEN_METRES: Definition(
        "the body is 2 m from where it stood",
        "the body is 12 m from where it stood",
        tape_m=(2.0, 12.0),
        errors=(_worst("distance_percent", 1.2, 60), _worst("time_s", 0.21, 60)),
    ),
    TimedProtocol.TWO_MINUTES: Definition(
        _FIRST_CONTACT, "120 s later", duration_s=120.0, errors=(_worst("distance_percent", 1.1, 40),)
    ),
    TimedProtocol.SIX_MINUTES: Definition(
        _FIRST_CONTACT, "360 s later", duration_s=360.0, errors=(_worst("distance_percent", 1.5, 10), _FEET, _RATER)
    ),
    TimedProtocol.UP_AND_GO: Definition(
        _LEFT_SEAT,
        "the thighs have come nine tenths of the way down",
        rises=1,
        course_m=3.0,
        errors=(_worst("distance_percent", 4.9, 200), _worst("time_s", 0.08, 200)),
    ),
    TimedProtocol.STAIRS: Definition(
        _FIRST_CONTACT,
        "the last contact",
        errors=(_worst("distance_percent", 11.0, 60), _worst("time_s", 0.06, 60)),
    ),
    TimedProtocol.SIT_TO_STAND: Definition(
        _LEFT_SEAT,
        "the thighs have come nine tenths of the way up for the fifth time",
        rises=5,
        is_walked=False,
        errors=(_worst("time_s", 0.08, 40),),
    ),
}


def course_of(planned: PlannedTest) -> float | None:
    """Give the length of the course as entered, else as the test has it, m; None where it has none, or no lap."""
    definition = DEFINITIONS[planned.protocol]
    return planned.course_m or planned.lap_m or definition.course_m or definition.length_m


def with_course(planned: PlannedTest, length_m: float | None) -> PlannedTest:
    """Enter the length of the course, m, of a test of a set time its lap; None: as the test has it."""
    definition = DEFINITIONS[planned.protocol]
    if definition.duration_s is not None:
        return replace(planned, lap_m=length_m)
    is_own = length_m == (definition.course_m or definition.length_m)
    return replace(planned, course_m=None if is_own else length_m)

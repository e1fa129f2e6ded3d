"""What each timed test is, where it begins and ends, and what is known of its error."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum


class TimedProtocol(StrEnum):
    """The tests; the values are the words of timed_tests.csv."""

    TEN_METRES = "10_m"
    TWO_MINUTES = "2_min"
    SIX_MINUTES = "6_min"
    UP_AND_GO = "up_and_go"
    SIT_TO_STAND = "sit_to_stand_5"


@dataclass(frozen=True, slots=True)
class KnownError:
    """How far off a quantity may be, `low` to `high` in the unit of its name, and who says so.

    `is_verified`: the source was read, or it was measured here; where not, what rests on it prints a dagger.
    """

    quantity: str
    low: float
    high: float
    source: str
    is_verified: bool = False


@dataclass(frozen=True, slots=True)
class Definition:
    """One test.

    Attributes
    ----------
    starts, ends
        What starts and ends the clock where no key does.
    duration_s
        Of a test of a set time.
    tape_m
        Where a set distance begins and ends, from where the patient stands first.
    rises
        How often the patient rises.
    """

    starts: str
    ends: str
    duration_s: float | None = None
    tape_m: tuple[float, float] | None = None
    rises: int = 0
    errors: tuple[KnownError, ...] = ()

    @property
    def is_from_chair(self) -> bool:
        return self.rises > 0


_FIRST_CONTACT = "first initial contact after both feet stood for 1 s"
_LEFT_SEAT = "the thighs have come a tenth of the way from the seat to standing"
_FEET = KnownError("distance_m", 0.0, 13.0, "six minutes by foot sensors; named to us, the paper was not read")
_RATER = KnownError("distance_m", 16.0, 39.0, "six minutes by a rater; named to us, the paper was not read")
_SIMULATED = "the worst of {} simulated courses, python -m tests.validation.timed_courses"


def _worst(quantity: str, error: float, courses: int) -> KnownError:
    return KnownError(quantity, 0.0, error, _SIMULATED.format(courses), is_verified=True)


DEFINITIONS: Mapping[TimedProtocol, Definition] = {
    TimedProtocol.TEN_METRES: Definition(
        "the body is 2 m from where it stood",
        "the body is 12 m from where it stood",
        tape_m=(2.0, 12.0),
        errors=(_worst("distance_percent", 1.2, 60), _worst("time_s", 0.21, 60)),
    ),
    TimedProtocol.TWO_MINUTES: Definition(
        _FIRST_CONTACT, "120 s later", duration_s=120.0, errors=(_worst("distance_percent", 1.2, 40),)
    ),
    TimedProtocol.SIX_MINUTES: Definition(
        _FIRST_CONTACT, "360 s later", duration_s=360.0, errors=(_worst("distance_percent", 1.6, 10), _FEET, _RATER)
    ),
    TimedProtocol.UP_AND_GO: Definition(
        _LEFT_SEAT,
        "the thighs have come nine tenths of the way down",
        rises=1,
        errors=(_worst("distance_percent", 2.3, 50), _worst("time_s", 0.06, 50)),
    ),
    TimedProtocol.SIT_TO_STAND: Definition(
        _LEFT_SEAT,
        "the thighs have come nine tenths of the way up for the fifth time",
        rises=5,
        errors=(_worst("time_s", 0.08, 40),),
    ),
}

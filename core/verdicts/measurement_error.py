"""By how much two means have to differ before more than chance, drift, clocks and straps is behind it.

How sure one mean is, u, is found in `core.verdicts.stride_means`. Of a difference U^2 = u1^2 + u2^2 + v^2 + 2 sigma^2
and the error is 1.96 U, the minimal detectable change at 95 %; v is what another speed alone may make of it, and sigma
adds what lies between the two means, by the kind of comparison.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from core.parameters import REGISTRY, QuantityKind
from core.verdicts.model import Assessment
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD
from core.verdicts.stride_means import MeanOfStrides

Z95 = 1.96
ANGLE_PER_LAG_DEG_S = 400.0  # what a joint turns in swing: so much of its angle is at stake per second of lag
SENTENCE_FACTOR = 1.5  # Bonferroni for some 16 judged measures: a sentence on page one needs so much more


class ComparisonKind(StrEnum):
    """What lies between two means."""

    HALVES = "halves"
    ATTACHED = "attached"
    LEGS = "legs"
    STRAPPINGS = "strappings"
    VISITS = "visits"


class ErrorSource(StrEnum):
    """What an error contains; the words of differences.csv."""

    CHANCE = "chance"
    DRIFT = "drift"
    CLOCK = "clock"
    SPEED = "speed"
    WALKS = "walk_to_walk"
    STRAPS = "strapping"
    DAYS = "day"
    EVENTS = "event_bias"
    ZERO = "zero"


# by the columns of strides.csv and of `both`; what is missing is not judged
KINDS = {quantity.column: quantity.error for quantity in REGISTRY if quantity.error is not None}

# What a quantity changes by with walking speed, per m/s: peak knee flexion in swing and stance of 42 adults from slow
# to fast (Fukuchi, Fukuchi & Duarte 2018, doi 10.7717/peerj.4640); those of ankle, segments and foot are the knee's,
# and those of foot flat and of the knee's timing are stance's, for want of any.
PER_SPEED: Mapping[QuantityKind, float] = {
    QuantityKind.KNEE_SHAPE: 11.0,
    QuantityKind.KNEE_HEIGHT: 11.0,
    QuantityKind.ANKLE_SHAPE: 11.0,
    QuantityKind.ANKLE_HEIGHT: 11.0,
    QuantityKind.STANCE: 4.8,
    QuantityKind.SEGMENT_SHAPE: 11.0,
    QuantityKind.SEGMENT_HEIGHT: 11.0,
    QuantityKind.FOOT_PITCH: 11.0,
    QuantityKind.FOOT_FLAT: 4.8,
    QuantityKind.KNEE_TIMING: 4.8,
}


SPEED_REPORTED_M_S = 0.005  # as far apart two speeds must be to be written as two, and to be called so


class Sigma(NamedTuple):
    """What is added between two means.

    `value` is a standard deviation of one mean in the quantity's unit, or, where `is_relative`, in percent of the mean.
    `is_published_error`: it is E / (1.96 sqrt 2) of a published minimal detectable change, whose upper end was taken.
    `is_verified`: the source was read, or it was measured here; where not, what rests on it prints a dagger.
    """

    value: float
    source: str
    is_relative: bool = False
    is_published_error: bool = False
    is_verified: bool = False
    is_borrowed: bool = False


def _of_error(error: float, source: str, *, is_borrowed: bool = False, is_published: bool = True) -> Sigma:
    return Sigma(error / (Z95 * math.sqrt(2)), source, is_published_error=is_published, is_borrowed=is_borrowed)


_NOTHING = Sigma(0.0, "one recording: nothing lies between", is_verified=True)
_WALKS = "repeated walks of one strapping, our recordings"
_VOLUNTEERS = (
    "motion-sensor knees, two visits, three testers, 15 volunteers: minimal detectable change 3.37 to 9.21 deg"
)
_BORROWED = f"the knee's figure, for want of one of the ankle ({_VOLUNTEERS})"
_OF_KNEE = f"the knee's figure, for want of one of segments and feet ({_VOLUNTEERS})"
_OF_FOOT = "1 deg as of the ankle, and 0.8 deg that 2.5 % of stride length make of a foot at toe-off: an estimate"
_OF_STANCE = "that of stance, for want of one"
_POSTURE = "with 3 deg of posture in each zero"
_BIAS = "events 10 ms early or late, alike in every stride of one leg"
_GUESS = "an estimate"

_STRAPS: Mapping[QuantityKind, Sigma] = {  # where each mean has a strapping of its own
    QuantityKind.KNEE_SHAPE: _of_error(9.2, _VOLUNTEERS),
    QuantityKind.ANKLE_SHAPE: _of_error(9.2, _BORROWED, is_borrowed=True),
    QuantityKind.KNEE_HEIGHT: _of_error(12.4, f"{_VOLUNTEERS}, {_POSTURE}"),
    QuantityKind.ANKLE_HEIGHT: _of_error(12.4, f"{_BORROWED}, {_POSTURE}", is_borrowed=True),
    QuantityKind.SEGMENT_SHAPE: _of_error(9.2, _OF_KNEE, is_borrowed=True),
    QuantityKind.SEGMENT_HEIGHT: _of_error(12.4, f"{_OF_KNEE}, {_POSTURE}", is_borrowed=True),
    QuantityKind.FOOT_PITCH: _of_error(9.2, _OF_KNEE, is_borrowed=True),
}
_STRAPPED_AGAIN: Mapping[QuantityKind, Sigma] = {
    **_STRAPS,
    QuantityKind.STANCE: Sigma(3.0, _GUESS),
    QuantityKind.TIME: Sigma(4.0, _GUESS, is_relative=True),
    QuantityKind.SPEED: Sigma(4.0, _GUESS, is_relative=True),
    QuantityKind.LENGTH: Sigma(5.0, _GUESS, is_relative=True),
    QuantityKind.FOOT_FLAT: Sigma(3.0, _OF_STANCE, is_borrowed=True),
    QuantityKind.KNEE_TIMING: Sigma(3.0, _OF_STANCE, is_borrowed=True),
}

SIGMAS: Mapping[ComparisonKind, Mapping[QuantityKind, Sigma]] = {
    ComparisonKind.HALVES: dict.fromkeys(QuantityKind, _NOTHING),
    ComparisonKind.ATTACHED: {
        QuantityKind.KNEE_SHAPE: Sigma(1.0, _WALKS),
        QuantityKind.ANKLE_SHAPE: Sigma(1.0, _WALKS),
        QuantityKind.KNEE_HEIGHT: Sigma(1.2, _WALKS),
        QuantityKind.ANKLE_HEIGHT: Sigma(1.2, _WALKS),
        QuantityKind.STANCE: Sigma(0.5, _WALKS, is_verified=True),
        QuantityKind.TIME: Sigma(2.0, _WALKS, is_relative=True, is_verified=True),
        QuantityKind.SPEED: Sigma(3.0, _WALKS, is_relative=True),
        QuantityKind.LENGTH: Sigma(2.5, _WALKS, is_relative=True, is_verified=True),
        QuantityKind.SEGMENT_SHAPE: Sigma(1.0, _OF_KNEE, is_borrowed=True),
        QuantityKind.SEGMENT_HEIGHT: Sigma(1.2, _OF_KNEE, is_borrowed=True),
        QuantityKind.FOOT_PITCH: Sigma(1.3, _OF_FOOT, is_borrowed=True),  # hypot of both
        QuantityKind.FOOT_FLAT: Sigma(1.2, _GUESS, is_borrowed=True),  # two events of two kinds, each less sure
        QuantityKind.KNEE_TIMING: Sigma(0.5, _OF_STANCE, is_borrowed=True),
    },
    ComparisonKind.LEGS: {
        **_STRAPS,
        QuantityKind.STANCE: _of_error(2.5, _BIAS, is_published=False),
        QuantityKind.TIME: _of_error(0.05, _BIAS, is_published=False),
        QuantityKind.LENGTH: _of_error(0.03, _GUESS, is_published=False),
    },
    ComparisonKind.STRAPPINGS: _STRAPPED_AGAIN,
    ComparisonKind.VISITS: {**_STRAPPED_AGAIN, QuantityKind.SPEED: _of_error(0.20, _GUESS, is_published=False)},
}

_BETWEEN: Mapping[ComparisonKind, tuple[ErrorSource, ...]] = {
    ComparisonKind.HALVES: (),
    ComparisonKind.ATTACHED: (ErrorSource.WALKS,),
    ComparisonKind.LEGS: (ErrorSource.STRAPS,),
    ComparisonKind.STRAPPINGS: (ErrorSource.WALKS, ErrorSource.STRAPS),
    ComparisonKind.VISITS: (ErrorSource.WALKS, ErrorSource.STRAPS, ErrorSource.DAYS),
}
_HEIGHTS = (QuantityKind.KNEE_HEIGHT, QuantityKind.ANKLE_HEIGHT, QuantityKind.SEGMENT_HEIGHT)
_OWN_LEG = (QuantityKind.STANCE, QuantityKind.TIME, QuantityKind.LENGTH)  # between legs the events' bias counts


class Judgement(StrEnum):
    """Is a difference real? The first two are judgements, the others say why there is none."""

    EXCEEDS_ERROR = "exceeds_error"
    INSIDE_ERROR = "inside_error"
    NOT_REPORTED = "withheld"
    TOO_FEW_STRIDES = "too_few_strides"
    NO_PUBLISHED_FIGURE = "no_published_figure"


@dataclass(frozen=True, slots=True)
class Difference:
    """One mean less another, the error it has to exceed to be real, and what that error contains.

    `difference` and `error` are NaN where not reported or not known; both are, of what is never compared.
    `is_worth_a_sentence`: it exceeds what a sentence on page one needs. `is_unverified`: the error rests on a figure
    whose source could not be read; `is_borrowed`: it is that of another joint or quantity.
    """

    difference: float
    error: float
    judgement: Judgement
    sources: tuple[ErrorSource, ...] = ()
    is_worth_a_sentence: bool = False
    is_unverified: bool = False
    is_borrowed: bool = False

    @property
    def exceeds(self) -> bool:
        return self.judgement is Judgement.EXCEEDS_ERROR

    @property
    def is_reported(self) -> bool:
        return math.isfinite(self.difference)

    @property
    def ratio(self) -> float:
        """How many errors it is large; 0 where it is not judged."""
        return abs(self.difference) / self.error if self.error > 0 and self.is_reported else 0.0


def sigma_of(name: str, kind: ComparisonKind) -> Sigma | None:
    """What lies between two means of a column in a comparison of a kind; None where no figure is known."""
    quantity = KINDS.get(name)
    if quantity is QuantityKind.TIME and kind is ComparisonKind.LEGS and name != "step_time_s":
        return None  # both feet make equally many strides
    return SIGMAS[kind].get(quantity) if quantity is not None else None


def compare(
    name: str,
    kind: ComparisonKind,
    one: MeanOfStrides,
    other: MeanOfStrides,
    assessments: tuple[Assessment, ...],
    *,
    speed_apart_m_s: float = 0.0,
    is_chosen_before: bool = False,
) -> Difference:
    """`one` less `other`: is it larger than its error?

    Parameters
    ----------
    name
        The column of strides.csv.
    assessments
        What may be stated about each of the two; where either is not reported there is no difference.
    speed_apart_m_s
        By how much the walks' speeds differ; what it alone may make of an angle or of stance is no difference.
    is_chosen_before
        The measure was chosen before the visit, as a goal is: a sentence then needs the error alone.

    Returns
    -------
    Difference
        In the unit of the column.
    """
    nothing = math.nan
    if any(not found.is_reported for found in assessments):
        return Difference(nothing, nothing, Judgement.NOT_REPORTED)
    if min(one.n, other.n) < MIN_STRIDES_FOR_MEAN:
        return Difference(nothing, nothing, Judgement.TOO_FEW_STRIDES)
    if KINDS.get(name) is QuantityKind.STANCE and any(found.is_toe_off_biased for found in assessments):
        return Difference(nothing, nothing, Judgement.NO_PUBLISHED_FIGURE)  # how late may change with the alignment
    difference = one.mean - other.mean
    if min(one.n, other.n) < MIN_STRIDES_FOR_SD:
        return Difference(difference, nothing, Judgement.TOO_FEW_STRIDES)
    sigma = sigma_of(name, kind)
    if sigma is None:
        return Difference(difference, nothing, Judgement.NO_PUBLISHED_FIGURE)
    between = sigma.value * (0.01 * 0.5 * abs(one.mean + other.mean) if sigma.is_relative else 1.0)
    by_speed = PER_SPEED.get(KINDS[name], 0.0) * abs(speed_apart_m_s)
    error = Z95 * math.sqrt(one.uncertainty**2 + other.uncertainty**2 + by_speed**2 + 2 * between**2)
    exceeds = abs(difference) > error
    factor = 1.0 if sigma.is_published_error or is_chosen_before else SENTENCE_FACTOR
    return Difference(
        difference=difference,
        error=error,
        judgement=Judgement.EXCEEDS_ERROR if exceeds else Judgement.INSIDE_ERROR,
        sources=_sources(name, kind, one, other, has_speed=by_speed > 0 and abs(speed_apart_m_s) >= SPEED_REPORTED_M_S),
        is_worth_a_sentence=abs(difference) > factor * error and not sigma.is_borrowed,
        is_unverified=not sigma.is_verified,
        is_borrowed=sigma.is_borrowed,
    )


def whisker(name: str, kind: ComparisonKind, found: MeanOfStrides) -> float:
    """Half of the error of a difference from a mean as sure: whiskers that lie apart differ by more than the error.

    Returns
    -------
    float
        In the unit of the column.
    """
    sigma = sigma_of(name, kind)
    if sigma is None or found.n < MIN_STRIDES_FOR_SD:
        return math.nan
    between = sigma.value * (0.01 * abs(found.mean) if sigma.is_relative else 1.0)
    return 0.5 * Z95 * math.sqrt(2 * found.uncertainty**2 + 2 * between**2)


def _sources(
    name: str, kind: ComparisonKind, one: MeanOfStrides, other: MeanOfStrides, *, has_speed: bool
) -> tuple[ErrorSource, ...]:
    quantity = KINDS[name]
    found = [ErrorSource.CHANCE, ErrorSource.DRIFT]
    if one.clock_error or other.clock_error:
        found.append(ErrorSource.CLOCK)
    if has_speed:
        found.append(ErrorSource.SPEED)
    if kind is ComparisonKind.LEGS and quantity in _OWN_LEG:
        return (*found, ErrorSource.EVENTS)
    found += _BETWEEN[kind]
    if quantity in _HEIGHTS and kind not in (ComparisonKind.HALVES, ComparisonKind.ATTACHED):
        found.append(ErrorSource.ZERO)
    return tuple(found)

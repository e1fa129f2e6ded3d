"""How large the difference of two means is likely to be, and what it exceeds: error, speed, healthy legs.

One mean has s^2 = u^2 + sigma^2, u found in `core.verdicts.stride_means` and sigma in `core.verdicts.sigmas`. Of a
difference d, S^2 = s1^2 + s2^2, and it is likely within d +- 1.96 S (95 of 100). Between legs there is the reference H
beside: what 95 of 100 healthy people differ by less, H^2 + 1.96^2 (u1^2 + u2^2) under the root. A change with walking
speed is what the slope makes of it; what is left has its own interval.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from statistics import NormalDist

from core.parameters import QuantityKind
from core.verdicts.model import Assessment
from core.verdicts.norms import MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD
from core.verdicts.sigmas import (
    HEALTHY_SOURCE,
    KINDS,
    SLOPE_SD,
    SLOPES,
    ComparisonKind,
    Sigma,
    healthy_between_legs,
    in_use,
    sigma_of,
)
from core.verdicts.stride_means import MeanOfStrides

Z95 = 1.96
ANGLE_PER_LAG_DEG_S = 400.0  # what a joint turns in swing: so much of its angle is at stake per second of lag
# How many errors a change needs on page one, which chooses among some 16 measures. Between days 1.2 made a false
# sentence in 20 of 267 simulated reports, 1.25 in 13; 1.5 would find 4 points of stance in 14 of 100 healthy people
# alone. With the sensors left on errors are small: 1.2 made one in 11 of 48, 1.65 in 3 and 1.75 in 2. Strapped again
# 1.5 makes 2 (tests.benchmarks.null_differences).
SENTENCE_FACTORS: Mapping[ComparisonKind, float] = {
    ComparisonKind.HALVES: 1.75,
    ComparisonKind.ATTACHED: 1.75,
    ComparisonKind.STRAPPINGS: 1.5,
    ComparisonKind.VISITS: 1.25,
}


class ErrorSource(StrEnum):
    """What an error contains; the words of differences.csv."""

    CHANCE = "chance"
    DRIFT = "drift"
    CLOCK = "clock"
    AXIS = "axis"
    WALKS = "walk_to_walk"
    STRAPS = "strapping"
    DAYS = "day"
    EVENTS = "event_bias"
    ZERO = "zero"


SPEED_REPORTED_M_S = 0.005  # as far apart two speeds must be to be written as two, and to be called so
Speeds = tuple[float, float]
"""Of the walks of two means, m/s; NaN where not known."""
UNKNOWN: Speeds = (math.nan, math.nan)

_BETWEEN: Mapping[ComparisonKind, tuple[ErrorSource, ...]] = {
    ComparisonKind.HALVES: (),
    ComparisonKind.ATTACHED: (ErrorSource.WALKS,),
    ComparisonKind.LEGS: (ErrorSource.STRAPS,),
    ComparisonKind.STRAPPINGS: (ErrorSource.WALKS, ErrorSource.STRAPS),
    ComparisonKind.VISITS: (ErrorSource.WALKS, ErrorSource.STRAPS, ErrorSource.DAYS),
}
_HEIGHTS = (QuantityKind.KNEE_HEIGHT, QuantityKind.ANKLE_HEIGHT, QuantityKind.SEGMENT_HEIGHT)
_OWN_LEG = (QuantityKind.STANCE, QuantityKind.TIME)  # between legs the events' bias counts


class Mark(StrEnum):
    """What a difference is beyond, as tables mark it; the words of differences.csv."""

    NONE = ""
    ERROR = "beyond_error"
    HEALTHY = "beyond_healthy"
    """Of legs: beyond error, and beyond what 95 of 100 healthy people differ by."""


class Judgement(StrEnum):
    """Is a difference real? The first two are judgements, the others state why there is none."""

    EXCEEDS_ERROR = "exceeds_error"
    INSIDE_ERROR = "inside_error"
    NOT_REPORTED = "withheld"
    TOO_FEW_STRIDES = "too_few_strides"
    NO_PUBLISHED_FIGURE = "no_published_figure"


@dataclass(frozen=True, slots=True)
class SpeedPart:
    """What of a change goes with another walking speed, and the rest with half of its interval; in the quantity's unit.

    `speed_change_m_s`: by how much the first walk is faster.
    """

    of_speed: float
    beyond: float
    error: float
    speed_change_m_s: float
    is_unverified: bool = False


@dataclass(frozen=True, slots=True)
class Difference:
    """One mean less another, half of its likely interval, what it exceeds, and what the interval contains.

    `difference` and `error` are NaN where not reported or not known; both are, of what is never compared.
    `healthy`, between legs: what 95 of 100 healthy people measured as surely differ by less; NaN where not known.
    `by_speed`: None where the quantity has no slope, or a speed is not known or the same.
    `is_worth_a_sentence`: it exceeds what a sentence on page one needs. `is_unverified`: the error rests on a figure
    whose source could not be read.
    """

    difference: float
    error: float
    judgement: Judgement
    sources: tuple[ErrorSource, ...] = ()
    mark: Mark = Mark.NONE
    healthy: float = math.nan
    by_speed: SpeedPart | None = None
    is_worth_a_sentence: bool = False
    is_unverified: bool = False

    @property
    def exceeds(self) -> bool:
        return self.judgement is Judgement.EXCEEDS_ERROR

    @property
    def is_reported(self) -> bool:
        return math.isfinite(self.difference)

    @property
    def is_judged(self) -> bool:
        """Whether it has an interval."""
        return self.judgement in (Judgement.EXCEEDS_ERROR, Judgement.INSIDE_ERROR) and self.error > 0

    @property
    def interval(self) -> tuple[float, float]:
        """Where the true difference is likely to be, in 95 of 100 such measurements; NaN where not known."""
        return self.difference - self.error, self.difference + self.error

    @property
    def ratio(self) -> float:
        """How many errors it is large; 0 where it is not judged."""
        return abs(self.difference) / self.error if self.is_judged else 0.0

    def share_of_at_least(self, limit: float) -> float:
        """Give the share (0 to 1, flat prior) with difference at least `limit`; NaN where it is not judged."""
        if not self.is_judged:
            return math.nan
        return NormalDist().cdf((abs(self.difference) - limit) / (self.error / Z95))


def compare(
    name: str,
    kind: ComparisonKind,
    one: MeanOfStrides,
    other: MeanOfStrides,
    assessments: tuple[Assessment, ...],
    *,
    speeds_m_s: Speeds = UNKNOWN,
    is_chosen_before: bool = False,
) -> Difference:
    """Subtract `other` from `one`; no difference where either is not reported in `assessments`.

    `speeds_m_s`: slow walks repeat less well, and what another speed makes is taken out beside. `is_chosen_before`:
    the measure was chosen before the visit, as a goal is, so that a sentence needs the error alone.
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
    own = math.hypot(one.uncertainty, other.uncertainty)
    between, is_verified = _apart(name, kind, sigma, (one.mean, other.mean), speeds_m_s)
    limit = healthy_between_legs(name) if kind is ComparisonKind.LEGS else nothing
    error, healthy = Z95 * math.hypot(own, between), math.hypot(limit, Z95 * own)
    exceeds = abs(difference) > error
    mark = Mark.HEALTHY if exceeds and abs(difference) > healthy else Mark.ERROR if exceeds else Mark.NONE
    factor = 1.0 if is_chosen_before else SENTENCE_FACTORS.get(kind, 1.0)
    is_change_worth = kind is not ComparisonKind.LEGS and abs(difference) > factor * error
    by_speed = (
        None if kind is ComparisonKind.LEGS else _by_speed(name, difference, own, sigma, (one, other), speeds_m_s)
    )
    return Difference(
        difference=difference,
        error=error,
        judgement=Judgement.EXCEEDS_ERROR if exceeds else Judgement.INSIDE_ERROR,
        sources=_sources(name, kind, one, other),
        mark=mark,
        healthy=healthy,
        by_speed=by_speed,
        is_worth_a_sentence=is_change_worth or mark is Mark.HEALTHY,
        is_unverified=not is_verified,
    )


def least_error(name: str, kind: ComparisonKind, mean: float) -> tuple[float, bool]:
    """Give what two means of this size differ by within error, NaN if unknown, and if its source is verified."""
    sigma = sigma_of(name, kind)
    if sigma is None:
        return math.nan, True
    between, is_verified = _apart(name, kind, sigma, (mean, mean), UNKNOWN)
    return Z95 * between, is_verified


def _apart(
    name: str, kind: ComparisonKind, sigma: Sigma, means: tuple[float, float], speeds_m_s: Speeds
) -> tuple[float, bool]:
    """What lies between two means, one SD, and whether its source is verified."""
    # attachment parts a person's legs by no more than healthy people's, whose natural asymmetry is in theirs
    found = math.hypot(*(sigma.of(mean, speed) for mean, speed in zip(means, speeds_m_s, strict=True)))
    limit = healthy_between_legs(name) / Z95 if kind is ComparisonKind.LEGS else math.nan
    return (limit, HEALTHY_SOURCE.is_verified) if limit < found else (found, sigma.is_verified)


def _by_speed(
    name: str, difference: float, own: float, sigma: Sigma, means: tuple[MeanOfStrides, MeanOfStrides], speeds: Speeds
) -> SpeedPart | None:
    slope, change_m_s = SLOPES.get(name), speeds[0] - speeds[1]
    if slope is None or not abs(change_m_s) >= SPEED_REPORTED_M_S:
        return None
    of_speed = slope.at(0.5 * sum(speeds)) * change_m_s
    sigmas = [sigma.of(found.mean, speed) for found, speed in zip(means, speeds, strict=True)]
    if slope.sigma is not None and in_use().study is None:  # what an own study found holds no part by speed
        sigmas = [min(one, slope.sigma) for one in sigmas]
    error = Z95 * math.hypot(own, *sigmas, SLOPE_SD * of_speed)
    is_unverified = not (slope.source.is_verified and sigma.is_verified)
    return SpeedPart(of_speed, difference - of_speed, error, change_m_s, is_unverified)


def whisker(name: str, kind: ComparisonKind, found: MeanOfStrides, speed_m_s: float = math.nan) -> float:
    """Give half the error of a difference from a mean as sure; whiskers that lie apart differ by more."""
    sigma = sigma_of(name, kind)
    if sigma is None or found.n < MIN_STRIDES_FOR_SD:
        return math.nan
    return 0.5 * Z95 * math.sqrt(2) * math.hypot(found.uncertainty, sigma.of(found.mean, speed_m_s))


def _sources(name: str, kind: ComparisonKind, one: MeanOfStrides, other: MeanOfStrides) -> tuple[ErrorSource, ...]:
    quantity = KINDS[name]
    found = [ErrorSource.CHANCE, ErrorSource.DRIFT]
    if one.clock_error or other.clock_error:
        found.append(ErrorSource.CLOCK)
    if one.axis_error or other.axis_error:
        found.append(ErrorSource.AXIS)
    if kind is ComparisonKind.LEGS and quantity in _OWN_LEG:
        return (*found, ErrorSource.EVENTS)
    found += _BETWEEN[kind]
    if quantity in _HEIGHTS and kind not in (ComparisonKind.HALVES, ComparisonKind.ATTACHED):
        found.append(ErrorSource.ZERO)
    return tuple(found)

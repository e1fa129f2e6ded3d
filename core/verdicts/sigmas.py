"""The one table of what repeated measurements of the same person differ by, each figure with source, people and n.

A sigma is the standard deviation of one mean, beside what its own strides show of its uncertainty. Slopes are what a
quantity changes by with walking speed; healthy limits are what 95 of 100 healthy people's legs differ by less. A clinic
may judge by figures of its own study instead (`core.verdicts.repeatability`); the published table stays as it is.
"""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from core.parameters import REGISTRY, STEP_TIME, QuantityKind

SLOW_M_S = 0.8  # slower, people after a stroke repeat their walk less well


class ComparisonKind(StrEnum):
    """What lies between two means."""

    HALVES = "halves"
    ATTACHED = "attached"
    LEGS = "legs"
    STRAPPINGS = "strappings"
    VISITS = "visits"


# by the columns of strides.csv and of `both`; what is missing is not judged
KINDS = {quantity.column: quantity.error for quantity in REGISTRY if quantity.error is not None}


class Source(NamedTuple):
    """Where a figure comes from: of how many people (0: not known), and whether its source was read or measured."""

    text: str
    people: str
    n: int
    is_verified: bool = True


@dataclass(frozen=True, slots=True)
class Sigma:
    """The standard deviation of one mean: a constant in the quantity's unit, and a share of the mean's size in percent.

    `slow`: both below SLOW_M_S, where they are others. `least`: what it is never below. What rests on a source that is
    not verified prints a dagger.
    """

    source: Source
    constant: float = 0.0
    share_percent: float = 0.0
    slow: tuple[float, float] | None = None
    least: "Sigma | None" = None

    @property
    def is_verified(self) -> bool:
        return self.source.is_verified

    def of(self, mean: float, speed_m_s: float = math.nan) -> float:
        """Give sigma for a mean of this size and speed; an unknown speed is not taken as slow."""
        is_slow = self.slow is not None and speed_m_s < SLOW_M_S
        constant, share = self.slow if is_slow and self.slow is not None else (self.constant, self.share_percent)
        found = math.hypot(constant, 0.01 * share * mean)
        return found if self.least is None else max(found, self.least.of(mean, speed_m_s))


_TWO_VISITS = Source(
    "two visits, foot sensors (Felius et al., Zenodo 10.5281/zenodo.11044903)", "25 healthy, 23 after a stroke", 48
)
_ONE_SESSION = Source("repeated walks, sensors left on, our analysis of foot sensors", "healthy, another laboratory", 0)
_KNEES = Source(
    "two days, another maker's sensors (Elias 2018, github arlindoelias/Sensor_reliability_study), and simulated "
    "strappings",
    "14 healthy",
    14,
)
_WALKS = Source("repeated walks of one strapping, simulated", "simulated", 36)
_ANKLES = Source(
    "no figure of this method: another maker's sensors gave 2.8 to 5 deg on two days", "14 healthy", 14, False
)
_OF_KNEE = Source("that of the knee, for want of one of segments", "14 healthy", 14, False)
_OF_STANCE = Source("that of stance, for want of one", "25 healthy, 23 after a stroke", 48, False)
_LEGS = Source("left against right, our analysis of walks, natural asymmetry and strapping included", "healthy", 40)
_BIAS = Source("events 10 ms early or late, alike in every stride of one leg: an estimate", "nobody", 0, False)
_FUKUCHI = Source("slow to fast walking (Fukuchi et al. 2018, doi 10.7717/peerj.4640)", "42 adults", 42, False)

_Q = QuantityKind
_STRAPPED_AGAIN: Mapping[QuantityKind, Sigma] = {
    _Q.STANCE: Sigma(_TWO_VISITS, 1.1, slow=(1.5, 0.0)),
    _Q.TIME: Sigma(_TWO_VISITS, share_percent=2.7, slow=(0.0, 5.5)),
    _Q.SPEED: Sigma(_TWO_VISITS, 0.065),
    _Q.LENGTH: Sigma(_TWO_VISITS, 0.045, slow=(0.055, 0.0)),
    _Q.FOOT_PITCH: Sigma(_TWO_VISITS, 2.0),
    _Q.HEEL_RISE: Sigma(_TWO_VISITS, 3.2),
    _Q.FOOT_FLAT: Sigma(_TWO_VISITS, 4.8),
    # 4.3: with 4.0 range and stance to swing of 144 simulated pairs on two days differed by 1.06 SD (root mean square),
    # with 4.3 by 1.01 (tests.benchmarks.null_differences)
    _Q.KNEE_SHAPE: Sigma(_KNEES, 1.2, 4.3),
    _Q.KNEE_HEIGHT: Sigma(_KNEES, 2.2, 4.0),
    _Q.KNEE_STRAIGHTENING: Sigma(_KNEES, 2.4),
    _Q.ANKLE_SHAPE: Sigma(_ANKLES, 3.3),
    _Q.ANKLE_HEIGHT: Sigma(_ANKLES, 4.5),
    _Q.SEGMENT_SHAPE: Sigma(_OF_KNEE, 1.2, 4.3),
    _Q.SEGMENT_HEIGHT: Sigma(_OF_KNEE, 2.2, 4.0),
    _Q.KNEE_TIMING: Sigma(_OF_STANCE, 1.1, slow=(1.5, 0.0)),
}
_LEFT_ON: Mapping[QuantityKind, Sigma] = {
    _Q.STANCE: Sigma(_ONE_SESSION, 0.55),
    _Q.TIME: Sigma(_ONE_SESSION, share_percent=2.2),
    _Q.SPEED: Sigma(_ONE_SESSION, 0.045),
    _Q.LENGTH: Sigma(_ONE_SESSION, 0.022),
    _Q.FOOT_PITCH: Sigma(_ONE_SESSION, 0.5),
    _Q.HEEL_RISE: Sigma(_ONE_SESSION, 0.9),
    _Q.FOOT_FLAT: Sigma(_ONE_SESSION, 4.0),
    _Q.KNEE_SHAPE: Sigma(_WALKS, 1.0),
    _Q.KNEE_HEIGHT: Sigma(_WALKS, 1.2),
    _Q.KNEE_STRAIGHTENING: Sigma(_WALKS, 1.0),
    _Q.ANKLE_SHAPE: Sigma(_WALKS, 1.0),
    _Q.ANKLE_HEIGHT: Sigma(_WALKS, 1.2),
    _Q.SEGMENT_SHAPE: Sigma(_OF_KNEE, 1.0),
    _Q.SEGMENT_HEIGHT: Sigma(_OF_KNEE, 1.2),
    _Q.KNEE_TIMING: Sigma(_OF_STANCE, 0.55),
    _Q.SET_ANGLE: Sigma(_WALKS, 0.25),
}
_NOTHING = Sigma(Source("one recording: nothing lies between", "one", 1))
_STEPS = Sigma(_BIAS, 0.018)  # of step time; each mean with its own leg's events

SIGMAS: Mapping[ComparisonKind, Mapping[QuantityKind, Sigma]] = {
    ComparisonKind.HALVES: dict.fromkeys(QuantityKind, _NOTHING),
    ComparisonKind.ATTACHED: _LEFT_ON,
    # each leg has a strapping of its own; what both legs share says nothing, and feet travel equally far
    ComparisonKind.LEGS: {
        kind: found for kind, found in _STRAPPED_AGAIN.items() if kind not in (_Q.SPEED, _Q.LENGTH, _Q.TIME)
    },
    ComparisonKind.STRAPPINGS: _STRAPPED_AGAIN,
    ComparisonKind.VISITS: _STRAPPED_AGAIN,
}


def sigma_of(column: str, kind: ComparisonKind) -> Sigma | None:
    """What lies between two means of a column in a comparison of a kind; None where no figure is known."""
    quantity = KINDS.get(column)
    if quantity is None:
        return None
    if kind is ComparisonKind.LEGS and column == STEP_TIME:
        return _STEPS
    return _in_use.sigmas[kind].get(quantity)


def healthy_between_legs(column: str) -> float:
    """Give what 95 of 100 healthy people's legs differ by less, less chance; NaN where not known."""
    return _in_use.healthy.get(column, math.nan)


@dataclass(frozen=True, slots=True)
class SpeedSlope:
    """What a quantity changes by, per m/s, below SLOW_M_S and above it, and what one mean differs by beside speed."""

    slow: float
    other: float
    source: Source
    sigma: float | None = None

    def at(self, speed_m_s: float) -> float:
        """Give the slope about this speed, in the quantity's unit per m/s."""
        return self.slow if speed_m_s < SLOW_M_S else self.other


SLOPE_SD = 0.3  # of a slope: people's differ by so much of it
SLOPES: Mapping[str, SpeedSlope] = {
    "stance_percent": SpeedSlope(-18.0, -5.0, _TWO_VISITS, 1.1),
    "swing_percent": SpeedSlope(18.0, 5.0, _TWO_VISITS, 1.1),
    "foot_pitch_at_contact_deg": SpeedSlope(12.0, 8.0, _TWO_VISITS, 1.8),
    "foot_heel_rise_deg": SpeedSlope(33.0, 15.0, _TWO_VISITS, 2.6),
    "stride_length_m": SpeedSlope(0.86, 0.58, _TWO_VISITS),
    "knee_range_deg": SpeedSlope(11.0, 11.0, _FUKUCHI),
    "knee_stance_to_swing_deg": SpeedSlope(11.0, 11.0, _FUKUCHI),
    "knee_swing_peak_deg": SpeedSlope(11.0, 11.0, _FUKUCHI),
}

HEALTHY_SOURCE = _LEGS
HEALTHY_BETWEEN_LEGS: Mapping[str, float] = {  # in the unit of the column, less what chance makes of it
    "stance_percent": 4.0,
    "swing_percent": 4.0,
    "foot_pitch_at_contact_deg": 6.1,
    "foot_heel_rise_deg": 8.5,
    "foot_flat_percent": 8.5,
    "knee_range_deg": 10.2,
    "knee_stance_to_swing_deg": 10.5,
    "knee_while_loading_deg": 4.4,
    "knee_straightening_deg": 2.8,
    "knee_at_initial_contact_deg": 7.8,
    "knee_loading_peak_deg": 8.1,
    "knee_stance_minimum_deg": 8.3,
    "knee_swing_peak_deg": 13.5,
    "ankle_range_deg": 6.2,
    "ankle_rocker_deg": 6.4,
    "ankle_push_off_deg": 7.7,
    "ankle_toes_lifted_deg": 7.0,
    "ankle_heel_rocker_deg": 4.6,
    "ankle_at_initial_contact_deg": 7.9,
    "ankle_stance_dorsiflexion_deg": 6.1,
    "ankle_push_off_plantarflexion_deg": 10.4,
    "ankle_swing_dorsiflexion_deg": 10.0,
}


class OwnStudy(NamedTuple):
    """Whose figures are in use: of how many people, until which day (ISO 8601, empty: not known)."""

    people: int
    day: str = ""


@dataclass(frozen=True, slots=True)
class ErrorFigures:
    """What differences are judged by. `study`: the clinic's own that they are of; None: as published."""

    sigmas: Mapping[ComparisonKind, Mapping[QuantityKind, Sigma]]
    healthy: Mapping[str, float]
    study: OwnStudy | None = None


PUBLISHED = ErrorFigures(SIGMAS, HEALTHY_BETWEEN_LEGS)
_in_use = PUBLISHED


def use(figures: ErrorFigures) -> None:
    """Judge by these from now on, in all threads of this process: those of the library that is open."""
    global _in_use
    _in_use = figures


def in_use() -> ErrorFigures:
    """What differences are judged by now."""
    return _in_use


@contextmanager
def using(figures: ErrorFigures) -> Iterator[None]:
    """Judge by these for as long as is needed, then as before."""
    before = in_use()
    use(figures)
    try:
        yield
    finally:
        use(before)

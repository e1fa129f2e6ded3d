"""Reference bands of cited groups, each with its source, ages, n and speed.

Nothing here is called normal: laboratories differ by 5 to 7 deg in offset, and speed changes every curve. The figures
are files of `resources`; this module is given their text.
"""

import csv
import math
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from core.body import JointKind
from core.gait.cycles import POINTS
from core.gait.spatiotemporal import MeanAndSd
from core.samples import GRAVITY_M_S2, FloatArray

MAX_SPEED_DIFFERENCE_M_S = 0.15  # further from its speed, the band of curves is not drawn
SPEED_CLASSES = ("slow", "comfortable", "fast")
FROUDE_LIMITS = (0.1304, 0.2306)  # where one class ends and the next begins: terciles of the source's walks
LEG_PER_HEIGHT = 0.53  # nobody types the length of a leg
LEG_LENGTHS_M = (0.75, 1.00)  # of adults, where nobody typed a height either
ADULT_FROM_YEARS = 18  # every band there is was measured on adults
KNEE_OVERREAD = 1.09  # so much more flexion do we read than optical markers, 9 +- 4 %
MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD = 3, 10
# What a judgement against a band adds to its sd, in the parameter's unit: the repeat error of a mean, and for stance
# the bias of events. With 1.6 points, as three laboratories lie apart, 14 % of 50 healthy walks lay beyond 2 SD, with
# 2.8 points 4 %. Of a step half a stride's.
OWN_SD: Mapping[str, tuple[float, ...]] = {"stance": (1.1, 2.8), "step_length": (0.5 * 0.045,)}

PUBLISHED = "Fukuchi, Fukuchi & Duarte 2018, PeerJ 6:e4640, data doi 10.6084/m9.figshare.5722711, CC BY 4.0"


@dataclass(frozen=True, slots=True)
class ReferenceCurves:
    """Mean and standard deviation between subjects (101,), degrees; flexion and dorsiflexion positive.

    `derivation`: who made these figures of what is PUBLISHED.
    The zero of the hip is that of the pelvis's markers, some 10 deg from standing: its curve shows a shape alone.
    """

    derivation: str
    group: str
    n: int
    ages_years: tuple[int, int]
    speed_m_s: float
    leg_length_m: float
    knee_mean_deg: FloatArray
    knee_sd_deg: FloatArray
    ankle_mean_deg: FloatArray
    ankle_sd_deg: FloatArray
    hip_mean_deg: FloatArray
    hip_sd_deg: FloatArray

    @property
    def source(self) -> str:
        """In English, as files have it."""
        return _source(self.derivation)

    @property
    def speed_class(self) -> str:
        return _class_of(froude_number(self.speed_m_s, self.leg_length_m))

    def is_near(self, speed_m_s: float) -> bool:
        """Whether a walk is as fast as the group's, within MAX_SPEED_DIFFERENCE_M_S."""
        return abs(speed_m_s - self.speed_m_s) <= MAX_SPEED_DIFFERENCE_M_S

    def mean_and_sd_deg(self, kind: str) -> tuple[FloatArray, FloatArray]:
        """Of the hip, the knee or the ankle."""
        of_kind = {
            JointKind.HIP: (self.hip_mean_deg, self.hip_sd_deg),
            JointKind.KNEE: (self.knee_mean_deg, self.knee_sd_deg),
            JointKind.ANKLE: (self.ankle_mean_deg, self.ankle_sd_deg),
        }
        return of_kind[JointKind(kind)]


@dataclass(frozen=True, slots=True)
class ReferenceValues:
    """Time and distance of one class of speed; `values` holds mean and sd between `n` subjects by parameter."""

    derivation: str
    group: str
    speed_class: str
    n: int
    values: Mapping[str, MeanAndSd]

    def judged(self, parameter: str) -> MeanAndSd:
        """Give mean and sd of a parameter, the sd widened by what our own measurement adds (OWN_SD)."""
        found = self.values[parameter]
        return MeanAndSd(found.mean, math.hypot(found.sd, *OWN_SD.get(parameter, ())), found.n)

    @property
    def source(self) -> str:
        """As `ReferenceCurves.source`."""
        return _source(self.derivation)

    @property
    def speed_m_s(self) -> float:
        """The group's mean walking speed."""
        return self.values["walking_speed"].mean


def _source(derivation: str) -> str:
    return f"{PUBLISHED}, as derived by {derivation}"


def read_curves(of_knee_and_ankle: str, of_hip: str) -> ReferenceCurves:
    """Read the texts of fukuchi2018_young_treadmill_comfortable_knee_ankle.csv and ..._hip.csv."""
    rows, hip_rows = _table(of_knee_and_ankle), _table(of_hip)
    for one in (rows, hip_rows):
        if len(one) != POINTS:
            raise ValueError(f"reference curves have {len(one)} rows, expected {POINTS}")

    def column(name: str) -> FloatArray:
        return np.array([float(row[name]) for row in (hip_rows if name.startswith("hip") else rows)])

    return ReferenceCurves(
        derivation="github VIONWILLIAMS/EXO-Forge-Studio",
        group="young adults, barefoot, treadmill",
        n=24,
        ages_years=(18, 39),  # "young adults", in the words of the source
        speed_m_s=1.245,
        leg_length_m=0.878,
        knee_mean_deg=column("knee_mean"),
        knee_sd_deg=column("knee_sd"),
        ankle_mean_deg=column("ankle_mean"),
        ankle_sd_deg=column("ankle_sd"),
        hip_mean_deg=column("hip_mean"),
        hip_sd_deg=column("hip_sd"),
    )


def read_time_distance(text: str) -> tuple[ReferenceValues, ...]:
    """From the text of fukuchi2018_spatiotemporal_overground_by_froude_class.csv, slow to fast."""
    rows = _table(text)
    return tuple(
        ReferenceValues(
            derivation="github antsal06/openacl",
            group="42 adults, 24 young and 18 older, barefoot, overground",
            speed_class=speed_class,
            n=n,
            values={
                row["parameter"]: MeanAndSd(float(row[f"{speed_class}_mean"]), float(row[f"{speed_class}_sd"]), n)
                for row in rows
            },
        )
        for speed_class, n in zip(SPEED_CLASSES, (34, 32, 19), strict=True)
    )


class AgeAndHeight(NamedTuple):
    """What of a patient chooses a band; None where nobody typed it."""

    age_years: int | None = None
    height_m: float | None = None


class NoBand(StrEnum):
    """Why no band is shown beside a walk."""

    CHILD = "child"
    SPEED_UNKNOWN = "speed_unknown"
    HEIGHT_MISSING = "height_missing"
    OTHER_SPEED = "other_speed"


@dataclass(frozen=True, slots=True)
class Bands:
    """The groups that a walk may stand beside: of curves and of time and distance, or why there is none.

    `are_curves_of_other_ages`: the curves may be looked at, but nothing is stated about a distance from them.
    """

    curves: ReferenceCurves | None
    values: ReferenceValues | None
    why_no_curves: NoBand | None = None
    why_no_values: NoBand | None = None
    are_curves_of_other_ages: bool = False


def froude_number(speed_m_s: float, leg_length_m: float) -> float:
    """Give speed relative to leg length, without unit: short and tall people who walk alike have one number."""
    return speed_m_s**2 / (GRAVITY_M_S2 * leg_length_m)


def class_of_speed(speed_m_s: float, height_m: float | None) -> str | None:
    """Give slow, comfortable or fast; None where without a height adult legs leave it open."""
    lengths_m = LEG_LENGTHS_M if height_m is None else (LEG_PER_HEIGHT * height_m,)
    found = {_class_of(froude_number(speed_m_s, length_m)) for length_m in lengths_m}
    return found.pop() if len(found) == 1 else None


def choose_bands(
    curves: ReferenceCurves, classes: tuple[ReferenceValues, ...], speed_m_s: float, who: AgeAndHeight
) -> Bands:
    """Choose the bands of adults who walked as fast for their legs; curves also near in speed."""
    if who.age_years is not None and who.age_years < ADULT_FROM_YEARS:
        return Bands(None, None, NoBand.CHILD, NoBand.CHILD)
    if not np.isfinite(speed_m_s):
        return Bands(None, None, NoBand.SPEED_UNKNOWN, NoBand.SPEED_UNKNOWN)
    name = class_of_speed(speed_m_s, who.height_m)
    if name is None:
        return Bands(None, None, NoBand.HEIGHT_MISSING, NoBand.HEIGHT_MISSING)
    values = next(group for group in classes if group.speed_class == name)
    if name != curves.speed_class or not curves.is_near(speed_m_s):
        return Bands(None, values, NoBand.OTHER_SPEED)
    youngest, oldest = curves.ages_years
    is_of_other_ages = who.age_years is not None and not youngest <= who.age_years <= oldest
    return Bands(curves, values, are_curves_of_other_ages=is_of_other_ages)


def height_offset_deg(curve_deg: FloatArray, group_mean_deg: FloatArray) -> float:
    """Give the median by which a curve (101,) lies above its group's: its height as a whole."""
    return float(np.median(curve_deg - group_mean_deg))


def peak_away_sd(
    value_deg: float, curve_deg: FloatArray, band: tuple[FloatArray, FloatArray], at: int, kind: str
) -> float:
    """Give how many group SD a peak lies from a band at its curve's height: only the shape counts.
    A knee takes the smaller of as measured and divided by KNEE_OVERREAD, 0 where their signs differ.
    """
    mean_deg, sd_deg = band

    def away(divisor: float) -> float:
        offset_deg = height_offset_deg(curve_deg / divisor, mean_deg)
        return float((value_deg / divisor - offset_deg - mean_deg[at]) / sd_deg[at])

    found = (away(1.0), away(KNEE_OVERREAD if kind == "knee" else 1.0))
    return min(found, key=abs) if found[0] * found[1] > 0 else 0.0


def _class_of(froude: float) -> str:
    return SPEED_CLASSES[bisect_right(FROUDE_LIMITS, froude)]


def _table(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(line for line in text.splitlines() if line and not line.startswith("#")))

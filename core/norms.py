"""What do others walk like? Cited groups, each with its source, ages, n and speed.

Nothing here is called normal: laboratories differ by 5 to 7 deg in offset, and speed changes every curve. The figures
are files of `resources`; this module is given their text.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.gait.cycles import POINTS
from core.gait.spatiotemporal import MeanAndSd
from core.samples import FloatArray

MAX_SPEED_DIFFERENCE_M_S = 0.15  # further from its speed, a band is not drawn without saying so
MIN_STRIDES_FOR_MEAN, MIN_STRIDES_FOR_SD = 3, 10

SOURCE = (
    "Fukuchi, Fukuchi & Duarte 2018, PeerJ 6:e4640, data doi 10.6084/m9.figshare.5722711, CC BY 4.0, "
    "as derived by {derivation}"
)


@dataclass(frozen=True, slots=True)
class ReferenceCurves:
    """Mean and standard deviation between subjects (101,), degrees, knee flexion and ankle dorsiflexion positive."""

    source: str
    group: str
    n: int
    speed_m_s: float
    knee_mean_deg: FloatArray
    knee_sd_deg: FloatArray
    ankle_mean_deg: FloatArray
    ankle_sd_deg: FloatArray

    def fits(self, speed_m_s: float) -> bool:
        return abs(speed_m_s - self.speed_m_s) <= MAX_SPEED_DIFFERENCE_M_S


@dataclass(frozen=True, slots=True)
class ReferenceValues:
    """Time and distance of one class of speed; `values` holds mean and sd between `n` subjects by parameter."""

    source: str
    group: str
    speed_class: str
    n: int
    values: Mapping[str, MeanAndSd]

    @property
    def speed_m_s(self) -> float:
        return self.values["walking_speed"].mean


def read_curves(text: str) -> ReferenceCurves:
    """From the text of fukuchi2018_young_treadmill_comfortable_knee_ankle.csv.

    Raises
    ------
    ValueError
        The table has not 101 rows.
    """
    rows = _table(text)
    if len(rows) != POINTS:
        raise ValueError(f"reference curves have {len(rows)} rows, expected {POINTS}")

    def column(name: str) -> FloatArray:
        return np.array([float(row[name]) for row in rows])

    return ReferenceCurves(
        source=SOURCE.format(derivation="github VIONWILLIAMS/EXO-Forge-Studio"),
        group="young adults, barefoot, treadmill",
        n=24,
        speed_m_s=1.245,
        knee_mean_deg=column("knee_mean"),
        knee_sd_deg=column("knee_sd"),
        ankle_mean_deg=column("ankle_mean"),
        ankle_sd_deg=column("ankle_sd"),
    )


def read_time_distance(text: str) -> tuple[ReferenceValues, ...]:
    """From the text of fukuchi2018_spatiotemporal_overground_by_froude_class.csv, slow to fast."""
    rows = _table(text)
    return tuple(
        ReferenceValues(
            source=SOURCE.format(derivation="github antsal06/openacl"),
            group="42 adults, 24 young and 18 older, barefoot, overground",
            speed_class=speed_class,
            n=n,
            values={
                row["parameter"]: MeanAndSd(float(row[f"{speed_class}_mean"]), float(row[f"{speed_class}_sd"]), n)
                for row in rows
            },
        )
        for speed_class, n in (("slow", 34), ("comfortable", 32), ("fast", 19))
    )


def nearest_class(classes: tuple[ReferenceValues, ...], speed_m_s: float) -> ReferenceValues:
    """The class whose mean speed is nearest; whether it is near enough is the reader's to see."""
    return min(classes, key=lambda reference: abs(reference.speed_m_s - speed_m_s))


def _table(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(line for line in text.splitlines() if line and not line.startswith("#")))

"""Time and distance of both feet's strides, and how much they vary."""

from dataclasses import dataclass

import numpy as np

from core.gait.strides import Strides
from core.samples import FloatArray

MIN_STRIDES_FOR_SD = 2


@dataclass(frozen=True, slots=True)
class MeanAndSd:
    """Over `n` strides; NaN where there are none (mean) or fewer than two (sd)."""

    mean: float
    sd: float
    n: int


@dataclass(frozen=True, slots=True)
class BothFeet:
    """What needs both feet; NaN where it cannot be determined."""

    cadence_steps_min: float
    double_support_percent: float
    speed_m_s: float


def parameters_of(strides: Strides, other: Strides | None) -> dict[str, FloatArray]:
    """Compute time and distance of each stride (k,), named as in strides.csv; `clearance_m`: of the sensor."""
    return {
        "stride_time_s": strides.time_s,
        "step_time_s": _step_times(strides, other),
        "stance_percent": strides.stance_percent,
        "swing_percent": 100.0 - strides.stance_percent,
        "stride_length_m": strides.length_m,
        "speed_m_s": strides.speed_m_s,
        "clearance_m": strides.clearance_m,
    }


def mean_and_sd(values: FloatArray) -> MeanAndSd:
    """Compute mean and standard deviation of the finite values (k,)."""
    known = values[np.isfinite(values)]
    mean = float(np.mean(known)) if len(known) else float("nan")
    sd = float(np.std(known, ddof=1)) if len(known) >= MIN_STRIDES_FOR_SD else float("nan")
    return MeanAndSd(mean, sd, len(known))


def both_feet(left: Strides, right: Strides) -> BothFeet:
    """Summarise the used strides of both feet, or of one; double support needs no common clock."""
    used = [(strides, strides.is_used) for strides in (left, right)]
    times = [float(np.mean(s.time_s[is_used])) for s, is_used in used if is_used.any()]
    speeds = np.array([mean_and_sd(s.speed_m_s[is_used]).mean for s, is_used in used])  # a shank gives none
    stances = [mean_and_sd(s.stance_percent[is_used]).mean for s, is_used in used]
    return BothFeet(
        cadence_steps_min=120.0 / float(np.mean(times)) if times else float("nan"),
        double_support_percent=sum(stances) - 100.0,
        speed_m_s=mean_and_sd(speeds).mean,
    )


def _step_times(strides: Strides, other: Strides | None) -> FloatArray:
    if other is None or not len(other):
        return np.full(len(strides), np.nan)
    contacts = np.unique(np.concatenate([other.start_s, other.end_s]))
    last = np.searchsorted(contacts, strides.end_s) - 1
    contact = np.where(last >= 0, contacts[np.maximum(last, 0)], np.nan)
    return np.where(contact > strides.start_s, strides.end_s - contact, np.nan)

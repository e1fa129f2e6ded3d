"""Angles over time with gaps, and their rates, as both systems of a comparison give them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from core.body import Joint
from core.samples import FloatArray

MAX_GAP_S = 0.05  # no curve is continued across a longer one, as in angles.csv,
EVEN_STEPS = 1.5  # but for one sampled so rarely, up to
LONGEST_STEP_S = 0.051  # 20 times a second, whose steps are a little over the limit as often as under it
GRID_HZ = 100.0
CUT_OFF_HZ = 6.0  # walking has its power below; tissue and markers ring above
FILTER_ORDER = 2
EDGE_S = 0.15  # the filter's own border, half a period of its cut-off and more
MIN_STRETCH_S = 0.6  # both borders, and something between


@dataclass(frozen=True, slots=True)
class TimedAngle:
    """One joint's angle on one system's clock, (n,) seconds ascending and radians; NaN in gaps.

    Turns beyond half a circle are taken out by whoever compares.
    """

    time_s: FloatArray
    angle_rad: FloatArray

    def __post_init__(self) -> None:
        if self.time_s.shape != self.angle_rad.shape or self.time_s.ndim != 1:
            raise ValueError(f"time_s has shape {self.time_s.shape}, angle_rad {self.angle_rad.shape}")


@dataclass(frozen=True, slots=True)
class ComparedTrial:
    """One walk as measured and as the reference has it, each by joint and on its own clock."""

    measured: Mapping[Joint, TimedAngle]
    reference: Mapping[Joint, TimedAngle]

    @property
    def joints(self) -> tuple[Joint, ...]:
        """What both have."""
        return tuple(joint for joint in Joint if joint in self.measured and joint in self.reference)


@dataclass(frozen=True, slots=True)
class RateStretch:
    """Rates without gaps: (n,) rad/s from `start_s` on, at GRID_HZ."""

    start_s: float
    rate_rad_s: FloatArray

    @property
    def time_s(self) -> FloatArray:
        return self.start_s + np.arange(len(self.rate_rad_s)) / GRID_HZ


def stretches_of(curve: TimedAngle) -> Iterator[TimedAngle]:
    """The parts of a curve without gaps, unwrapped through all of them."""
    is_known = np.isfinite(curve.angle_rad) & np.isfinite(curve.time_s)
    time_s, angle_rad = curve.time_s[is_known], np.unwrap(curve.angle_rad[is_known])
    if not len(time_s):
        return
    steps_s = np.diff(time_s)
    usual_s = float(np.median(steps_s)) if len(steps_s) else 0.0
    most_s = max(MAX_GAP_S, EVEN_STEPS * usual_s) if usual_s <= LONGEST_STEP_S else MAX_GAP_S
    for part in np.split(np.arange(len(time_s)), np.nonzero(steps_s > most_s)[0] + 1):
        yield TimedAngle(time_s[part], angle_rad[part])


def rates_of(curve: TimedAngle) -> list[RateStretch]:
    """The rates of a curve below CUT_OFF_HZ, without phase; stretches too short to be filtered are left out."""
    sections = butter(FILTER_ORDER, CUT_OFF_HZ, fs=GRID_HZ, output="sos")
    edge = round(EDGE_S * GRID_HZ)
    found = []
    for part in stretches_of(curve):
        if len(part.time_s) < 4 or part.time_s[-1] - part.time_s[0] < MIN_STRETCH_S:
            continue
        grid_s = np.arange(part.time_s[0], part.time_s[-1], 1.0 / GRID_HZ)
        rate = sosfiltfilt(sections, CubicSpline(part.time_s, part.angle_rad)(grid_s, 1))
        found.append(RateStretch(float(grid_s[edge]), rate[edge:-edge]))
    return found


def angle_at(curve: TimedAngle, time_s: FloatArray) -> FloatArray:
    """Give the angle (m,) at ascending instants (m,), by cubic splines; NaN in gaps and outside."""
    angle_rad = np.full(len(time_s), np.nan)
    for part in stretches_of(curve):
        is_inside = (time_s >= part.time_s[0]) & (time_s <= part.time_s[-1])
        if len(part.time_s) >= 4:
            angle_rad[is_inside] = CubicSpline(part.time_s, part.angle_rad)(time_s[is_inside])
        elif len(part.time_s) >= 2:
            angle_rad[is_inside] = np.interp(time_s[is_inside], part.time_s, part.angle_rad)
    return angle_rad

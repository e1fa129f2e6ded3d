"""Joint angles over 0-100 % of each stride, their mean, and the peaks a clinician reads."""

from dataclasses import dataclass

import numpy as np

from core.parameters import Excursion, PeakWindow
from core.samples import BoolArray, FloatArray
from core.signal.tracks import MAX_REPORTED_GAP_S, nominal_step_s

POINTS = 101


@dataclass(frozen=True, slots=True)
class MeanCycle:
    """Mean and standard deviation (101,) over `n` strides; NaN where there are none, or fewer than two."""

    mean: FloatArray
    sd: FloatArray
    n: int


@dataclass(frozen=True, slots=True)
class Peak:
    """One extremum of each stride (k,), and where, percent; NaN where there is none."""

    value: FloatArray
    percent: FloatArray


def cycles_of(time_s: FloatArray, angle: FloatArray, start_s: FloatArray, end_s: FloatArray) -> FloatArray:
    """Resample an angle (n,) to 0 to 100 % of each stride (k, 101); strides with gaps or cut off are NaN."""
    share = np.linspace(0.0, 1.0, POINTS)
    at_s = start_s[:, None] + (end_s - start_s)[:, None] * share
    if len(time_s) < 2:
        return np.full(at_s.shape, np.nan)
    cycles = np.interp(at_s, time_s, angle)
    step_s = np.diff(time_s, prepend=time_s[0])
    is_after_gap = step_s > max(MAX_REPORTED_GAP_S, 1.5 * nominal_step_s(time_s))
    missing = np.concatenate([[0], np.cumsum(~np.isfinite(angle))])
    gaps = np.cumsum(is_after_gap)  # up to and with each sample
    first = np.searchsorted(time_s, start_s, side="right") - 1
    last = np.searchsorted(time_s, end_s)
    is_whole = (first >= 0) & (last < len(time_s))
    first, last = np.maximum(first, 0), np.minimum(last, len(time_s) - 1)
    is_whole &= (missing[last + 1] == missing[first]) & (gaps[last] == gaps[first])
    cycles[~is_whole] = np.nan
    return cycles


def mean_cycle(cycles: FloatArray) -> MeanCycle:
    """Average the known strides of (k, 101), NaN: unknown."""
    known = cycles[np.isfinite(cycles).all(axis=1)]
    unknown = np.full(POINTS, np.nan)
    mean = known.mean(axis=0) if len(known) else unknown
    sd = known.std(axis=0, ddof=1) if len(known) > 1 else unknown
    return MeanCycle(mean, sd, len(known))


def find_peak(cycles: FloatArray, window: PeakWindow) -> Peak:
    """Find each stride's extremum (k, 101) within the window; none if at its edge in half of the strides."""
    n = len(cycles)
    is_known = ~np.isnan(cycles[:, 0])  # cycles are whole or missing
    nothing = Peak(np.full(n, np.nan), np.full(n, np.nan))
    if not is_known.any():
        return nothing
    part = np.where(is_known[:, None], cycles[:, window.first : window.last + 1], 0.0)
    at = part.argmax(axis=1) if window.is_maximum else part.argmin(axis=1)
    is_edge: BoolArray = (at == 0) | (at == window.last - window.first)
    if np.mean(is_edge[is_known]) >= 0.5:
        return nothing
    value = np.where(is_known, part[np.arange(n), at], np.nan)
    return Peak(value, np.where(is_known, window.first + at.astype(np.float64), np.nan))


def excursion_of_cycles(cycles: FloatArray, excursion: Excursion) -> FloatArray:
    """Give one window's maximum less the other's minimum (k,) of cycles (k, 101); NaN if either is no peak."""
    contact = cycles[:, 0] if len(cycles) else np.empty(0)
    high, low = (
        find_peak(cycles, window).value if window is not None else contact for window in (excursion.high, excursion.low)
    )
    return high - low


def range_of_cycles(cycles: FloatArray) -> FloatArray:
    """Give the range (k,) of each stride's cycle (k, 101), in its unit."""
    return cycles.max(axis=1) - cycles.min(axis=1)

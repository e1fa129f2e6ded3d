"""Where a signal passes a level and where it begins to grow, between samples, as indices."""

from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray

ONSET_RATIO = 2.05  # time to a level over time from there to its double: growth with the power 1.75 of time


@dataclass(frozen=True, slots=True)
class Onset:
    """Where a signal begins to grow, an index, and how many samples before its first level that was extrapolated."""

    index: float
    reach: float


def crossing(signal: FloatArray, first: int, last: int, level: float, which: int = 0) -> float:
    """Give the fractional index in first..last where `signal` (n,) first (`which` -1: last) passes `level`; or NaN."""
    above = signal[first : last + 1] - level
    is_positive = above > 0
    passes = (is_positive[1:] != is_positive[:-1]).nonzero()[0]
    if not len(passes):
        return float("nan")
    k = int(passes[which])
    return first + k + float(above[k] / (above[k] - above[k + 1]))


def onset(signal: FloatArray, peak: int, rest: int, level: float) -> Onset:
    """Give where a signal (n,), near zero at `rest`, begins to grow, extrapolated from `level` and its double."""
    first, last, which = (rest, peak, -1) if rest < peak else (peak, rest, 0)
    low, high = (crossing(signal, first, last, one, which) for one in (level, 2.0 * level))
    if not np.isfinite(low):
        return Onset(float(rest), 0.0)
    reach = ONSET_RATIO * (low - high) if np.isfinite(high) else 0.0
    found = float(np.clip(low + reach, min(rest, low), max(rest, low)))
    return Onset(found, abs(found - low))

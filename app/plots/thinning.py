"""Reduce an hour of samples to as many points as the screen has, without losing a peak or closing a gap."""

import numpy as np

from core.samples import FloatArray

FEW = 2  # samples per column that are drawn as they are


def thin(time_s: FloatArray, values: FloatArray, columns: int) -> tuple[FloatArray, FloatArray]:
    """Keep the lowest and highest value per column, in order; `time_s` ascending, both (n,), NaN in gaps.
    Empty columns stay gaps, single missing samples do not; up to `FEW` samples per column stay as they are.
    """
    per_column = len(values) // max(columns, 1)
    if per_column <= FEW:
        return time_s, values
    n = len(values) // per_column * per_column
    starts = np.arange(0, n, per_column)
    lowest = starts + np.argmin(_parts(values[:n], per_column, np.inf), axis=1)
    highest = starts + np.argmax(_parts(values[:n], per_column, -np.inf), axis=1)
    kept = np.sort(np.stack([lowest, highest], axis=1), axis=1).ravel()
    kept = np.concatenate([kept, np.arange(n, len(values))])
    return time_s[kept], values[kept]


def envelope(
    time_s: FloatArray, low: FloatArray, high: FloatArray, columns: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Reduce a band (n,) to the extremes of each column, gaps as in `thin`; the result never crosses itself."""
    per_column = len(time_s) // max(columns, 1)
    if per_column <= FEW:
        return time_s, low, high
    n = len(time_s) // per_column * per_column
    lowest = _parts(low[:n], per_column, np.inf).min(axis=1)
    highest = _parts(high[:n], per_column, -np.inf).max(axis=1)
    is_gap = np.isinf(lowest) | np.isinf(highest)
    lowest[is_gap] = highest[is_gap] = np.nan
    return time_s[per_column // 2 : n : per_column], lowest, highest


def _parts(values: FloatArray, per_column: int, instead_of_nan: float) -> FloatArray:
    parts = values.reshape(-1, per_column)
    return np.where(np.isnan(parts), instead_of_nan, parts)

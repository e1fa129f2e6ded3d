"""Spread of values, whatever a few of them do."""

import numpy as np

from core.samples import FloatArray


def median_of(values: FloatArray) -> float:
    """Give the median (n,), NaN if any is NaN; NumPy's own takes several times as long for a hundred values."""
    low, high, last = (len(values) - 1) // 2, len(values) // 2, len(values) - 1
    ordered = np.partition(values, (low, high, last))  # what is not a number comes last
    return float(0.5 * (ordered[low] + ordered[high])) if ordered[last] == ordered[last] else float("nan")


def robust_sd(values: FloatArray) -> float:
    """Estimate the SD of values scattered around zero by their median absolute value; NaN if any is NaN."""
    return 1.4826 * median_of(np.abs(values).ravel()) if values.size else float("nan")

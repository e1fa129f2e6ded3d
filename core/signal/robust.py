"""Spread of values, whatever a few of them do."""

import numpy as np

from core.samples import FloatArray


def robust_sd(values: FloatArray) -> float:
    """Estimate the SD of values scattered around zero by their median absolute value; NaN if any is NaN."""
    if not values.size:
        return float("nan")
    size = np.abs(values).ravel()
    low, high = (len(size) - 1) // 2, len(size) // 2
    size.partition((low, high, len(size) - 1))  # what is not a number comes last; NumPy's median is twice as slow
    return float(1.4826 * 0.5 * (size[low] + size[high])) if size[-1] == size[-1] else float("nan")

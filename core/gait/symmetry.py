"""Likeness of the two sides, and of one side with a reference group."""

import numpy as np

from core.samples import FloatArray


def symmetry_index_percent(one: float, other: float) -> float:
    """Compute 100 (X1 - X2) / (0.5 (X1 + X2)), 0: symmetric (Robinson et al. 1987); NaN unless both positive."""
    if not (one > 0 and other > 0):
        return float("nan")
    return 100.0 * (one - other) / (0.5 * (one + other))


def curve_difference(one: FloatArray, other: FloatArray) -> float:
    """Compute the mean absolute difference of two mean cycles (101,), in their unit; NaN where unknown."""
    return float(np.mean(np.abs(one - other)))


def gait_variable_score(mean: FloatArray, reference: FloatArray) -> float:
    """Compute RMS difference of mean cycles (101,) (Baker et al. 2009, doi 10.1016/j.gaitpost.2009.05.020)."""
    return float(np.sqrt(np.mean((mean - reference) ** 2)))

"""Likeness of the two sides, and of one side with a reference group."""

import numpy as np

from core.samples import FloatArray


def symmetry_index_percent(one: float, other: float) -> float:
    """100 (X1 - X2) / (0.5 (X1 + X2)), zero for symmetry (Robinson et al. 1987).

    For times, ranges and lengths only: NaN unless both are positive, since the index blows up around zero.

    Returns
    -------
    float
        Percent, -200 to 200.
    """
    if not (one > 0 and other > 0):
        return float("nan")
    return 100.0 * (one - other) / (0.5 * (one + other))


def curve_difference(one: FloatArray, other: FloatArray) -> float:
    """Mean absolute difference of two mean cycles (101,), in their unit; NaN where either is unknown.

    Parameters
    ----------
    one, other : (101,)
        Mean cycles in one unit.

    Returns
    -------
    float
        In that unit.
    """
    return float(np.mean(np.abs(one - other)))


def gait_variable_score(mean: FloatArray, reference: FloatArray) -> float:
    """Root mean square difference of a mean cycle (101,) from the mean of a reference group, in their unit.

    Baker et al. 2009, doi 10.1016/j.gaitpost.2009.05.020. The profile score of nine such variables needs sensors at
    pelvis and hip and is never computed.

    Parameters
    ----------
    mean, reference : (101,)
        Mean cycles in one unit.

    Returns
    -------
    float
        In that unit.
    """
    return float(np.sqrt(np.mean((mean - reference) ** 2)))

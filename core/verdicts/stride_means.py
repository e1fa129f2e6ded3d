"""The mean of a measure over strides, and how sure it is: chance with the strides' correlation, drift, clocks, axes.

u^2 = se^2 + d^2 + c^2 + a^2: its standard error, half of what the walk's halves or thirds differ by, what the lag's
uncertainty makes of it, and what the joint's axis does that its data leave open.
"""

import math
from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray

MIN_CORRELATION = 0.3  # of adjacent strides; 0 to 0.6 were seen in real walks, and short walks show too little
MAX_CORRELATION = 0.9  # beyond, the walk drifts, which the halves show


@dataclass(frozen=True, slots=True)
class MeanOfStrides:
    """A mean over strides and what is known of its uncertainty; NaN where it is not known."""

    mean: float
    sd: float
    n: int
    standard_error: float  # with the correlation of adjacent strides
    drift: float  # half of what the halves, or the thirds that lie farthest apart, differ by beyond chance
    clock_error: float = 0.0  # what the uncertainty of the lag between the joint's sensors makes of it
    axis_error: float = 0.0  # what the joint's axis makes of it, by two parts of the data that identify it each alone

    @property
    def uncertainty(self) -> float:
        """One standard deviation of the mean, u."""
        return math.hypot(self.standard_error, self.drift, self.clock_error, self.axis_error)


def mean_of_strides(values: FloatArray, clock_error: float = 0.0, axis_error: float = 0.0) -> MeanOfStrides:
    """Average finite values (k,) in order of time with their uncertainty, in their unit."""
    known = values[np.isfinite(values)]
    n = len(known)
    mean = float(np.mean(known)) if n else math.nan
    if n < 2:
        return MeanOfStrides(mean, math.nan, n, math.nan, math.nan)
    sd = float(np.std(known, ddof=1))
    r = min(max(MIN_CORRELATION, _lag_one_correlation(known)), MAX_CORRELATION)
    standard_error = sd / math.sqrt(n) * math.sqrt((1 + r) / (1 - r))
    return MeanOfStrides(
        mean=mean,
        sd=sd,
        n=n,
        standard_error=standard_error,
        drift=_drift(known, math.sqrt(sd / math.sqrt(n) * standard_error)),
        clock_error=clock_error,
        axis_error=axis_error,
    )


def _drift(values: FloatArray, by_chance: float) -> float:
    """Half of what halves or thirds differ by beyond chance."""
    # by chance alone the squared half difference of halves is 1 squared error of the whole, that of the thirds farthest
    # apart 2.5; correlated strides may themselves be drift, so `by_chance` holds the correlation half: between both
    # errors
    beyond = 0.0
    for parts, share in ((2, 1.0), (3, 2.5)):
        means = [part.mean() for part in np.array_split(values, parts) if len(part)]
        beyond = max(beyond, 0.25 * float(np.ptp(means)) ** 2 - share * by_chance**2)
    return math.sqrt(beyond)


def _lag_one_correlation(values: FloatArray) -> float:
    apart = values - values.mean()
    total = float(apart @ apart)
    return float(apart[1:] @ apart[:-1]) / total if total > 0 else 0.0

"""What does a sensor feel of a joint's acceleration, below the frequencies at which tissue rings?

The specific force of the joint is R (a - b - K o), linear in what is unknown of it (Seel et al. 2014, doi
10.3390/s140406891, eq 7). So each of its terms may be low-passed by itself, in the sensor's own earth, and two
neighbours still agree on the sum. In walking people what two neighbours disagree on falls from 1.7 to 0.35 m/s2 at
4 Hz, of a signal of 1.2.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from core.rotations import cross_matrix
from core.samples import BoolArray, FloatArray
from core.tracks import at_positions

CUTOFF_HZ = 4.0
REACH_S = 0.25  # the kernel beyond holds less than a hundredth of its weight
STEP_S = 0.02  # cubics between such instants are exact to a thousandth below the cutoff
MIN_HEARD = 0.95  # of the kernel's weight lies on samples that were heard


@dataclass(frozen=True, slots=True)
class JointForce:
    """The terms of one sensor at even instants (m,), low-passed without delay.

    With o the vector from the joint to the sensor and b the accelerometer's bias, the joint's specific force in the
    sensor's own earth is terms @ (-o, -b, 1).

    Attributes
    ----------
    terms : (m, 3, 7)
    heard : (m,)
        Share of the kernel's weight on samples that were heard.
    """

    start_s: float
    step_s: float
    terms: FloatArray
    heard: FloatArray

    @property
    def end_s(self) -> float:
        return self.start_s + self.step_s * (len(self.heard) - 1)

    def at(self, time_s: FloatArray) -> FloatArray:
        """Terms (n, 3, 7) at any instants (n,), on this sensor's clock."""
        found = at_positions(self.terms.reshape(-1, 21), (time_s - self.start_s) / self.step_s)
        return found.reshape(-1, 3, 7)

    def is_heard_at(self, time_s: FloatArray) -> BoolArray:
        nearest = np.round((time_s - self.start_s) / self.step_s).astype(np.int64)
        is_inside = (nearest >= 0) & (nearest < len(self.heard))
        return is_inside & (self.heard[np.clip(nearest, 0, len(self.heard) - 1)] > MIN_HEARD)


def joint_force(
    start_s: float,
    step_s: float,
    rate: FloatArray,
    acceleration: FloatArray,
    force: FloatArray,
    earth_from: FloatArray,
    is_heard: BoolArray,
) -> JointForce:
    """Low-pass the terms of one stretch.

    Parameters
    ----------
    rate, acceleration, force : (n, 3)
        Angular rate, angular acceleration (NaN where unknown) and specific force, in sensor axes.
    earth_from : (n, 3, 3)
    is_heard : (n,)
    """
    is_known = is_heard & np.isfinite(acceleration[:, 0])
    # R K with K = g g' - |g|^2 + [g']x
    seen = np.einsum("nij,nj->ni", earth_from, rate)
    swing = earth_from @ cross_matrix(np.where(is_known[:, None], acceleration, 0.0))
    swing += seen[:, :, None] * rate[:, None, :] - np.sum(rate**2, axis=1)[:, None, None] * earth_from
    felt = np.einsum("nij,nj->ni", earth_from, force)
    rows = np.concatenate([swing, earth_from, felt[..., None]], axis=2).reshape(-1, 21)
    kernel = _kernel(step_s)
    stride = max(1, round(STEP_S / step_s))
    weight = _smoothed(is_known.astype(float)[:, None], kernel, stride)
    terms = _smoothed(np.where(is_known[:, None], rows, 0.0), kernel, stride) / np.maximum(weight, 1e-9)
    return JointForce(start_s, stride * step_s, terms.reshape(-1, 3, 7), weight[:, 0])


@lru_cache(maxsize=64)
def _kernel(step_s: float) -> FloatArray:
    """Weights of a zero-phase Butterworth filter of order 2, forward and backward: 1/(1 + (f/fc)^4)."""
    half = max(1, round(REACH_S / step_s))
    turn = np.sqrt(2.0) * np.pi * CUTOFF_HZ * step_s * np.abs(np.arange(-half, half + 1))
    weights = np.exp(-turn) * (np.cos(turn) + np.sin(turn))
    return np.asarray(weights / weights.sum())


def _smoothed(rows: FloatArray, kernel: FloatArray, stride: int) -> FloatArray:
    """Every `stride`-th weighted mean (m, k) of rows (n, k); beyond the ends there is nothing."""
    half = len(kernel) // 2
    padded = np.pad(rows, ((half, half), (0, 0)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, len(kernel), axis=0)[::stride]
    smooth: FloatArray = windows @ kernel
    return smooth

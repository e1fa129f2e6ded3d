"""What a sensor feels of a joint's acceleration, below the frequencies at which tissue rings.

The specific force of the joint is R (a - b - K o), linear in what is unknown of it (Seel et al. 2014, doi
10.3390/s140406891, eq 7). So each of its terms may be low-passed by itself, in the sensor's own earth, and two
adjacent segments still agree on the sum. In walking people what they disagree on falls from 1.7 to 0.35 m/s2 at
4 Hz, of a signal of 1.2.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from core.samples import BoolArray, FloatArray
from core.signal.tracks import at_positions

CUTOFF_HZ = 4.0
REACH_S = 0.25  # the kernel beyond holds less than a hundredth of its weight
STEP_S = 0.02  # cubics between such instants are exact to a thousandth below the cutoff
MEANS_AT_ONCE = 32
MIN_RECEIVED = 0.95  # of the kernel's weight lies on samples that were received


@dataclass(frozen=True, slots=True)
class JointForce:
    """The terms of one sensor at even instants (m,), low-passed without delay.

    With o the vector from the joint to the sensor and b the accelerometer's bias, the joint's specific force in the
    sensor's own earth is terms @ (-o, -b, 1).
    """

    start_s: float
    step_s: float
    terms: FloatArray  # (m, 3, 7)
    received: FloatArray  # (m,): share of the kernel's weight on samples that were received

    @property
    def end_s(self) -> float:
        """When the last instant is."""
        return self.start_s + self.step_s * (len(self.received) - 1)

    def at(self, time_s: FloatArray) -> FloatArray:
        """Terms (n, 3, 7) at any instants (n,), on this sensor's clock."""
        found = at_positions(self.terms.reshape(-1, 21), (time_s - self.start_s) / self.step_s)
        return found.reshape(-1, 3, 7)

    def is_received_at(self, time_s: FloatArray) -> BoolArray:
        """Whether most of what the instants nearest to `time_s` (n,) are made of was received."""
        nearest = np.round((time_s - self.start_s) / self.step_s).astype(np.int64)
        is_inside = (nearest >= 0) & (nearest < len(self.received))
        return is_inside & (self.received[np.clip(nearest, 0, len(self.received) - 1)] > MIN_RECEIVED)


def joint_force(
    start_s: float,
    step_s: float,
    rate: FloatArray,
    acceleration: FloatArray,
    force: FloatArray,
    earth_from: FloatArray,
    is_received: BoolArray,
) -> JointForce:
    """Low-pass one stretch's terms into the sensor's own earth axes; NaN acceleration counts as not received."""
    is_known = is_received & np.isfinite(acceleration[:, 0])
    # one signal after the other, which is several times faster than one sample after the other
    turn = np.ascontiguousarray(earth_from.transpose(1, 2, 0))
    g, change, felt = (np.ascontiguousarray(v.T) for v in (rate, acceleration, force))
    rows = np.empty((22, len(rate)))
    terms, rows[21] = rows[:21].reshape(3, 7, -1), 1.0
    seen, square = np.sum(turn * g, axis=1), np.sum(g**2, axis=0)
    for j, k, m in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # R K with K = g g' - |g|^2 + [g']x
        terms[:, j] = seen * g[j] - square * turn[:, j] + change[m] * turn[:, k] - change[k] * turn[:, m]
    terms[:, 3:6] = turn
    terms[:, 6] = np.sum(turn * felt, axis=1)
    rows[:, ~is_known] = 0.0
    stride = max(1, round(STEP_S / step_s))
    smooth = _smoothed(rows, _kernel(step_s), stride)
    weight = smooth[21]
    means = np.ascontiguousarray((smooth[:21] / np.maximum(weight, 1e-9)).T)
    return JointForce(start_s, stride * step_s, means.reshape(-1, 3, 7), weight)


@lru_cache(maxsize=64)
def _kernel(step_s: float) -> FloatArray:
    """Weights of a zero-phase Butterworth filter of order 2, forward and backward: 1/(1 + (f/fc)^4)."""
    half = max(1, round(REACH_S / step_s))
    turn = np.sqrt(2.0) * np.pi * CUTOFF_HZ * step_s * np.abs(np.arange(-half, half + 1))
    weights = np.exp(-turn) * (np.cos(turn) + np.sin(turn))
    return np.asarray(weights / weights.sum())


def _smoothed(rows: FloatArray, kernel: FloatArray, stride: int) -> FloatArray:
    """Every `stride`-th weighted mean (k, m) of signals (k, n); beyond the ends there is nothing."""
    half, required = len(kernel) // 2, -(-rows.shape[1] // stride)
    blocks, span = -(-required // MEANS_AT_ONCE), MEANS_AT_ONCE * stride
    padded = np.zeros((len(rows), blocks * span + 2 * half))
    padded[:, half : half + rows.shape[1]] = rows
    windows = np.lib.stride_tricks.sliding_window_view(padded, span + 2 * half, axis=1)[:, ::span]
    weights = np.zeros((span + 2 * half, MEANS_AT_ONCE))
    for i in range(MEANS_AT_ONCE):
        weights[i * stride : i * stride + len(kernel), i] = kernel
    smooth = np.ascontiguousarray(windows).reshape(-1, span + 2 * half) @ weights
    return smooth.reshape(len(rows), -1)[:, :required]

"""Orientation filter VQF, written from its paper, for computers without its compiled package.

Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014: rates are integrated, the integral's tilt is corrected by the
low-passed specific force in an almost inertial frame, and a Kalman filter finds the gyroscope's bias at rest and in
motion. What the paper leaves open (how low-passes begin, the offline form) follows the authors' reference
implementation, version 2.1.2. `core.signal.published_offline` knows the future and adds the magnetometer.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, inf, pi, radians, sin, sqrt, tan

import numpy as np
from scipy.signal import lfilter

from core.samples import FloatArray

# Settings of the paper. Deviations of biases are in deg/s, and so are the variances of the Kalman filter.
TAU_ACC_S = 3.0
BIAS_SD_DEG_S = 0.5
BIAS_CLIP_RAD_S = radians(2.0)
FORGETTING_DEG_S, FORGETTING_S = 0.1, 100.0  # so far a bias wanders in so much time
MOTION_SD_DEG_S, REST_SD_DEG_S = 0.1, 0.03
VERTICAL_SHARE = 1e-4  # how much the absence of any knowledge about the vertical axis counts: little
REST_S, TAU_REST_S = 1.5, 0.5
REST_RAD_S, REST_M_S2 = radians(2.0), 0.5

STILL_RAD_S = float(np.finfo(float).eps)
UPSIDE_DOWN = 1e-6  # cosine of half the tilt; below it, the axis to turn about is arbitrary
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class FilterPass:
    """What the causal filter finds at each of n samples.

    `q_earth_from_sensor`: (n, 4). `bias_rad_s`: (n, 3). `bias_variance_deg2_s2`: (n, 3, 3).
    `smooth_rad_s`: (n, 3), the low-passed rates that show rest.
    """

    q_earth_from_sensor: FloatArray
    bias_rad_s: FloatArray
    bias_variance_deg2_s2: FloatArray
    smooth_rad_s: FloatArray


class LowPass:
    """Second-order Butterworth low-pass of several channels; for its first `tau_s` it gives the mean of what came."""

    def __init__(self, tau_s: float, step_s: float, channels: int) -> None:
        self._tau_s, self._step_s = tau_s, step_s
        c = tan(step_s / (sqrt(2.0) * tau_s)) if tau_s >= 0.5 * step_s else 0.0
        d = c * c + sqrt(2.0) * c + 1.0
        self._b = (c * c / d, 2.0 * c * c / d, c * c / d)
        self._a = (2.0 * (c * c - 1.0) / d, (c * c - sqrt(2.0) * c + 1.0) / d)
        if tau_s < 0.5 * step_s:  # it would not be stable
            self._b, self._a = (1.0, 0.0, 0.0), (0.0, 0.0)
        self._count = 0
        self._is_starting = True
        self._first, self._second = [0.0] * channels, [0.0] * channels  # to begin with, `_first` is the sum

    def settle(self, values: Sequence[float]) -> None:
        """Go on as if these values, one a channel, had always come."""
        self._is_starting = False
        self._first = [value * (1.0 - self._b[0]) for value in values]
        self._second = [value * (self._b[2] - self._a[1]) for value in values]

    def step(self, values: Sequence[float]) -> list[float]:
        """Take a value of each channel and give what they are now."""
        if self._is_starting:
            self._count += 1
            self._first = [total + value for total, value in zip(self._first, values, strict=True)]
            means = [total / self._count for total in self._first]
            if self._count * self._step_s >= self._tau_s:
                self.settle(means)
            return means
        (b0, b1, b2), (a1, a2) = self._b, self._a
        first, second = self._first, self._second
        smooth = []
        for k, x in enumerate(values):
            y = b0 * x + first[k]
            first[k] = b1 * x - a1 * y + second[k]
            second[k] = b2 * x - a2 * y
            smooth.append(y)
        return smooth

    def block(self, values: FloatArray) -> FloatArray:
        """Take values (n, channels) as n calls of `step` would."""
        smooth, start = np.empty(values.shape), 0
        while self._is_starting and start < len(values):
            smooth[start] = self.step(values[start].tolist())
            start += 1
        if start < len(values):
            state = np.array([self._first, self._second])
            smooth[start:], state = lfilter(self._b, (1.0, *self._a), values[start:], axis=0, zi=state)
            self._first, self._second = state.tolist()
        return smooth


class PublishedFilter:
    """The causal filter of one sensor, without magnetometer."""

    def __init__(self, step_s: float, tau_acc_s: float = TAU_ACC_S, bias_sd_deg_s: float = BIAS_SD_DEG_S) -> None:
        self._step_s, self._tau_acc_s, self._bias_sd_deg_s = step_s, tau_acc_s, bias_sd_deg_s
        self._wander = FORGETTING_DEG_S**2 * step_s / FORGETTING_S
        motion, rest = (sd**4 / self._wander + sd**2 for sd in (MOTION_SD_DEG_S, REST_SD_DEG_S))
        self._motion_variances = (motion, motion, motion / VERTICAL_SHARE)
        self._rest_variances = (rest, rest, rest)
        self.reset()

    def reset(self) -> None:
        """Begin as with the first sample."""
        self._inertial: Quaternion = (1.0, 0.0, 0.0, 0.0)  # from sensor, by rates alone
        self._earth: Quaternion = (1.0, 0.0, 0.0, 0.0)  # from the inertial frame, by specific forces
        self._smooth_gyr, self._smooth_acc = (LowPass(TAU_REST_S, self._step_s, 3) for _ in range(2))
        self._inertial_acc = LowPass(self._tau_acc_s, self._step_s, 3)
        self._turn_and_bias = LowPass(self._tau_acc_s, self._step_s, 11)
        self._rest_s, self._is_resting = 0.0, False
        self._bias: Vector = (0.0, 0.0, 0.0)
        self._vary_alike(self._bias_sd_deg_s**2)

    def bias(self) -> tuple[FloatArray, float]:
        """Give the bias (3,) and an upper bound of its deviation, rad/s."""
        xx, xy, xz, yy, yz, zz = map(abs, self._variance)
        largest = max(xx + xy + xz, xy + yy + yz, xz + yz + zz)
        return np.array(self._bias), radians(min(sqrt(largest), self._bias_sd_deg_s))

    def set_bias(self, bias_rad_s: FloatArray, sd_rad_s: float) -> None:
        """Begin with what is known of the bias (3,), whose deviation is the same in all directions."""
        x, y, z = bias_rad_s.tolist()
        self._bias = (x, y, z)
        self._vary_alike((sd_rad_s * 180.0 / pi) ** 2)

    def update(self, gyr_rad_s: FloatArray, acc_m_s2: FloatArray) -> FloatArray:
        """Give quaternions (n, 4), earth from sensor, of the next rates and specific forces (n, 3)."""
        return self.run(gyr_rad_s, acc_m_s2).q_earth_from_sensor

    def run(self, gyr_rad_s: FloatArray, acc_m_s2: FloatArray) -> FilterPass:
        """Take the next n samples, rates of the intervals before them (n, 3) and specific forces (n, 3)."""
        smooth = self._smooth_gyr.block(gyr_rad_s)
        is_turning = ((gyr_rad_s - smooth) ** 2).sum(axis=1) >= REST_RAD_S**2
        is_turning |= np.abs(smooth).max(axis=1) > BIAS_CLIP_RAD_S
        is_felt = acc_m_s2.any(axis=1)  # nothing at all is a loss
        felt, is_shaken = acc_m_s2[is_felt], np.zeros(len(acc_m_s2), dtype=np.bool_)
        is_shaken[is_felt] = ((felt - self._smooth_acc.block(felt)) ** 2).sum(axis=1) >= REST_M_S2**2
        found = []
        columns = (gyr_rad_s, acc_m_s2, smooth, is_turning, is_felt, is_shaken)
        for rate, force, slow, turns, feels, shakes in zip(*(c.tolist() for c in columns), strict=True):
            if turns:
                self._rest_s, self._is_resting = 0.0, False
            self._turn(rate)
            if feels:
                self._rest_s = 0.0 if shakes else self._rest_s + self._step_s
                self._is_resting = not shakes and (self._is_resting or self._rest_s >= REST_S)
                self._level(force, slow)
            found.append((*product(self._earth, self._inertial), *self._bias, *self._variance))
        values = np.array(found).reshape(-1, 13)
        variances = values[:, [7, 8, 9, 8, 10, 11, 9, 11, 12]].reshape(-1, 3, 3)
        return FilterPass(values[:, :4], values[:, 4:7], variances, smooth)

    def _vary_alike(self, variance: float) -> None:
        self._variance = (variance, 0.0, 0.0, variance, 0.0, variance)  # xx, xy, xz, yy, yz, zz

    def _turn(self, rate: Sequence[float]) -> None:
        """Prediction from the gyroscope."""
        x, y, z = rate[0] - self._bias[0], rate[1] - self._bias[1], rate[2] - self._bias[2]
        size = sqrt(x * x + y * y + z * z)
        if STILL_RAD_S < size < inf:
            half = 0.5 * size * self._step_s
            s = sin(half) / size
            self._inertial = unit_product(self._inertial, (cos(half), s * x, s * y, s * z))

    def _level(self, force: Sequence[float], slow: Sequence[float]) -> None:
        """Correction from the accelerometer, of the vertical and of the bias."""
        self._earth, (right, ahead) = levelled(self._earth, self._inertial_acc.step(rotated(self._inertial, force)))
        w, x, y, z = product(self._earth, self._inertial)
        bx, by, bz = self._bias
        turn = (
            *(1 - 2 * y * y - 2 * z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
            *(2 * (x * y + w * z), 1 - 2 * x * x - 2 * z * z, 2 * (y * z - w * x)),
            *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * x * x - 2 * y * y),
        )
        taken_off = turn[0] * bx + turn[1] * by + turn[2] * bz, turn[3] * bx + turn[4] * by + turn[5] * bz
        smooth = self._turn_and_bias.step((*turn, *taken_off))
        if self._is_resting:
            self._correct_bias(AXES, (slow[0] - bx, slow[1] - by, slow[2] - bz), self._rest_variances)
            return
        rows = smooth[0:3], smooth[3:6], smooth[6:9]
        explained = [a * bx + b * by + c * bz for a, b, c in rows]
        errors = (
            smooth[9] - ahead / self._step_s - explained[0],
            smooth[10] + right / self._step_s - explained[1],
            -explained[2],
        )
        self._correct_bias(rows, errors, self._motion_variances)

    def _correct_bias(self, rows: Sequence[Sequence[float]], errors: Sequence[float], variances: Vector) -> None:
        """Kalman filter, with three measurements of independent errors one after the other: no matrix to invert."""
        xx, xy, xz, yy, yz, zz = self._variance
        most, wander = self._bias_sd_deg_s**2, self._wander
        xx, yy, zz = (value + wander if value < most else value for value in (xx, yy, zz))
        dx = dy = dz = 0.0
        for (a, b, c), error, variance in zip(rows, errors, variances, strict=True):
            x, y, z = xx * a + xy * b + xz * c, xy * a + yy * b + yz * c, xz * a + yz * b + zz * c
            gain = 1.0 / (variance + a * x + b * y + c * z)
            step = gain * (_clipped(error) - a * dx - b * dy - c * dz)
            dx, dy, dz = dx + step * x, dy + step * y, dz + step * z
            xx, xy, xz = xx - gain * x * x, xy - gain * x * y, xz - gain * x * z
            yy, yz, zz = yy - gain * y * y, yz - gain * y * z, zz - gain * z * z
        self._variance = (xx, xy, xz, yy, yz, zz)
        x, y, z = self._bias
        self._bias = (_clipped(x + dx), _clipped(y + dy), _clipped(z + dz))


def levelled(earth: Quaternion, force: Sequence[float]) -> tuple[Quaternion, tuple[float, float]]:
    """Turn the earth so that an inertial force points up; give too where it pointed, its horizontal part."""
    x, y, z = rotated(earth, force)
    size = sqrt(x * x + y * y + z * z) or 1.0
    x, y, z = x / size, y / size, z / size
    w = sqrt(max(0.5 * (z + 1.0), 0.0))
    turn = (w, 0.5 * y / w, -0.5 * x / w, 0.0) if w > UPSIDE_DOWN else (0.0, 1.0, 0.0, 0.0)
    return unit_product(turn, earth), (x, y)


def product(p: Sequence[float], q: Sequence[float]) -> Quaternion:
    """Multiply quaternions, as floats: arrays of four are slow."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def unit_product(p: Sequence[float], q: Sequence[float]) -> Quaternion:
    """Multiply, and take off what rounding adds to the length."""
    w, x, y, z = product(p, q)
    size = sqrt(w * w + x * x + y * y + z * z)
    return w / size, x / size, y / size, z / size


def rotated(q: Quaternion, v: Sequence[float]) -> Vector:
    """Rotate a vector."""
    w, x, y, z = q
    a, b, c = v
    return (
        (1 - 2 * y * y - 2 * z * z) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c,
        2 * (x * y + w * z) * a + (1 - 2 * x * x - 2 * z * z) * b + 2 * (y * z - w * x) * c,
        2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * x * x - 2 * y * y) * c,
    )


def _clipped(bias_rad_s: float) -> float:
    if bias_rad_s > BIAS_CLIP_RAD_S:
        return BIAS_CLIP_RAD_S
    return -BIAS_CLIP_RAD_S if bias_rad_s < -BIAS_CLIP_RAD_S else bias_rad_s

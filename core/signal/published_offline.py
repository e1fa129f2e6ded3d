"""Offline form of the filter VQF, with or without magnetometer, for computers without its compiled package.

Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014. The bias is that of the causal filter forward and backward,
specific forces are smoothed both ways, and so is the heading. A field whose size or dip differs from the reference is
disturbed and does not turn the heading. As in `core.signal.published_filter`, open details follow the reference
implementation.
"""

from math import exp, pi, radians

import numpy as np

from core.samples import BoolArray, FloatArray
from core.signal.published_filter import (
    STILL_RAD_S,
    TAU_ACC_S,
    FilterPass,
    LowPass,
    PublishedFilter,
    Quaternion,
    levelled,
    product,
    unit_product,
)
from core.signal.rotations import matrix_from_quaternion, quaternions_about_vertical

TAU_MAG_S, TAU_FIELD_S, TAU_REFERENCE_S = 9.0, 0.05, 20.0
SIZE_SHARE, DIP_RAD = 0.1, radians(10.0)  # by which a field may differ
NEW_FIELD_S, FIRST_FIELD_S, NEW_FIELD_RAD_S = 20.0, 5.0, radians(20.0)  # of one field, while turning so fast
UNDISTURBED_S, MAX_REJECTED_S, REJECTED_FACTOR = 0.5, 60.0, 2.0


def offline_quaternions(
    gyr_rad_s: FloatArray, acc_m_s2: FloatArray, mag: FloatArray | None, step_s: float
) -> FloatArray:
    """Give quaternions (n, 4), earth from sensor, of rates, specific forces and, if any, fields (n, 3); y is north."""
    forward, backward = passes_both_ways(gyr_rad_s, acc_m_s2, step_s)
    turned = _smoothed(gyr_rad_s - bias_of_both(forward, backward), acc_m_s2, step_s)
    if mag is None:
        return turned
    is_disturbed = _disturbed(forward, mag, step_s)
    is_disturbed &= _disturbed(_reversed(backward), mag[::-1], step_s)[::-1]
    return _turned_to_north(turned, mag, is_disturbed, step_s)


def passes_both_ways(gyr_rad_s: FloatArray, acc_m_s2: FloatArray, step_s: float) -> tuple[FilterPass, FilterPass]:
    """Run the causal filter over n samples and over the same backward in time; both results are in order of time."""
    backward = PublishedFilter(step_s).run(-gyr_rad_s[::-1], acc_m_s2[::-1])
    return PublishedFilter(step_s).run(gyr_rad_s, acc_m_s2), _reversed(backward)


def bias_of_both(forward: FilterPass, backward: FilterPass) -> FloatArray:
    """Give the mean (n, 3) of both biases, rad/s, weighted by what is known of them."""
    one, other = (np.linalg.inv(found.bias_variance_deg2_s2) for found in (forward, backward))
    weighted = one @ forward.bias_rad_s[:, :, None] + other @ backward.bias_rad_s[:, :, None]
    return np.asarray(np.linalg.solve(one + other, weighted)[:, :, 0])


def _reversed(one: FilterPass) -> FilterPass:
    return FilterPass(
        one.q_earth_from_sensor[::-1], -one.bias_rad_s[::-1], one.bias_variance_deg2_s2[::-1], one.smooth_rad_s[::-1]
    )


def _smoothed(rates: FloatArray, acc_m_s2: FloatArray, step_s: float) -> FloatArray:
    """Orientation of rates without bias, whose vertical is that of forces smoothed both ways."""
    inertial = _integrated(rates, step_s)
    forces = np.einsum("nij,nj->ni", matrix_from_quaternion(inertial), acc_m_s2)
    there, back = LowPass(TAU_ACC_S, step_s, 3), LowPass(TAU_ACC_S, step_s, 3)
    forces = there.block(forces)
    back.settle(forces[-1].tolist())
    forces = back.block(forces[::-1])[::-1]
    earth: Quaternion = (1.0, 0.0, 0.0, 0.0)
    turned = []
    for q, force in zip(inertial.tolist(), forces.tolist(), strict=True):
        earth, _ = levelled(earth, force)
        turned.append(product(earth, q))
    return np.array(turned)


def _integrated(rates: FloatArray, step_s: float) -> FloatArray:
    size = np.sqrt(np.einsum("ni,ni->n", rates, rates))
    half = 0.5 * step_s * size
    sine = np.divide(np.sin(half), size, out=np.zeros(len(size)), where=size > STILL_RAD_S)
    steps = np.column_stack([np.cos(half), sine[:, None] * rates])
    q: Quaternion = (1.0, 0.0, 0.0, 0.0)
    turned = []
    for step in steps.tolist():
        q = unit_product(q, step)
        turned.append(q)
    return np.array(turned)


def _turned_to_north(
    q_earth_from_sensor: FloatArray, mag: FloatArray, is_disturbed: BoolArray, step_s: float
) -> FloatArray:
    """Turn about the vertical so that fields in sensor axes point along y."""
    field = _in_earth(q_earth_from_sensor, mag)
    delta = np.arctan2(field[:, 0], field[:, 1])
    delta = _smooth_angle(delta, is_disturbed, step_s)
    delta = _smooth_angle(delta[::-1], is_disturbed[::-1], step_s)[::-1]
    return quaternions_about_vertical(delta, q_earth_from_sensor)


def _disturbed(found: FilterPass, mag: FloatArray, step_s: float) -> BoolArray:
    """Whether each field in sensor axes differs from the reference, which is learned on the way."""
    there = mag.any(axis=1)  # nothing at all is a loss
    field = _in_earth(found.q_earth_from_sensor[there], mag[there])
    size = np.sqrt(np.einsum("ni,ni->n", field, field))
    dip = -np.arcsin(np.clip(field[:, 2] / size, -1.0, 1.0))
    fields = LowPass(TAU_FIELD_S, step_s, 2).block(np.column_stack([size, dip]))
    smooth = found.smooth_rad_s[there]
    is_fast = np.einsum("ni,ni->n", smooth, smooth) >= NEW_FIELD_RAD_S**2
    reference = _Reference(step_s)
    judged = [reference.is_left(a, b, fast) for (a, b), fast in zip(fields.tolist(), is_fast.tolist(), strict=True)]
    is_disturbed = np.ones(len(mag), dtype=np.bool_)
    last = np.cumsum(there) - 1  # the last field before a loss stands for it
    is_disturbed[last >= 0] = np.array(judged, dtype=np.bool_)[last[last >= 0]]
    return is_disturbed


class _Reference:
    """Size and dip of the field as it is without iron near, and of the one that may take its place."""

    def __init__(self, step_s: float) -> None:
        self._step_s = step_s
        self._gain = 1.0 - exp(-step_s / TAU_REFERENCE_S)
        self._size = self._dip = 0.0
        self._new_size, self._new_dip = -1.0, 0.0
        self._new_s = self._undisturbed_s = 0.0
        self._is_disturbed = True

    def is_left(self, size: float, dip: float, is_fast: bool) -> bool:
        """Take the next field; whether it is disturbed."""
        if _is_alike(size, self._size, dip, self._dip):
            self._undisturbed_s += self._step_s
            if self._undisturbed_s >= UNDISTURBED_S:
                self._is_disturbed = False
                self._size += self._gain * (size - self._size)
                self._dip += self._gain * (dip - self._dip)
        else:
            self._undisturbed_s, self._is_disturbed = 0.0, True
        self._learn(size, dip, is_fast)
        return self._is_disturbed

    def _learn(self, size: float, dip: float, is_fast: bool) -> None:
        if not _is_alike(size, self._new_size, dip, self._new_dip):
            self._new_s, self._new_size, self._new_dip = 0.0, size, dip
            return
        if is_fast:
            self._new_s += self._step_s
        self._new_size += self._gain * (size - self._new_size)
        self._new_dip += self._gain * (dip - self._new_dip)
        needed_s = NEW_FIELD_S if self._size else FIRST_FIELD_S
        if self._is_disturbed and self._new_s >= needed_s:
            self._size, self._dip = self._new_size, self._new_dip
            self._is_disturbed, self._undisturbed_s = False, UNDISTURBED_S


def _is_alike(size: float, other_size: float, dip: float, other_dip: float) -> bool:
    return abs(size - other_size) < SIZE_SHARE * other_size and abs(dip - other_dip) < DIP_RAD


def _smooth_angle(angle: FloatArray, is_disturbed: BoolArray, step_s: float) -> FloatArray:
    """First-order low-pass that begins as a mean and does not follow disturbed fields (n,), up to a limit."""
    now, usual_gain, first_gain, rejected_s = float(angle[0]), 1.0 - exp(-step_s / TAU_MAG_S), 1.0, 0.0
    smooth = []
    for value, disturbed in zip(angle.tolist(), is_disturbed.tolist(), strict=True):
        gain = usual_gain
        if not disturbed:
            rejected_s = max(rejected_s - REJECTED_FACTOR * step_s, 0.0)
        elif rejected_s <= MAX_REJECTED_S:
            rejected_s += step_s
            gain = 0.0
        else:
            gain /= REJECTED_FACTOR
        if first_gain:
            gain = max(gain, first_gain)
            first_gain /= first_gain + 1.0
            if first_gain * TAU_MAG_S < step_s:
                first_gain = 0.0
        now = _wrapped(now + gain * _wrapped(value - now))
        smooth.append(now)
    return np.array(smooth)


def _wrapped(angle: float) -> float:
    if angle > pi:
        return angle - 2.0 * pi
    return angle + 2.0 * pi if angle < -pi else angle


def _in_earth(q_earth_from_sensor: FloatArray, vectors: FloatArray) -> FloatArray:
    """Rotate by terms in the reference's order: of a field of zeros, the signs of its zeros give the heading there."""
    w, x, y, z = q_earth_from_sensor.T
    a, b, c = vectors.T
    return np.column_stack(
        [
            (1 - 2 * y * y - 2 * z * z) * a + 2 * b * (x * y - w * z) + 2 * c * (w * y + x * z),
            2 * a * (w * z + x * y) + b * (1 - 2 * x * x - 2 * z * z) + 2 * c * (y * z - w * x),
            2 * a * (x * z - w * y) + 2 * b * (w * x + y * z) + c * (1 - 2 * x * x - 2 * y * y),
        ]
    )

"""What a device's own orientation shows: angular rates, which of two kinds its gyroscope's are, and gravity."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.samples import GRAVITY_M_S2, BoolArray, FloatArray, RateKind

Numbers = NDArray[np.int64]
CLEARLY = 0.6  # of the other's error: then the rates are of this kind and not of the other


def derive_rates(q_earth_from_sensor: FloatArray, counter: Numbers, rate_hz: float) -> FloatArray:
    """Derive rates (n, 3), rad/s, in sensor axes from orientations (n, 4); NaN where an adjacent sample is missing.
    The slope of rotation vectors at each stamp: fourth-order central difference over two samples to a side
    (0.2 % low at a tenth of the sampling rate), or over one where a second is missing.
    """
    before_2, before, after, after_2 = (turn_to(q_earth_from_sensor, counter, steps) for steps in (-2, -1, 1, 2))
    over_two = (8.0 * (after - before) - (after_2 - before_2)) * rate_hz / 12.0
    over_one = (after - before) * rate_hz / 2.0
    return np.where(np.isfinite(over_two), over_two, over_one)


def rate_kind_by(
    q_earth_from_sensor: FloatArray, gyr_rad_s: FloatArray, counter: Numbers, rate_hz: float
) -> RateKind | None:
    """Give whether rates agree by far with those at the stamp or the mean before; None: neither, or under 1 s."""
    at_stamp = derive_rates(q_earth_from_sensor, counter, rate_hz)
    before = -turn_to(q_earth_from_sensor, counter, -1) * rate_hz
    errors = [np.linalg.norm(gyr_rad_s - rate, axis=1) for rate in (at_stamp, before)]
    is_known = np.isfinite(errors[0]) & np.isfinite(errors[1])
    if np.sum(is_known) < rate_hz:  # less than a second decides nothing
        return None
    at_stamp_error, before_error = (float(np.sqrt(np.mean(error[is_known] ** 2))) for error in errors)
    if before_error < CLEARLY * at_stamp_error:
        return RateKind.AVERAGED
    return RateKind.INSTANTANEOUS if at_stamp_error < CLEARLY * before_error else None


def turn_to(q: FloatArray, counter: Numbers, steps: int) -> FloatArray:
    """Give the rotation vector (n, 3), rad, from each orientation to that `steps` packets later; NaN if none."""
    turn = np.full((len(q), 3), np.nan)
    n = abs(steps)
    here, there = (slice(None, -n), slice(n, None)) if steps > 0 else (slice(n, None), slice(None, -n))
    is_there = np.isfinite(q[here] + q[there]).all(axis=1) & (counter[there] - counter[here] == steps)
    if is_there.any():
        start, end = (Rotation.from_quat(q[part][is_there], scalar_first=True) for part in (here, there))
        turn[here][is_there] = (start.inv() * end).as_rotvec()
    return turn


def rates_of_turns(turns: FloatArray, is_there: BoolArray, rate_hz: float) -> FloatArray:
    """Angular rates (n, 3), rad/s, of what a sensor turned by since the sample before, quaternions (n, 4)."""
    rate = np.full((len(turns), 3), np.nan)
    if is_there.any():
        rate[is_there] = Rotation.from_quat(turns[is_there], scalar_first=True).as_rotvec() * rate_hz
    return rate


def quaternions(make: Callable[[FloatArray], Rotation], values: FloatArray, is_there: BoolArray) -> FloatArray:
    """Orientations (n, 4), scalar first, that `make` makes of those values (n, ...) that are there; else NaN."""
    q = np.full((len(values), 4), np.nan)
    if is_there.any():
        q[is_there] = make(values[is_there]).as_quat(scalar_first=True)
    return q


def with_gravity(
    free_m_s2: FloatArray, q_earth_from_sensor: FloatArray, gravity_m_s2: float = GRAVITY_M_S2
) -> FloatArray:
    """Give specific force in sensor axes from free acceleration in earth axes, z up; NaN where missing."""
    felt = free_m_s2 + np.array([0.0, 0.0, gravity_m_s2])
    force = np.full_like(felt, np.nan)
    is_there = np.isfinite(felt).all(axis=-1) & np.isfinite(q_earth_from_sensor).all(axis=-1)
    if is_there.any():
        turn = Rotation.from_quat(q_earth_from_sensor[is_there], scalar_first=True)
        force[is_there] = turn.inv().apply(felt[is_there])
    return force

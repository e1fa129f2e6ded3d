"""Units held to the size of what was measured: every importer refuses what no sensor on a person can have felt.

Gravity is in every accelerometer, so the middle of its sizes distinguishes m/s2 from g, and from acceleration without
gravity. Angular rates have no such constant; beyond the ranges of sensors their unit is another, and where there is an
orientation, it gives the rates' unit by itself.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from core.samples import GRAVITY_M_S2, FloatArray
from devices.files.orientation_rates import Numbers, derive_rates
from devices.files.refusal import FileRefusedError, quoted

# of the middle of the sizes of acceleration. Lying still it is gravity, walking legs feel up to 14, running feet two to
# three times gravity; a tenth, without gravity or in g, and ten times as much, g taken for m/s2, are clearly beyond
FELT_M_S2 = (7.0, 40.0)
LIKE_G = (0.7, 1.4)
MOST_RAD_S = 70.0  # twice the widest range of these sensors, 2000 deg/s
FEW = 0.999  # of the rates that have to be possible: one damaged sample is no other unit
NO_GRAVITY = "the median acceleration of {sensor} is {middle}, which does not match gravity in m/s2"
TOO_FAST = "the angular rates of {sensor} reach {largest} deg/s, beyond the range of any sensor"
RECORD_AGAIN = "Check the sensor's range and calibration with the manufacturer's program, and record again"
WINDOW_S, MOST_WINDOWS, LEAST_SAMPLES = 2.0, 60, 100  # as long as steps cancel out, and the bias of rates does not show
# from gravity: the right unit at most, and then the other one at least
NEAR_M_S2 = ((0.3, 0.6), (0.1, 0.4))
TURNING_RAD_S = 0.2  # below, the noise of rates and orientation is what is compared


def check_magnitudes(
    acc_m_s2: FloatArray,
    gyr_rad_s: FloatArray | None,
    sensor: str,
    where: str,
    *,
    gyr_unit: str = "rad/s",
    is_export: bool = True,
) -> None:
    """Refuse samples whose size does not fit their units or lacks gravity; raises FileRefusedError."""
    middle = middle_size(acc_m_s2)
    least, most = FELT_M_S2
    name, shown = quoted(sensor), f"{middle:.2f}"
    if is_export and LIKE_G[0] < middle < LIKE_G[1]:
        raise FileRefusedError(
            where,
            "the median acceleration of {sensor} is {middle}, which does not match gravity in m/s2; the "
            "unit seems to be g",
            "Export the file again in m/s2, or correct the unit",
            sensor=name,
            middle=shown,
        )
    if not (np.isnan(middle) or least < middle < most):
        if is_export:
            raise FileRefusedError(
                where, NO_GRAVITY, "Export the file again in m/s2, with gravity included", sensor=name, middle=shown
            )
        raise FileRefusedError(where, NO_GRAVITY, RECORD_AGAIN, sensor=name, middle=shown)
    if gyr_rad_s is not None:
        _check_rates(gyr_rad_s, sensor, where, gyr_unit, is_export)


def _check_rates(gyr_rad_s: FloatArray, sensor: str, where: str, gyr_unit: str, is_export: bool) -> None:
    sizes = np.abs(gyr_rad_s[np.isfinite(gyr_rad_s)])
    largest = float(np.quantile(sizes, FEW)) if len(sizes) else 0.0
    if largest <= MOST_RAD_S:
        return
    name, shown = quoted(sensor), f"{np.degrees(largest):.0f}"
    if is_export and gyr_unit == "rad/s":
        raise FileRefusedError(
            where,
            "the angular rates of {sensor} are in deg/s, not in rad/s",
            "Export the file again in rad/s, or correct the unit",
            sensor=name,
        )
    if is_export:
        raise FileRefusedError(
            where, TOO_FAST, "Export the file again in deg/s, or correct the unit", sensor=name, largest=shown
        )
    raise FileRefusedError(where, TOO_FAST, RECORD_AGAIN, sensor=name, largest=shown)


def middle_size(vectors: FloatArray) -> float:
    """Give the median length of the vectors (n, 3) that are there; NaN where none is."""
    sizes = np.linalg.norm(vectors, axis=1)
    sizes = sizes[np.isfinite(sizes)]
    return float(np.median(sizes)) if len(sizes) else float(np.nan)


def times_the_turning(
    gyr_rad_s: FloatArray, q_earth_from_sensor: FloatArray, counter: Numbers, rate_hz: float
) -> float:
    """Give rates over the orientation's turning, median: 1 in rad/s, 57 in deg/s; NaN where it does not turn."""
    speed = np.linalg.norm(gyr_rad_s, axis=1)
    turned = np.linalg.norm(derive_rates(q_earth_from_sensor, counter, rate_hz), axis=1)
    is_turning = np.isfinite(speed) & (turned > TURNING_RAD_S)
    return float(np.median(speed[is_turning] / turned[is_turning])) if is_turning.any() else float(np.nan)


def rate_unit_by_gravity(time_s: FloatArray, acc_m_s2: FloatArray, rates: FloatArray) -> str:
    """Find the unit of rates (n, 3): "rad/s" or "deg/s", or empty where the motion does not show it.

    Turned by the right rates into the axes in which a window begins, the specific force is gravity in the mean; by
    others it is not. On 55 sensors of walking people and hinges the right unit left at most 0.3 m/s2, the other one
    from none (legs that hardly turn) to 5; in 128 recordings, also of the simulated walker, no unit was found wrongly.
    """
    steps_s = np.diff(time_s)
    if len(steps_s) < LEAST_SAMPLES:
        return ""
    step_s = float(np.median(steps_s))
    rows = max(round(WINDOW_S / step_s), 2) if step_s > 0 else len(time_s)
    starts = np.arange(0, len(time_s) - rows, rows)
    starts = starts[np.linspace(0, len(starts) - 1, min(len(starts), MOST_WINDOWS)).astype(int)]
    at = starts[:, None] + np.arange(rows)
    is_whole = np.isfinite(acc_m_s2[at]).all(axis=(1, 2)) & np.isfinite(rates[at]).all(axis=(1, 2))
    is_whole &= (np.abs(time_s[at[:, -1]] - time_s[at[:, 0]] - (rows - 1) * step_s) < step_s) if len(at) else True
    at = at[is_whole]
    if not len(at):
        return ""
    off = {
        unit: abs(_mean_turned(acc_m_s2[at], rates[at] * (scale * step_s)) - GRAVITY_M_S2)
        for unit, scale in (("rad/s", 1.0), ("deg/s", np.pi / 180.0))
    }
    right, other = sorted(off, key=off.__getitem__)
    return right if any(off[right] < most and off[other] > least for most, least in NEAR_M_S2) else ""


def _mean_turned(acc_m_s2: FloatArray, turns_rad: FloatArray) -> float:
    """The size of the mean specific force of windows (m, k, 3) in the axes in which each begins, in the median."""
    turned, total = Rotation.identity(len(acc_m_s2)), np.zeros((len(acc_m_s2), 3))
    for row in range(acc_m_s2.shape[1]):
        total += turned.apply(acc_m_s2[:, row])
        turned = turned * Rotation.from_rotvec(turns_rad[:, row])
    return float(np.median(np.linalg.norm(total / acc_m_s2.shape[1], axis=1)))

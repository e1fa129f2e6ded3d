"""How is each sensor turned? The offline filter VQF, without magnetometer, on the rates between two samples.

VQF (Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014) turns the orientation from one sample to the next by the rate
it is given. A rate of the instant of its stamp stands for half an interval before and after it, so it is averaged with
its predecessor; a rate that the device has averaged over the past interval is used as it is.
"""

import numpy as np
from vqf import offlineVQF

from core.rotations import matrix_from_quaternion
from core.samples import FloatArray, RateKind
from core.tracks import Track


def interval_rates(gyr_rad_s: FloatArray, rate_kind: RateKind) -> FloatArray:
    """Mean rates (n, 3) over the interval before each sample."""
    if rate_kind is RateKind.AVERAGED:
        return gyr_rad_s
    mean = gyr_rad_s.copy()
    mean[1:] += gyr_rad_s[:-1]
    mean[1:] *= 0.5
    return mean


def earth_from_sensor(track: Track, rate_kind: RateKind, gyro_bias_rad_s: FloatArray) -> FloatArray:
    """Orientation (n, 4), scalar first, earth z up, of each sample; its heading starts anywhere and may drift."""
    gyr = np.ascontiguousarray(interval_rates(track.gyr_rad_s - gyro_bias_rad_s, rate_kind))
    quaternion: FloatArray = offlineVQF(gyr, np.ascontiguousarray(track.acc_m_s2), None, track.step_s)["quat6D"]
    return quaternion


def earth_from_sensor_magnetic(track: Track, rate_kind: RateKind, gyro_bias_rad_s: FloatArray) -> FloatArray | None:
    """Orientation (n, 4) with a heading from the magnetic field; None without magnetometer."""
    if track.mag is None:
        return None
    gyr = np.ascontiguousarray(interval_rates(track.gyr_rad_s - gyro_bias_rad_s, rate_kind))
    acc, mag = np.ascontiguousarray(track.acc_m_s2), np.ascontiguousarray(track.mag)
    quaternion: FloatArray = offlineVQF(gyr, acc, mag, track.step_s)["quat9D"]
    return quaternion


def rotation_matrices(quaternion: FloatArray) -> FloatArray:
    return matrix_from_quaternion(quaternion)

"""How is each sensor turned? The offline filter VQF, without magnetometer, on the rates between two samples.

VQF (Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014) turns the orientation from one sample to the next by the rate
it is given. A rate of the instant of its stamp stands for half an interval before and after it, so it is averaged with
its predecessor; a rate that the device has averaged over the past interval is used as it is.
"""

from dataclasses import replace

import numpy as np
from vqf import offlineVQF

from core.pair import OrientedTrack
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


def oriented(track: Track, rate_kind: RateKind, gyro_bias_rad_s: FloatArray) -> OrientedTrack:
    """Take the gyroscope's bias (3,) off and find the orientation; its heading starts anywhere and may drift."""
    unbiased = replace(track, gyr_rad_s=track.gyr_rad_s - gyro_bias_rad_s)
    return OrientedTrack(unbiased, _filtered(unbiased, rate_kind, None)["quat6D"])


def oriented_to_north(track: Track, rate_kind: RateKind) -> OrientedTrack | None:
    """The device's own orientation, else one with a heading from the magnetic field, else None.

    `track` has its gyroscope bias removed already.
    """
    if track.q_device is not None and np.isfinite(track.q_device).all():
        return OrientedTrack(track, track.q_device)
    if track.mag is not None and np.isfinite(track.mag).all():
        return OrientedTrack(track, _filtered(track, rate_kind, np.ascontiguousarray(track.mag))["quat9D"])
    return None


def _filtered(track: Track, rate_kind: RateKind, mag: FloatArray | None) -> dict[str, FloatArray]:
    gyr = np.ascontiguousarray(interval_rates(track.gyr_rad_s, rate_kind))
    filtered: dict[str, FloatArray] = offlineVQF(gyr, np.ascontiguousarray(track.acc_m_s2), mag, track.step_s)
    return filtered

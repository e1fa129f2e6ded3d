"""Orientation of each sensor by the offline filter VQF, without magnetometer, on the rates between two samples.

VQF (Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014) turns the orientation from one sample to the next by the rate
it is given. A rate of the instant of its stamp represents half an interval before and after it, so it is averaged with
its predecessor; a rate that the device has averaged over the past interval is used as it is.
"""

from dataclasses import replace

import numpy as np

from core.samples import FloatArray, RateKind
from core.signal.filters import filtered_offline
from core.signal.pair import OrientedTrack
from core.signal.tracks import Track


def oriented(track: Track, rate_kind: RateKind, gyro_bias_rad_s: FloatArray) -> OrientedTrack:
    """Take the gyroscope's bias (3,) off and find the orientation; its heading starts anywhere and may drift.

    The rates of the result stand for the instants of their stamps, whatever the device sent.

    Parameters
    ----------
    gyro_bias_rad_s : (3,)
        In sensor axes.

    Returns
    -------
    OrientedTrack
        Earth from sensor, earth z up, by VQF (Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014).
    """
    rates = track.gyr_rad_s - gyro_bias_rad_s
    if rate_kind is RateKind.AVERAGED:
        intervals: FloatArray = rates
        instants: FloatArray = rates.copy()
        instants[:-1] = 0.5 * (rates[:-1] + rates[1:])
    else:
        intervals, instants = interval_rates(rates), rates
    turned = filtered_offline(intervals, track.acc_m_s2, None, track.step_s)
    return OrientedTrack(replace(track, gyr_rad_s=instants), turned)


def as_of_intervals(one: OrientedTrack) -> OrientedTrack:
    """Give what `oriented` makes of the same rates taken as interval averages, up to a sample of filter lag."""
    track = one.track
    x, y, z = 0.25 * track.step_s * track.gyr_rad_s.T  # half of half an interval's angle, small enough for its sine
    w, i, j, k = one.q_earth_from_sensor.T
    turned = np.stack(
        [w - i * x - j * y - k * z, i + w * x + j * z - k * y, j + w * y + k * x - i * z, k + w * z + i * y - j * x],
        axis=1,
    )
    turned /= np.sqrt(np.einsum("ni,ni->n", turned, turned))[:, None]
    rates = track.gyr_rad_s.copy()
    rates[:-1] = 0.5 * (rates[:-1] + rates[1:])
    return OrientedTrack(replace(track, gyr_rad_s=rates), turned)


def oriented_to_north(track: Track) -> OrientedTrack | None:
    """Give the device's orientation, else a magnetic heading, else None; `track` comes from `oriented`."""
    if track.q_device is not None and np.isfinite(track.q_device).all():
        return OrientedTrack(track, track.q_device)
    if track.mag is not None and np.isfinite(track.mag).all():
        rates = interval_rates(track.gyr_rad_s)
        return OrientedTrack(track, filtered_offline(rates, track.acc_m_s2, track.mag, track.step_s))
    return None


def interval_rates(rates: FloatArray) -> FloatArray:
    """Average each rate (n, 3) and its predecessor: the rate over the interval before each sample, rad/s."""
    mean = rates.copy()
    mean[1:] += rates[:-1]
    mean[1:] *= 0.5
    return mean

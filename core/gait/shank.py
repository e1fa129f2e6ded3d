"""Initial contact and toe-off where only the shank wears a sensor: less sure, and marked.

In swing the shank turns fast and forward; toe-off is the trough of its rate before (Salarian et al. 2004,
doi 10.1109/TBME.2004.827933). Their trough after it is blurred by the shock of landing: initial contact is taken
from where the shank ceases to swing forward. What the foot does in between stays unknown.
"""

import numpy as np
from scipy.signal import find_peaks

from core.gait.crossings import crossing
from core.gait.events import SD_S, SOURCES, EventSource, FootEvents
from core.gait.foot import MOVING_RAD_S
from core.samples import FloatArray, IntArray
from core.signal.pair import OrientedTrack
from core.signal.rotations import matrix_from_quaternion

SMOOTH_S = 0.05  # soft tissue rings at 9 Hz and more
MIN_SWING_RATE_RAD_S = 0.8
SWING_SHARE = 0.4  # of the usual peak of swing
MIN_STRIDE_S = 0.6
REACH_S = 0.6  # from the peak of swing to its beginning and end, at the slowest
CONTACT_AFTER_S = 0.034  # 30 ms at 2 m/s and 40 at 0.3, on the simulated walker


def gait_of_shank(shank: OrientedTrack) -> FootEvents:
    """Detect initial contact and toe-off (k,) of a leg from its bias-free shank, without gaps; the rest NaN."""
    track = shank.track
    gyr, step_s = track.gyr_rad_s, track.step_s
    axis = _swing_axis(gyr)
    rate = gyr @ axis
    off, peaks, on = _swings(rate, step_s)
    pointing = matrix_from_quaternion(shank.q_earth_from_sensor[peaks]) @ axis
    heading = np.unwrap(np.arctan2(pointing[:, 1], pointing[:, 0]))
    unknown = np.full(len(peaks), np.nan)
    missing = np.concatenate([[0], np.cumsum(~track.is_measured)])
    is_known = np.isfinite(SD_S[EventSource.SHANK])
    return FootEvents(
        heel_rise_s=unknown,
        toe_off_s=track.start_s + step_s * off,
        initial_contact_s=track.start_s + step_s * on,
        full_contact_s=unknown,
        length_m=unknown,
        height_m=unknown,
        climb_m=unknown,
        turn_rad=np.diff(heading, prepend=heading[:1]),
        is_certain=np.ones(len(peaks), dtype=bool),
        is_measured=missing[np.ceil(on).astype(int) + 1] == missing[np.floor(off).astype(int)],
        source=np.tile(np.where(is_known, SOURCES.index(EventSource.SHANK), 0), (len(peaks), 1)),
        sd_s=np.tile(SD_S[EventSource.SHANK], (len(peaks), 1)),
        is_from_shank=True,
    )


def _swing_axis(gyr: FloatArray) -> FloatArray:
    """The axis the shank mostly turns about, signed so that swing is positive: no other phase is as fast."""
    moving = gyr[np.sum(gyr**2, axis=1) > MOVING_RAD_S**2]
    if not len(moving):
        return np.array([1.0, 0.0, 0.0])
    axis = np.asarray(np.linalg.eigh(moving.T @ moving)[1][:, -1])
    return axis if np.sum((moving @ axis) ** 3) >= 0 else -axis


def _swings(rate: FloatArray, step_s: float) -> tuple[FloatArray, IntArray, FloatArray]:
    """Toe-off, peak and initial contact of every swing, as indices; one whose troughs are not both there is none."""
    width = max(1, round(SMOOTH_S / step_s))
    smooth = np.convolve(rate, np.full(width, 1.0 / width), mode="same")
    distance = max(1, round(MIN_STRIDE_S / step_s))
    peaks, properties = find_peaks(smooth, height=MIN_SWING_RATE_RAD_S, distance=distance)
    if len(peaks):
        peaks = peaks[properties["peak_heights"] > SWING_SHARE * np.median(properties["peak_heights"])]
    reach = round(REACH_S / step_s)
    rows = []
    for peak in peaks.tolist():
        before = np.flatnonzero(smooth[max(0, peak - reach) : peak] < 0.0)
        ceases = crossing(smooth, peak, min(peak + reach, len(smooth) - 1), 0.0)
        on = ceases + CONTACT_AFTER_S / step_s
        if len(before) and on < len(smooth) - 1:  # not so where it never ceases
            rows.append((_trough_before(smooth, max(0, peak - reach) + int(before[-1])), peak, on))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 3)
    return columns[:, 0], columns[:, 1].astype(np.int64), columns[:, 2]


def _trough_before(rate: FloatArray, index: int) -> int:
    """The last local minimum up to `index`."""
    while index > 0 and rate[index - 1] < rate[index]:
        index -= 1
    return index

"""Stamps of packets, which come late and together, put on one straight line, as an even sensor took its samples."""

from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray

EVEN = 0.25  # of a step: stamps nearer to whole steps were made by the sensor's own clock
MOST_UNEVEN = 0.02  # of the samples
LATE_S = 2.0  # so long a packet may be late; what is missing for longer was lost
LEAST_LOSS_S = 0.03  # packets are not more punctual


@dataclass(frozen=True, slots=True)
class StraightTimes:
    """Times on a straight line, and by how much nine tenths of the stamps were away from it at most."""

    time_s: FloatArray
    away_s: float
    least_loss_s: float
    rate_hz: float


def lasting_step_back(stamp_s: FloatArray, rate_hz: float) -> int | None:
    """Find the first sample from which packets' stamps are lastingly earlier than those before imply."""
    window, least_s = max(round(LATE_S * rate_hz), 4), max(1.5 / rate_hz, LEAST_LOSS_S)
    back = np.flatnonzero(np.diff(stamp_s) < -least_s) + 1
    if not len(back):
        return None
    step_s = _usual_step_s(stamp_s, window) if len(stamp_s) > 2 * window else 1.0 / rate_hz
    delay_s = stamp_s - np.arange(len(stamp_s)) * step_s
    for at in back:
        if delay_s[max(at - window, 0) : at].min() - delay_s[at : at + window].min() > least_s:
            return int(at)
    return None


def _usual_step_s(stamp_s: FloatArray, window: int) -> float:
    return float(np.median(stamp_s[window:] - stamp_s[:-window])) / window


def straight_times(stamp_s: FloatArray, rate_hz: float, late_s: float = LATE_S) -> StraightTimes | None:
    """Fit a line through late stamps, gaps where samples were lost; None: even already, or too few.
    A loss is where the least delay of the samples after it is above that of those before, `late_s` around it.
    """
    window = max(round(late_s * rate_hz), 4)
    if len(stamp_s) <= 2 * window or not np.isfinite(stamp_s).all():
        return None
    steps = np.diff(stamp_s) * rate_hz
    whole = np.maximum(np.round(steps), 1.0)
    if (steps > 0).all() and np.mean(np.abs(steps - whole) > EVEN) <= MOST_UNEVEN:
        return None
    step_s = _usual_step_s(stamp_s, window)
    if not step_s > 0.0:
        return None
    count = np.arange(len(stamp_s), dtype=np.float64)
    least_loss_s = max(1.5 * step_s, LEAST_LOSS_S)
    delay_s = stamp_s - count * step_s
    for at in np.flatnonzero(np.diff(stamp_s) > least_loss_s) + 1:
        before, after = delay_s[max(at - window, 0) : at], delay_s[at : at + window]
        late_s = float(after.min() - before.min())
        if late_s > least_loss_s:
            lost = max(round(late_s / step_s), 1)
            count[at:] += lost
            delay_s[at:] -= lost * step_s
    slope_s, first_s = np.polynomial.polynomial.polyfit(count - count.mean(), stamp_s, 1)[::-1]
    if not slope_s > 0.0:
        return None
    time_s = first_s + slope_s * (count - count.mean())
    return StraightTimes(time_s, float(np.quantile(np.abs(stamp_s - time_s), 0.9)), least_loss_s, 1.0 / slope_s)

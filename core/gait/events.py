"""When does a foot land and leave? Four events of every swing, from the pitch rate of the foot.

One definition of each event, for any speed and sampling rate; levels follow each foot's own peaks:

- toe-off: the fast plantarflexion of push-off ends, its rate has fallen to TOE_OFF_SHARE of its peak;
- initial contact: near the end of swing the floor turns the foot down; the rate reaches CONTACT_SHARE of the usual peak
  of loading, after the last time the toes rose. The shock itself is no help: below 100 Hz it is aliased, and a jerk
  threshold latches onto earlier peaks;
- full contact and heel rise: the rate comes to rest, and leaves it.

Where a foot hardly rolls (shuffling, a flat landing) the pitch says nothing; its speed does, and the events are marked.
"""

from dataclasses import dataclass

import numpy as np

from core.gait.foot import FootMotion, follow
from core.pair import OrientedTrack
from core.samples import BoolArray, FloatArray

TOE_OFF_SHARE = 0.88
CONTACT_SHARE = 0.69
MAX_FALL_S = 0.04  # a foot whose toes come down that long has landed, whatever shakes the sensor
STILL_SHARE, MIN_STILL_RAD_S = 0.05, 0.1  # of the peak of push-off: below, the foot is flat
ONSET_RATIO = 2.05  # time to a level over time from there to its double: growth with the power 1.75 of time
LANDING_RATIO = 1.4  # a landing ends steeply, and soft tissue rings after it
MIN_ROLL_RAD_S = 0.5  # slower push-off or loading, and the foot is put down and lifted flat
FLAT_SHARE = 0.15  # of the greatest speed: below, a foot that does not roll is on the floor


@dataclass(frozen=True, slots=True)
class FootEvents:
    """The events of one foot, one row per swing: heel rise, toe-off, then initial contact and full contact. All (k,).

    Attributes
    ----------
    length_m, height_m, turn_rad
        How far the swing carried the foot over the floor, how high the sensor rose, how far the foot turned about the
        vertical; NaN from a shank.
    is_certain
        False where the foot hardly rolled, or its pitch contradicts its way.
    is_measured
        False where samples were missing between heel rise and full contact.
    """

    heel_rise_s: FloatArray
    toe_off_s: FloatArray
    initial_contact_s: FloatArray
    full_contact_s: FloatArray
    length_m: FloatArray
    height_m: FloatArray
    turn_rad: FloatArray
    is_certain: BoolArray
    is_measured: BoolArray
    is_from_shank: bool = False

    def __len__(self) -> int:
        return len(self.toe_off_s)


def gait_of(foot: OrientedTrack) -> FootEvents:
    """Events of one foot over one stretch without gaps, in any mounting. Its gyroscope bias must have been removed."""
    return detect_events(follow(foot), foot.track.is_measured)


def detect_events(motion: FootMotion, is_measured: BoolArray) -> FootEvents:
    """Events of every swing of `motion`.

    Parameters
    ----------
    is_measured : (n,)
        As `Track.is_measured`.
    """
    rate, swings = motion.pitch_rate_rad_s, motion.swings
    speed = np.linalg.norm(motion.velocity_m_s, axis=1)
    spans = list(zip(swings.anchor_before.tolist(), swings.fastest.tolist(), swings.anchor_after.tolist(), strict=True))
    push = [a + int(np.argmin(rate[a : m + 1])) for a, m, _ in spans]
    load = [m + int(np.argmin(rate[m : b + 1])) for _, m, b in spans]
    usual_push = float(np.median(-rate[push])) if spans else 0.0
    usual_load = float(np.median(-rate[load])) if spans else 0.0
    still = max(MIN_STILL_RAD_S, STILL_SHARE * usual_push)
    rows = np.full((len(spans), 4), np.nan)
    is_rolling = np.zeros(len(spans), dtype=bool)
    for k, ((a, m, b), p, q) in enumerate(zip(spans, push, load, strict=True)):
        is_rolling[k] = -rate[p] > MIN_ROLL_RAD_S and -rate[q] > MIN_ROLL_RAD_S
        flat = FLAT_SHARE * speed[m]
        off = first_crossing(rate, p, m, TOE_OFF_SHARE * rate[p]) if -rate[p] > MIN_ROLL_RAD_S else np.nan
        level = -CONTACT_SHARE * min(-rate[q], usual_load)
        on = _contact(rate, m, q, level, MAX_FALL_S / motion.step_s) if -rate[q] > MIN_ROLL_RAD_S else np.nan
        off = off if np.isfinite(off) else last_crossing(speed, a, m, flat)
        on = on if np.isfinite(on) else first_crossing(speed, m, b, flat)
        rise, full = _onset(-rate, p, a, still), _onset(-rate, q, b, LANDING_RATIO * still)
        rows[k] = min(rise, off), off, on, max(full, on)
    rows = np.where(np.isfinite(rows), rows, np.nan)
    is_whole = np.isfinite(rows).all(axis=1)
    times = motion.time_of(rows[is_whole])
    missing = np.concatenate([[0], np.cumsum(~is_measured)])
    is_heard = missing[swings.anchor_after + 1] == missing[swings.anchor_before]
    return FootEvents(
        heel_rise_s=times[:, 0],
        toe_off_s=times[:, 1],
        initial_contact_s=times[:, 2],
        full_contact_s=times[:, 3],
        length_m=np.linalg.norm(motion.travel_m, axis=1)[is_whole],
        height_m=motion.height_m[is_whole],
        turn_rad=motion.turn_rad[is_whole],
        is_certain=(is_rolling & motion.is_direction_certain)[is_whole],
        is_measured=is_heard[is_whole],
    )


def first_crossing(signal: FloatArray, first: int, last: int, level: float) -> float:
    """Fractional index in first..last where `signal` (n,) first passes `level`; NaN where it does not."""
    return _crossing(signal, first, last, level, 0)


def last_crossing(signal: FloatArray, first: int, last: int, level: float) -> float:
    """Fractional index in first..last where `signal` (n,) last passes `level`; NaN where it does not."""
    return _crossing(signal, first, last, level, -1)


def _crossing(signal: FloatArray, first: int, last: int, level: float, which: int) -> float:
    above = signal[first : last + 1] - level
    passes = np.flatnonzero((above[1:] > 0) != (above[:-1] > 0))
    if not len(passes):
        return float("nan")
    k = int(passes[which])
    return first + k + float(above[k] / (above[k] - above[k + 1]))


def _contact(rate: FloatArray, fastest: int, load: int, level: float, longest: float) -> float:
    """Where the rate, on its last way down to the peak of loading, reaches `level`; `longest` samples at most."""
    falls = last_crossing(rate, fastest, load, 0.0)
    reached = first_crossing(rate, max(fastest, int(falls)), load, level) if np.isfinite(falls) else np.nan
    return float(np.fmin(reached, falls + longest))


def _onset(rate: FloatArray, peak: int, rest: int, still: float) -> float:
    """Where a rate that is zero at index `rest` begins to grow towards its peak, extrapolated from two low levels."""
    first, last, which = (rest, peak, -1) if rest < peak else (peak, rest, 0)
    low, high = (_crossing(rate, first, last, level, which) for level in (still, 2.0 * still))
    if not np.isfinite(low):
        return float(rest)
    reach = ONSET_RATIO * (low - high) if np.isfinite(high) else 0.0
    return float(np.clip(low + reach, min(rest, low), max(rest, low)))

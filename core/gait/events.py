"""When does a foot land and leave? Four events of every swing, from the pitch rate of the foot.

One definition of each event, for any speed and sampling rate; levels follow each foot's own peaks:

- toe-off: the fast plantarflexion of push-off ends, its rate has fallen to TOE_OFF_SHARE of its peak;
- initial contact: near the end of swing the floor turns the foot down; the rate reaches CONTACT_SHARE of the usual peak
  of loading, after the last time the toes rose. At 200 Hz the shock comes at this instant; below 100 Hz it is aliased,
  and a jerk threshold latches onto earlier peaks;
- full contact and heel rise: the rate comes to rest, and leaves it.

A foot that lands with its forefoot is turned the other way by the floor: toes up, by a heel that comes down. Its full
contact is where it ceases to sink, be the heel on the floor or not.


Where a foot hardly rolls, or comes down flat while it goes on (shuffling), the pitch says nothing; its speed does, and
the events are marked.
Where the sensor shakes on its foot, the rate of one swing says little; the foot's mean swing does.
"""

from dataclasses import dataclass, replace

import numpy as np

from core.gait.foot import FootMotion, follow
from core.pair import OrientedTrack
from core.samples import BoolArray, FloatArray

TOE_OFF_SHARE = 0.88
CONTACT_SHARE = 0.69
LANDED_S = 0.02  # after half the peak of loading a foot has landed, whatever then shakes the sensor
STILL_SHARE, MIN_STILL_RAD_S = 0.05, 0.09  # of the peak of push-off: below, the foot is flat; the share at 0.3 m/s
ONSET_RATIO = 2.05  # time to a level over time from there to its double: growth with the power 1.75 of time
LANDING_RATIO = 1.4  # a landing ends steeply, and soft tissue rings after it
MIN_ROLL_RAD_S = 0.5  # slower push-off or loading, and the foot is put down and lifted flat
FOREFOOT_RAD = np.deg2rad(3.0)  # heels first, real feet go 2 deg below their rest
FLAT_LANDING_RAD = np.deg2rad(8.0)  # toes no further up may come down in the air: the foot then goes on at more than
LANDED_SHARE = 0.25  # of its greatest speed
SHAKING_SHARE = 0.25  # of the level of rest: so far apart, flat feet's rates are not the feet's; real ones are by 0.16
MIN_SWINGS_TO_AVERAGE = 4
FLAT_SHARE = 0.15  # of the greatest speed: below, a foot that does not roll is on the floor


@dataclass(frozen=True, slots=True)
class Usual:
    """A foot's usual greatest pitch rates, toes down, in push-off and loading, and the rate below which it is flat."""

    push_rad_s: float
    load_rad_s: float
    still_rad_s: float


@dataclass(frozen=True, slots=True)
class Landing:
    """A foot that comes down: its pitch rate (n,) from index `begin` on to rest, which the floor makes negative.

    With the forefoot first that is toes up. A flat landing hardly has the toes up before.
    """

    begin: int
    rate_rad_s: FloatArray
    is_forefoot: bool = False
    is_flat: bool = False


@dataclass(frozen=True, slots=True)
class MeanRate:
    """Mean pitch rate (n,) of several swings around a mark, which lies at index `before`.

    `unrest_rad_s` is how much the swings differ while the foot is flat.
    """

    rate_rad_s: FloatArray
    before: int
    unrest_rad_s: float


@dataclass(frozen=True, slots=True)
class FootEvents:
    """The events of one foot, one row per swing: heel rise, toe-off, then initial contact and full contact. All (k,).

    Attributes
    ----------
    length_m, height_m, turn_rad
        How far the swing carried the foot over the floor, how high the sensor (not the toe) rose, how far the foot
        turned about the vertical; NaN from a shank.
    is_certain
        False where the foot hardly rolled or came down flat while it went on, or its pitch contradicts its way.
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
    leaving = [rate[a : m + 1] for a, m, _ in spans]
    landings = [_landing_of(motion, m, b) for _, m, b in spans]
    is_heel_first = np.array([not landing.is_forefoot for landing in landings], dtype=bool)
    push, load = (-np.array([part.min() for part in parts]) for parts in (leaving, [x.rate_rad_s for x in landings]))
    is_rolling = (push > MIN_ROLL_RAD_S) & (load > MIN_ROLL_RAD_S)
    usual = _usual(push, load)
    rows = np.full((len(spans), 4), np.nan)
    for k, (a, m, b) in enumerate(spans):
        rows[k, :2] = _leaving(leaving[k], usual) + a
        rows[k, 2:] = _landing(landings[k], usual, motion.step_s)
        flat = FLAT_SHARE * speed[m]
        if not np.isfinite(rows[k, 1]):
            rows[k, 1] = last_crossing(speed, a, m, flat)
        if landings[k].is_flat and np.isfinite(rows[k, 2]) and speed[int(rows[k, 2])] > LANDED_SHARE * speed[m]:
            rows[k, 2], is_rolling[k] = np.nan, False
        if not np.isfinite(rows[k, 2]):
            rows[k, 2] = first_crossing(speed, m, b, flat)
    is_usual = is_rolling & is_heel_first & (push > 0.5 * usual.push_rad_s) & (load > 0.5 * usual.load_rad_s)
    _steady(rows, motion, spans, is_usual, usual)
    rows[:, 0] = np.minimum(rows[:, 0], rows[:, 1])
    rows[:, 3] = np.maximum(rows[:, 3], rows[:, 2])
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


def _landing_of(motion: FootMotion, fastest: int, rest: int) -> Landing:
    """How a foot comes down between two indices; with its forefoot first, its toes are further down than in stance."""
    rate, pitch = motion.pitch_rate_rad_s, motion.pitch_rad
    highest = fastest + int(np.argmax(pitch[fastest : rest + 1]))
    lowest = highest + int(np.argmin(pitch[highest : rest + 1]))
    if pitch[lowest] > -FOREFOOT_RAD:
        return Landing(fastest, rate[fastest : rest + 1], False, bool(pitch[highest] < FLAT_LANDING_RAD))
    lowered = highest + int(np.argmin(rate[highest : lowest + 1]))
    return Landing(lowered, -rate[lowered : rest + 1], True, False)


def _leaving(rate: FloatArray, usual: Usual) -> FloatArray:
    """Heel rise and toe-off as indices of a pitch rate (n,) from rest to mid-swing; NaN: hardly rolled."""
    push = int(np.argmin(rate))
    if -rate[push] <= MIN_ROLL_RAD_S:
        return np.array([_onset(-rate, push, 0, usual.still_rad_s), np.nan])
    off = first_crossing(rate, push, len(rate) - 1, TOE_OFF_SHARE * rate[push])
    return np.array([_onset(-rate, push, 0, usual.still_rad_s), off])


def _landing(landing: Landing, usual: Usual, step_s: float) -> FloatArray:
    """Initial and full contact as indices; NaN: hardly rolled."""
    rate = landing.rate_rad_s
    load = int(np.argmin(rate))
    full = _onset(-rate, load, len(rate) - 1, LANDING_RATIO * usual.still_rad_s)
    level = -CONTACT_SHARE * min(-rate[load], usual.load_rad_s)
    on = _contact(rate, load, level, step_s) if -rate[load] > MIN_ROLL_RAD_S else np.nan
    return np.array([on, full]) + landing.begin


def _steady(
    rows: FloatArray, motion: FootMotion, spans: list[tuple[int, int, int]], is_usual: BoolArray, usual: Usual
) -> None:
    """Time the usual swings' events, rows (k, 4), by the foot's mean swing if its sensor shakes; in place.

    Integrated to a pitch, the shaking is small: where the pitch passes half its greatest, toes down and toes up, is
    sure in every swing. How far from these marks the events lie is read off the mean rate of all swings. From stride to
    stride the events then vary as the marks do.
    """
    marks = np.array([_marks(motion.pitch_rad, *span) for span in spans]).reshape(-1, 2)
    chosen = np.flatnonzero(is_usual & np.isfinite(marks).all(axis=1))
    if len(chosen) < MIN_SWINGS_TO_AVERAGE:
        return
    rate = motion.pitch_rate_rad_s
    begin, middle, end = np.array(spans)[chosen].T
    leave = _mean_rate([rate[a : m + 1] for a, m in zip(begin, middle, strict=True)], marks[chosen, 0] - begin, usual)
    land = _mean_rate([rate[m : b + 1] for m, b in zip(middle, end, strict=True)], marks[chosen, 1] - middle, usual)
    unrest = 0.5 * (leave.unrest_rad_s + land.unrest_rad_s)
    if unrest < SHAKING_SHARE * usual.still_rad_s:
        return
    usual = replace(usual, still_rad_s=max(usual.still_rad_s, 3.0 * unrest / np.sqrt(len(chosen))))
    leaving = _leaving(leave.rate_rad_s, usual) - leave.before
    landing = _landing(Landing(-land.before, land.rate_rad_s), usual, motion.step_s)
    if np.isfinite(leaving).all() and np.isfinite(landing).all():
        rows[chosen, :2] = marks[chosen, :1] + leaving
        rows[chosen, 2:] = marks[chosen, 1:] + landing


def _usual(push: FloatArray, load: FloatArray) -> Usual:
    if not len(push):
        return Usual(0.0, 0.0, MIN_STILL_RAD_S)
    usual_push = float(np.median(push))
    return Usual(usual_push, float(np.median(load)), max(MIN_STILL_RAD_S, STILL_SHARE * usual_push))


def _marks(pitch: FloatArray, rest: int, fastest: int, next_rest: int) -> tuple[float, float]:
    """Where the pitch (n,) first passes half its greatest toes down, and last half its greatest toes up; else NaN."""
    lowest = rest + int(np.argmin(pitch[rest : fastest + 1]))
    highest = fastest + int(np.argmax(pitch[fastest : next_rest + 1]))
    return (
        first_crossing(pitch, rest, lowest, 0.5 * pitch[lowest]),
        last_crossing(pitch, highest, next_rest, 0.5 * pitch[highest]),
    )


def _mean_rate(rates: list[FloatArray], marks: FloatArray, usual: Usual) -> MeanRate:
    """Mean of the rates of several swings, (n,) each, aligned at their `marks` (k,), as far as most of them reach."""
    before = int(np.median(marks))
    after = int(np.median([len(rate) - 1 - mark for rate, mark in zip(rates, marks, strict=True)]))
    offsets = np.arange(-before, after + 1)
    rows = np.stack(
        [
            np.interp(mark + offsets, np.arange(len(rate)), rate, left=np.nan, right=np.nan)
            for rate, mark in zip(rates, marks, strict=True)
        ]
    )
    mean = np.nanmean(rows, axis=0)
    is_flat = np.abs(mean) < usual.still_rad_s
    unrest = float(np.median(np.nanstd(rows[:, is_flat], axis=0))) if is_flat.any() else 0.0
    return MeanRate(mean, before, unrest)


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


def _contact(rate: FloatArray, load: int, level: float, step_s: float) -> float:
    """Where the rate, on its last way down to the peak of loading, reaches `level`, LANDED_S after its half at most."""
    falls = last_crossing(rate, 0, load, 0.0)
    if not np.isfinite(falls):
        return float("nan")
    half, whole = (first_crossing(rate, int(falls), load, share * level) for share in (0.5 / CONTACT_SHARE, 1.0))
    return float(np.fmin(whole, half + LANDED_S / step_s))


def _onset(rate: FloatArray, peak: int, rest: int, still: float) -> float:
    """Where a rate that is zero at index `rest` begins to grow towards its peak, extrapolated from two low levels."""
    first, last, which = (rest, peak, -1) if rest < peak else (peak, rest, 0)
    low, high = (_crossing(rate, first, last, level, which) for level in (still, 2.0 * still))
    if not np.isfinite(low):
        return float(rest)
    reach = ONSET_RATIO * (low - high) if np.isfinite(high) else 0.0
    return float(np.clip(low + reach, min(rest, low), max(rest, low)))

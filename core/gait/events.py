"""Four events of every swing of a foot, from its pitch rate: heel rise, toe-off, initial and full contact.

One definition of each event, for any speed and sampling rate; levels follow each foot's own peaks:

- toe-off: the fast plantarflexion of push-off ends, its rate has fallen to TOE_OFF_SHARE of its peak;
- initial contact: near the end of swing the floor turns the foot down; the rate reaches CONTACT_SHARE of the usual peak
  of loading, after the last time the toes rose. At 200 Hz the shock comes at this instant; below 100 Hz it is aliased,
  and a jerk threshold latches onto earlier peaks;
- full contact and heel rise: the rate comes to rest, and leaves it.

A foot that lands with its forefoot is turned the other way by the floor: toes up, by a heel that comes down. Its full
contact is where it ceases to sink, be the heel on the floor or not.

Where a foot hardly rolls, or comes down flat while it goes on (shuffling, dragging), the pitch shows nothing of contact
and toe-off; how the sole travels over the floor does (`core.gait.sole`). What neither shows stays unknown, that event
alone. Each event carries its source and a standard deviation.
Where the sensor shakes on its foot, the rate of one swing shows little; the foot's mean swing does.
"""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from core.gait.crossings import Onset, crossing, onset
from core.gait.foot import FootMotion, follow
from core.gait.rolling import LANDING_SHARES, LEAST_SWINGS, landing_marks, leaving_marks, sharpest, timed_by
from core.gait.sole import SoleTravel, travel_of
from core.samples import BoolArray, FloatArray, IntArray
from core.signal.pair import OrientedTrack
from core.signal.robust import robust_sd
from core.signal.tracks import MAX_REPORTED_GAP_S

TOE_OFF_SHARE = 0.88
CONTACT_SHARE = 0.69
LANDED_S = 0.02  # after half the peak of loading a foot has landed, whatever then shakes the sensor
STILL_SHARE, MIN_STILL_RAD_S = 0.05, 0.09  # of the peak of push-off: below, the foot is flat; the share at 0.3 m/s
LANDING_RATIO = 1.4  # a landing ends steeply, and soft tissue rings after it
MIN_ROLL_RAD_S = 0.5  # slower push-off or loading, and the foot is put down and lifted flat
FOREFOOT_RAD = np.deg2rad(3.0)  # heels first, real feet go 2 deg below their rest
FLAT_LANDING_RAD = np.deg2rad(8.0)  # toes no further up before landing may come down in the air
MAX_STRAIGHT_RAD = np.deg2rad(12.0)  # straight strides turn a foot by up to 5 deg
MIN_LOWERED_RAD = np.deg2rad(17.0)  # a foot that turns its toes down less on leaving is lifted; healthy ones turn 50
SHAKING_SHARE = 0.25  # of the level of rest: so far apart, flat feet's rates are not the feet's; real ones are by 0.16
STRAY_SD, STRAY_S = 5.0, 0.07  # beyond both, a toe-off lies where no other of the foot's does
FLAT_SHARE = 0.15  # of the greatest speed: below, a foot that does not roll is on the floor; for the live events


class EventSource(StrEnum):
    """What gave the time of an event."""

    UNKNOWN = ""
    PITCH = "pitch"
    SOLE = "sole"
    SHANK = "shank"


SOURCES = tuple(EventSource)
EVENTS = ("heel_rise_s", "toe_off_s", "initial_contact_s", "full_contact_s")  # the order of columns
# Standard deviations, s, of EVENTS by what found them, beside what was extrapolated. Pitch: initial contact and toe-off
# against optics and force plates (10-14 and 3-8 ms), the others on simulated feet; sole: simulated flat, dragging feet
SD_S = {
    EventSource.PITCH: (0.020, 0.010, 0.012, 0.020),
    EventSource.SOLE: (np.nan, 0.020, 0.020, np.nan),
    EventSource.SHANK: (np.nan, 0.020, 0.015, np.nan),
}
REACH_SHARE = 0.5  # of an extrapolated time is its standard deviation


@dataclass(frozen=True, slots=True)
class Usual:
    """A foot's usual greatest pitch rates, toes down, in push-off and loading, and the rate below which it is flat."""

    push_rad_s: float
    load_rad_s: float
    still_rad_s: float


@dataclass(frozen=True, slots=True)
class Landing:
    """A foot that comes down: its pitch rate (n,) from index `begin` on to rest, which the floor makes negative.

    With the forefoot first that is toes up.
    """

    begin: int
    rate_rad_s: FloatArray
    is_forefoot: bool = False


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

    Heel rise and full contact are NaN where they are not known.

    `length_m`, `height_m`, `climb_m`, `turn_rad`: how far the swing carried the foot over the floor, how high the
    sensor (not the toe) rose, how much higher the foot came to stand, how far it turned about the vertical; NaN from a
    shank.
    `source`, `sd_s`: (k, 4): what gave each event, an index into SOURCES, and its standard deviation; columns as
    EVENTS, NaN where unknown.
    """

    heel_rise_s: FloatArray
    toe_off_s: FloatArray
    initial_contact_s: FloatArray
    full_contact_s: FloatArray
    length_m: FloatArray
    height_m: FloatArray
    climb_m: FloatArray
    turn_rad: FloatArray
    is_certain: BoolArray  # False where the contacts themselves are in doubt: the foot's pitch contradicts its way
    is_measured: BoolArray  # False where samples were missing between heel rise and full contact
    source: IntArray
    sd_s: FloatArray
    is_from_shank: bool = False

    def __len__(self) -> int:
        return len(self.toe_off_s)


@dataclass(frozen=True, slots=True)
class Timing:
    """Events of every swing as they are timed: indices of samples, sources and extrapolated samples, (k, 4) each."""

    index: FloatArray
    source: IntArray
    reach: FloatArray

    def put(self, k: int, event: int, found: Onset, source: EventSource) -> None:
        self.index[k, event], self.reach[k, event] = found.index, found.reach
        self.source[k, event] = SOURCES.index(source) if np.isfinite(found.index) else 0


HEEL_RISE, TOE_OFF, CONTACT, FULL_CONTACT = range(4)


def gait_of(foot: OrientedTrack, is_rigid: bool = False) -> FootEvents:
    """Events of one foot over one stretch without gaps, in any mounting. Its gyroscope bias must have been removed.

    Parameters
    ----------
    foot
        One stretch without gaps, in sensor axes.
    is_rigid
        The foot does not bend at its toes, as a prosthetic one: it goes on turning when its toes have left the floor.

    Returns
    -------
    FootEvents
        One row per swing, seconds on the track's clock.
    """
    return detect_events(follow(foot), foot.track.is_measured, is_rigid)


def detect_events(motion: FootMotion, is_measured: BoolArray, is_rigid: bool = False) -> FootEvents:
    """Detect the events of every swing, s on the motion's clock; `is_measured` (n,) as in `Track`."""
    rate, swings, sole = motion.pitch_rate_rad_s, motion.swings, travel_of(motion)
    spans = list(zip(swings.anchor_before.tolist(), swings.fastest.tolist(), swings.anchor_after.tolist(), strict=True))
    leaving = [rate[a : m + 1] for a, m, _ in spans]
    landings = [_landing_of(motion, m, b, sole.lands[k]) for k, (_, m, b) in enumerate(spans)]
    is_heel_first = np.array([not landing.is_forefoot for landing in landings], dtype=bool)
    push, load = (-np.array([part.min() for part in parts]) for parts in (leaving, [x.rate_rad_s for x in landings]))
    usual = _usual(push, load)
    size = (len(spans), len(EVENTS))
    timing = Timing(np.full(size, np.nan), np.zeros(size, dtype=np.int64), np.zeros(size))
    for k, (a, _, _) in enumerate(spans):
        for event, found in enumerate((*_leaving(leaving[k], usual, a), *_landing(landings[k], usual, motion.step_s))):
            timing.put(k, event, found, EventSource.PITCH)
    is_flat = np.array([motion.pitch_rad[m : b + 1].max() < FLAT_LANDING_RAD for _, m, b in spans], dtype=bool)
    is_straight = np.abs(motion.turn_rad) < MAX_STRAIGHT_RAD
    is_landed = sole.is_landing(timing.index[:, CONTACT], is_flat, is_straight, motion.step_s)
    is_rolling = (push > MIN_ROLL_RAD_S) & (load > MIN_ROLL_RAD_S) & is_landed
    is_usual = is_rolling & is_heel_first & (push > 0.5 * usual.push_rad_s) & (load > 0.5 * usual.load_rad_s)
    _even_out(timing, motion, spans, is_usual)
    _steady(timing.index, motion, spans, is_usual, usual)
    lowered = [-float(motion.pitch_rad[a : m + 1].min()) for a, m, _ in spans]
    is_lifted = is_rigid or bool(len(spans) and np.median(lowered) < MIN_LOWERED_RAD)
    _time_by_sole(timing, sole, is_lifted, is_landed)
    without_stray_toe_offs(timing, swings.fastest, motion.step_s)
    for k in np.flatnonzero(~(timing.index[:, FULL_CONTACT] >= timing.index[:, CONTACT])).tolist():
        timing.put(k, FULL_CONTACT, _settled(rate, timing.index[k, CONTACT], spans[k][2], usual), EventSource.PITCH)
    _even_out_others(timing, motion, spans, landings, is_usual)
    return _as_events(motion, timing, is_measured)


def _time_by_sole(timing: Timing, sole: SoleTravel, is_lifted: bool, is_landed: BoolArray) -> None:
    """Time toe-offs of a lifted foot, and contacts that the pitch does not show, by the sole; in place."""
    for k in range(len(sole.lands)):
        if is_lifted or not np.isfinite(timing.index[k, TOE_OFF]):
            timing.put(k, TOE_OFF, Onset(sole.leaves[k], sole.leaves_reach[k]), EventSource.SOLE)
        if not is_landed[k]:
            timing.put(k, CONTACT, Onset(sole.lands[k], sole.lands_reach[k]), EventSource.SOLE)
        if timing.index[k, HEEL_RISE] > timing.index[k, TOE_OFF]:
            timing.put(k, HEEL_RISE, Onset(np.nan, 0.0), EventSource.UNKNOWN)


def _settled(rate: FloatArray, contact: float, rest: int, usual: Usual) -> Onset:
    """Full contact of a foot that has landed, whatever way it then turns; NaN: it hardly turns, or never landed."""
    if not np.isfinite(contact):
        return Onset(np.nan, 0.0)
    first = min(int(np.ceil(contact)), rest)
    turning = np.abs(rate[first : rest + 1])
    fastest = int(np.argmax(turning))
    if turning[fastest] <= MIN_ROLL_RAD_S:
        return Onset(np.nan, 0.0)
    full = onset(turning, fastest, rest - first, LANDING_RATIO * usual.still_rad_s)
    return Onset(full.index + first, full.reach)


def _as_events(motion: FootMotion, timing: Timing, is_measured: BoolArray) -> FootEvents:
    swings = motion.swings
    times = motion.time_of(timing.index)
    missing = np.concatenate([[0], np.cumsum(~is_measured)])
    by_source = np.array([SD_S.get(source, (np.nan,) * len(EVENTS)) for source in SOURCES])
    sd_s = np.hypot(by_source[timing.source, np.arange(len(EVENTS))], REACH_SHARE * motion.step_s * timing.reach)
    is_received = missing[swings.anchor_after + 1] == missing[swings.anchor_before]
    sd_s[~is_received] = np.hypot(sd_s[~is_received], MAX_REPORTED_GAP_S)  # the event may lie where samples are missing
    return FootEvents(
        heel_rise_s=times[:, HEEL_RISE],
        toe_off_s=times[:, TOE_OFF],
        initial_contact_s=times[:, CONTACT],
        full_contact_s=times[:, FULL_CONTACT],
        length_m=np.linalg.norm(motion.travel_m, axis=1),
        height_m=motion.height_m,
        climb_m=motion.climb_m,
        turn_rad=motion.turn_rad,
        is_certain=np.full(len(swings), motion.is_direction_certain),
        is_measured=is_received,
        source=timing.source,
        sd_s=sd_s,
    )


def _landing_of(motion: FootMotion, fastest: int, rest: int, lands: float) -> Landing:
    """How a foot comes down between two indices; with its forefoot first, its toes are further down than in stance."""
    # a sole that never ceases to travel, as in a leg that circles, may come down anywhere up to its rest
    rate, pitch = motion.pitch_rate_rad_s, motion.pitch_rad
    until = min(rest, max(fastest, int(np.ceil(lands)))) if np.isfinite(lands) else rest
    highest = fastest + int(np.argmax(pitch[fastest : until + 1]))
    lowest = highest + int(np.argmin(pitch[highest : rest + 1]))
    if pitch[lowest] > -FOREFOOT_RAD:
        return Landing(fastest, rate[fastest : rest + 1])
    lowered = highest + int(np.argmin(rate[highest : lowest + 1]))
    return Landing(lowered, -rate[lowered : rest + 1], is_forefoot=True)


def _leaving(rate: FloatArray, usual: Usual, begin: int = 0) -> tuple[Onset, Onset]:
    """Heel rise and toe-off of a pitch rate (n,) from rest, at index `begin`, to mid-swing; NaN: hardly rolled."""
    push = int(np.argmin(rate))
    if -rate[push] <= MIN_ROLL_RAD_S:
        return Onset(np.nan, 0.0), Onset(np.nan, 0.0)
    rise = onset(-rate, push, 0, usual.still_rad_s)
    off = crossing(rate, push, len(rate) - 1, TOE_OFF_SHARE * rate[push])
    return Onset(rise.index + begin, rise.reach), Onset(off + begin, 0.0)


def _landing(landing: Landing, usual: Usual, step_s: float) -> tuple[Onset, Onset]:
    """Initial and full contact; NaN: hardly rolled."""
    rate = landing.rate_rad_s
    load = int(np.argmin(rate))
    if -rate[load] <= MIN_ROLL_RAD_S:
        return Onset(np.nan, 0.0), Onset(np.nan, 0.0)
    full = onset(-rate, load, len(rate) - 1, LANDING_RATIO * usual.still_rad_s)
    on = _contact(rate, load, -CONTACT_SHARE * min(-rate[load], usual.load_rad_s), step_s)
    return Onset(on + landing.begin, 0.0), Onset(full.index + landing.begin, full.reach)


def _even_out(timing: Timing, motion: FootMotion, spans: list[tuple[int, int, int]], is_usual: BoolArray) -> None:
    """Time heel rise and full contact of usual swings by the marks of a rolling foot; in place."""
    # a foot begins and ends to roll too slowly for a level of its rate to be sharp; how far from its mark it mostly
    # does, all its swings say together
    landing = landing_marks(motion.pitch_rad, spans, LANDING_SHARES[0])
    for event, marks in ((HEEL_RISE, leaving_marks(motion.pitch_rad, spans)), (FULL_CONTACT, landing)):
        known = np.flatnonzero(is_usual & np.isfinite(timing.index[:, event] - marks))
        if len(known) >= LEAST_SWINGS:
            timing.index[known, event], timing.reach[known, event] = timed_by(marks[known], timing.index[known, event])


def _even_out_others(
    timing: Timing,
    motion: FootMotion,
    spans: list[tuple[int, int, int]],
    landings: list[Landing],
    is_usual: BoolArray,
) -> None:
    """Time heel rise and full contact of other straight swings by their marks, if sharper; in place."""
    # feet put down slowly, flat or toes first come to rest slowly, and tissue rings at their level of rest
    is_straight = np.abs(motion.turn_rad) < MAX_STRAIGHT_RAD
    is_forefoot = np.array([landing.is_forefoot for landing in landings], dtype=bool)
    lowered = [landing.begin if landing.is_forefoot else None for landing in landings]
    of_landing = [landing_marks(motion.pitch_rad, spans, share, lowered) for share in LANDING_SHARES]
    for event, beside, is_one, candidates in (
        (HEEL_RISE, TOE_OFF, is_straight, [leaving_marks(motion.pitch_rad, spans)]),
        (FULL_CONTACT, CONTACT, is_straight & is_forefoot, of_landing),
        (FULL_CONTACT, CONTACT, is_straight & ~is_forefoot, of_landing),
    ):
        marks = sharpest(candidates, timing.index[:, event], timing.index[:, beside], is_one)
        if marks is None:
            continue
        known = np.flatnonzero(np.isfinite(marks))
        index, spread = timed_by(marks[known], timing.index[known, event])
        is_other = ~is_usual[known]
        timing.index[known[is_other], event], timing.reach[known[is_other], event] = index[is_other], spread


def without_stray_toe_offs(timing: Timing, fastest: IntArray, step_s: float) -> None:
    """Move stray toe-offs to the foot's usual time before the fastest sample, `fastest` (k,); in place."""
    if len(fastest) < LEAST_SWINGS:
        return
    before = fastest - timing.index[:, TOE_OFF]
    usual = float(np.median(before))
    reach = max(STRAY_SD * robust_sd(before - usual), STRAY_S / step_s)
    for k in np.flatnonzero(np.abs(before - usual) > reach).tolist():
        timing.index[k, TOE_OFF] = fastest[k] - usual
        timing.reach[k, TOE_OFF] = abs(before[k] - usual)


def _steady(
    rows: FloatArray, motion: FootMotion, spans: list[tuple[int, int, int]], is_usual: BoolArray, usual: Usual
) -> None:
    """Time the usual swings' events, rows (k, 4), by the foot's mean swing if its sensor shakes; in place."""
    # integrated to a pitch the shaking is small: where it passes half its greatest, toes down and toes up, is sure in
    # every swing; how far from these marks the events lie is read off the mean rate of all swings
    marks = np.array([_marks(motion.pitch_rad, *span) for span in spans]).reshape(-1, 2)
    chosen = np.flatnonzero(is_usual & np.isfinite(marks).all(axis=1))
    if len(chosen) < LEAST_SWINGS:
        return
    rate = motion.pitch_rate_rad_s
    begin, middle, end = np.array(spans)[chosen].T
    leave = _mean_rate([rate[a : m + 1] for a, m in zip(begin, middle, strict=True)], marks[chosen, 0] - begin, usual)
    land = _mean_rate([rate[m : b + 1] for m, b in zip(middle, end, strict=True)], marks[chosen, 1] - middle, usual)
    unrest = 0.5 * (leave.unrest_rad_s + land.unrest_rad_s)
    if unrest < SHAKING_SHARE * usual.still_rad_s:
        return
    usual = replace(usual, still_rad_s=max(usual.still_rad_s, 3.0 * unrest / np.sqrt(len(chosen))))
    leaving = np.array([found.index for found in _leaving(leave.rate_rad_s, usual, -leave.before)])
    landing = np.array([f.index for f in _landing(Landing(-land.before, land.rate_rad_s), usual, motion.step_s)])
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
        crossing(pitch, rest, lowest, 0.5 * pitch[lowest]),
        crossing(pitch, highest, next_rest, 0.5 * pitch[highest], which=-1),
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


def _contact(rate: FloatArray, load: int, level: float, step_s: float) -> float:
    """Where the rate, on its last way down to the peak of loading, reaches `level`, LANDED_S after its half at most."""
    falls = crossing(rate, 0, load, 0.0, which=-1)
    if not np.isfinite(falls):
        return float("nan")
    half, whole = (crossing(rate, int(falls), load, share * level) for share in (0.5 / CONTACT_SHARE, 1.0))
    return float(np.fmin(whole, half + LANDED_S / step_s))

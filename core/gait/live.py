"""Gait events of one foot while it walks: those of `core.gait.events`, causally and within `SETTINGS.max_delay_s`.

The definitions and their constants are those of the offline events. What offline reads off the whole walk is learnt
on the way: the usual peaks from the last steps, the pitch axis from all turning so far. As long as the delay allows,
an event waits until its peak has passed, so that it is the same peak as offline.

A rate alone does not distinguish a push-off from a heel lifted on the spot: from stance to stance the specific force
is integrated, and a foot that gains no speed has not left the floor. What cannot be known in time is reported late
(`LiveEvent.is_late`): the heel rise of a step from standing, with its toe-off, since one who shifts weight lifts the
heel as well; flat landings, and steps of a foot that hardly rolls, once the foot is calm again; and the heel rises of
a sensor that shakes on its foot, whose stances have shown that it does. The full contact of a flat landing is not
reported.

A foot that lands with its forefoot gets its contact when its toes come down in the air, 0.1 to 0.2 s too early.
All this is about walking: a foot that is moved about in the air gets steps too, until it has not stood
for long.
"""

import math
from collections import deque
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from statistics import median

from core.gait.crossings import ONSET_RATIO
from core.gait.events import (
    CONTACT_SHARE,
    FLAT_SHARE,
    LANDED_S,
    LANDING_RATIO,
    MIN_ROLL_RAD_S,
    MIN_STILL_RAD_S,
    STILL_SHARE,
    TOE_OFF_SHARE,
)
from core.gait.foot import MIN_SWING_M, MIN_SWING_M_S
from core.gait.live_motion import LiveMotion, Travelled, Vector, dot, speeds_of, way_of_m
from core.gait.phases import Phase
from core.gait.strides import MAX_STRIDE_S
from core.samples import FloatArray
from core.signal.tracks import MAX_REPORTED_GAP_S

Sample = tuple[float, float]  # time, rate


@dataclass(frozen=True, slots=True)
class LiveEventSettings:
    """The constants of the live events; shares and ratios have no unit, times are seconds.

    Sources are named where one is on record. Where none is, the value is a choice of this project whose reason is all
    that was written down; `tests/benchmarks/live_gait.py` measures how the events do with all of them.

    `max_delay_s`: longest time from an event to the sample that reports it, unless it is late. Source: the display,
    which draws every 33 ms and so shows an event when it is 0.13 s old at most.
    `early_ratio`: of the rate of rest: enough for a heel rise where waiting for the double would be too late.
    `growth`: the pitch rate grows as this power of time after heel rise. Source: `ONSET_RATIO` in
    `core.gait.crossings`.
    `standing_s`: a foot flat for longer is standing. Source: at 0.3 m/s, the slowest, a foot is flat for 0.7 s of each
    stride.
    `max_push_s`: from the end of push-off until the foot has speed; after longer the heel was lifted on the spot.
    """

    max_delay_s: float = 0.095
    memory: int = 5  # steps whose peaks and times say what is usual
    passed_share: float = 0.6  # of its peak: a rate that has fallen so far has passed it
    sure_ratio: float = 5.0  # of the rate of rest: a heel that turns so fast has risen
    early_ratio: float = 1.8
    growth: float = 1.75
    min_flat_s: float = 0.06  # A foot stays flat longer than this; a loading shock does not
    standing_s: float = 1.5
    max_push_s: float = 0.3
    first_load_share: float = 0.7  # peak of loading as a share of the peak of push-off, until a loading has been seen
    min_swing_s: float = 0.12  # an earlier fall of the toes is not the landing. Source: a third of the swing at 2 m/s.
    sway_ratio: float = 2.0  # A heel rise is so many times faster than the sways of the last stances
    sway_memory: float = 0.85  # share of the fastest sway that is remembered after one step
    max_swing_s: float = 1.5  # after longer the landing was missed. Source: more than twice the swing at 0.3 m/s.
    landing_share: float = 0.7  # of its greatest speed in this swing: a foot that is faster is in mid-swing


SETTINGS = LiveEventSettings()


class FootEvent(StrEnum):
    """The four events of one foot."""

    HEEL_RISE = "heel_rise"
    TOE_OFF = "toe_off"
    INITIAL_CONTACT = "initial_contact"
    FULL_CONTACT = "full_contact"


PHASE_AFTER = {
    FootEvent.HEEL_RISE: Phase.PRE_SWING,
    FootEvent.TOE_OFF: Phase.SWING,
    FootEvent.INITIAL_CONTACT: Phase.LOADING,
    FootEvent.FULL_CONTACT: Phase.FOOT_FLAT,
}


@dataclass(frozen=True, slots=True)
class LiveEvent:
    """`time_s` is when it happened, `reported_s` the sample that showed it."""

    event: FootEvent
    time_s: float
    reported_s: float

    @property
    def is_late(self) -> bool:
        return self.reported_s - self.time_s > SETTINGS.max_delay_s


@dataclass(frozen=True, slots=True)
class PhaseChange:
    """The sample at `reported_s` put the foot into a phase, or showed an event: it has been in this phase since
    `since_s`."""

    phase: Phase
    since_s: float
    reported_s: float


class LiveEvents:
    """Events, phase and cadence of one foot, fed sample by sample or in blocks of any size, in any mounting.

    Parameters
    ----------
    pitch_axis : (3,) or None
        About which the foot mostly turns, in sensor axes, either sign, if calibration gives it; it is followed on.
    """

    def __init__(self, pitch_axis: FloatArray | None = None) -> None:
        self._motion = LiveMotion(pitch_axis)
        self._time_s, self._step_s = math.nan, math.nan
        self._events: list[LiveEvent] = []
        self.changes: list[PhaseChange] = []
        """What the samples of the last update made of the phase. Between two phases found at one sample it may have
        passed others: its events name them."""
        self.phase = Phase.UNKNOWN
        """The foot's phase now, as far as known: pre-swing is shown at once and may turn out to be a sway."""
        self._path: list[Sample] = []  # since the phase began, or since the rate last showed that it cannot end yet
        self._pushes: deque[float] = deque(maxlen=SETTINGS.memory)
        self._loads: deque[float] = deque(maxlen=SETTINGS.memory)
        self._contacts_s: deque[float] = deque(maxlen=SETTINGS.memory + 1)
        self._still = MIN_STILL_RAD_S
        self._flat_since_s = -math.inf
        self._peak = 0.0
        self._is_rise_reported = self._is_walking = False
        self._off_s: float | None = None
        self._push = self._fastest_m_s = 0.0
        self._left_s = self._slow_s = self._contact_s = math.nan
        self._dip: list[Sample] = []
        self._sway = 0.0  # how fast the standing foot has turned toes down without leaving
        self._half_s: float | None = None
        self._full_s: float | None = None
        self._waiting: list[tuple[float, Vector, float]] = []  # time, rate, speed, while there is no axis

    @property
    def pitch_axis(self) -> Vector | None:
        """About which the foot pitches, in sensor axes: a positive rate lifts the toes; None while it is not known."""
        return self._motion.pitch_axis

    @property
    def cadence_steps_min(self) -> float:
        """From this foot's last strides, two steps each; NaN before two contacts and when it no longer walks."""
        if len(self._contacts_s) < 2 or self._time_s - self._contacts_s[-1] > MAX_STRIDE_S:
            return math.nan
        return 120.0 / median(end - start for start, end in pairwise(self._contacts_s))

    def update(self, time_s: FloatArray, gyr_rad_s: FloatArray, acc_m_s2: FloatArray) -> list[LiveEvent]:
        """Take the next samples; returns what they show, in the order in which it is found.

        Parameters
        ----------
        time_s : (n,)
            Ascending stamps; a step longer than MAX_REPORTED_GAP_S is a gap, after which the foot has to stand first.
        gyr_rad_s, acc_m_s2 : (n, 3)
            In sensor axes, NaN where a sample is missing; the rates free of the gyroscope's bias.
        """
        self._events, self.changes = [], []
        for now_s, gyr, acc in zip(time_s.tolist(), gyr_rad_s.tolist(), acc_m_s2.tolist(), strict=True):
            step_s = now_s - self._time_s
            if not math.isfinite(sum(gyr) + sum(acc)) or step_s <= 0.0:
                continue
            last_s, last_phase, events_before = self._time_s, self.phase, len(self._events)
            self._time_s, self._step_s = now_s, step_s
            if step_s <= MAX_REPORTED_GAP_S:
                self._take(gyr, acc)
            else:  # so does the first sample of all, whose step is NaN
                self._forget_the_step()
            if self.phase is not last_phase or len(self._events) > events_before:
                since_s = last_s if self.phase is Phase.UNKNOWN else self._since_s(now_s)
                self.changes.append(PhaseChange(self.phase, since_s, now_s))
        return self._events

    def _since_s(self, now_s: float) -> float:
        """Since when the foot is in the phase that the sample at `now_s` put it into."""
        last = self._events[-1] if self._events else None
        is_by_event = last is not None and last.reported_s == now_s and PHASE_AFTER[last.event] is self.phase
        return last.time_s if last is not None and is_by_event else now_s

    def _forget_the_step(self) -> None:
        self.phase, self._path, self._waiting, self._flat_since_s = Phase.UNKNOWN, [], [], -math.inf
        self._contacts_s.clear()
        self._motion.start_again()

    def _take(self, gyr: Vector, acc: Vector) -> None:
        motion = self._motion
        motion.add(self._time_s, self._step_s, gyr, acc, 2.0 * self._still)
        if motion.travelled:
            self._arrive(motion.travelled)
        if self.phase is Phase.UNKNOWN and motion.calm_s > SETTINGS.min_flat_s:
            self._stand(-math.inf)
        if motion.flat_s > SETTINGS.min_flat_s:
            self._rest()
        if motion.has_turned_round:
            self._pushes.clear()
            self._loads.clear()
            if motion.flat_s == 0.0:  # it leaves the floor by now
                self._end_landing()
        if motion.pitch_axis is not None:
            self._advance((self._time_s, dot(gyr, motion.pitch_axis)), motion.speed_m_s)
            return
        self._waiting.append((self._time_s, gyr, motion.speed_m_s))
        if len(self._waiting) > MAX_STRIDE_S / self._step_s:
            del self._waiting[0]
        axis = motion.find_axis()
        if axis is not None:
            waiting, self._waiting = self._waiting, []
            for then_s, rate, speed_m_s in waiting:
                self._advance((then_s, dot(rate, axis)), speed_m_s)

    def _arrive(self, travelled: Travelled) -> None:
        """The foot is calm again. Had it hardly rolled, its speed shows when it left and landed."""
        speeds = speeds_of(travelled)
        fastest = max(range(len(speeds)), key=lambda k: speeds[k][1])
        level = FLAT_SHARE * speeds[fastest][1]
        on_s = next((_crossing(a, b, level) for a, b in pairwise(speeds[fastest:]) if b[1] <= level), self._time_s)
        if self.phase is Phase.SWING:
            self._slow_s = on_s
            return
        is_reported = self._contact_s >= travelled[0][0]
        if is_reported or speeds[fastest][1] < MIN_SWING_M_S or way_of_m(travelled) < MIN_SWING_M:
            return
        rises = [pair for pair in pairwise(speeds[: fastest + 1]) if pair[0][1] <= level < pair[1][1]]
        self._show_message(FootEvent.TOE_OFF, _crossing(*rises[-1], level) if rises else speeds[0][0])
        self._show_message(FootEvent.INITIAL_CONTACT, on_s)
        self._stand(self._time_s)

    def _rest(self) -> None:
        """The foot lies flat: whatever was missed, it is standing."""
        if not self._pushes:
            self._motion.forget_axis()
        else:
            self._motion.rest()
        if self._motion.flat_s > 2.0 * SETTINGS.min_flat_s and self.phase not in (Phase.FOOT_FLAT, Phase.PRE_SWING):
            self._end_landing()

    def _end_landing(self) -> None:
        """Report what is still to be reported of a foot that has come down."""
        if self.phase is Phase.SWING and self._dip:
            self._touch_down(self._contact(self._dip, -self._peak), self._dip)
        elif self.phase is Phase.SWING and not math.isnan(self._slow_s):
            self._show_message(FootEvent.INITIAL_CONTACT, self._slow_s)
        if self.phase is Phase.LOADING and self._full_s is not None:
            self._show_message(FootEvent.FULL_CONTACT, self._full_s)
        is_landing = self.phase in (Phase.SWING, Phase.LOADING)
        self._stand(self._time_s if is_landing else self._flat_since_s)

    def _stand(self, since_s: float) -> None:
        self.phase, self._path, self._flat_since_s = Phase.FOOT_FLAT, [], since_s

    def _show_message(self, event: FootEvent, time_s: float) -> None:
        self._events.append(LiveEvent(event, time_s, self._time_s))
        if event is FootEvent.INITIAL_CONTACT:
            if time_s - self._contact_s > MAX_STRIDE_S:
                self._contacts_s.clear()
            self._contact_s = time_s
            self._contacts_s.append(time_s)
        elif event is FootEvent.FULL_CONTACT:
            self._loads.append(-self._peak)

    def _is_due(self, time_s: float) -> bool:
        """Would the next sample be too late to report it?"""
        return self._time_s + self._step_s - time_s > SETTINGS.max_delay_s

    def _advance(self, now: Sample, speed_m_s: float) -> None:
        if self.phase is Phase.SWING:
            self._land(now, speed_m_s)
        elif self.phase is Phase.LOADING:
            self._settle(now)
        elif self.phase is Phase.PRE_SWING:
            self._leave(now, speed_m_s)
        elif self.phase is Phase.FOOT_FLAT:
            self._lift(now)

    def _lift(self, now: Sample) -> None:
        """Foot flat until the rate, toes down, has passed the level of rest and its double, or time is up."""
        self._follow(now, -self._still)
        if len(self._path) < 2:
            return
        is_walking = now[0] - self._flat_since_s < SETTINGS.standing_s
        is_early = is_walking and now[1] < -SETTINGS.early_ratio * self._still and self._is_due(self._rise(self._still))
        if is_early or now[1] < -2.0 * self._still:
            self.phase, self._peak, self._off_s = Phase.PRE_SWING, now[1], None
            self._is_walking, self._is_rise_reported = is_walking, False
            self._watch_rise(now)

    def _follow(self, now: Sample, above: float) -> None:
        """Keep the samples since the rate was last above a level, and the one before."""
        if now[1] > above:
            self._path = [now]
        else:
            self._path.append(now)

    def _leave(self, now: Sample, speed_m_s: float) -> None:
        """Pre-swing until the rate has well passed the peak of push-off, and the foot has speed."""
        last = self._path[-1]
        self._path.append(now)
        is_old = self._off_s is not None and now[0] - self._off_s > SETTINGS.max_push_s
        if now[1] > -self._still and (is_old or -self._peak < MIN_ROLL_RAD_S):
            if self._is_walking:
                self._sway = max(self._sway, -self._peak)
            self._stand(self._flat_since_s)  # no push-off
            return
        if now[1] <= self._peak:
            self._peak, self._off_s = now[1], None
        elif self._off_s is None:
            self._off_s = _passes(last, now, TOE_OFF_SHARE * self._peak)
        if is_old:
            self._peak, self._off_s = 0.0, None
        self._watch_rise(now)
        if self._off_s is None or -self._peak < MIN_ROLL_RAD_S or speed_m_s < MIN_SWING_M_S:
            return
        if now[1] < SETTINGS.passed_share * self._peak and not self._is_due(self._off_s):
            return
        self._push = -self._peak
        self._pushes.append(self._push)
        self._sway *= SETTINGS.sway_memory
        self._still = max(MIN_STILL_RAD_S, STILL_SHARE * median(self._pushes))
        if not self._is_rise_reported:
            self._show_rise(self._rise(self._still))
        self._show_message(FootEvent.TOE_OFF, self._off_s)
        self.phase, self._path = Phase.SWING, []
        self._left_s, self._slow_s, self._fastest_m_s = self._off_s, math.nan, 0.0
        self._peak, self._dip = 0.0, []

    def _watch_rise(self, now: Sample) -> None:
        if not self._is_walking or self._is_rise_reported or -now[1] < SETTINGS.sway_ratio * self._sway:
            return
        rise_s = self._rise(self._still)
        if -now[1] > SETTINGS.sure_ratio * self._still or self._is_due(rise_s):
            self._show_rise(rise_s)

    def _rise(self, still: float) -> float:
        """Where a rate that falls to the peak of push-off began to, extrapolated from two low levels."""
        # until it reaches the second, its growth with the power 1.75 of time shows it as well
        low, high = self._path[0][0], None
        for last, now in pairwise(self._path):
            if last[1] > -still >= now[1]:
                low, high = _crossing(last, now, -still), None
            if last[1] > -2.0 * still >= now[1]:
                high = _crossing(last, now, -2.0 * still)
            if now[1] <= self._peak:
                break
        if high is None:
            end_s, end_rate = self._path[-1]
            reach_s = (end_s - low) / ((max(-end_rate / still, 1.1)) ** (1.0 / SETTINGS.growth) - 1.0)
        else:
            reach_s = ONSET_RATIO * (high - low)
        return max(low - reach_s, self._flat_since_s)

    def _show_rise(self, rise_s: float) -> None:
        self._show_message(FootEvent.HEEL_RISE, rise_s)
        self._is_rise_reported = True

    def _land(self, now: Sample, speed_m_s: float) -> None:
        """Swing until the toes, having come up, are turned down by the floor."""
        self._fastest_m_s = max(self._fastest_m_s, speed_m_s)
        since_s = now[0] - self._left_s
        if since_s > SETTINGS.max_swing_s:
            self.phase, self._path = Phase.UNKNOWN, []
            return
        self._path.append(now)
        is_near = since_s > SETTINGS.min_swing_s and speed_m_s < SETTINGS.landing_share * self._fastest_m_s
        lowest = min(rate for _, rate in self._path)
        if self._path[0][1] <= 0.0 or -lowest < MIN_ROLL_RAD_S or not is_near:
            lowest = 0.0
        if now[1] > 0.0:
            if lowest < self._peak:
                self._peak, self._dip = lowest, self._path  # this was the landing, if the foot turns out to lie flat
            self._path = [now]
        if now[1] > 0.0 or lowest == 0.0:
            return
        usual = median(self._loads) if self._loads else SETTINGS.first_load_share * self._push
        contact_s = self._contact(self._path, -lowest)
        if now[1] > SETTINGS.passed_share * lowest:
            is_slow = speed_m_s < FLAT_SHARE * self._fastest_m_s
            is_reported = is_slow or -lowest > SETTINGS.passed_share * usual or self._is_due(contact_s)
        else:  # the peak is to come: at least the usual one, or it passes in time
            contact_s = self._contact(self._path, usual)
            is_reported = self._is_due(contact_s)
        if is_reported:
            self._touch_down(contact_s, self._path)

    def _contact(self, path: list[Sample], load: float) -> float:
        """Where a rate that falls through zero reaches its share of the peak of loading; infinite before."""
        load = min(load, median(self._loads)) if self._loads else load
        half_s = whole_s = math.inf
        for last, now in pairwise(path):
            if math.isinf(half_s) and now[1] <= -0.5 * load:
                half_s = _crossing(last, now, -0.5 * load)
            if now[1] <= -CONTACT_SHARE * load:
                whole_s = _crossing(last, now, -CONTACT_SHARE * load)
                break
        return min(whole_s, half_s + LANDED_S)

    def _touch_down(self, contact_s: float, path: list[Sample]) -> None:
        self._show_message(FootEvent.INITIAL_CONTACT, contact_s)
        self.phase, self._path = Phase.LOADING, []
        self._peak, self._half_s, self._full_s = 0.0, None, None
        for sample in path:
            if self.phase is Phase.LOADING:
                self._settle(sample)

    def _settle(self, now: Sample) -> None:
        """Loading until the rate has come to rest."""
        last = self._path[-1] if self._path else now
        self._path = [now]
        still = LANDING_RATIO * self._still
        if now[1] < self._peak:
            self._peak, self._half_s, self._full_s = now[1], None, None
        if self._half_s is None and last[1] <= -2.0 * still < now[1]:
            self._half_s = _crossing(last, now, -2.0 * still)
        if self._full_s is None and last[1] <= -still < now[1]:
            full_s = _crossing(last, now, -still)
            self._full_s = full_s + ONSET_RATIO * (full_s - self._half_s) if self._half_s is not None else full_s
        if self._full_s is None:
            return
        usual = median(self._loads) if self._loads else math.inf
        is_sure = -self._peak > SETTINGS.passed_share * usual and now[0] > self._full_s
        if is_sure or self._is_due(self._full_s):
            self._show_message(FootEvent.FULL_CONTACT, self._full_s)
            self._stand(self._full_s)


def _crossing(last: Sample, now: Sample, level: float) -> float:
    """When the straight line between two samples is at `level`."""
    return last[0] + (now[0] - last[0]) * (level - last[1]) / (now[1] - last[1])


def _passes(last: Sample, now: Sample, level: float) -> float | None:
    """When the straight line between two samples passes `level`; None where it does not."""
    return None if (last[1] > level) == (now[1] > level) else _crossing(last, now, level)

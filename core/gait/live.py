"""When does a foot land and leave, as it walks? The events of `core.gait.events`, causally and within MAX_DELAY_S.

The definitions and their constants are those of the offline events; what offline reads off the whole walk, the usual
peaks and the pitch axis, is learnt from the steps so far. The first step teaches the axis and tells nothing.
"""

from collections import deque
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from core.gait.events import (
    CONTACT_SHARE,
    LANDING_RATIO,
    MAX_FALL_S,
    MIN_ROLL_RAD_S,
    MIN_STILL_RAD_S,
    ONSET_RATIO,
    STILL_SHARE,
    TOE_OFF_SHARE,
)
from core.gait.foot import MOVING_RAD_S
from core.gait.phases import Phase
from core.samples import FloatArray

MAX_DELAY_S = 0.1
MEMORY = 5  # steps whose peaks say what is usual
MIN_FLAT_S = 0.06  # a foot stays flat longer; a loading shock does not
MIN_STEP_S = 0.3  # from foot flat to foot flat; less is a twitch
VOTE_MEMORY = 0.7  # of one step's word on which way the toes are, in the next
MIN_SWING_S = 0.15
PASSED_SHARE = 0.6  # of the peak of push-off: a rate that has fallen so far will not grow again
FALLING_SHARE = 0.15  # of the peak of loading: a rate that is lower only wavers
FIRST_LOAD = 0.7  # of the peak of push-off is the peak of loading, until one has been seen
FORGETTING_S = 20.0  # a strap slips; the axis follows


class FootEvent(StrEnum):
    HEEL_RISE = "heel_rise"
    TOE_OFF = "toe_off"
    INITIAL_CONTACT = "initial_contact"
    FULL_CONTACT = "full_contact"


@dataclass(frozen=True, slots=True)
class LiveEvent:
    """`time_s` is when it happened, `told_s` the sample that told."""

    event: FootEvent
    time_s: float
    told_s: float


class LiveEvents:
    """Events of one foot, sample by sample. Rates must be free of the gyroscope's bias."""

    def __init__(self, step_s: float) -> None:
        self._step_s = step_s
        self._phase = Phase.UNKNOWN
        self._moment = np.zeros((3, 3))
        self._axis: FloatArray | None = None
        self._votes = 0.0
        self._turned, self._tilted = np.zeros(3), np.zeros(3)
        self._since_flat_s = 0.0
        self._flat_s = 0.0
        self._pushes: deque[float] = deque(maxlen=MEMORY)
        self._loads: deque[float] = deque(maxlen=MEMORY)
        self._last: tuple[float, float] | None = None
        self._rise: float | None = None
        self._peak = 0.0
        self._off: float | None = None
        self._fell: float | None = None
        self._half: float | None = None

    @property
    def phase(self) -> Phase:
        """The foot's phase, as far as told."""
        return self._phase

    def update(self, time_s: float, gyr_rad_s: FloatArray) -> list[LiveEvent]:
        """Take one sample, its rate (3,) in sensor axes; returns what it tells."""
        self._learn_axis(gyr_rad_s)
        if self._axis is None:
            return []
        now = (time_s, float(gyr_rad_s @ self._axis))
        last, self._last = self._last, now
        if last is None:
            return []
        if self._flat_s > 2.0 * MIN_FLAT_S and self._phase is not Phase.FOOT_FLAT:
            self._phase, self._rise = Phase.FOOT_FLAT, None  # whatever was missed, the foot stands
        told = self._step(last, now)
        return [] if told is None else [LiveEvent(told[0], told[1], time_s)]

    def _learn_axis(self, gyr: FloatArray) -> None:
        """The principal axis of the moving foot, anew after each step, in which the toes were mostly down."""
        speed = float(np.linalg.norm(gyr))
        if speed > MOVING_RAD_S:
            self._moment = self._moment * (1.0 - self._step_s / FORGETTING_S) + np.outer(gyr, gyr)
        self._turned = self._turned + gyr * self._step_s
        self._tilted = self._tilted + self._turned * self._step_s
        self._since_flat_s += self._step_s
        self._flat_s = self._flat_s + self._step_s if speed < 2.0 * self._still() else 0.0
        if self._flat_s <= MIN_FLAT_S:
            return
        if self._since_flat_s > MIN_STEP_S and self._moment.any():
            axis = np.linalg.eigh(self._moment)[1][:, -1]
            if self._axis is not None:
                axis = axis * np.sign(axis @ self._axis)
            self._votes = VOTE_MEMORY * self._votes - float(np.sign(self._tilted @ axis))
            self._axis = axis * (1.0 if self._votes >= 0 else -1.0)
            self._votes = abs(self._votes)
        self._since_flat_s, self._turned, self._tilted = 0.0, np.zeros(3), np.zeros(3)

    def _still(self) -> float:
        return max(MIN_STILL_RAD_S, STILL_SHARE * float(np.median(self._pushes))) if self._pushes else MIN_STILL_RAD_S

    def _step(self, last: tuple[float, float], now: tuple[float, float]) -> tuple[FootEvent, float] | None:
        if self._phase is Phase.SWING:
            return self._land(last, now)
        if self._phase is Phase.LOADING:
            return self._settle(last, now)
        if self._phase is Phase.PRE_SWING:
            return self._leave(last, now)
        return self._lift(last, now)

    def _lift(self, last: tuple[float, float], now: tuple[float, float]) -> tuple[FootEvent, float] | None:
        """Foot flat until the rate, toes down, has passed the level of rest and its double."""
        still = self._still()
        passed = _passes(last, now, -still)
        if passed is not None:
            self._rise = passed if now[1] < last[1] else None
        doubled = _passes(last, now, -2.0 * still)
        if self._rise is None or doubled is None:
            return None
        rise_s = self._rise - ONSET_RATIO * (doubled - self._rise)
        self._phase, self._peak, self._off = Phase.PRE_SWING, 0.0, None
        return FootEvent.HEEL_RISE, max(rise_s, now[0] - MAX_DELAY_S)

    def _leave(self, last: tuple[float, float], now: tuple[float, float]) -> tuple[FootEvent, float] | None:
        """Pre-swing until the rate has well passed the peak of push-off."""
        if now[1] > -self._still() and -self._peak < MIN_ROLL_RAD_S:
            self._phase = Phase.FOOT_FLAT  # a sway, no push-off
            return None
        if now[1] <= self._peak:
            self._peak, self._off = now[1], None
            return None
        if self._off is None:
            self._off = _passes(last, now, TOE_OFF_SHARE * self._peak)
        usual = float(np.median(self._pushes)) if self._pushes else MIN_ROLL_RAD_S
        if self._off is None or -self._peak < 0.4 * usual:
            return None
        if now[1] < PASSED_SHARE * self._peak and now[0] - self._off < MAX_DELAY_S - self._step_s:
            return None
        self._pushes.append(-self._peak)
        self._phase, self._peak, self._fell = Phase.SWING, 0.0, None
        return FootEvent.TOE_OFF, self._off

    def _land(self, last: tuple[float, float], now: tuple[float, float]) -> tuple[FootEvent, float] | None:
        """Swing until the toes, having come up, are turned down by the floor."""
        self._peak = max(self._peak, now[1])
        if now[1] > 0.0:
            self._fell = None
        elif last[1] > 0.0:
            self._fell = _passes(last, now, 0.0)
        if self._fell is None or self._off is None or self._fell - self._off < MIN_SWING_S:
            return None
        load = float(np.median(self._loads)) if self._loads else FIRST_LOAD * self._pushes[-1]
        reached = _passes(last, now, -CONTACT_SHARE * load)
        if reached is None and (now[0] < self._fell + MAX_FALL_S or now[1] > -FALLING_SHARE * load):
            return None
        contact = self._fell + MAX_FALL_S if reached is None else min(reached, self._fell + MAX_FALL_S)
        self._phase, self._peak, self._half = Phase.LOADING, now[1], None
        return FootEvent.INITIAL_CONTACT, contact

    def _settle(self, last: tuple[float, float], now: tuple[float, float]) -> tuple[FootEvent, float] | None:
        """Loading until the rate has come to rest."""
        self._peak = min(self._peak, now[1])
        still = LANDING_RATIO * self._still()
        self._half = _passes(last, now, -2.0 * still) if now[1] > -2.0 * still >= last[1] else self._half
        full = _passes(last, now, -still) if now[1] > -still >= last[1] else None
        if full is None:
            return None
        self._loads.append(-self._peak)
        self._phase, self._rise = Phase.FOOT_FLAT, None
        onset = full if self._half is None else full + ONSET_RATIO * (full - self._half)
        return FootEvent.FULL_CONTACT, min(onset, now[0] + MAX_DELAY_S)


def _passes(last: tuple[float, float], now: tuple[float, float], level: float) -> float | None:
    """When the straight line between two samples (time, value) passes `level`; None where it does not."""
    if (last[1] > level) == (now[1] > level):
        return None
    return last[0] + (now[0] - last[0]) * (level - last[1]) / (now[1] - last[1])

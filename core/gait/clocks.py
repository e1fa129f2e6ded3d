"""Evidence of a common clock of both legs: without one, no instant of a leg may be set against one of the other.

Within a leg the joints' motion ties the clocks of its sensors; between the legs nothing does but a clock that they
share, or stamps that were fitted to one. A stamp proves a common clock only where it carries more than the sample's
number: stamps of 0.00, 0.01, 0.02 s are made up, and two sensors started apart have the same.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from core.body import Joint, Side, Site
from core.samples import FloatArray
from core.session import Recording, Session
from core.signal.tracks import nominal_step_s

READ_S, CARE_S = 0.005, 0.020  # of what the clocks may still be apart
MAX_LAG_S = 0.005  # found inside of a leg: the sensors' clocks are not what they seem
MAX_SHARE_OFF_PERCENT, ALIKE_STANCE_PERCENT = 5.0, 3.0  # steps so uneven with stances so alike are two clocks
TOGETHER_S = 0.25  # one command starts all sensors within this, and stops them
MADE_UP_S = 0.0002  # stamps so near to a round rate all along contain nothing but the sample's number
SAME_STAMP_S = 0.0005
MIN_SAMPLES = 100


class ClockTie(StrEnum):
    """What ties the clocks of both legs."""

    ONE_CLOCK = "one_clock"
    HOST_CLOCK = "host_clock"
    PELVIS = "pelvis"
    UNKNOWN = "unknown"


class ClockGate(StrEnum):
    """What decided."""

    RESIDUAL = "residual"
    UNKNOWN = "unknown"
    LAG = "lag"
    STEP_SHARE = "step_share"


@dataclass(frozen=True, slots=True)
class LegSteps:
    """What one leg's clock is judged by: the site of its events, and its usual step time and stance; NaN: not known."""

    site: Site
    step_time_s: float
    stance_percent: float


@dataclass(frozen=True, slots=True)
class LegClocks:
    """Evidence that both legs' sensors share one time in one walk, and what follows.

    `step_share_percent`: the left step's share of both steps, NaN without steps of both feet. Two clocks that are off
    by 0.1 of a stride shift it by 10 points.
    """

    tie: ClockTie
    residual_s: float  # how far apart the clocks may still be; NaN where nothing ties them
    lag_s: float  # the largest lag found inside of a leg
    step_share_percent: float
    stance_difference_percent: float  # left less right

    @property
    def gate(self) -> ClockGate:
        if self.lag_s >= MAX_LAG_S:
            return ClockGate.LAG
        is_uneven = abs(self.step_share_percent - 50.0) > MAX_SHARE_OFF_PERCENT
        if is_uneven and abs(self.stance_difference_percent) < ALIKE_STANCE_PERCENT:
            return ClockGate.STEP_SHARE
        return ClockGate.UNKNOWN if self.tie is ClockTie.UNKNOWN else ClockGate.RESIDUAL

    @property
    def value(self) -> float:
        """What the gate looked at: seconds, for `STEP_SHARE` percent; NaN where nothing is known."""
        by_gate = {ClockGate.LAG: self.lag_s, ClockGate.STEP_SHARE: self.step_share_percent}
        return by_gate.get(self.gate, self.residual_s)

    @property
    def limit(self) -> float:
        """What `value` was held against: seconds, for `STEP_SHARE` the points off 50 %."""
        by_gate = {ClockGate.LAG: MAX_LAG_S, ClockGate.STEP_SHARE: MAX_SHARE_OFF_PERCENT}
        return by_gate.get(self.gate, READ_S if self.residual_s <= CARE_S else CARE_S)


def leg_clocks(
    session: Session, recording: Recording, steps: Mapping[Side, LegSteps], lags_s: Mapping[Joint, float]
) -> LegClocks:
    """Judge both legs' clocks by what the session states, stamps prove and steps contradict."""
    tie, residual_s = _tie(session, recording, steps)
    share, difference = _share_and_difference(steps)
    lag_s = max((abs(one) for one in lags_s.values()), default=0.0)
    return LegClocks(tie, residual_s, lag_s, share, difference)


def _tie(session: Session, recording: Recording, steps: Mapping[Side, LegSteps]) -> tuple[ClockTie, float]:
    known = [steps[side].site for side in Side if side in steps and recording.holds(steps[side].site)]
    if len(known) < len(Side):
        return ClockTie.UNKNOWN, float("nan")
    ids = [info.clock if (info := session.sensors.get(site)) else "" for site in known]
    if all(ids):
        return (ClockTie.ONE_CLOCK, 0.0) if len(set(ids)) == 1 else (ClockTie.UNKNOWN, float("nan"))
    residual_s = stamps_residual_s(*(recording.imu[site].time_s for site in known))
    return (ClockTie.HOST_CLOCK if np.isfinite(residual_s) else ClockTie.UNKNOWN), residual_s


def stamps_residual_s(one_s: FloatArray, other_s: FloatArray) -> float:
    """Give how far apart ascending stamps (n,), (m,) leave two clocks, s; NaN: no common one is proven."""
    if min(len(one_s), len(other_s)) < MIN_SAMPLES:
        return float("nan")
    apart_s = np.abs(np.array([one_s[0] - other_s[0], one_s[-1] - other_s[-1]]))
    lines = [_line(stamps_s) for stamps_s in (one_s, other_s)]
    if apart_s.max() > TOGETHER_S or any(line.is_made_up for line in lines):
        return float("nan")
    nearest = np.clip(np.searchsorted(other_s, one_s), 1, len(other_s) - 1)
    off_s = np.minimum(np.abs(one_s - other_s[nearest - 1]), np.abs(one_s - other_s[nearest]))
    if np.mean(off_s < SAME_STAMP_S) > 0.9:
        return float(np.sqrt(np.mean(np.minimum(off_s, SAME_STAMP_S) ** 2)))
    if apart_s[0] < 1e-6:  # each counted from its own beginning
        return float("nan")
    return float(np.hypot(lines[0].rms_s, lines[1].rms_s))


@dataclass(frozen=True, slots=True)
class StampLine:
    """How one sensor's stamps lie on a straight line over the sample's number."""

    rms_s: float
    is_made_up: bool


def _line(stamps_s: FloatArray) -> StampLine:
    step_s = nominal_step_s(stamps_s)
    number = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(np.diff(stamps_s) / step_s), 1.0))])
    slope, start = np.polyfit(number, stamps_s, 1)
    rms_s = float(np.sqrt(np.mean((stamps_s - start - slope * number) ** 2)))
    round_s = [round(float(slope), 4), 1.0 / max(1.0, round(1.0 / float(slope), 1))]
    off_s = [float(np.max(np.abs(stamps_s - stamps_s[0] - one * number))) for one in round_s]
    return StampLine(rms_s, min(off_s) < MADE_UP_S)


def _share_and_difference(steps: Mapping[Side, LegSteps]) -> tuple[float, float]:
    """The left step's share of both, and the stances' difference, percent; NaN where a side has none."""
    if len(steps) < len(Side):
        return float("nan"), float("nan")
    left, right = (steps[side] for side in Side)
    share = 100.0 * left.step_time_s / (left.step_time_s + right.step_time_s)
    return share, left.stance_percent - right.stance_percent

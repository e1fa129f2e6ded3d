"""Angle of a joint as it moves: the twist of the causal orientations; on a true hinge the rates' angle.

Two causal forms were measured against the offline result (tests/benchmarks/live_angle.py). On a human joint the twist
is better: there the rates' integral collects off-axis motion, and tissue keeps the accelerations of both segments from
meeting. On a true hinge the integral is: it needs no vertical, for which a causal filter has to wait. On a human joint
it serves for the first seconds after a gap, when both filters have just begun.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.calibration.certainty import angle_sd_rad
from core.live.drift import ObservationModel, SlowDrift, Wandering
from core.live.integral import BIAS_RAD_S, BIAS_WALK_RAD_S, Integral
from core.live.joint_frames import JointFrames, JointGeometry
from core.live.orientation import OrientedSamples
from core.live.pairing import NO_PAIRS, PairedSamples, Pairing
from core.results import AxisSource, JointCalibration
from core.samples import FloatArray, IntArray
from core.signal.pair import MOVING_RAD_S, MOVING_WINDOW_S
from core.signal.robust import robust_sd
from core.signal.rotations import wrap

BEAT_S = 0.1  # what moves slowly is looked at once in this time, on the proximal grid
WITNESS_STEP_S = 0.05
WITNESS_S = 5.0  # of movement, whose off-axis rate shows how sure the angle is
CERTAINTY_BEATS = 5  # from one word on that to the next
BLEND_S = 1.0  # from one calibration to the next

# Relative heading, from j1 = R12 j2; two orientation filters walk as offline.
HEADING = Wandering(np.deg2rad(0.3), BIAS_RAD_S, BIAS_WALK_RAD_S)
HEADING_LOOKS = ObservationModel(first_scale=np.deg2rad(5.0), min_scale=np.deg2rad(0.3), correlation_s=0.5)

# How far the twist is off while filters that begin amid a movement look for the vertical: measured on walks cut open.
START_MOVING_RAD, SETTLES_S = np.deg2rad(15.0), 1.5
SETTLED_RAD = np.deg2rad(0.5)
SETTLING_KNEE_S, SETTLING_ANKLE_S = 4.0, 8.0  # after which the twist is better than a human joint's integral
START_RESTING_RAD = np.deg2rad(2.0)
RESTING_FORCE_M_S2 = (9.4, 10.2)  # of a sensor that hardly moves
MAX_START_RAD = np.deg2rad(6.0)  # no angle is reported as long as its start is less sure

MAX_STEEPNESS = 0.99  # sine; an axis that is upright shows no heading at all


@dataclass(frozen=True, slots=True)
class AngleSamples:
    """Flexion or dorsiflexion on the proximal sensor's grid, radians, and its standard deviation; NaN in gaps.

    All (n,). `tick` is the proximal stream's: where it jumps, that sensor gave no samples for long.
    """

    tick: IntArray
    time_s: FloatArray
    angle_rad: FloatArray
    sd_rad: FloatArray

    def __len__(self) -> int:
        return len(self.tick)


def followed_by_beats(
    rows: PairedSamples, per_beat: int, follow: Callable[[PairedSamples, int], tuple[FloatArray, FloatArray]]
) -> tuple[FloatArray, FloatArray]:
    """What `follow` gives (two of (n,)) of samples of one beat that follow each other, of all of them; NaN in gaps."""
    beat = rows.tick // per_beat
    is_one_piece = len(rows) > 0 and rows.tick[-1] - rows.tick[0] == len(rows) - 1 and beat[0] == beat[-1]
    if is_one_piece and rows.is_measured.all():  # as most blocks are: quicker
        return follow(rows, int(beat[0]))
    angle, sd = np.full(len(rows), np.nan), np.full(len(rows), np.nan)
    is_edge = (rows.tick[1:] - rows.tick[:-1] != 1) | (beat[1:] != beat[:-1])
    is_edge |= rows.is_paired[1:] != rows.is_paired[:-1]
    for a, b in pairwise([0, *(np.flatnonzero(is_edge) + 1).tolist(), len(rows)]):
        if b > a and rows.is_paired[a]:
            angle[a:b], sd[a:b] = follow(rows.part(slice(a, b)), int(beat[a]))
    if not rows.is_measured.all():
        angle[~rows.is_measured] = sd[~rows.is_measured] = np.nan
    return angle, sd


def start_sd_of(rows: PairedSamples) -> float:
    """How sure the first sample's angle is: resting, where gravity shows the vertical at once, or amid a movement."""
    signals = np.stack([rows.proximal[0], rows.distal[0]])
    force = np.linalg.norm(signals[:, 7:10], axis=1)
    is_resting = np.linalg.norm(signals[:, 4:7]) < MOVING_RAD_S
    is_resting &= bool(np.all((force > RESTING_FORCE_M_S2[0]) & (force < RESTING_FORCE_M_S2[1])))
    return float(START_RESTING_RAD if is_resting else START_MOVING_RAD)


def start_sd_at(time_s: FloatArray, started_s: float, sd_rad: float) -> FloatArray:
    """What is left (n,) of the start's uncertainty, and what stays."""
    left: FloatArray = sd_rad * np.exp((started_s - time_s) / SETTLES_S)
    return np.hypot(left, SETTLED_RAD)


def still_ahead(time_s: FloatArray, since_s: float, ahead_rad: float) -> FloatArray:
    """How far (n,) what is shown is still ahead on the way from one calibration to the next."""
    return np.asarray(0.5 * ahead_rad * (1 + np.cos(np.pi * np.minimum((time_s - since_s) / BLEND_S, 1.0))))


class LiveAngle:
    """The angle of one joint, with the calibration in force.

    The sensors' headings start anywhere and drift apart; what they differ by is tracked from where the joint axis
    points (j1 = R12 j2), looked at ten times a second. Half a turn from its zero the angle jumps by a whole turn: no
    knee or ankle gets there, and none is a turn off after a gap.

    Parameters
    ----------
    proximal_step_s, distal_step_s
        Of the two streams' grids.
    clock_offset_s
        What brings the proximal sensor's clock to the clock of the angles: at an ankle the lag of the knee.

    Attributes
    ----------
    paired
        What both sensors measured at the instants of the last update.
    """

    def __init__(
        self,
        calibration: JointCalibration,
        proximal_step_s: float,
        distal_step_s: float,
        clock_offset_s: float = 0.0,
    ) -> None:
        self._step_s = proximal_step_s
        self._per_beat = max(1, round(BEAT_S / proximal_step_s))
        self._clock_offset_s = clock_offset_s
        self._pairing = Pairing(proximal_step_s, distal_step_s, calibration.lag_s)
        self.paired = NO_PAIRS
        self._geometry = JointGeometry(calibration)
        self._certainty = _Certainty(calibration, proximal_step_s)
        self._heading = SlowDrift(HEADING, HEADING_LOOKS)
        self._seen: list[tuple[complex, float, int]] = []  # sums of what was seen of it, of times, and of how many
        self._integral: Integral | None = None
        self._started_s, self._start_sd_rad = 0.0, START_MOVING_RAD
        self._beat, self._next = 0, -1
        self._last: float | None = None  # the angle reported last in this stretch
        self._is_switched = False
        self._blend: tuple[float, float] | None = None  # since when, and how far ahead of the new calibration then

    @property
    def is_provisional(self) -> bool:
        """An ankle whose axis no step has confirmed: free motion alone hardly shows it."""
        calibration = self._geometry.calibration
        return not calibration.joint.is_knee and calibration.axis_source is AxisSource.FREE_MOTION

    def recalibrate(self, calibration: JointCalibration) -> None:
        """Blend to another calibration of the joint within BLEND_S, on half a cosine, from the next sample on."""
        old, new = self._geometry, JointGeometry(calibration)
        if (new.j1 @ old.j1) * (new.j2 @ old.j2) < 0:  # paired the other way round: so are the headings
            self._heading.turn(np.pi)
        self._geometry, self._pairing.lag_s = new, calibration.lag_s
        self._certainty.calibration = calibration
        self._seen, self._is_switched = [], True

    def update(self, proximal: OrientedSamples, distal: OrientedSamples) -> AngleSamples:
        """Take what is new of both sensors, in order; returns the angle as far as both of them have reached."""
        self.paired = rows = self._pairing.update(proximal, distal)
        angle, sd = followed_by_beats(rows, self._per_beat, self._follow)
        return AngleSamples(rows.tick, rows.time_s + self._clock_offset_s, angle, sd)

    def _follow(self, rows: PairedSamples, beat: int) -> tuple[FloatArray, FloatArray]:
        """Angle and standard deviation (n,) of samples of one beat that follow each other."""
        frames, time_s = self._geometry.frames(rows), rows.time_s
        is_new_stretch, is_new_beat = rows.tick[0] != self._next, beat != self._beat
        if is_new_stretch:
            self._start(rows, frames)
        start_sd = start_sd_at(time_s, self._started_s, self._start_sd_rad)
        if is_new_beat and not is_new_stretch:
            self._look(float(start_sd[0]))
        self._beat, self._next = beat, int(rows.tick[-1]) + 1
        heading = self._heading.at(time_s)
        twist, heading_sd = frames.twist(heading), self._heading_part(frames)
        if is_new_beat or is_new_stretch or self._is_switched:
            self._choose(float(time_s[0]), float(twist[0]), float(start_sd[0]))
        if self._integral is not None:
            twist, start_sd = self._integral.follow(rows), np.full(len(rows), self._integral.sd_rad)
            heading_sd = np.zeros(len(rows))
        self._see(rows, frames)
        self._certainty.take(rows, frames, self._geometry, heading, twist)
        angle = self._geometry.clinical(twist)
        sd = np.sqrt(self._certainty.sd_rad**2 + start_sd**2 + heading_sd**2)
        if self._is_switched and self._last is not None:
            turned = self._geometry.calibration.clinical_sign * self._step_s * self._geometry.bending_rate(rows)[0]
            self._blend = float(time_s[0]), float(wrap(self._last + turned - angle[0]))
        self._is_switched = False
        if self._blend is not None:
            angle, sd = self._blended(time_s, angle, sd, *self._blend)
        is_unsure = start_sd > MAX_START_RAD
        self._last = None if is_unsure[-1] else float(angle[-1])
        if is_unsure.any():
            angle[is_unsure] = sd[is_unsure] = np.nan
        return angle, sd

    def _start(self, rows: PairedSamples, frames: JointFrames) -> None:
        """A stretch begins: resting, where gravity shows the vertical at once, or amid a movement."""
        self._started_s, self._start_sd_rad = float(rows.time_s[0]), start_sd_of(rows)
        self._heading.restart(self._started_s, float(np.angle(frames.heading_seen[0])), 2 * self._start_sd_rad)
        self._integral, self._seen = None, []
        self._last, self._is_switched, self._blend = None, False, None

    def _heading_part(self, frames: JointFrames) -> FloatArray:
        """What the heading's uncertainty makes of the angle's (n,): the more, the steeper the axis is."""
        # a wrong axis shows a wrong heading, by the tangent of its steepness, and stays so
        steep = np.minimum(np.abs(frames.steepness), MAX_STEEPNESS)
        by_axis = (self._geometry.calibration.axis_sd_rad or 0.0) * steep / np.sqrt(1 - steep**2)
        return np.hypot(self._heading.sd_rad, by_axis) * steep

    def _choose(self, time_s: float, twist_rad: float, start_sd_rad: float) -> None:
        """Which of the two forms is shown from here on."""
        is_moving_start = self._start_sd_rad > START_RESTING_RAD
        settling_s = SETTLING_KNEE_S if self._geometry.calibration.joint.is_knee else SETTLING_ANKLE_S
        is_settling = is_moving_start and self._geometry.has_centre and time_s < self._started_s + settling_s
        is_required = self._geometry.is_hinge or is_settling
        if is_required and (self._integral is None or self._is_switched):
            is_unknown = is_moving_start and time_s == self._started_s
            start = None if is_unknown else start_sd_rad
            self._integral = Integral(self._geometry, self._step_s, time_s, twist_rad, start)
        elif not is_required and self._integral is not None:
            self._integral, self._is_switched = None, True

    def _blended(
        self, time_s: FloatArray, angle: FloatArray, sd: FloatArray, since_s: float, ahead_rad: float
    ) -> tuple[FloatArray, FloatArray]:
        """On the way from one calibration to the next, which is part of the uncertainty."""
        ahead = still_ahead(time_s, since_s, ahead_rad)
        if time_s[-1] > since_s + BLEND_S:
            self._blend = None
        return wrap(angle + ahead), np.hypot(sd, ahead)

    def _see(self, rows: PairedSamples, frames: JointFrames) -> None:
        seen, time_s = frames.heading_seen, rows.time_s
        if not rows.is_measured.all():
            seen, time_s = seen[rows.is_measured], time_s[rows.is_measured]
        self._seen.append((complex(seen.sum()), float(time_s.sum()), len(seen)))

    def _look(self, start_sd_rad: float) -> None:
        """What the beat that has ended shows of the slow things."""
        seen, time_s, count = (sum(part) for part in zip(*self._seen, strict=True)) if self._seen else (0j, 0.0, 0)
        self._seen = []
        if count:
            self._heading.look(seen / count, time_s / count, count * self._step_s, start_sd_rad)
        if self._integral is not None:
            self._integral.look()
        self._certainty.update()


class _Certainty:
    """Standard deviation of the angle by the offline formula, from the off-axis rate in the last movement."""

    def __init__(self, calibration: JointCalibration, step_s: float) -> None:
        self.calibration = calibration
        self._every = max(1, round(WITNESS_STEP_S / step_s))
        self._speeds: deque[float] = deque(maxlen=round(MOVING_WINDOW_S / WITNESS_STEP_S))
        count = round(WITNESS_S / WITNESS_STEP_S)
        self._across: deque[complex] = deque(maxlen=count)
        self._twists: deque[float] = deque(maxlen=count)
        self._beats = 0
        self.sd_rad = self._found()

    def take(
        self, rows: PairedSamples, frames: JointFrames, geometry: JointGeometry, heading: FloatArray, twist: FloatArray
    ) -> None:
        """Keep a few of these samples, if they are of a movement."""
        first = int(-rows.tick[0] % self._every)
        if first >= len(rows):
            return
        which = slice(first, None, self._every)
        chosen = rows.part(which)
        rate_1, rate_2 = geometry.rates(chosen)
        across = frames.part(which).off_axis_rate(rate_1, rate_2, heading[which])
        speed = np.sqrt(np.sum(rate_1**2 + rate_2**2, axis=1))
        for k in np.flatnonzero(chosen.is_measured).tolist():
            self._speeds.append(float(speed[k]))
            if sum(self._speeds) > MOVING_RAD_S * len(self._speeds):
                self._across.append(complex(across[k]))
                self._twists.append(float(twist[which][k]))

    def update(self) -> None:
        """A beat has passed."""
        self._beats += 1
        if self._beats % CERTAINTY_BEATS == 0 and self._across:
            self.sd_rad = self._found()

    def _found(self) -> float:
        c = self.calibration
        off_axis = robust_sd(np.array(self._across).view(np.float64)) if self._across else 0.0
        bent = np.unwrap(np.array(self._twists)) if self._twists else np.zeros(1)
        usual = np.std(bent, keepdims=True)  # an average over postures
        kind = c.joint.is_knee, c.is_hinge, c.nature
        return float(angle_sd_rad(usual, off_axis, float(np.ptp(bent)), *kind)[0])

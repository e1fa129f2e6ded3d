"""Angles, phases and steps of both legs of a walking patient as they happen, and straps that slip."""

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from core.body import Joint, Segment, Side, Site, ankle_of, knee_of
from core.calibration.strap import WINDOW_S, Slip, Turns, slips, turns_over
from core.gait.live import FootEvent, LiveEvent, LiveEvents, PhaseChange
from core.gait.phases import Phase
from core.hip.results import HipIdentification
from core.live.angle import AngleSamples, LiveAngle
from core.live.bias import BiasCorrection
from core.live.foot_pitch import FootPitch, FootStrike
from core.live.hips import LiveHips
from core.live.knee_check import KneeCheck
from core.live.orientation import NOTHING, OrientedSamples
from core.live.pairing import PairedSamples, joined_rows
from core.live.sensors import LiveSensor, LiveSensors
from core.results import JointCalibration
from core.samples import FloatArray, ImuBlock
from core.signal.pair import pair_of

KEPT_WINDOWS = 24  # two minutes say what is usual
MIN_SHARE_OF_WINDOW = 0.8
STRIDES_FOR_ANKLE = 5  # after so many of a side its ankle's axis can be found again, from free motion and walk together


@dataclass(frozen=True, slots=True)
class LiveJoint:
    """What is new of one joint.

    `is_provisional`: an ankle whose axis comes from free motion alone, or a hip whose heading is not sure yet.
    """

    samples: AngleSamples
    is_provisional: bool


@dataclass(frozen=True, slots=True)
class LiveFoot:
    """One foot now: what is new, its phase, its cadence (steps per minute, NaN while it does not walk), its strides.

    `strikes` are the pitches at those of the new contacts that followed a flat stance. `is_doubtful`: its own knee
    swings more often or less often than the foot lands, so that no figure of its events holds; cadence is NaN then.
    `doubtful_from_s`: when the first of those steps was over, NaN while there is no doubt.
    """

    events: tuple[LiveEvent, ...]
    changes: tuple[PhaseChange, ...]
    phase: Phase
    cadence_steps_min: float
    strides: int
    strikes: tuple[FootStrike, ...] = ()
    is_doubtful: bool = False
    doubtful_from_s: float = math.nan


@dataclass(frozen=True, slots=True)
class WalkingState:
    """What the samples since the last state have shown; a side is in `feet` if a foot sensor is worn there.

    `turned` are the new samples themselves, on an even clock, with their orientations. `slips` and `corrections` are
    all so far.
    """

    joints: Mapping[Joint, LiveJoint] = field(default_factory=dict)
    feet: Mapping[Side, LiveFoot] = field(default_factory=dict)
    slips: tuple[Slip, ...] = ()
    corrections: tuple[BiasCorrection, ...] = ()
    turned: Mapping[Site, OrientedSamples] = field(default_factory=dict)


class LiveWalk:
    """Both legs of a walking patient, block by block, with the calibration in force.

    Fed a whole recording at once it gives the same as fed in blocks of any size, and so in any order of sites.

    Parameters
    ----------
    sensors
        Rate, gyroscope bias (3,) in sensor axes and kind of rate of every sensor that is worn.
    calibration
        Of the joints whose angles are required, from `analyse`; joints without both sensors are passed over.
    hips
        What `analyse` has found of the hips; they are passed over without a sensor on the pelvis.

    Examples
    --------
    >>> sensors = {
    ...     site: LiveSensor(rate_hz=100.0, gyro_bias_rad_s=rest_of(block).gyr_rad_s)
    ...     for site, block in standing.imu.items()
    ... }
    >>> live = LiveWalk(sensors, analyse(session).calibrations[-1].joints)
    >>> state = live.update(walk.imu)  # or block by block, as samples come
    >>> sorted(state.joints)
    [<Joint.LEFT_ANKLE: 'left_ankle'>, <Joint.LEFT_KNEE: 'left_knee'>]
    """

    def __init__(
        self,
        sensors: Mapping[Site, LiveSensor],
        calibration: Mapping[Joint, JointCalibration],
        hips: Mapping[Joint, HipIdentification] | None = None,
    ) -> None:
        self._sensors = LiveSensors(sensors)
        known = [joint for joint in calibration if joint.proximal in sensors and joint.distal in sensors]
        lags_s = {joint: calibration[joint].lag_s for joint in known}
        self._angles = {
            joint: LiveAngle(
                calibration[joint],
                sensors[joint.proximal].step_s,
                sensors[joint.distal].step_s,
                clock_offset_s=0.0 if joint.is_knee else lags_s.get(knee_of(joint.side), 0.0),
            )
            for joint in known
        }
        self._straps = {joint: _StrapWatch(calibration[joint], sensors[joint.proximal].step_s) for joint in known}
        self._feet = {
            site: _LiveFoot(_pitch_axis(site.leg_side, calibration), _clock_offset_s(site.leg_side, lags_s))
            for site in sensors
            if site.segment is Segment.FOOT
        }
        self._hips = LiveHips(sensors, hips or {})
        self._slips: tuple[Slip, ...] = ()

    def update(self, blocks: Mapping[Site, ImuBlock]) -> WalkingState:
        """Take new samples of some or all sites; KeyError for a site not announced."""
        turned = self._sensors.update(blocks)
        joints, has_new_window = {}, False
        for joint, angle in self._angles.items():
            both = turned.get(joint.proximal, NOTHING), turned.get(joint.distal, NOTHING)
            joints[joint] = LiveJoint(angle.update(*both), angle.is_provisional)
            has_new_window |= self._straps[joint].update(angle.paired)
        for joint, reported in self._hips.update(turned).items():
            joints[joint] = LiveJoint(reported.samples, reported.is_provisional)
        if has_new_window:
            found = slips({joint: strap.turns for joint, strap in self._straps.items()})
            known = {slip.site for slip in self._slips}
            self._slips += tuple(slip for slip in found if slip.site not in known)
        feet = {
            site.leg_side: foot.update(turned.get(site, NOTHING), joints.get(knee_of(site.leg_side)))
            for site, foot in self._feet.items()
        }
        return WalkingState(joints, feet, self._slips, self._sensors.corrections, turned)

    def recalibrate(self, joint: Joint, calibration: JointCalibration) -> None:
        """Go over to another calibration of a joint without a jump: an ankle's, once STRIDES_FOR_ANKLE are in."""
        self._angles[joint].recalibrate(calibration)
        self._straps[joint].calibration = calibration

    def find_hips(self, hips: Mapping[Joint, HipIdentification]) -> None:
        """Show hips that were not known before, and go over to other frames of those that were, without a jump."""
        self._hips.find(hips)

    @property
    def late(self) -> dict[Site, int]:
        """Samples of each site that came too late, or twice, and were dropped."""
        return self._sensors.late


def _pitch_axis(side: Side, calibration: Mapping[Joint, JointCalibration]) -> FloatArray | None:
    ankle = calibration.get(ankle_of(side))
    return None if ankle is None else ankle.axis_distal


def _clock_offset_s(side: Side, lags_s: Mapping[Joint, float]) -> float:
    """What brings the foot's clock to the thigh's."""
    return sum(lags_s.get(joint, 0.0) for joint in (knee_of(side), ankle_of(side)))


class _LiveFoot:
    def __init__(self, pitch_axis: FloatArray | None, clock_offset_s: float) -> None:
        self._events = LiveEvents(pitch_axis)
        self._clock_offset_s = clock_offset_s
        self._pitch = FootPitch()
        self._check = KneeCheck()
        self._contacts = 0

    def update(self, samples: OrientedSamples, knee: LiveJoint | None) -> LiveFoot:
        received = samples.is_measured
        if not received.all():
            samples = OrientedSamples(
                samples.tick[received], samples.time_s[received], samples.signals[received], received[received]
            )
        time_s = samples.time_s + self._clock_offset_s
        events = tuple(self._events.update(time_s, samples.gyr_rad_s, samples.acc_m_s2))
        axis = self._events.pitch_axis
        strikes = self._pitch.update(time_s, samples, events, None if axis is None else np.array(axis))
        contacts_s = [event.time_s for event in events if event.event is FootEvent.INITIAL_CONTACT]
        self._contacts += len(contacts_s)
        if knee is not None:
            self._check.update(knee.samples, contacts_s)
        is_doubtful = self._check.is_doubtful
        cadence_steps_min = math.nan if is_doubtful else self._events.cadence_steps_min
        changes = tuple(self._events.changes)
        strides = max(0, self._contacts - 1)
        from_s = self._check.doubtful_from_s
        return LiveFoot(events, changes, self._events.phase, cadence_steps_min, strides, strikes, is_doubtful, from_s)


class _StrapWatch:
    """The turns of one joint's sensors against each other, one window after the other."""

    def __init__(self, calibration: JointCalibration, step_s: float) -> None:
        self.calibration = calibration
        self._step_s = step_s
        self._per_window = round(WINDOW_S / step_s)
        self._rows: list[PairedSamples] = []
        self._windows: deque[tuple[float, float]] = deque(maxlen=KEPT_WINDOWS)

    @property
    def turns(self) -> Turns:
        time_s, turn_rad = np.array(self._windows).reshape(-1, 2).T
        return Turns(time_s, turn_rad)

    def update(self, rows: PairedSamples) -> bool:
        """Take what is new of both sensors; returns whether a window has been judged."""
        number = rows.tick // self._per_window
        if len(rows) and number[0] == number[-1]:
            return self._add(rows, int(number[0]))
        is_judged = False
        for a, b in pairwise([0, *(np.flatnonzero(np.diff(number)) + 1).tolist(), len(rows)]):
            if b > a:
                is_judged |= self._add(rows.part(slice(a, b)), int(number[a]))
        return is_judged

    def _add(self, rows: PairedSamples, number: int) -> bool:
        is_next = bool(self._rows) and number != self._rows[0].tick[0] // self._per_window
        is_judged = is_next and self._judge()
        self._rows = [rows] if is_next else [*self._rows, rows]
        return is_judged

    def _judge(self) -> bool:
        """Whether the window just ended shows a turn; one with a gap between two filters' starts does not."""
        window = joined_rows(self._rows)
        if len(window) < MIN_SHARE_OF_WINDOW * self._per_window or not window.is_paired.all():
            return False
        if np.any(np.diff(window.tick) > 1):
            return False
        one, two = window.proximal, window.distal
        rates, forces = (one[:, 4:7], two[:, 4:7]), (one[:, 7:10], two[:, 7:10])
        pair = pair_of(window.time_s, self._step_s, rates, forces, (one[:, 0:4], two[:, 0:4]), window.is_measured)
        found = turns_over(pair, self.calibration.axis_proximal, self.calibration.axis_distal)
        self._windows.extend(zip(found.time_s.tolist(), found.turn_rad.tolist(), strict=True))
        return len(found.time_s) > 0

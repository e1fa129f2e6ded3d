"""Estimate what the walking patient does now and did in the last seconds.

It gives what the screen draws: curves, phases, steps.
"""

import math
from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np

from app.live_output.chunks import LiveChunk
from app.wizard.walking.live_chunk import chunk_of, verdict_by
from app.wizard.walking.readout import LiveLane, LiveTrace, PhaseSpan, WalkingReadout
from core.body import LEG_JOINTS, Joint, Segment, Site, knee_of
from core.gait.live import PHASE_AFTER, FootEvent, LiveEvent, PhaseChange
from core.gait.phases import Phase
from core.gait.strides import MAX_STRIDE_S
from core.hip.results import HipIdentification
from core.live.angle import AngleSamples
from core.live.sensors import LiveSensor
from core.live.stride_values import StrideValue, StrideValues
from core.live.walking import LiveFoot, LiveJoint, LiveWalk
from core.results import JointCalibration
from core.samples import FloatArray, ImuBlock
from core.targets import TargetMeasure
from core.timed.live import LiveTest
from core.verdicts.model import Verdict

KEPT_S = 15.0
SILENT_S = 0.5
# Beyond, a knee or ankle is not where the stated sites put it. Of 12 ankles of people walking after a stroke three
# left it, for 0.2 s in all at most: such samples are left out, and only where they are more so is the whole joint.
PLAUSIBLE_RAD = np.deg2rad(-40.0), np.deg2rad(160.0)
OUTSIDE_S = 0.5
HIP_RAD = -np.inf, np.inf
KEPT_VALUES = 64  # of strides; who looks thirty times a second misses none


class WalkingEstimator:
    """Both legs of a walking patient, from walk to walk without a break: filters that have settled stay so.

    Parameters
    ----------
    live_sensors
        By name. Sensors that are missing here, or in `site_of`, are not worn.
    hips
        What was found of the hips until now.

    Attributes
    ----------
    calibrated
        The joints with a calibration whose two sensors are worn and send samples.
    on_value
        Called by the estimator's thread whenever `state` has a new value of a stride, so that nobody has to look.
    on_chunk
        Called by the estimator's thread with what is new, for other programs; None while nothing is sent.
    rates_hz
        Of the samples of each joint in `calibrated`.
    test
        The timed test that is going on; it is given all samples.
    """

    def __init__(
        self,
        site_of: Mapping[str, Site],
        live_sensors: Mapping[str, LiveSensor],
        calibration: Mapping[Joint, JointCalibration],
        hips: Mapping[Joint, HipIdentification] | None = None,
    ) -> None:
        self._site_of = {name: site for name, site in site_of.items() if name in live_sensors}
        sensors = {site: live_sensors[name] for name, site in self._site_of.items()}
        self._walking = LiveWalk(sensors, calibration, hips)
        self.calibrated = frozenset(
            joint for joint in LEG_JOINTS if joint in calibration and {joint.proximal, joint.distal} <= set(sensors)
        )
        self._steps_s = {site: sensor.step_s for site, sensor in sensors.items()}
        self.rates_hz = {joint: 1.0 / self._steps_s[joint.proximal] for joint in LEG_JOINTS if joint in self.calibrated}
        self._calibration = {joint: calibration[joint] for joint in self.calibrated}
        self._verdicts: dict[Joint, Verdict] = {}  # by that, once somebody asks
        self._curves = {
            joint: _Curve(self._steps_s[joint.proximal]) for joint in LEG_JOINTS if joint in self.calibrated
        }
        self._foot_sites = {site.leg_side: site for site in sensors if site.segment is Segment.FOOT}
        self._feet = {side: _Foot() for side in self._foot_sites}
        self._received_s: dict[Site, float] = {}
        self._first_s: float | None = None
        self._now_s = -np.inf
        self._count_from_s = -np.inf  # set by the screen
        self._values = StrideValues()
        self._reported: deque[StrideValue] = deque(maxlen=KEPT_VALUES)
        self._values_reported = 0
        self.on_value: Callable[[], None] | None = None
        self.on_chunk: Callable[[LiveChunk], None] | None = None
        self.test: LiveTest | None = None  # set by the screen
        self._wishes: deque[tuple[Joint, JointCalibration]] = deque()  # put in by the screen, taken by the estimator
        self._hips: deque[Mapping[Joint, HipIdentification]] = deque()  # the same
        self.state = WalkingReadout()

    def recalibrate(self, joint: Joint, calibration: JointCalibration) -> None:
        """Blend to another calibration from the next update on; only for calibrated joints. Thread-safe."""
        self._wishes.append((joint, calibration))

    def find_hips(self, hips: Mapping[Joint, HipIdentification]) -> None:
        """Show newly found hips and blend others to new frames, from the next update on. Thread-safe."""
        self._hips.append(hips)

    def count_from(self, time_s: float) -> None:
        """Count strides from here on, as a walk begins. From any thread."""
        self._count_from_s = time_s

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        """Take new samples of some or all sensors; those that are not worn are passed over."""
        while self._wishes:
            joint, calibration = self._wishes.popleft()
            if joint in self._curves:
                self._walking.recalibrate(joint, calibration)
                self._calibration[joint] = calibration
                self._verdicts.pop(joint, None)
        while self._hips:
            self._walking.find_hips(self._hips.popleft())
        worn = {self._site_of[name]: block for name, block in blocks.items() if name in self._site_of and len(block)}
        if not worn:
            return
        self._hear(worn)
        reported = self._walking.update(worn)
        test = self.test
        if test is not None:
            test.update(reported.turned)
        kept_from_s = self._now_s - KEPT_S
        joints = {}
        for joint, new in reported.joints.items():
            if joint not in self._curves:
                self._curves[joint] = _Curve(self._steps_s[joint.proximal], HIP_RAD)
            joints[joint] = self._curves[joint].add(new)
        traces = {joint: curve.since(kept_from_s) for joint, curve in self._curves.items()}
        implausible = tuple(joint for joint, curve in self._curves.items() if curve.outside_s > OUTSIDE_S)
        values = tuple(
            one
            for one in self._values.update(replace(reported, joints=joints))
            if one.measure is not TargetMeasure.KNEE_SWING_PEAK or knee_of(one.side) not in implausible
        )
        self._reported.extend(values)
        self._values_reported += len(values)
        missing = tuple(site for site in self._walking_sites() if self._is_silent(site))
        lanes, cadences, strides = {}, [], {}
        for side, foot in self._feet.items():
            site = self._foot_sites[side]
            foot.take(reported.feet[side], worn.get(site))
            lanes[side] = foot.lane(kept_from_s, is_silent=site in missing)
            count = foot.strides_since(self._count_from_s, kept_from_s)
            if not foot.is_doubtful:
                strides[side] = count
            cadence = reported.feet[side].cadence_steps_min
            if math.isfinite(cadence) and site not in missing:
                cadences.append(cadence)
        self.state = WalkingReadout(
            now_s=self._now_s,
            joints={joint: trace for joint, trace in traces.items() if joint not in implausible},
            lanes=lanes,
            strides=strides,
            cadence_steps_min=sum(cadences) / len(cadences) if cadences else math.nan,
            slips=reported.slips,
            corrections=reported.corrections,
            missing=missing,
            implausible=implausible,
            doubtful=tuple(self._foot_sites[side] for side, foot in reported.feet.items() if foot.is_doubtful),
            stride_values=tuple(self._reported),
            values_reported=self._values_reported,
            test=None if test is None else test.state,
        )
        if values and (on_value := self.on_value) is not None:
            on_value()
        if (on_chunk := self.on_chunk) is not None:
            for joint in self._calibration.keys() - self._verdicts.keys():
                self._verdicts[joint] = verdict_by(self._calibration[joint])
            on_chunk(chunk_of(reported, joints, self._verdicts, implausible, missing))

    def _hear(self, worn: Mapping[Site, ImuBlock]) -> None:
        for site, block in worn.items():
            self._received_s[site] = float(block.time_s[-1])
        if self._first_s is None:
            self._first_s = min(float(block.time_s[0]) for block in worn.values())
        self._now_s = max(self._received_s.values())

    def _walking_sites(self) -> list[Site]:
        return [site for site in Site if site in self._site_of.values()]

    def _is_silent(self, site: Site) -> bool:
        assert self._first_s is not None
        return self._now_s - self._received_s.get(site, self._first_s) > SILENT_S


class _Curve:
    """One joint's angles. They are written behind what the screen holds, and never twice: what it holds stays."""

    def __init__(self, step_s: float, plausible_rad: tuple[float, float] = PLAUSIBLE_RAD) -> None:
        self._step_s, self._plausible_rad = step_s, plausible_rad
        self._outside: list[float] = []  # when
        self._room = round(4 * KEPT_S / step_s)
        self._time_s, self._angle_rad = np.empty(self._room), np.empty(self._room)
        self._begin = self._end = 0
        self._last_tick: int | None = None
        self._is_provisional = False

    @property
    def outside_s(self) -> float:
        """For how long the angle was, within what is kept, where none can be."""
        return len(self._outside) * self._step_s

    def add(self, new: LiveJoint) -> LiveJoint:
        """Take the next samples, and give them without those that cannot be; where ticks jump, a NaN parts them."""
        self._is_provisional = new.is_provisional
        lowest, highest = self._plausible_rad
        is_outside = (new.samples.angle_rad < lowest) | (new.samples.angle_rad > highest)
        if is_outside.any():
            self._outside += new.samples.time_s[is_outside].tolist()
            angle_rad = np.where(is_outside, np.nan, new.samples.angle_rad)
            new = replace(new, samples=replace(new.samples, angle_rad=angle_rad))
        if len(new.samples):
            self._write(new.samples)
        return new

    def _write(self, samples: AngleSamples) -> None:
        before = samples.tick[:1] - 1 if self._last_tick is None else [self._last_tick]
        jumps = np.flatnonzero(np.diff(np.concatenate([before, samples.tick])) > 1)
        self._last_tick = int(samples.tick[-1])
        time_s, angle_rad = samples.time_s, samples.angle_rad
        if len(jumps):
            time_s = np.insert(time_s, jumps, time_s[jumps] - self._step_s)
            angle_rad = np.insert(angle_rad, jumps, np.nan)
        end = self._end + len(time_s)
        if end > len(self._time_s):
            end = self._move(len(time_s))
        self._time_s[self._end : end], self._angle_rad[self._end : end] = time_s, angle_rad
        self._end = end

    def since(self, time_s: float) -> LiveTrace:
        self._outside = self._outside[bisect_left(self._outside, time_s) :]
        self._begin += int(self._time_s[self._begin : self._end].searchsorted(time_s))
        part = slice(self._begin, self._end)
        return LiveTrace(_read_only(self._time_s[part]), _read_only(self._angle_rad[part]), self._is_provisional)

    def _move(self, coming: int) -> int:
        """Go over to new arrays with what is still needed; returns where the coming samples end there."""
        kept = slice(self._begin, self._end)
        count = self._end - self._begin
        room = max(self._room, 2 * (count + coming))
        old_s, old_rad = self._time_s[kept], self._angle_rad[kept]
        self._time_s, self._angle_rad = np.empty(room), np.empty(room)
        self._time_s[:count], self._angle_rad[:count] = old_s, old_rad
        self._begin, self._end = 0, count
        return count + coming


class _Foot:
    """One foot's phases, silences and contacts."""

    def __init__(self) -> None:
        self._phases: list[tuple[Phase, float]] = []  # each lasts until the next
        self._silent_s: list[tuple[float, float]] = []
        self._received_s: float | None = None
        self._contacts_s: list[float] = []  # of the last seconds
        self._from_s = -np.inf
        self._passed = 0  # strides since `_from_s` whose beginning is not among them any more
        self._first_s = np.inf  # of the contacts since `_from_s`
        self._is_doubtful_now = self._was_doubtful = False
        self._lane, self._lane_of = LiveLane(), object()  # what was given last, and what it was made of

    @property
    def is_doubtful(self) -> bool:
        """Whether its count is: what was lost or invented since its first contact stays in it.

        Before that a patient may end another movement, in which knees bend and no foot lands.
        """
        return self._is_doubtful_now or self._was_doubtful

    def take(self, foot: LiveFoot, block: ImuBlock | None) -> None:
        if block is not None:
            before = block.time_s[:1] if self._received_s is None else np.array([self._received_s])
            time_s = np.concatenate([before, block.time_s])
            ends = np.flatnonzero(np.diff(time_s) > SILENT_S)
            self._silent_s += zip(time_s[ends].tolist(), time_s[ends + 1].tolist(), strict=True)
            self._received_s = float(time_s[-1])
        for events, change in _by_sample(foot.events, foot.changes):
            for event in events:
                self._begin(PHASE_AFTER[event.event], event.time_s)
                if event.event is FootEvent.INITIAL_CONTACT:
                    self._contacts_s.append(event.time_s)
                    if event.time_s >= self._from_s:
                        self._first_s = min(self._first_s, event.time_s)
            self._go_over(change)
        self._is_doubtful_now = foot.is_doubtful and foot.doubtful_from_s >= self._from_s
        self._was_doubtful |= self._is_doubtful_now and foot.doubtful_from_s >= self._first_s

    def strides_since(self, time_s: float, kept_from_s: float) -> int:
        """Count strides since `time_s`, contacts up to MAX_STRIDE_S apart.

        Contacts before `kept_from_s` go: another `time_s` later counts from there at the earliest.
        """
        if time_s != self._from_s:
            self._from_s, self._passed, self._first_s = time_s, 0, np.inf
            self._is_doubtful_now = self._was_doubtful = False
        strides = [(start, end) for start, end in pairwise(self._contacts_s) if end - start <= MAX_STRIDE_S]
        count = self._passed + sum(start >= time_s for start, _ in strides)
        self._passed += sum(time_s <= start and end < kept_from_s for start, end in strides)
        self._contacts_s = self._contacts_s[max(bisect_left(self._contacts_s, kept_from_s) - 1, 0) :]
        return count

    def lane(self, from_s: float, is_silent: bool) -> LiveLane:
        """What is still of interest; the rest is forgotten. As long as nothing changes it is the same object."""
        while len(self._phases) > 1 and self._phases[1][1] < from_s:
            del self._phases[0]
        self._silent_s = [span for span in self._silent_s if span[1] >= from_s]
        lane_of = tuple(self._phases), tuple(self._silent_s), self._received_s if is_silent else None
        if lane_of != self._lane_of:
            self._lane, self._lane_of = self._make_lane(is_silent), lane_of
        return self._lane

    def _make_lane(self, is_silent: bool) -> LiveLane:
        following = [*self._phases[1:], (Phase.UNKNOWN, self._received_s if is_silent else None)]
        spans = tuple(
            PhaseSpan(phase, start_s, end_s)
            for (phase, start_s), (_, end_s) in zip(self._phases, following, strict=False)
            if phase is not Phase.UNKNOWN
        )
        silent: tuple[tuple[float, float | None], ...] = tuple(self._silent_s)
        if is_silent and self._received_s is not None:
            silent = (*silent, (self._received_s, None))
        return LiveLane(spans, silent)

    def _begin(self, phase: Phase, at_s: float) -> None:
        """An event gave since when the foot is in a phase: what was shown after that instant was premature."""
        while self._phases and self._phases[-1][1] >= at_s:
            self._phases.pop()
        if not self._phases or self._phases[-1][0] is not phase:
            self._phases.append((phase, at_s))

    def _go_over(self, change: PhaseChange) -> None:
        """A sample put the foot into a phase, with an event or without."""
        last = self._phases[-1] if self._phases else None
        if last is not None and last[0] is Phase.PRE_SWING and change.phase is Phase.FOOT_FLAT:
            self._begin(Phase.FOOT_FLAT, last[1])  # it did not leave the floor
        elif last is None or last[0] is not change.phase:
            self._begin(change.phase, change.since_s)


def _by_sample(
    events: tuple[LiveEvent, ...], changes: tuple[PhaseChange, ...]
) -> list[tuple[list[LiveEvent], PhaseChange]]:
    """Events and the change that came from one sample; every event comes with a change."""
    return [([event for event in events if event.reported_s == change.reported_s], change) for change in changes]


def _read_only(part: FloatArray) -> FloatArray:
    view = part.view()
    view.flags.writeable = False
    return view

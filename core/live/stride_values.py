"""One value per stride, as it happens, of each measure that a patient can be given a target for.

A value is reported as soon as its event is known: a knee's when it has fallen from the peak of its swing, the others
with the event of the foot that ends what they measure. Starts, stops and turns are reported as well; who aims at
something sees every stride.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from core.body import Side, knee_of
from core.gait.live import FootEvent, LiveEvent
from core.gait.strides import MAX_STRIDE_S
from core.live.angle import AngleSamples
from core.live.walking import LiveFoot, WalkingState
from core.samples import FloatArray
from core.signal.tracks import MAX_REPORTED_GAP_S
from core.targets import TargetMeasure

# A walking knee falls by as much within 0.04 s of its peak; noise and its filters' steps stay below a tenth of it.
PASSED_RAD = np.deg2rad(2.0)
BEFORE_TOE_OFF_S = 0.08  # a stiff knee bends most just before the foot leaves; offline its peak is sought from 55 % on
KEPT_S = 5.0  # of angles: longer than a swing with the delay of its events


@dataclass(frozen=True, slots=True)
class StrideValue:
    """`value` in the measure's unit, of the leg or foot of `side`.

    `event_s` is the instant of what was measured, the peak or the foot's event, `reported_s` the sample that showed it,
    both on the clock of the angles.
    """

    measure: TargetMeasure
    side: Side
    value: float
    event_s: float
    reported_s: float


class StrideValues:
    """The values of both legs, from what `LiveWalk` reports, one state after the other; none of a doubtful foot."""

    def __init__(self) -> None:
        self._knees: dict[Side, _KneeSwing] = {side: _KneeSwing() for side in Side}
        self._contacts_s: dict[Side, float] = dict.fromkeys(Side, -math.inf)
        self._stances_s: dict[Side, tuple[float, float]] = {}  # of the latest: its end, and how long it lasted

    def update(self, state: WalkingState) -> tuple[StrideValue, ...]:
        """Give the values that a state contains, in the order in which they became known."""
        reported: list[StrideValue] = []
        feet = {side: foot for side, foot in state.feet.items() if not foot.is_doubtful}
        for side, foot in feet.items():
            joint = state.joints.get(knee_of(side))
            if joint is not None:
                reported += self._knee_values(side, joint.samples, foot)
            reported += (
                StrideValue(TargetMeasure.FOOT_STRIKE, side, math.degrees(one.pitch_rad), one.time_s, one.reported_s)
                for one in foot.strikes
            )
        reported += self._event_values(feet)
        return tuple(sorted(reported, key=lambda one: one.reported_s))

    def _knee_values(self, side: Side, samples: AngleSamples, foot: LiveFoot) -> Iterator[StrideValue]:
        for peak_rad, at_s, reported_s in self._knees[side].update(samples, foot.events):
            yield StrideValue(TargetMeasure.KNEE_SWING_PEAK, side, math.degrees(peak_rad), at_s, reported_s)

    def _event_values(self, feet: Mapping[Side, LiveFoot]) -> Iterator[StrideValue]:
        every = [(event, side) for side, foot in feet.items() for event in foot.events]
        for event, side in sorted(every, key=lambda one: one[0].reported_s):
            if event.event is FootEvent.INITIAL_CONTACT:
                stride_s = event.time_s - self._contacts_s[side]
                self._contacts_s[side] = event.time_s
                if 0.0 < stride_s <= MAX_STRIDE_S:
                    yield StrideValue(TargetMeasure.CADENCE, side, 120.0 / stride_s, event.time_s, event.reported_s)
            elif event.event is FootEvent.TOE_OFF:
                ratio = self._stance_ratio(side, event.time_s)
                if ratio is not None:
                    yield StrideValue(TargetMeasure.STANCE_RATIO, side, 100.0 * ratio, event.time_s, event.reported_s)

    def _stance_ratio(self, side: Side, off_s: float) -> float | None:
        """This leg's stance that has just ended over the other's latest; None where one of them is not known."""
        stance_s = off_s - self._contacts_s[side]
        if not 0.0 < stance_s <= MAX_STRIDE_S:
            return None
        self._stances_s[side] = off_s, stance_s
        ended_s, other_s = self._stances_s.get(side.other, (-math.inf, math.nan))
        return stance_s / other_s if off_s - ended_s <= MAX_STRIDE_S else None


class _KneeSwing:
    """The largest flexion of each swing of one knee; none of a swing in which the angle was not known throughout."""

    def __init__(self) -> None:
        self._time_s: FloatArray = np.empty(0)
        self._angle_rad: FloatArray = np.empty(0)
        self._from_s: float | None = None  # of the swing whose peak is still to be reported

    def update(self, samples: AngleSamples, events: Iterable[LiveEvent]) -> Iterator[tuple[float, float, float]]:
        """Give the peak, its instant and the instant at which it was known, of each swing that shows it now."""
        self._time_s = np.concatenate([self._time_s, samples.time_s])
        self._angle_rad = np.concatenate([self._angle_rad, samples.angle_rad])
        for event in events:
            if event.event is FootEvent.TOE_OFF:
                yield from self._passed(event.reported_s)
                self._from_s = event.time_s - BEFORE_TOE_OFF_S
            elif event.event is FootEvent.INITIAL_CONTACT:
                yield from self._passed(event.reported_s)
                yield from self._ended(event)
        yield from self._passed(math.inf)
        if len(self._time_s):
            first = int(np.searchsorted(self._time_s, self._time_s[-1] - KEPT_S))
            self._time_s, self._angle_rad = self._time_s[first:], self._angle_rad[first:]

    def _passed(self, until_s: float) -> Iterator[tuple[float, float, float]]:
        """The peak, if the angle has fallen from it by `until_s`."""
        time_s, angle_rad = self._swing(until_s)
        has_fallen = angle_rad < np.maximum.accumulate(angle_rad) - PASSED_RAD
        if has_fallen.any():
            end = int(np.argmax(has_fallen))
            peak = int(np.argmax(angle_rad[:end]))
            self._from_s = None
            yield float(angle_rad[peak]), float(time_s[peak]), float(time_s[end])

    def _ended(self, contact: LiveEvent) -> Iterator[tuple[float, float, float]]:
        """The peak of a knee that hardly fell until the foot landed."""
        time_s, angle_rad = self._swing(contact.time_s)
        if len(time_s):
            peak = int(np.argmax(angle_rad))
            yield float(angle_rad[peak]), float(time_s[peak]), contact.reported_s
        self._from_s = None

    def _swing(self, until_s: float) -> tuple[FloatArray, FloatArray]:
        """The angles of the present swing; none, and it is given up, where some are not known."""
        if self._from_s is None:
            return np.empty(0), np.empty(0)
        a = int(np.searchsorted(self._time_s, self._from_s))
        b = int(np.searchsorted(self._time_s, until_s, side="right"))
        time_s, angle_rad = self._time_s[a:b], self._angle_rad[a:b]
        edges = np.concatenate([[self._from_s], time_s])
        if not np.isfinite(angle_rad).all() or np.any(np.diff(edges) > MAX_REPORTED_GAP_S):
            self._from_s = None
            return np.empty(0), np.empty(0)
        return time_s, angle_rad

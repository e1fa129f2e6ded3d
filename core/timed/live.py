"""A timed test as it goes on: the clock, the way so far, turns and laps, by the rules of the recording.

The samples of the last seconds are looked at four times a second, as a recording's are; swings that lie back further
are settled and kept. So a step is known a moment after its foot has come to rest, and the clock starts, in hindsight,
where it would in the recording.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from core.body import Segment, Side, Site
from core.live.orientation import NOTHING, OrientedSamples, joined
from core.samples import FloatArray, RateKind
from core.signal.orientation import oriented
from core.signal.pair import OrientedTrack
from core.signal.tracks import Track
from core.timed.found import NotMeasured, TimedTest
from core.timed.protocols import DEFINITIONS, KeyMeaning, PlannedTest
from core.timed.seat import NO_SEAT, STEP_S, SeatMotions, motions_of_tilt
from core.timed.timing import origin_of, timed
from core.timed.way import BodyWay, FootSwings, ReceivedFoot, moving_pieces, swings_of, way_of

LOOK_S = 0.25  # between one look and the next
SETTLED_S = 3.0  # a swing that ended so long ago has another stance and more behind it: nothing changes it
KEPT_S = 6.0  # of samples: a swing that is not settled, and the stance before it
LEAST_SAMPLES = 10  # too few for any swing
OVERLAP_S = 0.05
SEAT_SURE_S = 0.7  # after the thighs seem to have come to the seat, or upright
LAST_STEP_S = 5.0  # on stairs the patient may stand for so long between two steps
KEY_AT_START_S = 1.5  # a key pressed so shortly after the motion began meant the beginning
RUN_OUT_S = 2.5  # after the motion has ended a test, a key may still say where the tape is


NO_SWINGS = FootSwings(np.empty(0), np.empty(0), np.empty(0), np.empty(0), np.empty((0, 2)), np.empty((0, 2)))


@dataclass(frozen=True, slots=True)
class LiveReadout:
    """A test now, on the clock of the sensors; NaN where not known (yet).

    `distance_m`: since the start, as far as the steps show; NaN while `reasons` say why it cannot be determined.
    `steps`: side and way in metres of each contact since the start, in order of time.
    """

    planned: PlannedTest
    now_s: float = math.nan
    start_s: float = math.nan
    end_s: float = math.nan
    distance_m: float = math.nan
    found: TimedTest | None = None
    steps: tuple[tuple[Side, float], ...] = ()
    reasons: tuple[NotMeasured, ...] = ()
    silent: tuple[Site, ...] = ()
    is_still: bool = False

    @property
    def has_begun(self) -> bool:
        return math.isfinite(self.start_s)

    @property
    def is_over(self) -> bool:
        return math.isfinite(self.end_s)

    @property
    def turns(self) -> int:
        """How many turns about there were since the start."""
        return sum(turn.is_about for turn in self.found.turns) if self.found is not None else 0

    def elapsed_s(self, now_s: float) -> float:
        """What the clock shows at `now_s`; NaN before the start."""
        return (self.end_s if self.is_over else now_s) - self.start_s


class LiveTest:
    """One test from the samples of feet and thighs, block by block.

    Parameters
    ----------
    upright
        The vertical (3,) in the axes of each thigh's sensor while the patient is standing.
    rigid_sides
        Those with a prosthetic foot.
    from_s
        When the recording began; what was before does not count.
    """

    def __init__(
        self,
        planned: PlannedTest,
        upright: Mapping[Site, FloatArray],
        rigid_sides: frozenset[Side],
        feet: frozenset[Side],
        from_s: float,
    ) -> None:
        self.planned = planned  # its keys are set by the screen, and read by the estimator
        self._from_s = from_s
        self._feet = {side: _LiveFootWay(side, side in rigid_sides, from_s) for side in Side if side in feet}
        chair = DEFINITIONS[planned.protocol].is_from_chair
        self._thighs = {site: _LiveThigh(up, from_s) for site, up in upright.items() if chair}
        self._looked_s = self._now_s = -math.inf
        self.state = LiveReadout(self.planned)

    def press(self, time_s: float) -> KeyMeaning | None:
        """Take a key, on the sensors' clock; what it meant, None where nothing is left to say. From any thread."""
        state, planned = self.state, self.planned
        if time_s <= self._from_s:
            return None
        is_at_start = not state.has_begun or time_s - state.start_s < KEY_AT_START_S
        if planned.start_key_s is None and planned.end_key_s is None and is_at_start:
            self.planned = replace(planned, start_key_s=time_s)
            self.state = replace(state, planned=self.planned, start_s=time_s, end_s=math.nan, distance_m=math.nan)
            return KeyMeaning.START
        is_late = state.is_over and time_s > state.end_s + RUN_OUT_S
        if planned.end_key_s is None and not is_late and not time_s <= (planned.start_key_s or -math.inf):
            self.planned = replace(planned, end_key_s=time_s)
            self.state = replace(state, planned=self.planned, end_s=time_s)
            return KeyMeaning.END
        return None

    def update(self, turned: Mapping[Site, OrientedSamples]) -> None:
        """Take what is new of the sensors."""
        for site, samples in turned.items():
            if not len(samples.time_s):
                continue
            self._now_s = max(self._now_s, float(samples.time_s[-1]))
            if site.segment is Segment.FOOT and site.side in self._feet:
                self._feet[site.side].add(samples)
            elif site in self._thighs:
                self._thighs[site].add(samples)
        if self._now_s - self._looked_s >= LOOK_S and self._now_s > self._from_s:
            self._looked_s = self._now_s
            self._look()

    def _look(self) -> None:
        planned, now_s = self.planned, self._now_s
        feet = {side: foot.received() for side, foot in self._feet.items() if foot.has_samples}
        way = way_of(feet, self._from_s, now_s)
        found = timed(way, self._seat(), planned)
        start_s, end_s = found.start_s, found.end_s
        if found.definition.is_from_chair and not found.is_end_by_key and now_s - end_s < SEAT_SURE_S:
            end_s = math.nan  # how far the thighs will come is not seen yet
        if planned.protocol.is_on_stairs and not found.is_end_by_key and now_s - end_s < LAST_STEP_S:
            end_s = math.nan  # a step may follow yet
        distance_m = math.nan
        steps: tuple[tuple[Side, float], ...] = ()
        if math.isfinite(start_s) and len(way.time_s):
            until_s = end_s if math.isfinite(end_s) else now_s
            if not way.silences_in(start_s, until_s):
                distance_m = way.way_at(until_s) - origin_of(way, start_s)
            steps = _steps(way, start_s, until_s)
        silent = tuple(one.site for one in way.silences if one.end_s >= now_s - LOOK_S)
        if planned == self.planned:  # else a key was pressed meanwhile, and the next look is on it
            is_still = bool(self._feet) and all(foot.is_still for foot in self._feet.values())
            reasons = tuple(one for one in found.missing if one is not NotMeasured.NOT_FINISHED)
            self.state = LiveReadout(
                planned, now_s, start_s, end_s, distance_m, found, steps, reasons, silent, is_still
            )

    def _seat(self) -> SeatMotions:
        if not self._thighs:
            return replace(NO_SEAT, has_thighs=False)
        known = [thigh for thigh in self._thighs.values() if thigh.has_samples]
        if not known:
            return NO_SEAT
        time_s = np.arange(self._from_s, self._now_s, STEP_S)
        return motions_of_tilt(time_s, np.mean([thigh.tilt_at(time_s) for thigh in known], axis=0))


def _steps(way: BodyWay, start_s: float, end_s: float) -> tuple[tuple[Side, float], ...]:
    """Side and way of each contact since the start."""
    begin_m = origin_of(way, start_s)
    rows = [(float(t), side) for side, foot in way.feet.items() for t in foot.contact_s if start_s <= t <= end_s]
    return tuple((side, way.way_at(t) - begin_m) for t, side in sorted(rows))


class _LiveFootWay:
    """One foot's swings so far: the settled ones, and those of the samples that are kept."""

    def __init__(self, side: Side, is_rigid: bool, from_s: float) -> None:
        self._site, self._is_rigid, self._from_s = Site(f"{side}_{Segment.FOOT}"), is_rigid, from_s
        self._kept = NOTHING
        self._settled = NO_SWINGS
        self._stretches_s: list[tuple[float, float]] = []
        self.is_still = False

    @property
    def has_samples(self) -> bool:
        return bool(self._stretches_s)

    def add(self, samples: OrientedSamples) -> None:
        last_tick = self._kept.tick[-1:] if len(self._kept) else samples.tick[:1] - 2
        jumps = np.flatnonzero(np.diff(np.concatenate([last_tick, samples.tick])) > 1).tolist()
        for begin, end in pairwise([*dict.fromkeys([0, *jumps]), len(samples)]):
            part = samples.part(slice(begin, end))
            start_s, end_s = float(part.time_s[0]), float(part.time_s[-1])
            if begin in jumps:
                self._look(math.inf)
                self._kept = part
                self._stretches_s.append((start_s, end_s))
            else:
                self._kept = joined([self._kept, part])
                self._stretches_s[-1] = self._stretches_s[-1][0], end_s

    def received(self) -> ReceivedFoot:
        """What is known of the foot by now."""
        last_s = self._stretches_s[-1][1]
        fresh = self._look(last_s - SETTLED_S)
        self._kept = self._kept.part(slice(int(np.searchsorted(self._kept.time_s, last_s - KEPT_S)), None))
        return ReceivedFoot(self._site, tuple(self._stretches_s), (self._settled, fresh))

    def _look(self, settled_to_s: float) -> FootSwings:
        """Keep the swings that ended before an instant for good, and give the others."""
        fresh = NO_SWINGS
        if len(self._kept) < LEAST_SAMPLES:
            return fresh
        whole = _track(self._kept)
        last_s = max(self._settled.ended_s, self._from_s)
        pieces = moving_pieces(whole)
        self.is_still = not pieces or pieces[-1].track.end_s < whole.track.end_s - 0.5 * whole.track.step_s
        for piece in pieces:
            found = swings_of(piece, self._is_rigid).between(last_s - OVERLAP_S, math.inf)
            settled = found.between(-math.inf, settled_to_s)
            self._settled = _followed(self._settled, settled)
            fresh = _followed(fresh, found.between(settled.ended_s - OVERLAP_S, math.inf))
        return fresh


def _followed(one: FootSwings, other: FootSwings) -> FootSwings:
    """Swings and those after them, the heading going on from the ones to the others."""
    if not len(one.turned_s) or not len(other.turned_s):
        return one if len(one.turned_s) else other
    turned_rad = one.heading_rad[-1, 1] - other.heading_rad[0, 0]
    return FootSwings(
        np.concatenate([one.toe_off_s, other.toe_off_s]),
        np.concatenate([one.contact_s, other.contact_s]),
        np.concatenate([one.arc_m, other.arc_m]),
        np.concatenate([one.climb_m, other.climb_m]),
        np.concatenate([one.turned_s, other.turned_s]),
        np.concatenate([one.heading_rad, other.heading_rad + turned_rad]),
    )


class _LiveThigh:
    """How far one thigh is tilted from standing."""

    def __init__(self, upright: FloatArray, from_s: float) -> None:
        self._upright, self._from_s = upright / np.linalg.norm(upright), from_s
        self._time_s: FloatArray = np.empty(0)
        self._tilt_rad: FloatArray = np.empty(0)

    @property
    def has_samples(self) -> bool:
        return len(self._time_s) > 0

    def add(self, samples: OrientedSamples) -> None:
        w, x, y, z = samples.q_earth_from_sensor.T
        up = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
        is_received = samples.time_s >= self._from_s
        tilt_rad = np.arccos(np.clip(up @ self._upright, -1.0, 1.0))
        self._time_s = np.concatenate([self._time_s, samples.time_s[is_received]])
        self._tilt_rad = np.concatenate([self._tilt_rad, tilt_rad[is_received]])

    def tilt_at(self, time_s: FloatArray) -> FloatArray:
        return np.asarray(np.interp(time_s, self._time_s, self._tilt_rad))


def _track(kept: OrientedSamples) -> OrientedTrack:
    """One stretch of samples as the offline analysis has it, which knows what came after."""
    # by live orientations a slow walker's strides come out up to a tenth too long
    time_s = kept.time_s
    step_s = float(time_s[-1] - time_s[0]) / (len(kept) - 1)
    track = Track(float(time_s[0]), step_s, kept.gyr_rad_s, kept.acc_m_s2, None, None, kept.is_measured)
    return oriented(track, RateKind.INSTANTANEOUS, np.zeros(3))

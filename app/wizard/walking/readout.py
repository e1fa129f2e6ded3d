"""A walk as seen live: the last seconds of angles, phases and steps. The estimator makes it, the page draws it."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from core.body import Joint, Side, Site
from core.calibration.strap import Slip
from core.gait.phases import Phase
from core.live.bias import BiasCorrection
from core.live.stride_values import StrideValue
from core.samples import FloatArray
from core.timed.live import LiveReadout


@dataclass(frozen=True, slots=True)
class LiveTrace:
    """The last seconds of one joint, both (n,): ascending times on the acquisition's clock, radians, NaN where missing.

    `is_provisional`: the newest samples of an ankle whose axis comes from free motion alone, or of a hip whose heading
    is not sure yet.
    """

    time_s: FloatArray
    angle_rad: FloatArray
    is_provisional: bool = False


@dataclass(frozen=True, slots=True)
class PhaseSpan:
    """A foot's phase; `end_s` None: it still lasts."""

    phase: Phase
    start_s: float
    end_s: float | None


@dataclass(frozen=True, slots=True)
class LiveLane:
    """One foot's last seconds: its known phases in order, and when it was silent, from and to; None: it still is."""

    spans: tuple[PhaseSpan, ...] = ()
    silent_s: tuple[tuple[float, float | None], ...] = ()


@dataclass(frozen=True, slots=True)
class WalkingReadout:
    """All times on the acquisition's clock, as the thighs' sensors have it.

    `now_s`: the newest sample of any sensor, NaN before the first; while all are silent, the time that goes on
    meanwhile.
    `joints`: of every joint with a calibration, or hip that was found, whose two sensors are worn and whose angle can
    be.
    `lanes`, `strides`: of every side with a foot sensor; strides since the walk began, of feet that their own knees
    never contradicted.
    `missing`, `doubtful`: sites that are silent; feet whose events disagree with their knees now.
    `implausible`: knees and ankles whose angle left what a joint can do within the last seconds, so that they are not
    in `joints`.
    `stride_values`, `values_reported`: the values of the last strides in the order reported, for a target; and how many
    there were of them so far, those that are no longer among them included.
    """

    now_s: float = math.nan
    joints: Mapping[Joint, LiveTrace] = field(default_factory=dict)
    lanes: Mapping[Side, LiveLane] = field(default_factory=dict)
    strides: Mapping[Side, int] = field(default_factory=dict)
    cadence_steps_min: float = math.nan  # of both feet; NaN while nobody walks
    slips: tuple[Slip, ...] = ()
    corrections: tuple[BiasCorrection, ...] = ()
    missing: tuple[Site, ...] = ()
    implausible: tuple[Joint, ...] = ()
    doubtful: tuple[Site, ...] = ()
    stride_values: tuple[StrideValue, ...] = ()
    values_reported: int = 0
    test: LiveReadout | None = None  # the state of the timed test that the walk is; None of other walks

    @property
    def knees(self) -> dict[Side, LiveTrace]:
        return {joint.side: trace for joint, trace in self.joints.items() if joint.is_knee}

    @property
    def ankles(self) -> dict[Side, LiveTrace]:
        return {joint.side: trace for joint, trace in self.joints.items() if not joint.is_knee and not joint.is_hip}

    @property
    def hips(self) -> dict[Side, LiveTrace]:
        return {joint.side: trace for joint, trace in self.joints.items() if joint.is_hip}

    def while_silent(self, now_s: float, sites: Collection[Site]) -> "WalkingReadout":
        """The same at `now_s` while nothing is received: time goes on, what came last ends there, none is made up."""
        if math.isnan(self.now_s) or now_s <= self.now_s:
            return self
        lanes = {side: _silent_since(lane, self.now_s) for side, lane in self.lanes.items()}
        missing = tuple(site for site in Site if site in sites)
        return replace(self, now_s=now_s, lanes=lanes, cadence_steps_min=math.nan, missing=missing)


def _silent_since(lane: LiveLane, from_s: float) -> LiveLane:
    spans = tuple(replace(span, end_s=from_s) if span.end_s is None else span for span in lane.spans)
    is_silent = any(end_s is None for _, end_s in lane.silent_s)
    return LiveLane(spans, lane.silent_s if is_silent else (*lane.silent_s, (from_s, None)))

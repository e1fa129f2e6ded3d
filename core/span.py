"""What is known of one span of validity while it is analysed: each joint once, for all recordings it is calibrated in.

`core.analysis` fills it step by step; a step reads what those before it have found.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from core.angles.measure import Twist
from core.body import LEG_JOINTS, Joint, Segment, Side, Site, ankle_of, knee_of
from core.calibration.clinical_sign import ClinicalSign
from core.calibration.identified import Identified
from core.calibration.validity import Basis
from core.hip.analysis import NO_HIPS, HipsOfSpan
from core.results import JointCalibration
from core.session import Recording, RecordingKind
from core.signal.reception import Pause
from core.signal.sensors import SensorTracks


@dataclass(slots=True, eq=False)
class JointAnalysis:
    """One joint as the same recordings calibrate it, once it is identified.

    `lags_s`, `twists`: by the name of the recording that the joint moves in; a twist until it is turned to an angle.
    `motion_sign`: as the motion gives it, since the user's word on a knee is none on its ankle.
    """

    identified: Identified
    knee: "JointAnalysis | None" = None  # of an ankle, the knee above, where that is identified
    lags_s: dict[str, float] = field(default_factory=dict)
    twists: dict[str, Twist] = field(default_factory=dict)
    calibration: JointCalibration = field(init=False)
    motion_sign: ClinicalSign = field(init=False)

    @property
    def basis(self) -> Basis:
        return self.identified.basis


@dataclass(slots=True, eq=False)
class SpanAnalysis:
    """One span of validity.

    `bases`: what calibrates each joint in each recording, by the recording's name; also where nothing could be
    identified.
    `pauses`: when no sensor was received, by the recording's name.
    `doubted_sites`, `drifts_percent`: sites whose sensors seem exchanged; how much faster than its leg's a clock runs,
    by the walk's name and site.
    `joints`: those that were identified, knees first, since they help their ankles.
    `slipped_s`: from when on a side's straps are not to be trusted, by the walk's name, on its clock.
    """

    tracks: SensorTracks
    bases: dict[tuple[str, Joint], Basis]
    pauses: Mapping[str, Sequence[Pause]]
    doubted_sites: frozenset[Site]
    drifts_percent: dict[tuple[str, Site], float]
    joints: dict[Basis, JointAnalysis] = field(default_factory=dict)
    hips: HipsOfSpan = NO_HIPS
    slipped_s: dict[tuple[str, Side], float] = field(default_factory=dict)

    @property
    def moving(self) -> list[Recording]:
        return [recording for recording in self.tracks.span if recording.kind is not RecordingKind.STANDING]

    @property
    def walks(self) -> list[Recording]:
        return [recording for recording in self.tracks.span if recording.kind is RecordingKind.WALKING]

    def joint(self, name: str, joint: Joint) -> JointAnalysis | None:
        """A joint in the recording of that name; None where it is not identified."""
        basis = self.bases.get((name, joint))
        return self.joints.get(basis) if basis is not None else None

    def joints_in(self, recording: Recording) -> dict[Joint, JointAnalysis]:
        """The joints identified for a recording."""
        found = {joint: self.joint(recording.name, joint) for joint in LEG_JOINTS}
        return {joint: one for joint, one in found.items() if one is not None}

    def lag_s(self, name: str, joint: Joint) -> float:
        """What is added to the stamps of a joint's distal sensor in the recording of that name, s."""
        found = self.joint(name, joint)
        return found.lags_s[name] if found is not None else 0.0

    def offset_s(self, recording: Recording, site: Site) -> float:
        """What brings a sensor's clock to the recording's, s: the lags of the joints above it, and its leg's."""
        if site.side is None:
            return 0.0
        joints_above = {Segment.THIGH: 0, Segment.SHANK: 1, Segment.FOOT: 2}[site.segment]
        above = (knee_of(site.side), ankle_of(site.side))[:joints_above]
        return sum(self.lag_s(recording.name, joint) for joint in above) + self.hips.offset_s(recording, site.side)

    def ringing_rad_s(self, joint: Joint) -> float | None:
        """How much tissue rings at a joint in the walk where it does most; None without a walk."""
        joints = [(self.joint(walk.name, joint), walk.name) for walk in self.walks]
        rung = [one.twists[name].moving_ringing for one, name in joints if one is not None]
        found = [float(np.sqrt(np.mean(np.sum(one**2, axis=1)))) for one in rung if len(one)]
        return max(found, default=None)

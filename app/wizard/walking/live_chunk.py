"""What other programs are given of an update: each joint's new samples under its verdict, and the feet's events."""

from collections.abc import Collection, Mapping

from app.live_output.chunks import EventMark, LiveChunk, angle_chunk
from core.body import LEG_JOINTS, Joint, Site
from core.gait.live import FootEvent
from core.live.walking import LiveJoint, WalkingState
from core.results import JointCalibration
from core.verdicts.gates import calibration_verdicts
from core.verdicts.model import Verdict, worst

SENT_EVENTS = (FootEvent.INITIAL_CONTACT, FootEvent.TOE_OFF)


def chunk_of(
    reported: WalkingState,
    joints: Mapping[Joint, LiveJoint],
    verdicts: Mapping[Joint, Verdict],
    implausible: Collection[Joint],
    missing: tuple[Site, ...],
) -> LiveChunk:
    """`joints`: as they are drawn, without what cannot be; `verdicts`: of their absolute angles, by calibration."""
    slipped = {slip.site for slip in reported.slips}
    angles = {}
    for joint in LEG_JOINTS:
        if (new := joints.get(joint)) is None or not len(new.samples):
            continue
        verdict = worst([verdicts[joint], Verdict.CARE]) if new.is_provisional else verdicts[joint]
        if joint in implausible or {joint.proximal, joint.distal} & slipped:
            verdict = Verdict.NOT_REPORTED
        angles[joint] = angle_chunk(new.samples.time_s, new.samples.angle_rad, new.samples.sd_rad, verdict)
    marks = [
        EventMark(side, one.event, one.time_s, one.reported_s)
        for side, foot in reported.feet.items()
        if not foot.is_doubtful
        for one in foot.events
        if one.event in SENT_EVENTS
    ]
    marks.sort(key=lambda mark: (mark.reported_s, mark.time_s))
    doubtful = tuple(side for side, foot in reported.feet.items() if foot.is_doubtful)
    return LiveChunk(angles, tuple(marks), doubtful, missing)


def verdict_by(calibration: JointCalibration) -> Verdict:
    """What may be stated about a joint's absolute angle before there is a walk."""
    return calibration_verdicts(calibration).height.verdict

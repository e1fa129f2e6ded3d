"""What may be stated, and why: the verdicts of an analysis with the sentences of their gates."""

from collections.abc import Iterator
from typing import NamedTuple

from app.wording.verdicts import gate_sentence
from core.body import Joint, Side
from core.results import Analysis, RecordingAnalysis
from core.session import RecordingKind
from core.verdicts.model import Assessment, Verdict, together
from core.verdicts.status import NO_ZERO, NOT_REPORTED, RANGE_ONLY, joint_status


class Stated(NamedTuple):
    """One line of the table of verdicts."""

    recording: str
    subject: str
    quantity: str
    assessment: Assessment


def why_status(recording: RecordingAnalysis, joint: Joint) -> str:
    """Why a joint's status is no better, in sentences, the gravest first; empty where it can be read."""
    found = recording.verdicts.joint(joint)
    status = joint_status(recording, joint)
    decisive = {RANGE_ONLY: found.sign, NO_ZERO: found.height, NOT_REPORTED: found.shape}
    return why(decisive.get(status, together((found.shape, found.height))))


def why(found: Assessment) -> str:
    """The sentences of its gates, the gravest first."""
    return " ".join(dict.fromkeys(gate_sentence(reason) for reason in found.reasons))


def all_that_is_stated(analysis: Analysis) -> Iterator[Stated]:
    """Every verdict of every recording: joints, then, of a walk, legs and what compares them."""
    for recording in analysis.recordings:
        for joint in recording.verdicts.reported_joints:
            of_joint = recording.verdicts.joint(joint)
            for name in ("shape", "height", "sign"):
                yield Stated(recording.name, joint.replace("_", " "), name, getattr(of_joint, name))
        if recording.kind is RecordingKind.WALKING:
            for side in Side:
                of_leg = recording.verdicts.leg(side)
                for name in ("timing", "distance"):
                    yield Stated(recording.name, f"{side} leg", name, getattr(of_leg, name))
            yield Stated(recording.name, "both legs", "between", recording.verdicts.between)
        if recording.verdicts.pelvis.verdict is not Verdict.NOT_MEASURED:
            yield Stated(recording.name, "pelvis", "angles", recording.verdicts.pelvis)
            for side, found in recording.verdicts.abduction.items():
                yield Stated(recording.name, f"{side} hip", "abduction", found)
            if recording.kind is RecordingKind.WALKING:
                yield Stated(recording.name, "pelvis", "tilt range", recording.verdicts.pelvis_tilt)

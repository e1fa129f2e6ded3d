"""What may be stated, as the files have it: a word per joint and per sample, and the verdicts with reasons."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from app.wording.verdicts import gate_sentence
from core.body import Joint, Side
from core.results import Analysis, RecordingAnalysis
from core.samples import BoolArray
from core.session import RecordingKind
from core.verdicts.model import Assessment, JointVerdicts, Verdict, together

READ, CARE, NOT_REPORTED = str(Verdict.READ), str(Verdict.CARE), str(Verdict.NOT_REPORTED)
RANGE_ONLY, NO_ZERO = "range_only", "no_zero"
WITH_HEIGHT = (READ, CARE)


class Stated(NamedTuple):
    """One line of the table of verdicts."""

    recording: str
    subject: str
    quantity: str
    assessment: Assessment


def joint_status(recording: RecordingAnalysis, joint: Joint) -> str:
    """What holds of a joint's angle in one recording, as `status_of` has it."""
    return status_of(recording.verdicts.joint(joint))


def status_of(found: JointVerdicts) -> str:
    """Give a joint's status; empty: not measured, `RANGE_ONLY`: sign unknown, `NO_ZERO`: offset meaningless."""
    if found.shape.verdict is Verdict.NOT_MEASURED:
        return ""
    if not found.shape.is_reported:
        return NOT_REPORTED
    if not found.sign.is_reported:
        return RANGE_ONLY
    return str(together((found.shape, found.height)).verdict) if found.height.is_reported else NO_ZERO


def why_status(recording: RecordingAnalysis, joint: Joint) -> str:
    """Why a joint's status is no better, in sentences, the gravest first; empty where it can be read."""
    found = recording.verdicts.joint(joint)
    status = joint_status(recording, joint)
    decisive = {RANGE_ONLY: found.sign, NO_ZERO: found.height, NOT_REPORTED: found.shape}
    return why(decisive.get(status, together((found.shape, found.height))))


def is_slipped(recording: RecordingAnalysis, side: Side, rows: slice = slice(None)) -> BoolArray:
    """Which of some samples come after a strap of this side slipped: there no angle of it holds."""
    from_s = recording.slipped_from_s.get(side, np.inf)
    return np.asarray(recording.time_s[rows] >= from_s, dtype=bool)


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

"""One word per joint and sample for what may be stated, as files and frames have it."""

import numpy as np

from core.body import Joint, Side
from core.results import RecordingAnalysis
from core.samples import BoolArray
from core.verdicts.model import JointVerdicts, Verdict, together

READ, CARE, NOT_REPORTED = str(Verdict.READ), str(Verdict.CARE), str(Verdict.NOT_REPORTED)
RANGE_ONLY, NO_ZERO = "range_only", "no_zero"
WITH_HEIGHT = (READ, CARE)


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


def is_slipped(recording: RecordingAnalysis, side: Side, rows: slice = slice(None)) -> BoolArray:
    """Which of some samples come after a strap of this side slipped: there no angle of it holds."""
    from_s = recording.slipped_from_s.get(side, np.inf)
    return np.asarray(recording.time_s[rows] >= from_s, dtype=bool)

"""An analysis with something changed by hand, judged again as the program would."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from app.summary.reference_bands import NOBODY
from app.summary.request import AnalysedVisit
from core.body import LEG_JOINTS, Joint, Side
from core.gait.strides import Reason
from core.results import Analysis, RecordingAnalysis
from core.session import RecordingKind, Session
from core.verdicts.gates import judged
from core.verdicts.norms import AgeAndHeight


def recalibrated(analysis: Analysis, joints: Iterable[Joint] = LEG_JOINTS, **change: Any) -> Analysis:
    """With these fields of the calibrations of some joints changed."""
    some = set(joints)
    spans = tuple(
        replace(
            span, joints={joint: replace(one, **change) if joint in some else one for joint, one in span.joints.items()}
        )
        for span in analysis.calibrations
    )
    return judged(replace(analysis, calibrations=spans))


def rewalked(analysis: Analysis, **change: Any) -> Analysis:
    """With these fields of every walk changed."""
    recordings = tuple(
        replace(one, **change) if one.kind is RecordingKind.WALKING else one for one in analysis.recordings
    )
    return judged(replace(analysis, recordings=recordings))


def with_used(walk: RecordingAnalysis, side: Side, count: int) -> RecordingAnalysis:
    """The same walk, of a side only the first `count` strides used and the others left out as turning; not judged."""
    gait = walk.gait[side]
    reason = (Reason.USED,) * count + (Reason.TURN,) * (len(gait.strides) - count)
    return replace(walk, gait={**walk.gait, side: replace(gait, strides=replace(gait.strides, reason=reason))})


def with_few_strides(analysis: Analysis, **counts: int) -> Analysis:
    """With the first strides of some sides used alone: `left=2`."""
    recordings = list(analysis.recordings)
    for k, one in enumerate(recordings):
        for side, count in counts.items():
            if Side(side) in one.gait:
                recordings[k] = with_used(recordings[k], Side(side), count)
    return judged(replace(analysis, recordings=tuple(recordings)))


def visit_of(analysis: Analysis, session: Session, who: AgeAndHeight = NOBODY) -> AnalysedVisit:
    """The analysis with the session it came of, walked by a patient of this age and height."""
    born = 2026 - who.age_years if who.age_years is not None else None
    patient = replace(session.patient, birth_year=born, height_m=who.height_m)
    return AnalysedVisit(replace(session, patient=patient, started="2026-11-23T10:00:00+00:00"), analysis)


def walk_of(analysis: Analysis) -> RecordingAnalysis:
    """The only walk."""
    (walk,) = (recording for recording in analysis.recordings if recording.kind is RecordingKind.WALKING)
    return walk

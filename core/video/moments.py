"""Moments of a walk that a clip is stepped to: contacts, toe-offs, and where the knee is bent most in swing."""

from enum import StrEnum

import numpy as np

from core.body import Side, knee_of
from core.results import RecordingAnalysis
from core.samples import FloatArray


class Moment(StrEnum):
    """The values of the first two are the words of events.csv."""

    INITIAL_CONTACT = "initial_contact"
    TOE_OFF = "toe_off"
    PEAK_KNEE_FLEXION = "peak_knee_flexion"


def moments_s(recording: RecordingAnalysis, side: Side, moment: Moment) -> FloatArray:
    """Times of a moment of one leg, ascending, shape (m,); none where that leg did not walk or has no knee."""
    gait = recording.gait.get(side)
    if gait is None:
        return np.zeros(0)
    if moment is Moment.PEAK_KNEE_FLEXION:
        return _peaks_s(recording, side)
    found = np.concatenate([np.zeros(0), *(getattr(events, f"{moment}_s") for events in gait.events)])
    return np.sort(found[np.isfinite(found)])


def _peaks_s(recording: RecordingAnalysis, side: Side) -> FloatArray:
    """Of each swing, where the angle is known over all of it."""
    knee, strides = recording.joints.get(knee_of(side)), recording.gait[side].strides
    if knee is None:
        return np.zeros(0)
    peaks = []
    for toe_off_s, end_s in zip(strides.toe_off_s, strides.end_s, strict=True):
        if not np.isfinite(toe_off_s):
            continue
        first, last = np.searchsorted(recording.time_s, (toe_off_s, end_s))
        swing = knee.angle_rad[first:last]
        if len(swing) and np.isfinite(swing).all():
            peaks.append(recording.time_s[first + int(np.argmax(swing))])
    return np.array(peaks, dtype=np.float64)

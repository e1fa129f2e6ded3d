"""Phases of a foot beside the curve of a joint. A lane below it, on the same axes."""

from collections.abc import Mapping

import numpy as np

from app.review.data_quality_panel import Place, pieces_of, shown_deg
from core.body import Joint
from core.gait.phases import PHASES, Phase
from core.results import RecordingAnalysis
from core.samples import FloatArray

BELOW, LEAST_BELOW_DEG = 0.15, 5.0  # of the curve's range


def lanes_of(recording: RecordingAnalysis, joint: Joint) -> Mapping[Phase, tuple[FloatArray, FloatArray]]:
    """Give each phase's times and heights in degrees (k,), NaN after each; empty: curve or timing not reported."""
    gait, curve_deg = recording.gait.get(joint.side), _curve_deg(recording, joint)
    known_deg = curve_deg[np.isfinite(curve_deg)]
    if gait is None or not len(known_deg) or not recording.verdicts.leg(joint.side).timing.is_reported:
        return {}
    height_deg = float(known_deg.min() - max(BELOW * np.ptp(known_deg), LEAST_BELOW_DEG))
    shown_phase = np.where(np.isfinite(curve_deg), gait.phase, PHASES.index(Phase.UNKNOWN))
    borders = np.flatnonzero(np.diff(shown_phase)) + 1
    first = np.concatenate([[0], borders])
    last = np.concatenate([borders, [len(shown_phase) - 1]])
    lanes = {}
    for number, phase in enumerate(PHASES):
        runs = shown_phase[first] == number
        if phase and runs.any():
            begins_s, ends_s = recording.time_s[first[runs]], recording.time_s[last[runs]]
            time_s = np.stack([begins_s, ends_s, ends_s], axis=1).ravel()
            lanes[phase] = time_s, np.tile([height_deg, height_deg, np.nan], len(begins_s))
    return lanes


def _curve_deg(recording: RecordingAnalysis, joint: Joint) -> FloatArray:
    """A joint's curve (n,) as it is shown, a shape about its own mean; NaN where it is not reported."""
    shown = np.full(len(recording.time_s), np.nan)
    for place, rows in pieces_of(recording, joint):
        if place is not Place.NOT_REPORTED:
            shown[rows] = shown_deg(place, recording.measured[joint].angle_rad[rows])
    return shown

"""Axes of the curves of a log, the same for the left and the right leg."""

import numpy as np

from app.review.data_quality_panel import Place, pieces_of, shown_deg
from app.review.phase_lane import lanes_of
from core.body import Joint, JointKind, Side
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray
from core.session import RecordingKind

BAND_SD = 2.0
MARGIN, LEAST_DEG = 0.05, 10.0  # round what is shown, of its range; so that noise does not fill an axis


def range_of(analysis: Analysis, kind: JointKind) -> tuple[float, float] | None:
    """Give lowest and highest degree over both legs with certainty and phases; None if no curve is shown."""
    walks = [r for r in analysis.recordings if r.kind is RecordingKind.WALKING] or analysis.recordings
    shown = [part for r in walks for side in Side for part in _parts_deg(r, kind.of(side))]
    known = [part[np.isfinite(part)] for part in shown]
    if not any(map(len, known)):
        return None
    low, high = min(p.min() for p in known if len(p)), max(p.max() for p in known if len(p))
    margin = max(MARGIN * (high - low), (LEAST_DEG - (high - low)) / 2)
    return float(low - margin), float(high + margin)


def _parts_deg(recording: RecordingAnalysis, joint: Joint) -> list[FloatArray]:
    """A joint's curve with its band, each piece as it is shown, and its lanes."""
    if joint not in recording.measured:
        return []
    angle = recording.measured[joint]
    parts = [height_deg for _, height_deg in lanes_of(recording, joint).values()]
    for place, rows in pieces_of(recording, joint):
        if place is not Place.NOT_REPORTED:
            angle_deg, sd_deg = shown_deg(place, angle.angle_rad[rows]), np.rad2deg(angle.sd_rad[rows])
            parts += [angle_deg - BAND_SD * sd_deg, angle_deg, angle_deg + BAND_SD * sd_deg]
    return parts

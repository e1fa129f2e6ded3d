"""Values that a sensor on the pelvis adds to `summary.json`. Without one, nothing is added."""

import math
from typing import Any

import numpy as np

from app.system.tables import finite
from core.hip.results import HipIdentification
from core.results import RecordingAnalysis


def summarise_pelvis(recording: RecordingAnalysis) -> dict[str, Any]:
    """Give the hips' identification, the clock of both legs, turns, and the pelvis's lean; nothing without a pelvis."""
    reported: dict[str, Any] = {}
    if recording.leg_clock is not None:
        clock = recording.leg_clock
        reported["leg_clock_offset_s"], reported["leg_clock_sd_s"] = finite(clock.offset_s), finite(clock.sd_s)
        reported["leg_clock_status"] = str(clock.status)
    if recording.pelvis is not None:
        tilt, is_reported = recording.pelvis.tilt_rad, recording.verdicts.pelvis.is_reported
        known = tilt[np.isfinite(tilt)]
        reported["pelvis_lean_deg"] = finite(math.degrees(float(known.mean()))) if is_reported and len(known) else None
        reported["hips"] = {str(joint): _identification(hip.identification) for joint, hip in recording.hips.items()}
        reported["turns"] = [
            {"start_s": turn.start_s, "end_s": turn.end_s, "angle_deg": math.degrees(turn.angle_rad)}
            for turn in recording.turns
        ]
    return reported


def _identification(found: HipIdentification) -> dict[str, Any]:
    return {
        "centre_proximal_m": [float(part) for part in found.centre_proximal_m],
        "centre_distal_m": [float(part) for part in found.centre_distal_m],
        "sign_margin": finite(found.margin),
        "disagreement": finite(found.disagreement),
        "heading_sd_deg": finite(math.degrees(found.heading_sd_rad)),
        "is_3d": bool(found.is_3d),
        "moving_s": finite(found.moving_s),
        "lag_s": finite(found.lag_s),
        "centres_apart_m": finite(found.centres_apart_m),
        "from": {"standing": found.standing_from},
    }

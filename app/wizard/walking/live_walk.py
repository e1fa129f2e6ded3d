"""What the estimator's thread tells of a walk, as the page takes it."""

import math
from collections.abc import Mapping

from app.wizard.walking.estimator import WalkingView
from app.wizard.walking.live_lanes import LiveLane, PhaseSpan
from app.wizard.walking.live_strip import LiveTrace
from app.wizard.walking.page import WalkingReadout
from core.body import Side


def live_walk(view: WalkingView, strides: Mapping[Side, int]) -> WalkingReadout:
    """Give what to draw of a view that has heard something."""
    knees: dict[Side, LiveTrace] = {}
    ankles: dict[Side, LiveTrace] = {}
    for joint, curve in view.joints.items():
        traces = knees if joint.is_knee else ankles
        traces[joint.side] = LiveTrace(curve.time_s, curve.angle_rad, curve.is_provisional)
    lanes = {
        side: LiveLane(tuple(PhaseSpan(span.phase, span.start_s, span.end_s) for span in lane.spans), lane.silent_s)
        for side, lane in view.lanes.items()
    }
    cadence = math.nan if view.cadence_steps_min is None else view.cadence_steps_min
    return WalkingReadout(view.now_s or 0.0, knees, ankles, lanes, strides, cadence)

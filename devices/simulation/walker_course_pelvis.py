"""The pelvis of the simulated patient on a course: it turns with the way, and pitches while the patient rises and sits.

How people's pelvis pitches there was measured by nobody here: forward before the thighs leave the seat, most while they
do, upright with them. It is an estimate, good for seeing which quantity is which and for no accuracy.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d

from core.body import Side
from devices.simulation.walker_bouts import SeatChange
from devices.simulation.walker_motion import Y_AXIS, Z_AXIS, LegMotion, rotation_about
from devices.simulation.walker_pelvis import PelvisMotion, hip_m, hung

PITCH_RAD = np.deg2rad(25.0)  # an estimate
LEAD_SHARE = 0.4  # of the rise: so much earlier the trunk begins to lean
HEADING_S = 0.3


def course_pelvis(
    motions: Mapping[Side, LegMotion], changes: Sequence[SeatChange]
) -> tuple[PelvisMotion, dict[Side, LegMotion]]:
    """Give the pelvis between two legs and the legs as they hang from it; earth axes, z up."""
    time_s = motions[Side.LEFT].time_s
    step_s = float(time_s[1] - time_s[0])
    # the thighs' y points to the left also where they lie on the seat
    left = sum((motion.rotations[0, :, :2, 1] for motion in motions.values()), np.zeros((len(time_s), 2)))
    left = gaussian_filter1d(left, HEADING_S / step_s, axis=0)
    facing = np.unwrap(np.arctan2(-left[:, 0], left[:, 1]))
    pitch = np.zeros_like(time_s)
    for change in changes:
        lead_s = LEAD_SHARE * change.duration_s
        begin_s, end_s = change.start_s - (0.0 if change.is_down else lead_s), change.end_s
        end_s += lead_s if change.is_down else 0.0
        u = np.clip((time_s - begin_s) / (end_s - begin_s), 0.0, 1.0)
        pitch += PITCH_RAD * (4.0 * u * (1.0 - u)) ** 2
    rotations = rotation_about(Z_AXIS, facing) @ rotation_about(Y_AXIS, pitch)
    pelvis = PelvisMotion(time_s, rotations, np.mean([motion.origins_m[0] for motion in motions.values()], axis=0))
    return pelvis, {side: hung(motion, hip_m(pelvis, side)) for side, motion in motions.items()}

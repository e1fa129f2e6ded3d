"""A simulated walk on a treadmill, whose belt rises and is slowed by each landing."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from core.body import Side
from devices.simulation.walker_body import Treadmill
from devices.simulation.walker_motion import X_AXIS, Y_AXIS, LegMotion, rotation_about

RIPPLE_S = 0.35  # a belt that was slowed has made up for it after this
BUMP_SHARE = 0.3  # the bump's steepest slope is then the belt's speed


def on_treadmill(motions: Mapping[Side, LegMotion], belt: Treadmill, speed_m_s: float) -> dict[Side, LegMotion]:
    """Move both legs on a belt that slows at landings, seen from its mean speed; they walk along +x."""
    up_hill = rotation_about(Y_AXIS, np.array([-np.arctan(belt.slope)]))[0]
    time_s = motions[Side.LEFT].time_s
    moved_m = np.zeros_like(time_s)
    for landed_s in np.concatenate([motion.events.initial_contact_s for motion in motions.values()]):
        u = np.clip((time_s - landed_s) / RIPPLE_S, 0.0, 1.0)
        moved_m -= BUMP_SHARE * RIPPLE_S * belt.ripple * speed_m_s * (4.0 * u * (1.0 - u)) ** 3
    shift_m = moved_m[:, None] * X_AXIS
    return {
        side: replace(motion, rotations=up_hill @ motion.rotations, origins_m=(motion.origins_m + shift_m) @ up_hill.T)
        for side, motion in motions.items()
    }

"""A sensor that swings about one axis of its own, whose rates and specific force are therefore known exactly."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from core.samples import FloatArray

SWING_AXIS = np.array([0.6, 0.0, 0.8])  # in sensor axes
SWING_RAD_S = 5.65
SWING_TILT = Rotation.from_euler("xz", [70, 20], degrees=True)


@dataclass(frozen=True, slots=True)
class SwingingSensor:
    """Rates and specific force (n, 3) in sensor axes; acceleration without gravity (n, 3) in earth axes, z up."""

    time_s: FloatArray
    q_earth_from_sensor: FloatArray
    gyr_rad_s: FloatArray
    acc_m_s2: FloatArray
    free_m_s2: FloatArray


def swinging_sensor(
    rows: int = 300, rate_hz: float = 100.0, reach_rad: float = 0.7, gravity_m_s2: float = 9.81
) -> SwingingSensor:
    time_s = np.arange(rows) / rate_hz
    angle = reach_rad * np.sin(SWING_RAD_S * time_s)
    rate = reach_rad * SWING_RAD_S * np.cos(SWING_RAD_S * time_s)
    turn = SWING_TILT * Rotation.from_rotvec(angle[:, None] * SWING_AXIS)
    free = np.column_stack([np.sin(7 * time_s), 0.5 * np.cos(3 * time_s), 0.3 * np.sin(5 * time_s)])
    acc = turn.inv().apply(free + np.array([0.0, 0.0, gravity_m_s2]))
    return SwingingSensor(time_s, turn.as_quat(scalar_first=True), rate[:, None] * SWING_AXIS, acc, free)

"""A simulated sensor that swings on a loose strap."""

import numpy as np
from scipy.signal import lfilter

from core.samples import FloatArray
from devices.simulation.walker_motion import Z_AXIS
from devices.simulation.walker_sensors import Mounting, acceleration, small_rotation

SWING_HZ, DAMPING = 7.0, 0.15
TURN_RAD_PER_M_S2, SHIFT_M_PER_M_S2 = np.deg2rad(0.3), 0.0003  # a foot swings with 20 to 40 m/s2


def on_loose_strap(
    poses: tuple[FloatArray, FloatArray], mounting: Mounting, looseness: float, time_s: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Give the poses of a sensor that swings on its strap as a mass on a spring; `looseness` 1: some degrees."""
    if looseness <= 0.0:
        return poses
    rotations, place_m = poses
    step_s = float(time_s[1] - time_s[0])
    felt = np.einsum("nji,nj->ni", rotations, acceleration(place_m, step_s))  # without gravity, which it hangs in
    swung = looseness * _spring(felt, step_s)
    outward = mounting.segment_from_sensor.T @ Z_AXIS
    turned = TURN_RAD_PER_M_S2 * np.cross(outward, swung)
    return (
        rotations @ small_rotation(turned),
        place_m + SHIFT_M_PER_M_S2 * np.einsum("nij,nj->ni", rotations, swung),
    )


def _spring(force: FloatArray, step_s: float) -> FloatArray:
    """How far a damped mass on a spring follows a force (n, 3); after its ringing as far as the force."""
    omega = 2.0 * np.pi * SWING_HZ * step_s
    damped = np.exp(-DAMPING * omega)
    poles = [1.0, -2.0 * damped * np.cos(omega * np.sqrt(1.0 - DAMPING**2)), damped**2]
    return np.asarray(lfilter([sum(poles)], poles, force, axis=0))

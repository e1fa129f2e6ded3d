"""What the joint reads in standing, from gravity alone, seen in both joint planes."""

import numpy as np

from core.samples import FloatArray
from core.signal.rotations import joint_frame, wrap


def standing_twist(down_1: FloatArray, down_2: FloatArray, axis_1: FloatArray, axis_2: FloatArray) -> float:
    """Give the twist in standing, arg(z(a1) conj z(a2)) of mean forces (3,), -pi to pi; no heading needed."""
    z1, z2 = (
        complex(down @ x, down @ y)
        for down, (x, y) in zip((down_1, down_2), map(joint_frame, (axis_1, axis_2)), strict=True)
    )
    return float(np.angle(z1 * np.conj(z2)))


def within_half_a_turn(samples_rad: FloatArray, of_rad: float | None = None) -> FloatArray:
    """Bring angle samples (n,), rad, within half a turn of `of_rad`, or of their mean direction."""
    if of_rad is None:
        of_rad = float(np.angle(np.mean(np.exp(1j * samples_rad)))) if samples_rad.size else 0.0
    return of_rad + wrap(samples_rad - of_rad)


def wrapped_to_zero(angle_rad: FloatArray) -> FloatArray:
    """Move an angle (n,), NaN in gaps, by whole turns so that its median is within half a turn of zero."""
    if not np.isfinite(angle_rad).any():
        return angle_rad
    return angle_rad - 2 * np.pi * np.round(np.nanmedian(angle_rad) / (2 * np.pi))

"""How far thigh and shank lean forward of the vertical, relative to how they stood.

A sensor knows the vertical, not the bone it is strapped to. The knee's axis, found in both sensors, gives the
plane in which a segment leans; standing gives where it leans by nothing. So every inclination is relative to
standing: for a patient standing with the shank 5 degrees forward these figures put it 5 degrees further back than it
is.
"""

import numpy as np

from core.gait.strides import Strides
from core.samples import GRAVITY_M_S2, FloatArray
from core.signal.filters import filtered_offline
from core.signal.rotations import joint_frame, wrap

COARSE_S = 0.05  # of a filter that takes seconds
STARTING_S = 0.15  # before its first contact a foot gets going, and after its last it stops


def lean_about(axis: FloatArray, up: FloatArray) -> FloatArray:
    """Give the turn (n,) of a segment against the vertical `up` (n, 3) about `axis` (3,), rad, arbitrary zero."""
    x, y = joint_frame(axis)
    lean = -np.arctan2(up @ y, up @ x)  # what the segment turns by, the vertical turns back by in its axes
    known = np.isfinite(lean)
    lean[known] = np.unwrap(lean[known])
    return lean


def inclination(
    lean_rad: FloatArray, axis: FloatArray, standing_up: FloatArray | None, clinical_sign: int
) -> FloatArray:
    """Give forward inclination (n,) of thigh or shank, rad, upper end forward, from standing or the median."""
    known = lean_rad[np.isfinite(lean_rad)]
    if standing_up is not None:
        zero = float(lean_about(axis, standing_up[None, :])[0])
    else:
        zero = float(np.median(known)) if len(known) else 0.0
    return np.asarray(clinical_sign * wrap(lean_rad - zero))


def tilt_by_speeding_up(strides: Strides, time_s: FloatArray) -> FloatArray:
    """Give how far a segment seems to lean back (n,), rad, because a walk begins, turns and ends.

    The filter takes the mean acceleration of some seconds for the vertical. While somebody gets going that is more than
    gravity, by 1.5 deg in the first second: here the same filter is given nothing but the speed of the strides. Zero
    where no length of a stride is known. Who walks already as the recording begins has got going before.
    """
    known = np.isfinite(strides.length_m) & np.isfinite(strides.turn_rad)
    tilt = np.zeros(len(time_s))
    if not known.any():
        return tilt
    turned_rad = np.cumsum(np.where(known, strides.turn_rad, 0.0))
    heading_rad = turned_rad - 0.5 * np.where(known, strides.turn_rad, 0.0)
    velocity = strides.length_m / strides.time_s * np.exp(1j * heading_rad)
    middle_s = 0.5 * (strides.start_s + strides.end_s)
    coarse_s = np.arange(time_s[0], time_s[-1] + COARSE_S, COARSE_S)
    moving = np.zeros(len(coarse_s), dtype=complex)
    for bout in np.unique(strides.bout[known]):
        mine = known & (strides.bout == bout)
        first_s, last_s = strides.start_s[mine][0], strides.end_s[mine][-1]
        stride_s = float(np.median(strides.time_s[mine]))
        from_s = first_s - (STARTING_S if first_s - time_s[0] > stride_s else stride_s)
        to_s = last_s + (STARTING_S if time_s[-1] - last_s > stride_s else stride_s)
        here = (coarse_s > from_s) & (coarse_s < to_s)
        moving[here] = np.interp(coarse_s[here], middle_s[mine], velocity[mine])
    gained = np.gradient(moving, COARSE_S)
    force = np.column_stack([gained.real, gained.imag, np.full(len(gained), GRAVITY_M_S2)])
    turned = filtered_offline(np.zeros_like(force), force, None, COARSE_S)
    heading = np.interp(coarse_s, middle_s, heading_rad)
    forward = (-2.0 * turned[:, 2] + 2j * turned[:, 1]) * np.exp(-1j * heading)
    return np.asarray(np.interp(time_s, coarse_s, forward.real))

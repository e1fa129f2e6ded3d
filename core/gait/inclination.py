"""How far thigh and shank lean forward of the vertical, relative to how they stood.

A sensor knows the vertical, not the bone it is strapped to. The knee's axis, found in both sensors, gives the
plane in which a segment leans; standing gives where it leans by nothing. So every inclination is relative to
standing: for a patient standing with the shank 5 degrees forward these figures put it 5 degrees further back than it
is.
"""

import numpy as np

from core.samples import FloatArray
from core.signal.rotations import joint_frame, wrap


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

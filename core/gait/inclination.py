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
    """Turn (n,) of a segment about its joint axis against the vertical, rad, from a zero of the sensor's own.

    Parameters
    ----------
    axis : (3,)
        Unit vector, in sensor axes.
    up : (n, 3)
        The vertical, in sensor axes; of any length.

    Returns
    -------
    (n,)
        Without jumps; NaN where `up` is. Right-handed about `axis`.
    """
    x, y = joint_frame(axis)
    lean = -np.arctan2(up @ y, up @ x)  # what the segment turns by, the vertical turns back by in its axes
    known = np.isfinite(lean)
    lean[known] = np.unwrap(lean[known])
    return lean


def inclination(
    lean_rad: FloatArray, axis: FloatArray, standing_up: FloatArray | None, clinical_sign: int
) -> FloatArray:
    """Forward inclination (n,) of thigh or shank, rad, the upper end forward positive, zero as in standing.

    Parameters
    ----------
    lean_rad : (n,)
        Of `lean_about`, NaN where unknown.
    axis : (3,)
        Of the knee, in the sensor's axes.
    standing_up : (3,) or None
        The vertical in standing, in the sensor's axes. Without it the zero is the median, and only differences hold.
    clinical_sign
        1 or -1; what turns the axis so that turning the shank about it bends the knee.

    Returns
    -------
    (n,)
        Within half a turn.
    """
    known = lean_rad[np.isfinite(lean_rad)]
    if standing_up is not None:
        zero = float(lean_about(axis, standing_up[None, :])[0])
    else:
        zero = float(np.median(known)) if len(known) else 0.0
    return np.asarray(clinical_sign * wrap(lean_rad - zero))

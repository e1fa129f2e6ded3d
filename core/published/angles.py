"""The paper's two joint angles: from orientations (eq 10), and from rates and accelerations alone (eqs 11 to 15).

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, section 3.2. All angles share sign and zero: alpha is the signed
angle about the proximal joint axis from the distal to the proximal x axis, the opposite of the twist.
"""

import numpy as np
from scipy.signal import lfilter

from core.samples import FloatArray
from core.signal.pair import Pair, lever_acceleration
from core.signal.rotations import in_plane, joint_frame, wrap

MIN_IN_PLANE_M_S2 = 2.0  # below, the direction of the shifted acceleration means nothing
DEFAULT_TAU_S = 2.0
TREND_S = 0.5  # over which the direction of the difference is followed
START_S = 2.0  # the first accelerations, whose median starts the fusion


def angle_from_orientations(
    earth_from_1: FloatArray, earth_from_2: FloatArray, j1: FloatArray, j2: FloatArray
) -> FloatArray:
    """Eq 10: signed angle (n,) about R1 j1 from R2 x2 to R1 x1, for rotations (n, 3, 3) into one common earth.

    Parameters
    ----------
    earth_from_1, earth_from_2 : (n, 3, 3)
        Rotations of each sensor's axes into one common earth.
    j1, j2 : (3,)
        Unit axes, each in its own sensor's axes.

    Returns
    -------
    (n,)
        rad, -pi to pi.
    """
    x1, x2 = earth_from_1 @ joint_frame(j1)[0], earth_from_2 @ joint_frame(j2)[0]
    about = earth_from_1 @ j1
    sine = np.sum(np.cross(x2, x1) * about, axis=1)
    return np.asarray(np.arctan2(sine, np.sum(x1 * x2, axis=1)))


def angle_from_rates(g1: FloatArray, g2: FloatArray, j1: FloatArray, j2: FloatArray, step_s: float) -> FloatArray:
    """Eq 11 by the trapezoid rule: drifting angle (n,) from the first sample on.

    Parameters
    ----------
    g1, g2 : (n, 3)
        Angular rates, rad/s, each in its own sensor's axes.
    j1, j2 : (3,)
        Unit axes, each in its own sensor's axes.

    Returns
    -------
    (n,)
        rad, 0 at the first sample.
    """
    rate = g1 @ j1 - g2 @ j2
    return np.concatenate([[0.0], np.cumsum(0.5 * step_s * (rate[1:] + rate[:-1]))])


def angle_from_accelerations(pair: Pair, j1: FloatArray, j2: FloatArray, o1: FloatArray, o2: FloatArray) -> FloatArray:
    """Eqs 12 to 14: angle (n,) between the shifted accelerations in the joint plane, NaN where it means nothing.

    Parameters
    ----------
    j1, j2 : (3,)
        Unit axes, each in its own sensor's axes.
    o1, o2 : (3,)
        Centres: vectors from the joint to each sensor, m, in its axes.

    Returns
    -------
    (n,)
        rad, -pi to pi.
    """
    z1 = in_plane(pair.a1 - lever_acceleration(pair.g1, pair.dg1, o1), j1)
    z2 = in_plane(pair.a2 - lever_acceleration(pair.g2, pair.dg2, o2), j2)
    angle = -np.angle(z1 * np.conj(z2))
    with np.errstate(invalid="ignore"):
        angle[~(np.minimum(np.abs(z1), np.abs(z2)) > MIN_IN_PLANE_M_S2)] = np.nan
    return angle


def fused_angle(from_rates: FloatArray, from_accelerations: FloatArray, step_s: float, tau_s: float) -> FloatArray:
    """Eq 15 with lambda = 1 - exp(-dt/tau): angle (n,), the rates' on short, the accelerations' on long times.

    A constant bias b of the relative rate leaves a steady offset b dt (1 - lambda)/lambda, close to b tau. The filter
    runs on the unwrapped difference of the two angles, so that a turn through 180 degrees cannot pull it over; where
    the accelerations show nothing it holds.

    Parameters
    ----------
    from_rates : (n,)
        rad, eq 11.
    from_accelerations : (n,)
        rad, eq 14; NaN where it means nothing.

    Returns
    -------
    (n,)
        rad; NaN throughout where the accelerations show nothing.
    """
    known = np.flatnonzero(np.isfinite(from_accelerations))
    if len(known) == 0:
        return np.full_like(from_rates, np.nan)
    difference = unwrapped_about_trend(from_accelerations[known] - from_rates[known], step_s)
    held = np.searchsorted(known, np.arange(len(from_rates)), side="right") - 1
    difference_held = difference[np.maximum(held, 0)]
    weight = 1 - np.exp(-step_s / tau_s)
    start = float(np.median(difference_held[: max(1, round(START_S / step_s))]))
    smooth, _ = lfilter([weight], [1.0, weight - 1.0], difference_held, zi=[(1 - weight) * start])
    return np.asarray(from_rates + smooth)


def unwrapped_about_trend(angle_rad: FloatArray, step_s: float) -> FloatArray:
    """Whole turns taken out of a noisy angle (n,) by following its smoothed direction, not the samples beside it.

    From one sample to the next an impact may turn an acceleration by more than half a turn, which plain unwrapping
    would keep for good.

    Parameters
    ----------
    angle_rad : (n,)
        Without NaN.

    Returns
    -------
    (n,)
        rad.
    """
    weight = 1 - np.exp(-step_s / TREND_S)
    direction = np.exp(1j * angle_rad)
    trend, _ = lfilter([weight], [1.0, weight - 1.0], direction, zi=[(1 - weight) * direction[0]])
    trend_rad = np.unwrap(np.angle(trend))
    return np.asarray(trend_rad + wrap(angle_rad - trend_rad))


def published_angle(
    pair: Pair, j1: FloatArray, j2: FloatArray, o1: FloatArray, o2: FloatArray, tau_s: float = DEFAULT_TAU_S
) -> FloatArray:
    """Eq 15 (n,) of a pair of sensors, radians.

    Parameters
    ----------
    j1, j2 : (3,)
        Unit axes, each in its own sensor's axes.
    o1, o2 : (3,)
        Centres: vectors from the joint to each sensor, m, in its axes.
    tau_s
        Time constant of the fusion.

    Returns
    -------
    (n,)
        rad. Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, eqs 11 to 15.
    """
    from_rates = angle_from_rates(pair.g1, pair.g2, j1, j2, pair.step_s)
    return fused_angle(from_rates, angle_from_accelerations(pair, j1, j2, o1, o2), pair.step_s, tau_s)

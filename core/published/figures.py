"""The paper's own pictures of how a joint is found: its Figures 3, 4 and 6, from any patient's samples.

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891. Each function takes the axes that were found, by whatever method,
and gives the numbers that the figure draws.
"""

from dataclasses import dataclass

import numpy as np

from core.published.angles import angle_from_accelerations, angle_from_rates, fused_angle
from core.published.signs import MIN_IN_PLANE_RAD_S, USED_SHARE
from core.samples import ComplexArray, FloatArray
from core.signal.datasets import Datasets
from core.signal.pair import Pair
from core.signal.robust import robust_sd
from core.signal.rotations import angle_between, in_plane, joint_frame, wrap

GRID_STEP_RAD = np.deg2rad(5.0)  # finer than any valley of eq 6, which is a sum of smooth terms
CHUNK = 500  # data sets at a time, so that long recordings need no more memory than short ones
WINDOW_S = 1.0  # long enough for a curve to have a shape, short enough for the joint to stay as bent as it is
HOP_S = 0.25
DRIFT_STEPS = 8
MIN_DRIFT_S = 3.0  # a slope over less is the accelerations' own noise


@dataclass(frozen=True, slots=True)
class CostOverSphere:
    """Eq 6 over all directions of one sensor's axis, the other sensor's axis held where it was found (Fig. 3).

    Rows go from -90 to 90 degrees of latitude, columns from -180 to 180 of longitude; `axis` (3,), the one in use, lies
    on the equator at 90 degrees, its opposite at -90. `direction` (r, c, 3) are unit vectors in sensor axes,
    `rms_rad_s` (r, c) the root mean square of the error e_i of eq 3 there. `lowest` (3,) is where that is least, on the
    same side as `axis`.
    """

    axis: FloatArray
    lowest: FloatArray
    direction: FloatArray
    rms_rad_s: FloatArray

    @property
    def apart_rad(self) -> float:
        """How far the axis in use lies from where eq 6 alone would put it."""
        return angle_between(self.axis, self.lowest)


@dataclass(frozen=True, slots=True)
class ProjectedRates:
    """Angular rates in both joint planes over one second of little bending, as complex numbers (k,), rad/s (Fig. 4).

    The distal curve is turned about the origin to fit the proximal one as well as it can, once with the axes paired as
    they are and once with one of them reversed. The two congruences are 1 where one curve lies on the other.
    """

    time_s: FloatArray
    proximal: ComplexArray
    distal: ComplexArray
    reversed_distal: ComplexArray
    congruence: float
    reversed_congruence: float


@dataclass(frozen=True, slots=True)
class TwoWays:
    """Eqs 11, 14 and 15 over one recording (Fig. 6), (n,) radians, sign and zero of alpha; NaN between two stretches.

    `from_rates_rad` begins, in every stretch, where the fusion does. `from_accelerations_rad` is brought within half a
    turn of the fused angle and is NaN where the accelerations lie along the axis. `drift_rad_s` is the slope of the
    first against the second, NaN where the longest stretch is too short for one; `scatter_rad` the spread of the second
    about the fused angle.
    """

    time_s: FloatArray
    from_rates_rad: FloatArray
    from_accelerations_rad: FloatArray
    fused_rad: FloatArray
    drift_rad_s: float
    scatter_rad: float


def cost_over_sphere(rate: FloatArray, axis: FloatArray, length_rad_s: FloatArray) -> CostOverSphere:
    """The error of eq 3 for every axis that one sensor could have.

    Parameters
    ----------
    rate : (n, 3)
        Rates of one sensor in the data sets of eq 2, rad/s.
    axis : (3,)
        The axis in use.
    length_rad_s : (n,)
        |g x j| of the other sensor about its own axis.

    Returns
    -------
    CostOverSphere
        Root mean square errors of eq 3 over all directions, rad/s.
    """
    latitude = np.linspace(-np.pi / 2, np.pi / 2, round(np.pi / GRID_STEP_RAD) + 1)[:, None]
    longitude = np.linspace(-np.pi, np.pi, round(2 * np.pi / GRID_STEP_RAD) + 1)[None, :]
    across, north = joint_frame(axis)
    level = np.cos(latitude)
    direction = (
        (level * np.cos(longitude))[..., None] * across
        + (level * np.sin(longitude))[..., None] * axis
        + np.broadcast_to(np.sin(latitude), (latitude.size, longitude.size))[..., None] * north
    )
    rms = _rms_of_constraint(rate, direction.reshape(-1, 3), length_rad_s).reshape(direction.shape[:2])
    return CostOverSphere(axis, _lowest(rate, axis, direction, rms, length_rad_s), direction, rms)


def _rms_of_constraint(rate: FloatArray, direction: FloatArray, length_rad_s: FloatArray) -> FloatArray:
    """Root mean square (d,) of |g x j| - length for unit vectors (d, 3)."""
    total = np.zeros(len(direction))
    for first in range(0, len(rate), CHUNK):
        part = slice(first, first + CHUNK)
        along = direction @ rate[part].T
        across = np.sqrt(np.maximum(np.sum(rate[part] ** 2, axis=1) - along**2, 0.0))
        total += np.sum((across - length_rad_s[part]) ** 2, axis=1)
    return np.asarray(np.sqrt(total / max(len(rate), 1)))


def _lowest(
    rate: FloatArray, axis: FloatArray, direction: FloatArray, rms: FloatArray, length_rad_s: FloatArray
) -> FloatArray:
    """The lowest direction (3,), searched ever finer about the lowest of the grid."""
    best = direction.reshape(-1, 3)[int(np.argmin(rms))]
    reach = GRID_STEP_RAD
    steps = np.linspace(-1.0, 1.0, 11)
    while reach > np.deg2rad(0.01):
        x, y = joint_frame(best)
        near = best + reach * (steps[:, None, None] * x + steps[None, :, None] * y).reshape(-1, 3)
        near /= np.linalg.norm(near, axis=1, keepdims=True)
        best = near[int(np.argmin(_rms_of_constraint(rate, near, length_rad_s)))]
        reach *= 0.3
    return np.asarray(best if best @ axis >= 0 else -best)


def costs_of_both(sets: Datasets, j1: FloatArray, j2: FloatArray) -> tuple[CostOverSphere, CostOverSphere]:
    """Fig. 3 for the proximal and for the distal sensor, from data sets of eq 2 and the axes (3,) in use.

    Parameters
    ----------
    j1, j2 : (3,)
        Unit axes in use, each in its own sensor's axes.

    Returns
    -------
    CostOverSphere, CostOverSphere
        Of the proximal and of the distal sensor.
    """
    length_1, length_2 = (np.linalg.norm(np.cross(g, j), axis=1) for g, j in ((sets.g1, j1), (sets.g2, j2)))
    return cost_over_sphere(sets.g1, j1, length_2), cost_over_sphere(sets.g2, j2, length_1)


def projected_rates(pairs: tuple[Pair, ...], j1: FloatArray, j2: FloatArray) -> ProjectedRates | None:
    """The second that shows the pairing of the axes best among those in which the joint bends least; None without
    one.

    "Best" is the largest difference between how well both pairings fit, whichever of them fits better.

    Parameters
    ----------
    j1, j2 : (3,)
        Unit axes in use, each in its own sensor's axes.

    Returns
    -------
    ProjectedRates or None
        rad/s, in both joint planes.
    """
    found = []
    for pair in pairs:
        width, hop = max(4, round(WINDOW_S / pair.step_s)), max(1, round(HOP_S / pair.step_s))
        unknown = np.concatenate([[0], np.cumsum(~pair.is_known)])
        for first in range(0, len(pair) - width + 1, hop):
            part = slice(first, first + width)
            if unknown[part.stop] != unknown[part.start]:
                continue
            z1, z2 = in_plane(pair.g1[part], j1), in_plane(pair.g2[part], j2)
            strength = float(np.sqrt(np.mean(np.abs(z1) * np.abs(z2))))
            if strength > MIN_IN_PLANE_RAD_S:
                bending = float(np.mean(np.abs(pair.g1[part] @ j1) + np.abs(pair.g2[part] @ j2)))
                clear = abs(abs(np.sum(z1 * np.conj(z2))) - abs(np.sum(z1 * z2)))
                found.append((bending / strength, clear, pair, part))
    if not found:
        return None
    found.sort(key=lambda window: window[0])
    _, _, pair, part = max(found[: max(1, int(USED_SHARE * len(found)))], key=lambda window: window[1])
    z1, z2 = in_plane(pair.g1[part], j1), in_plane(pair.g2[part], j2)
    distal, congruence = _turned_onto(z1, z2)
    reversed_distal, reversed_congruence = _turned_onto(z1, in_plane(pair.g2[part], -j2))
    return ProjectedRates(pair.time_s[part], z1, distal, reversed_distal, congruence, reversed_congruence)


def _turned_onto(z1: ComplexArray, z2: ComplexArray) -> tuple[ComplexArray, float]:
    """The curve z2 (k,) turned to fit z1 best, and how well it then does: 1 the same curve, 0 nothing in common."""
    product = np.sum(z1 * np.conj(z2))
    size = float(np.sqrt(np.sum(np.abs(z1) ** 2) * np.sum(np.abs(z2) ** 2)))
    return np.asarray(z2 * np.exp(1j * np.angle(product))), float(abs(product)) / max(size, 1e-12)


def two_ways(
    pairs: tuple[Pair, ...], j1: FloatArray, j2: FloatArray, o1: FloatArray, o2: FloatArray, tau_s: float
) -> TwoWays:
    """Both angles of section 3.2.2 and their fusion over the stretches of one recording, in order of time.

    Parameters
    ----------
    j1, j2, o1, o2 : (3,)
        Axes, and centres in m, of the proximal and of the distal sensor.
    tau_s
        Time constant of eq 15.

    Returns
    -------
    TwoWays
        Angles in rad.
    """
    parts = _without_turns([_stretch(pair, j1, j2, o1, o2, tau_s) for pair in pairs])
    drift = float("nan")
    if parts:
        longest = max(parts, key=lambda part: part[0][-1] - part[0][0])
        drift = _slope(longest[0], longest[1] - longest[2])
    time_s, rates, accelerations, fused = (_with_gaps([part[k] for part in parts]) for k in range(4))
    scatter = accelerations - fused
    return TwoWays(time_s, rates, accelerations, fused, drift, robust_sd(scatter[np.isfinite(scatter)]))


Stretch = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Time, eqs 11, 14 and 15, each (n,)."""


def _without_turns(parts: list[Stretch]) -> list[Stretch]:
    """Every stretch moved by whole turns to go on where the one before ended."""
    moved: list[Stretch] = []
    for time_s, rates, accelerations, fused in parts:
        apart = moved[-1][3][-1] - fused[0] if moved else 0.0
        turn = 2 * np.pi * np.round(apart / (2 * np.pi)) if np.isfinite(apart) else 0.0
        moved.append((time_s, rates + turn, accelerations + turn, fused + turn))
    return moved


def _stretch(pair: Pair, j1: FloatArray, j2: FloatArray, o1: FloatArray, o2: FloatArray, tau_s: float) -> Stretch:
    """Both angles of one stretch, and their fusion."""
    rates = angle_from_rates(pair.g1, pair.g2, j1, j2, pair.step_s)
    accelerations = angle_from_accelerations(pair, j1, j2, o1, o2)
    fused = fused_angle(rates, accelerations, pair.step_s, tau_s)
    if np.isfinite(fused).any():
        rates = rates + (fused[0] - rates[0])
    near = fused + wrap(accelerations - fused)
    return pair.time_s, rates, np.where(pair.is_measured, near, np.nan), fused


def _with_gaps(parts: list[FloatArray]) -> FloatArray:
    """All stretches, with one NaN between two of them."""
    apart = [value for part in parts for value in (part, np.array([np.nan]))]
    return np.concatenate(apart[:-1]) if apart else np.empty(0)


def _slope(time_s: FloatArray, values: FloatArray) -> float:
    """Slope of a line through values (n,), whatever a few of them do; NaN over less than three seconds."""
    known = np.isfinite(values)
    if np.count_nonzero(known) < 10 or float(np.ptp(time_s[known])) < MIN_DRIFT_S:
        return float("nan")
    t, y = time_s[known] - time_s[known].mean(), values[known]
    weight = np.ones(len(t))
    slope = 0.0
    for _ in range(DRIFT_STEPS):
        middle = np.array([np.sum(weight * t), np.sum(weight * y)]) / np.sum(weight)
        slope = float(np.sum(weight * (t - middle[0]) * (y - middle[1])) / np.sum(weight * (t - middle[0]) ** 2))
        error = y - middle[1] - slope * (t - middle[0])
        weight = 1 / np.sqrt(1 + (error / max(robust_sd(error), 1e-6)) ** 2)
    return slope

"""Axes of both sensors from the lengths of the rates across the joint.

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, section 3.1.1, equations 3 to 6: Gauss-Newton on spherical
coordinates. The paper starts anywhere; some starts end in a wrong minimum on short or planar motion, so six are tried
and the lowest sum of squares wins.
"""

import numpy as np

from core.samples import FloatArray

MAX_STEPS = 30
CONVERGED_RAD = 1e-7
# (phi, theta) along three axes that no sensor prefers, for sensor 1 and 2
STARTS = tuple((a, b, c, d) for a, b in ((0.2, 0.3), (0.3, 1.9), (1.2, 0.8)) for c, d in ((0.2, 1.2), (1.1, 2.6)))


def axis_from_angles(phi: float, theta: float) -> FloatArray:
    """Unit vector (3,) of inclination phi and azimuth theta (eqs 4 and 5).

    Parameters
    ----------
    phi, theta
        rad.

    Returns
    -------
    (3,)
        In sensor axes.
    """
    return np.array([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)])


def _tangents(phi: float, theta: float) -> FloatArray:
    by_phi = [-np.sin(phi) * np.cos(theta), -np.sin(phi) * np.sin(theta), np.cos(phi)]
    by_theta = [-np.cos(phi) * np.sin(theta), np.cos(phi) * np.cos(theta), 0.0]
    return np.array([by_phi, by_theta]).T


def constraint(g1: FloatArray, g2: FloatArray, j1: FloatArray, j2: FloatArray) -> FloatArray:
    """|g1 x j1| - |g2 x j2| (n,) of eq 3, rad/s.

    Parameters
    ----------
    g1, g2 : (n, 3)
        Angular rates, rad/s, each in its own sensor's axes.
    j1, j2 : (3,)
        Unit axes, each in its own sensor's axes.

    Returns
    -------
    (n,)
        rad/s.
    """
    return np.asarray(np.linalg.norm(np.cross(g1, j1), axis=1) - np.linalg.norm(np.cross(g2, j2), axis=1))


def identify_axes(g1: FloatArray, g2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit axes (3,) in both sensors, each up to its sign.

    Parameters
    ----------
    g1, g2 : (n, 3)
        Rates of the data sets S(i) (eq 2), rad/s.

    Returns
    -------
    (3,) and (3,)
        Each in its own sensor's axes; eqs 3 to 6.
    """
    x, _ = min((_gauss_newton(g1, g2, np.array(start)) for start in STARTS), key=lambda found: found[1])
    return axis_from_angles(x[0], x[1]), axis_from_angles(x[2], x[3])


def _gauss_newton(g1: FloatArray, g2: FloatArray, x: FloatArray) -> tuple[FloatArray, float]:
    damping = 1e-3
    error, slope = _error_and_slope(g1, g2, x)
    cost = float(error @ error)
    for _ in range(MAX_STEPS):
        information = slope.T @ slope
        step = -np.linalg.solve(information + damping * np.diag(np.diag(information) + 1e-9), slope.T @ error)
        new_error, new_slope = _error_and_slope(g1, g2, x + step)
        new_cost = float(new_error @ new_error)
        if new_cost > cost:
            damping = min(damping * 10, 1e6)
            if damping >= 1e6:
                break
            continue
        x, error, slope, cost, damping = x + step, new_error, new_slope, new_cost, max(damping / 10, 1e-9)
        if np.max(np.abs(step)) < CONVERGED_RAD:
            break
    return x, cost


def _error_and_slope(g1: FloatArray, g2: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The constraint (n,) and its slopes (n, 4) by the angles x."""
    slope = np.empty((len(g1), 4))
    lengths = []
    for k, (rate, sign) in enumerate(((g1, 1.0), (g2, -1.0))):
        phi, theta = x[2 * k], x[2 * k + 1]
        slopes = rate @ _tangents(phi, theta)
        # the slope by phi is a unit vector across the axis; this is the other one
        other = rate @ np.array([-np.sin(theta), np.cos(theta), 0.0])
        length = np.maximum(np.sqrt(slopes[:, 0] ** 2 + other**2), 1e-9)  # |g x j|
        slope[:, 2 * k : 2 * k + 2] = -sign * ((rate @ axis_from_angles(phi, theta)) / length)[:, None] * slopes
        lengths.append(length)
    return lengths[0] - lengths[1], slope

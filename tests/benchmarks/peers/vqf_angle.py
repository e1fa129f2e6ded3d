"""Angle that the orientation filter VQF makes of a joint whose axes are known.

VQF (Laidig & Seel 2023, doi 10.1016/j.inffus.2022.10.014) as its documentation states: the rate over the interval
before each sample, default parameters, no magnetometer. The heading between the two sensors is the least-squares fit
that lays one axis on the other, in closed form over adjacent windows; the angle is the twist about the axis.
"""

from collections.abc import Callable

import numpy as np

from core.calibration.zero import standing_twist
from core.samples import FloatArray, RateKind
from core.signal.rotations import joint_frame, matrix_from_quaternion, turn_about_vertical
from tests.benchmarks.trials import Trial

WINDOW_S = 10.0

Filter = Callable[[FloatArray, FloatArray, float], FloatArray]


def online(gyr_rad_s: FloatArray, acc_m_s2: FloatArray, step_s: float) -> FloatArray:
    """Earth from sensor (n, 4), from the past alone."""
    from vqf import VQF  # which has no wheel for every computer

    return np.asarray(VQF(step_s).updateBatch(gyr_rad_s, acc_m_s2)["quat6D"])


def offline(gyr_rad_s: FloatArray, acc_m_s2: FloatArray, step_s: float) -> FloatArray:
    """Earth from sensor (n, 4), from past and future."""
    from vqf import offlineVQF  # as above

    return np.asarray(offlineVQF(gyr_rad_s, acc_m_s2, None, step_s)["quat6D"])


def orientations(trial: Trial, run: Filter) -> tuple[FloatArray, FloatArray]:
    """Earth from sensor (n, 4) of both sensors."""
    found = []
    for rates, acc in ((trial.g1, trial.a1), (trial.g2, trial.a2)):
        before = rates.copy()
        if trial.rate_kind is RateKind.INSTANTANEOUS:
            before[1:] = 0.5 * (rates[1:] + rates[:-1])
        found.append(run(before, np.ascontiguousarray(acc), trial.step_s))
    return found[0], found[1]


def angle(trial: Trial, run: Filter, axis_1: FloatArray, axis_2: FloatArray) -> FloatArray:
    """Angle (n,), zero in standing where there was one, rad."""
    earth_1, earth_2 = (matrix_from_quaternion(q) for q in orientations(trial, run))
    heading = fitted_heading(earth_1 @ axis_1, earth_2 @ axis_2, trial.step_s)
    (x1, y1), (x2, y2) = joint_frame(axis_1), joint_frame(axis_2)
    x2_earth = turn_about_vertical(heading, earth_2 @ x2)
    y2_earth = turn_about_vertical(heading, earth_2 @ y2)
    x1_earth, y1_earth = earth_1 @ x1, earth_1 @ y1
    sine = np.sum(x2_earth * y1_earth, axis=1) - np.sum(y2_earth * x1_earth, axis=1)
    cosine = np.sum(x2_earth * x1_earth, axis=1) + np.sum(y2_earth * y1_earth, axis=1)
    twist = np.unwrap(np.arctan2(sine, cosine))
    if trial.down_1 is None or trial.down_2 is None:
        return twist
    return twist - standing_twist(trial.down_1, trial.down_2, axis_1, axis_2)


def fitted_heading(axis_1_earth: FloatArray, axis_2_earth: FloatArray, step_s: float) -> FloatArray:
    """Heading (n,) that turns the second sensor's axis (n, 3) onto the first one's, linear between windows of 10 s."""
    product = (axis_1_earth[:, 0] + 1j * axis_1_earth[:, 1]) * (axis_2_earth[:, 0] - 1j * axis_2_earth[:, 1])
    n = len(product)
    edges = np.linspace(0, n, max(1, round(n * step_s / WINDOW_S)) + 1).astype(int)
    centres = 0.5 * (edges[1:] + edges[:-1] - 1)
    return np.interp(np.arange(n), centres, np.unwrap(np.angle(np.add.reduceat(product, edges[:-1]))))

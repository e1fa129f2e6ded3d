"""Centres from the lengths of the accelerations, shifted into the joint.

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, section 3.1.3, equations 7 to 9, by Gauss-Newton.
"""

import numpy as np

from core.samples import FloatArray
from core.signal.pair import lever_matrix

MAX_STEPS = 30
CONVERGED_M = 1e-7
START_M = 0.05  # off the singular start at zero lever
MAX_STEP_M = 0.3


def identify_centres(
    a1: FloatArray, a2: FloatArray, g1: FloatArray, g2: FloatArray, dg1: FloatArray, dg2: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Vectors (3,) from some point of the joint axis to both sensors, m.

    Parameters
    ----------
    a1, a2, g1, g2, dg1, dg2 : (n, 3)
        The data sets S(i) of eq 2.

    Returns
    -------
    (3,) and (3,)
        m, each in its own sensor's axes; eqs 7 and 8.
    """
    lever_1, lever_2 = lever_matrix(g1, dg1), lever_matrix(g2, dg2)
    x = np.full(6, START_M)
    for _ in range(MAX_STEPS):
        one, two = a1 - lever_1 @ x[:3], a2 - lever_2 @ x[3:]
        length_1 = np.maximum(np.linalg.norm(one, axis=1), 1e-9)
        length_2 = np.maximum(np.linalg.norm(two, axis=1), 1e-9)
        by_1 = -np.einsum("ni,nij->nj", one / length_1[:, None], lever_1)
        by_2 = np.einsum("ni,nij->nj", two / length_2[:, None], lever_2)
        slope = np.concatenate([by_1, by_2], axis=1)
        # along a hinge's axis nothing is determined: the shortest step is taken there
        step = -np.linalg.lstsq(slope, length_1 - length_2, rcond=1e-6)[0]
        step *= min(1.0, MAX_STEP_M / max(float(np.linalg.norm(step)), 1e-12))
        x = x + step
        if np.max(np.abs(step)) < CONVERGED_M:
            break
    return x[:3], x[3:]


def shifted_to_sensors(o1: FloatArray, o2: FloatArray, j1: FloatArray, j2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The point of the joint axis nearest to both sensors (eq 9).

    Parameters
    ----------
    o1, o2 : (3,)
        Vectors from a point of the joint axis to each sensor, m, in its axes.
    j1, j2 : (3,)
        Unit axes, each in its own sensor's axes.

    Returns
    -------
    (3,) and (3,)
        Vectors from the nearest point to each sensor, m, in its axes.
    """
    along = 0.5 * float(o1 @ j1 + o2 @ j2)
    return o1 - j1 * along, o2 - j2 * along

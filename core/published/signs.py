"""Pairing of the two axes' signs: the projected rates are congruent when they match, mirror images when not.

Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, section 3.1.2 and Figure 4: at times when little happens about
the joint axis, the rates in the two joint planes are the same curve up to a rotation.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.samples import FloatArray
from core.signal.rotations import in_plane

WINDOW_S = 0.5  # in which the joint hardly bends
MIN_IN_PLANE_RAD_S = 0.2  # less movement than this draws no curve
USED_SHARE = 0.25  # of the windows, those with the least flexion


def signs_match(g1: FloatArray, g2: FloatArray, j1: FloatArray, j2: FloatArray, step_s: float) -> tuple[bool, float]:
    """Whether j1 and j2 pair up, and how clearly: 0 undecided, 1 beyond doubt.

    Parameters
    ----------
    g1, g2 : (n, 3)
        Consecutive rates, rad/s.
    j1, j2 : (3,)
        Unit axes, each in its own sensor's axes.

    Returns
    -------
    bool and float
        Whether they pair up, and 0 to 1.
    """
    z1, z2 = in_plane(g1, j1), in_plane(g2, j2)
    width = max(4, round(WINDOW_S / step_s))
    windows = len(z1) // width
    if windows == 0:
        return True, 0.0

    def cut(values: NDArray[Any]) -> NDArray[Any]:
        return values[: windows * width].reshape(windows, width)

    flexion = np.mean(np.abs(cut(g1 @ j1)) + np.abs(cut(g2 @ j2)), axis=1)
    strength = np.sqrt(np.mean(np.abs(cut(z1)) * np.abs(cut(z2)), axis=1))
    ratio = np.where(strength > MIN_IN_PLANE_RAD_S, flexion / np.maximum(strength, 1e-9), np.inf)
    used = np.argsort(ratio)[: max(1, int(USED_SHARE * windows))]
    congruent = np.sum(np.abs(np.sum(cut(z1) * np.conj(cut(z2)), axis=1))[used])
    mirrored = np.sum(np.abs(np.sum(cut(z1) * cut(z2), axis=1))[used])
    return bool(congruent >= mirrored), float(abs(congruent - mirrored) / max(congruent + mirrored, 1e-12))

"""Stretches in which a sensor lies still, and what it reads then."""

from dataclasses import dataclass

import numpy as np

from core.samples import FloatArray, ImuBlock
from core.signal.pair import moving_mean
from core.signal.tracks import BLOCK_S, is_received, nominal_step_s

WINDOW_S = 0.5
MAX_SPREAD_RAD_S = 0.06  # sway and trembling of a standing person; a step is ten times that
MAX_ACC_SPREAD_M_S2 = 0.4
MAX_BIAS_RAD_S = np.deg2rad(15.0)  # a mean rate above this is a slow turn, not a bias
MIN_REST_S = 0.5


@dataclass(frozen=True, slots=True)
class Rest:
    """Means (3,) of a sensor over its still samples, and how long they last."""

    gyr_rad_s: FloatArray
    acc_m_s2: FloatArray
    duration_s: float


def rest_of(block: ImuBlock) -> Rest | None:
    """What a sensor reads while it is still in the first ten minutes; None where it never is for half a second."""
    first = slice(0, int(np.searchsorted(block.time_s, block.time_s[0] + BLOCK_S))) if len(block) else slice(0)
    time_s, gyr, acc = block.time_s[first], block.gyr_rad_s[first], block.acc_m_s2[first]
    is_there = is_received(time_s, gyr, acc)
    time_s, gyr, acc = time_s[is_there], gyr[is_there], acc[is_there]
    if len(time_s) < 5:
        return None
    step_s = nominal_step_s(time_s)
    width = max(3, round(WINDOW_S / step_s))
    if len(time_s) < width:
        return None
    mean_rate = moving_mean(gyr, width)
    is_quiet = (_spread(gyr, width) < MAX_SPREAD_RAD_S) & (_spread(acc, width) < MAX_ACC_SPREAD_M_S2)
    is_quiet &= np.sum(mean_rate**2, axis=1) < MAX_BIAS_RAD_S**2
    duration_s = float(np.count_nonzero(is_quiet) * step_s)
    if duration_s < MIN_REST_S:
        return None
    return Rest(np.mean(gyr[is_quiet], axis=0), np.mean(acc[is_quiet], axis=0), duration_s)


def _spread(values: FloatArray, width: int) -> FloatArray:
    """Standard deviation (n,) of vectors (n, 3) about their centred mean."""
    centred = values - np.median(values, axis=0)  # keeps the difference of squares exact
    square = np.sum(moving_mean(centred**2, width) - moving_mean(centred, width) ** 2, axis=1)
    return np.sqrt(np.maximum(square, 0.0))

"""Samples at the end of a sensor's range, where a signal is cut off."""

import numpy as np

from core.samples import BoolArray, FloatArray

MIN_RUN = 3  # equal extreme values in a row
MIN_CLIPPED = 6  # samples: what happens once is chance
CLIPPED_STEPS = 5  # of the sensor's least steps: noise goes on by one or two
BEYOND_M_S2, BEYOND_RAD_S = 14.7, 1.5  # 1.5 g; the narrowest ranges are 2 g and 125 deg/s


def clipped_rates(gyr_rad_s: FloatArray) -> BoolArray:
    """Give which finite rates lie at the end of the range, (n, k): one column for each end that is reached."""
    return _clipped(gyr_rad_s, BEYOND_RAD_S)


def clipped_forces(acc_m_s2: FloatArray) -> BoolArray:
    """Give which finite forces lie at the end of the range, (n, k): one column for each end that is reached."""
    return _clipped(acc_m_s2, BEYOND_M_S2)


def _clipped(values: FloatArray, beyond: float) -> BoolArray:
    """Which samples of (n, 3) lie at the end of the sensor's range."""
    # there a signal stays, farther from zero than any rest (`beyond`), and would have gone on by the slope with which
    # it came or left; a coarse sensor repeats its extremes as well, but where the signal turns
    ends = []
    for v in (side for column in values.T for side in (column, -column)):
        limit = float(v.max(initial=0.0))
        if limit <= beyond or np.count_nonzero(v == limit) < MIN_RUN:
            continue
        steps = np.abs(np.diff(v))
        edges = np.flatnonzero(np.diff(np.concatenate([[0], (v == limit).astype(np.int8), [0]])))
        runs = [(int(i), int(j)) for i, j in zip(edges[::2], edges[1::2], strict=True) if j - i >= MIN_RUN]
        least = CLIPPED_STEPS * float(np.min(steps[steps > 0.0], initial=np.inf))
        if sum(j - i for i, j in runs if _would_go_on(v, i, j, limit, least)) >= MIN_CLIPPED:
            ends.append(v == limit)
    return np.stack(ends, axis=1) if ends else np.zeros((len(values), 0), dtype=bool)


def _would_go_on(v: FloatArray, first: int, end: int, limit: float, least: float) -> bool:
    """Whether a signal comes and leaves by more than `least`, and one of both leads beyond more than flatness does."""
    sides = [(v[i], v[i] - v[k]) for i, k in ((first - 1, first - 2), (end, end + 1)) if 0 <= k < len(v)]
    farthest = max((limit - near for near, _ in sides), default=0.0)
    beyond = max((near + slope - limit for near, slope in sides), default=0.0)
    return beyond > max(least, 0.5 * farthest) and all(slope > least for _, slope in sides)

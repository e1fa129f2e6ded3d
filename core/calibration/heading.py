"""How do the headings of the two orientation filters differ over a recording, once the axes are known?"""

import numpy as np

from core.calibration.datasets import Datasets, gather, knot_positions
from core.calibration.hinge import robust_sd
from core.calibration.joint_axis import (
    NEUTRAL_SCALE_RAD,
    RATE_SCALE_RAD_S,
    Candidates,
    heading_from_axes,
    polish,
    residuals,
)
from core.pair import Pair
from core.samples import BoolArray, FloatArray, IntArray

SAMPLES_PER_S = 10.0  # residuals are correlated over half a second
STEPS = 3
MIN_RATE_SCALE_RAD_S = 0.01
MIN_NEUTRAL_SCALE_RAD = np.deg2rad(0.3)


def heading_over(pair: Pair, axis_1: FloatArray, axis_2: FloatArray) -> FloatArray:
    """Heading (n,) of the distal earth in the proximal one at every sample of a pair."""
    data = _spread(pair, pair.is_known)
    if len(data) < 10:
        data = _spread(pair, np.ones(len(pair), dtype=bool))
    knots = heading_from_axes(data, axis_1[None], axis_2[None])
    start = Candidates(axis_1[None], axis_2[None], knots, np.array([np.inf]))
    fit = polish(data, start, STEPS, is_axis_fixed=True)
    rate_scale, neutral_scale = residual_scales(data, fit)
    fit = polish(data, fit, STEPS, rate_scale, neutral_scale, is_axis_fixed=True)
    intervals, position = knot_positions(pair)
    return np.interp(position, np.arange(intervals + 1), fit.knots_rad[0])


def _spread(pair: Pair, is_used: BoolArray) -> Datasets:
    index: IntArray = np.flatnonzero(is_used)
    stride = max(1, round(1 / (SAMPLES_PER_S * pair.step_s)))
    return gather((pair,), [index[::stride]])


def residual_scales(data: Datasets, fit: Candidates) -> tuple[float, float]:
    """Robust spreads of the off-axis rate (rad/s) and of the parting of the axes (rad) under the first candidate."""
    r = residuals(data, fit.axis_1, fit.axis_2, data.heading(fit.knots_rad), RATE_SCALE_RAD_S, NEUTRAL_SCALE_RAD)
    rate = robust_sd(r.value[0, :, :4]) * np.sqrt(2) * RATE_SCALE_RAD_S
    neutral = robust_sd(r.value[0, :, 4:]) * NEUTRAL_SCALE_RAD
    return max(rate, MIN_RATE_SCALE_RAD_S), max(neutral, MIN_NEUTRAL_SCALE_RAD)

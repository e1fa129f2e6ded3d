"""Two walks at the same percent of a stride each: the used strides of one leg, in the order they were walked."""

from typing import NamedTuple

import numpy as np

from core.body import Side
from core.results import RecordingAnalysis
from core.samples import FloatArray


class StridePlace(NamedTuple):
    """Which used stride of a leg, from 0, and how far into it."""

    number: int
    percent: float


def used_strides(recording: RecordingAnalysis, side: Side) -> FloatArray:
    """Start and end of each used stride, shape (k, 2)."""
    gait = recording.gait.get(side)
    if gait is None:
        return np.zeros((0, 2))
    used = gait.strides.is_used
    return np.stack([gait.strides.start_s[used], gait.strides.end_s[used]], axis=1)


def place_at(strides: FloatArray, time_s: float) -> StridePlace | None:
    """The stride (of k, 2) that a time is in; None between them."""
    number = int(np.searchsorted(strides[:, 0], time_s, side="right")) - 1
    if number < 0 or time_s > strides[number, 1]:
        return None
    start_s, end_s = strides[number]
    return StridePlace(number, 100.0 * (time_s - start_s) / (end_s - start_s))


def time_at(strides: FloatArray, place: StridePlace) -> float | None:
    """The same place in another walk, which begins again where it has fewer strides; None without a used stride."""
    if not len(strides):
        return None
    start_s, end_s = strides[place.number % len(strides)]
    return float(start_s + place.percent / 100.0 * (end_s - start_s))

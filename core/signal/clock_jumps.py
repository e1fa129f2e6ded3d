"""Clocks that jump forward: a gap in one sensor's stamps in which no time passed.

A loss looks the same in the one sensor. The others distinguish them: during a loss they measure, or pause alike.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.samples import FloatArray

JUMP_S = 1.0  # shorter gaps are reported as what they look like
LONGER_THAN_LOSS_S = 60.0  # no sensor is out of reach so long while all others rest
COVERED = 0.5  # of a gap, in which another sensor measured or paused
SAME_LENGTH_S = 0.1  # what two sensors measured is equally long although one has a gap more: none was lost in it
NEAR_LENGTH = 0.05

Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class ClockJump:
    """A jump by `by_s`, `after_s` after the sensor's first sample."""

    after_s: float
    by_s: float


def spans_of(time_s: FloatArray) -> list[Span]:
    """Give begin and end of each part of a recording without a gap longer than `JUMP_S`."""
    if not len(time_s):
        return []
    ends = np.flatnonzero(np.diff(time_s) > JUMP_S)
    begins_s, ends_s = time_s[[0, *(ends + 1)]], time_s[[*ends, len(time_s) - 1]]
    return list(zip(begins_s.tolist(), ends_s.tolist(), strict=True))


def jump_of(own: Sequence[Span], others: Sequence[Sequence[Span]]) -> ClockJump | None:
    """Find the first jump of a sensor's clock; None where there is none, or no other sensor to compare with.
    A gap is a jump where the sensor measured as long as another without it, or where no other measured
    or paused for most of it and it measured nearly as long, or the gap is longer than any loss.
    """
    measured_s = _measured_s(own)
    apart_s = min((abs(_measured_s(spans) - measured_s) for spans in others if spans), default=np.inf)
    for (_, begin_s), (end_s, _) in pairwise(own):
        gap = begin_s, end_s
        if any(_covered_s(_pauses(spans), gap) > COVERED * (end_s - begin_s) for spans in others):
            continue
        is_measured = any(_covered_s(spans, gap) > COVERED * (end_s - begin_s) for spans in others)
        is_near = apart_s <= NEAR_LENGTH * measured_s or (apart_s < np.inf and end_s - begin_s > LONGER_THAN_LOSS_S)
        if apart_s <= SAME_LENGTH_S or (is_near and not is_measured):
            return ClockJump(begin_s - own[0][0], end_s - begin_s)
    return None


def _pauses(spans: Sequence[Span]) -> list[Span]:
    return [(end_s, begin_s) for (_, end_s), (begin_s, _) in pairwise(spans)]


def _covered_s(spans: Sequence[Span], gap: Span) -> float:
    return sum(max(min(one[1], gap[1]) - max(one[0], gap[0]), 0.0) for one in spans)


def _measured_s(spans: Sequence[Span]) -> float:
    return sum(end_s - begin_s for begin_s, end_s in spans)

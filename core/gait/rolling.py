"""Where the pitch of a rolling foot passes a share of its extremes: marks that scatter less than the rate's own rest.

Integrated to a pitch, what shakes a sensor is small; where the rate falls below a level it decides.
"""

from collections.abc import Sequence

import numpy as np

from core.gait.crossings import crossing
from core.samples import BoolArray, FloatArray
from core.signal.robust import robust_sd

LEAVING_SHARE = 0.2  # of the lowest pitch on leaving: where its passing is sharp
LANDING_SHARES = (0.25, 0.5)  # and of the extreme on landing; the first serves heels that land first
LEAST_SWINGS = 4  # from which a mean is meaningful

Spans = Sequence[tuple[int, int, int]]  # of each swing: the rest before, where it is fastest, the rest after


def leaving_marks(pitch: FloatArray, spans: Spans) -> FloatArray:
    """Find where a swing's pitch (n,), rad, passes its share of the lowest on leaving, (k,); NaN: nowhere."""
    marks = np.full(len(spans), np.nan)
    for k, (a, m, _) in enumerate(spans):
        lowest = a + int(np.argmin(pitch[a : m + 1]))
        marks[k] = crossing(pitch, a, lowest, LEAVING_SHARE * pitch[lowest], which=-1)
    return marks


def landing_marks(
    pitch: FloatArray, spans: Spans, share: float, lowered: Sequence[int | None] | None = None
) -> FloatArray:
    """Find where pitch (n,), rad, passes a share of its extreme on landing, (k,); `lowered` None: heel first."""
    marks = np.full(len(spans), np.nan)
    for k, (_, m, b) in enumerate(spans):
        toes = None if lowered is None else lowered[k]
        extreme = m + int(np.argmax(pitch[m : b + 1])) if toes is None else toes + int(np.argmin(pitch[toes : b + 1]))
        marks[k] = crossing(pitch, extreme, b, share * pitch[extreme])
    return marks


def timed_by(marks: FloatArray, instants: FloatArray) -> tuple[FloatArray, float]:
    """Give instants at the median distance from their marks (k,), and the scatter in samples."""
    apart = instants - marks
    usual = float(np.median(apart))
    return marks + usual, robust_sd(apart - usual)


def sharpest(
    candidates: Sequence[FloatArray], instants: FloatArray, beside: FloatArray, is_one: BoolArray
) -> FloatArray | None:
    """Give the marks (k,) that scatter least from event `beside`, if less than `instants`; NaN: unknown."""
    found, least = None, 1.0
    for marks in candidates:
        is_known = is_one & ((marks - beside) * (instants - beside) >= 0.0)
        if np.sum(is_known) < LEAST_SWINGS:
            continue
        scatter, of_marks = (float(np.std((values - beside)[is_known])) for values in (instants, marks))
        if of_marks < least * scatter:
            found, least = np.where(is_known, marks, np.nan), of_marks / scatter
    return found

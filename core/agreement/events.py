"""Events and stride lengths of a walk beside those of a reference."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.body import Side
from core.gait.strides import Strides
from core.samples import FloatArray

SAME_S = 0.15  # an event further from the reference's, less what is usual for its kind, is another event
NEARLY_ALL = 0.9  # of the most pairs: a walk is nearly as like itself a stride later
BIN_S = 0.05

EventKey = tuple[Side, str]
Events = Mapping[EventKey, FloatArray]
"""Instants (k,), ascending, by side and kind of event."""


@dataclass(frozen=True, slots=True)
class EventAgreement:
    """One kind of event of one foot: how late each event of the reference was found (k,), NaN where it was not.

    `more`: events found between the first and the last of the reference that it has not.
    """

    late_s: FloatArray
    more: int

    @property
    def count(self) -> int:
        return len(self.late_s)

    @property
    def found(self) -> int:
        return int(np.count_nonzero(np.isfinite(self.late_s)))

    @property
    def bias_s(self) -> float:
        """Mean lateness, NaN where none was found."""
        return float(np.nanmean(self.late_s)) if self.found else float("nan")

    @property
    def sd_s(self) -> float:
        """Standard deviation (n - 1), the constant offset taken out."""
        return float(np.nanstd(self.late_s, ddof=1)) if self.found > 1 else float("nan")


def joined(parts: list[EventAgreement]) -> EventAgreement:
    """The same kind of several feet or walks taken together."""
    return EventAgreement(np.concatenate([part.late_s for part in parts]), sum(part.more for part in parts))


def event_offset(found: Events, reference: Events) -> float:
    """Give what to add to the walk's clock for the reference's, to BIN_S; 0 where 0 pairs nearly as many."""
    keys = [key for key in found if key in reference]
    apart = np.concatenate([(reference[key][:, None] - found[key][None]).ravel() for key in keys] or [np.empty(0)])
    if not len(apart):
        return 0.0
    candidates = np.unique(np.round(np.append(apart, 0.0) / BIN_S)) * BIN_S
    pairs = np.array([np.count_nonzero(np.abs(apart - at) < 1.5 * BIN_S) for at in candidates])
    enough = candidates[pairs >= NEARLY_ALL * pairs.max()]
    return 0.0 if 0.0 in enough else float(candidates[np.argmax(pairs)])


def compare_events(found: Events, reference: Events) -> dict[EventKey, EventAgreement]:
    """How late each event of the reference was found, where both know its kind. Both on one clock."""
    return {key: _compared(found.get(key, np.empty(0)), reference[key]) for key in reference}


def _compared(found_s: FloatArray, true_s: FloatArray) -> EventAgreement:
    """Pair by nearness around the usual lateness, so that another definition of an event loses none."""
    late_s = np.full(len(true_s), np.nan)
    if not len(found_s) or not len(true_s):
        return EventAgreement(late_s, 0)
    usual_s = float(np.median(found_s[np.argmin(np.abs(found_s - true_s[:, None]), axis=1)] - true_s))
    taken = np.zeros(len(found_s), dtype=bool)
    for k, at_s in enumerate(true_s):
        nearest = int(np.argmin(np.abs(found_s - at_s - usual_s) + np.where(taken, np.inf, 0.0)))
        if not taken[nearest] and abs(found_s[nearest] - at_s - usual_s) < SAME_S:
            taken[nearest] = True
            late_s[k] = found_s[nearest] - at_s
    inside = (found_s - usual_s > true_s[0] - SAME_S) & (found_s - usual_s < true_s[-1] + SAME_S)
    return EventAgreement(late_s, int(np.count_nonzero(inside & ~taken)))


def compare_lengths(strides: Strides, reference: FloatArray) -> FloatArray:
    """Give lengths (k, 2) m, measured and reference, of used strides whose swing lies in a reference stride.
    `reference` (n, 3): first and last instant on the walk's clock, s, and length, m.
    """
    pairs = []
    for toe_off_s, end_s, length_m, is_used in zip(
        strides.toe_off_s, strides.end_s, strides.length_m, strides.is_used, strict=True
    ):
        middle_s = 0.5 * (toe_off_s + end_s)
        inside = np.nonzero((reference[:, 0] <= middle_s) & (middle_s < reference[:, 1]))[0]
        if is_used and np.isfinite(length_m) and len(inside) == 1:
            pairs.append((length_m, reference[inside[0], 2]))
    return np.array(pairs).reshape(-1, 2)

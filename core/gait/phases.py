"""The phase of a foot at each instant: loading, foot flat, pre-swing, swing (references 34 and 35 of the paper).

Pre-swing is heel rise to toe-off, not Perry's, which starts at the other foot's contact.
"""

from collections.abc import Sequence
from enum import StrEnum

import numpy as np

from core.gait.events import FootEvents
from core.samples import FloatArray, IntArray


class Phase(StrEnum):
    """The values are the words of angles.csv."""

    UNKNOWN = ""
    LOADING = "loading"
    FOOT_FLAT = "foot_flat"
    PRE_SWING = "pre_swing"
    SWING = "swing"


PHASES = tuple(Phase)
AFTER = (Phase.PRE_SWING, Phase.SWING, Phase.LOADING, Phase.FOOT_FLAT)  # heel rise, toe-off, initial and full contact


def phases_at(time_s: FloatArray, stretches: Sequence[FootEvents]) -> IntArray:
    """Give the phase (n,) at ascending instants, an index into PHASES; 0 where a bounding event is unknown."""
    phase = np.zeros(len(time_s), dtype=np.int64)
    for events in stretches:
        if not len(events):
            continue
        rows = [events.heel_rise_s, events.toe_off_s, events.initial_contact_s, events.full_contact_s]
        edges = np.stack(rows, axis=1).ravel()
        begins = np.tile([PHASES.index(p) for p in AFTER], len(events))
        is_known = np.isfinite(edges)
        begins[:-1][~is_known[1:]] = 0  # it ends with what is not known
        edges, begins = np.maximum.accumulate(edges[is_known]), begins[is_known]
        passed = np.searchsorted(edges, time_s, side="right")
        is_inside = (passed > 0) & (passed < len(edges))
        phase[is_inside] = begins[passed[is_inside] - 1]
    return phase

"""In which phase is a foot at each instant? Loading, foot flat, pre-swing, swing (references 34 and 35 of the paper).

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


def phases_at(time_s: FloatArray, stretches: Sequence[FootEvents]) -> IntArray:
    """Index (n,) into PHASES at each of the ascending instants; 0, unknown, before the first and after the last event;
    in stance too where only the shank wore a sensor.

    Parameters
    ----------
    time_s : (n,)
        On the clock of the events.
    stretches
        One foot's events, one item per stretch without gaps.
    """
    phase = np.zeros(len(time_s), dtype=np.int64)
    for events in stretches:
        if not len(events):
            continue
        rows = [events.heel_rise_s, events.toe_off_s, events.initial_contact_s, events.full_contact_s]
        after = [Phase.FOOT_FLAT, Phase.PRE_SWING, Phase.SWING, Phase.LOADING]
        if events.is_from_shank:
            rows, after = rows[1:3], [Phase.UNKNOWN, Phase.SWING]
        edges = np.maximum.accumulate(np.stack(rows, axis=1).ravel())
        passed = np.searchsorted(edges, time_s, side="right")
        names = np.array([PHASES.index(p) for p in after])[passed % len(after)]
        is_inside = (passed > 0) & (passed < len(edges))
        phase[is_inside] = names[is_inside]
    return phase

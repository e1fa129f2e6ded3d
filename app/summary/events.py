"""Gait events of a walk in order of time."""

import math

from core.body import Side
from core.results import RecordingAnalysis

EVENTS = ("initial_contact", "full_contact", "heel_rise", "toe_off")


def events_of(recording: RecordingAnalysis) -> list[tuple[float, Side, str]]:
    """Time, side and kind of every event that is known, ascending."""
    found = [
        (float(time_s), side, event)
        for side, gait in recording.gait.items()
        for events in gait.events
        for event in EVENTS
        for time_s in getattr(events, f"{event}_s")
        if math.isfinite(time_s)
    ]
    return sorted(found, key=lambda event: (event[0], event[1], EVENTS.index(event[2])))

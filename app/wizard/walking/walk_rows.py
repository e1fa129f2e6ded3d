"""The walks of a session as the list on the page shows them, and what is shown about the one that is asked about."""

import math
from typing import TYPE_CHECKING

from app.storage.stored import RecordingState
from app.wizard.walking.walk_list import WalkRow, WalkState
from app.wizard.walking.walk_notice import length_s, strides_of
from app.wording.numbers import clock
from app.wording.translation import tr
from core.body import Side
from core.session import RecordingKind

if TYPE_CHECKING:
    from app.editing.session_recording import Ongoing, SessionRecording
    from app.wizard.recordings import SessionRecordings
    from app.wizard.visit import Visit


def ongoing_walk(recordings: "SessionRecordings") -> "Ongoing | None":
    """The walk that is being recorded."""
    ongoing = recordings.ongoing
    return ongoing if ongoing is not None and ongoing.details.kind is RecordingKind.WALKING else None


def rows_of(visit: "Visit") -> tuple[WalkRow, ...]:
    """All walks of the session in the order of recording, those in the sensors and the one that goes on last."""
    recordings = visit.recordings
    names = recordings.shown_names
    strapped_last = {recording.id for recording in recordings.since_strapped}
    rows = []
    for recording in recordings.walks:
        state = WalkState.KEPT if recording.details.is_kept else WalkState.DISCARDED
        if not recording.is_decided:
            is_recovered = recording.stored.state is RecordingState.RECOVERED
            state = WalkState.RECOVERED if is_recovered else WalkState.ASKING
        strides = max(strides_of(visit, recording).values(), default=None)
        name, is_old = names[recording.details.name], recording.id not in strapped_last
        video_s = visit.clips.length_s(recording.id)
        rows.append(WalkRow(str(recording.id), name.letter, name.words, state, strides, is_old, video_s))
    ongoing = ongoing_walk(recordings)
    fetched_later = [reported for reported in recordings.in_sensors if reported.kind is RecordingKind.WALKING]
    for reported in fetched_later:
        name = names[reported.name]
        rows.append(WalkRow("", name.letter, name.words, WalkState.IN_SENSORS))
    if ongoing is not None and ongoing.details not in fetched_later:
        name = names[ongoing.details.name]
        rows.append(WalkRow("", name.letter, name.words, WalkState.RECORDING))
    return tuple(rows)


def facts_of(visit: "Visit", recording: "SessionRecording", cadence_steps_min: float) -> str:
    """Of the walk that is asked about: its strides, its cadence where it is known, its length."""
    strides = strides_of(visit, recording)
    stated = []
    if strides:
        counts = ", ".join(f"{side.letter} {strides[side]}" for side in Side if side in strides)
        stated.append(tr("Strides: {counts}").format(counts=counts))
    if math.isfinite(cadence_steps_min):
        stated.append(tr("{cadence:.0f} steps/min").format(cadence=cadence_steps_min))
    stated.append(clock(length_s(recording)))
    return " · ".join(stated)

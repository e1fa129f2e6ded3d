"""Choice of the strides of a visit's walks that are left out by hand, and how that is taken back."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.wording.translation import tr
from core.body import Side

if TYPE_CHECKING:
    from app.editing.session_recording import SessionRecording
    from app.widgets.stride_list import StrideLine
    from app.wizard.recordings import SessionRecordings

LeftOut = Mapping[Side, tuple[float, ...]]


class StrideChoice(QObject):
    """States what is required; the library follows, and `SessionRecordings.changed` is emitted when it has."""

    offered = Signal(str, object)  # what was done, and what undoes it

    def __init__(self, recordings: "SessionRecordings", parent: QObject) -> None:
        super().__init__(parent)
        self._recordings = recordings

    def turn(self, walk: str, line: "StrideLine", is_left_out: bool) -> None:
        """Leave one stride out, or take it in again."""
        recording = self._recording(walk)
        if recording is None:
            return
        before = self._recordings.stated(recording).left_out_s
        others = tuple(time_s for time_s in before.get(line.side, ()) if not line.start_s <= time_s < line.end_s)
        middle_s = (line.start_s + line.end_s) / 2
        times_s = tuple(sorted((*others, middle_s))) if is_left_out else others
        reported = tr("{stride} of {walk} is excluded.") if is_left_out else tr("{stride} of {walk} is included again.")
        stated = reported.format(stride=line.name, walk=self._called(walk))
        self._change(recording, {**before, line.side: times_s}, stated)

    def take_all_in(self, walk: str) -> None:
        """Let all strides of a walk count that were left out by hand."""
        if (recording := self._recording(walk)) is not None:
            stated = tr("All usable strides of {walk} are included.").format(walk=self._called(walk))
            self._change(recording, {}, stated)

    def _change(self, recording: "SessionRecording", left_out_s: LeftOut, reported: str) -> None:
        before = self._recordings.stated(recording).left_out_s
        self._move(recording.id, before, left_out_s)
        self.offered.emit(reported[:1].upper() + reported[1:], self._undoing(recording.id, left_out_s, before))

    def _undoing(self, recording_id: UUID, after: LeftOut, before: LeftOut) -> Callable[[], None]:
        return lambda: self._move(recording_id, after, before)

    def _move(self, recording_id: UUID, one: LeftOut, other: LeftOut) -> None:
        """Change what is left out as from `one` to `other`; no other stride becomes anything else."""
        recording = next((recording for recording in self._recordings.walks if recording.id == recording_id), None)
        if recording is None:
            return
        now = self._recordings.stated(recording).left_out_s
        required = {}
        for side in Side:
            held, before, after = (set(times_s.get(side, ())) for times_s in (now, one, other))
            required[side] = tuple(sorted((held | (after - before)) - (before - after)))
        left_out_s = {side: times_s for side, times_s in required.items() if times_s}
        self._recordings.change(recording, lambda reported: replace(reported, left_out_s=left_out_s))

    def _recording(self, walk: str) -> "SessionRecording | None":
        return next((recording for recording in self._recordings.walks if recording.details.name == walk), None)

    def _called(self, walk: str) -> str:
        return str(self._recordings.shown_names[walk])

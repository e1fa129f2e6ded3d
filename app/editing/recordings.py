"""Recordings that have ended, as they are edited: kept or not, conditions, corrections."""

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.editing.edited_record import EditedRecord
from app.editing.session_recording import SessionRecording
from app.storage.edited_fields import KEPT, with_recording_fields
from app.storage.stored import StoredRecording
from app.storage.three_way import Edited, Values
from app.wording.translation import capitalised
from app.workers.library_controller import LibraryController
from core.session import Recording

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary


class RecordingEdits(EditedRecord[StoredRecording]):
    """The library answers in the order of asking.

    Parameters
    ----------
    find
        Gives a recording as it is shown on the screen, by its id.
    name_of
        Gives what one is called there, by its name.

    Signals
    -------
    saved
        A StoredRecording as the library has it now.
    """

    saved = Signal(object)

    def __init__(
        self,
        controller: LibraryController,
        find: Callable[[UUID], SessionRecording | None],
        name_of: Callable[[str], str],
        parent: QObject,
    ) -> None:
        super().__init__(controller, parent)
        self._find, self._name_of = find, name_of
        self._saying: deque[tuple[UUID, Recording | None]] = deque()  # entered and not answered yet, oldest first

    def is_saving(self, recording_id: UUID) -> bool:
        """Whether something that was stated about a recording is still to be answered."""
        return any(stated == recording_id for stated, _ in self._saying)

    def stated(self, recording: SessionRecording) -> Recording:
        """What is stated about a recording: what is to be saved last, or what is saved."""
        saying = (
            reported for stated, reported in reversed(self._saying) if reported is not None and stated == recording.id
        )
        return next(saying, recording.details)

    def save(self, recording_id: UUID, base: Values, stated: Values) -> None:
        """Save what is `stated`, based on the values that stood on the screen."""
        self._say(recording_id, stated, lambda opened: opened.library.edits.recording(recording_id, base, stated))

    def decide(self, recording_id: UUID, is_kept: bool) -> None:
        """Give the answer that was asked for: nobody is asked again, at the next start either."""
        self._say(recording_id, {KEPT: is_kept}, lambda opened: opened.library.edits.decision(recording_id, is_kept))

    def _say(
        self, recording_id: UUID, stated: Values, call: "Callable[[OpenedLibrary], Edited[StoredRecording]]"
    ) -> None:
        recording = self._find(recording_id)
        reported = with_recording_fields(self.stated(recording), stated) if recording is not None else None
        self._saying.append((recording_id, reported))
        self._run(call, self._on_saved)

    def _called(self, stored: StoredRecording) -> str:
        return capitalised(self._name_of(stored.details.name))

    def _choose(self, stored: StoredRecording, base: Values, stated: Values) -> None:
        self.save(stored.id, base, stated)
        self.changed.emit()

    def _on_saved(self, edited: Edited[StoredRecording]) -> None:
        self._saying.popleft()
        self.saved.emit(edited.stored)
        self._show_message(edited)
        self._ask(edited)

    def _on_refused(self, what: str, remedy: str) -> None:
        self._saying.popleft()
        self.changed.emit()
        super()._on_refused(what, remedy)

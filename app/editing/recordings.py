"""What is said of recordings once they have ended, on its way into the library: kept or not, conditions, corrections.

What was said last holds on the screen at once. What another station changed of the same meanwhile is merged and told;
where both changed the same, it is asked which holds.
"""

import datetime
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.editing.question import EditQuestion, chosen_fields
from app.editing.session_recording import SessionRecording
from app.editing.words import others_message
from app.storage.edited_fields import KEPT, with_recording_fields
from app.storage.stored import StoredRecording
from app.storage.three_way import Contest, Edited, Values
from app.wording.translation import capitalised
from app.workers.library_controller import LibraryController
from core.samples import Recording

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary


class RecordingEdits(QObject):
    """The library answers in the order of asking.

    Parameters
    ----------
    find
        Gives a recording as it stands on the screen, by its id.
    called
        Gives what one is called there, by its name.

    Signals
    -------
    saved
        A StoredRecording as the library has it now.
    settled
        Nothing more is on its way of what was refused, or was chosen of two values.
    refused
        What the library refused, and what to do.
    merged
        What another station changed meanwhile, in two sentences.
    asked
        An EditQuestion: what both changed.
    """

    saved = Signal(object)
    settled = Signal()
    refused = Signal(str, str)
    merged = Signal(str, str)
    asked = Signal(object)

    def __init__(
        self,
        controller: LibraryController,
        find: Callable[[UUID], SessionRecording | None],
        called: Callable[[str], str],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._controller, self._find, self._called = controller, find, called
        self._saying: deque[tuple[UUID, Recording | None]] = deque()  # said and not answered yet, oldest first

    def is_saving(self, recording_id: UUID) -> bool:
        """Whether something that was said of a recording is still to be answered."""
        return any(said == recording_id for said, _ in self._saying)

    def said(self, recording: SessionRecording) -> Recording:
        """What is told of a recording: what is to be saved last, or what is saved."""
        saying = (told for said, told in reversed(self._saying) if told is not None and said == recording.id)
        return next(saying, recording.details)

    def save(self, recording_id: UUID, upon: Values, said: Values) -> None:
        """Save what is `said` upon the values that stood on the screen."""

        def save(opened: "OpenedLibrary") -> Edited[StoredRecording]:
            return opened.library.edits.recording(recording_id, upon, said)

        self._say(recording_id, said, save)

    def decide(self, recording_id: UUID, is_kept: bool) -> None:
        """Give the answer that was asked for: nobody is asked again, at the next start either."""

        def decide(opened: "OpenedLibrary") -> Edited[StoredRecording]:
            return opened.library.edits.decision(recording_id, is_kept)

        self._say(recording_id, {KEPT: is_kept}, decide)

    def _say(
        self, recording_id: UUID, said: Values, call: "Callable[[OpenedLibrary], Edited[StoredRecording]]"
    ) -> None:
        recording = self._find(recording_id)
        told = with_recording_fields(self.said(recording), said) if recording is not None else None
        self._saying.append((recording_id, told))
        self._controller.run(call, self._on_saved, self._on_refused, self)

    def _settle(self, recording_id: UUID, contests: Sequence[Contest], fields: frozenset[str]) -> None:
        """Save what was chosen of both sides."""
        upon, said = chosen_fields(contests, fields)
        if said:
            self.save(recording_id, upon, said)
        self.settled.emit()

    def _on_saved(self, edited: Edited[StoredRecording]) -> None:
        self._saying.popleft()
        stored = edited.stored
        self.saved.emit(stored)
        called = capitalised(self._called(stored.details.name))
        if edited.others:
            self.merged.emit(*others_message(called, edited.others, datetime.datetime.now().astimezone()))
        if edited.contests:
            self.asked.emit(EditQuestion(called, edited.contests, partial(self._settle, stored.id, edited.contests)))

    def _on_refused(self, what: str, remedy: str) -> None:
        self._saying.popleft()
        self.settled.emit()
        self.refused.emit(what, remedy)

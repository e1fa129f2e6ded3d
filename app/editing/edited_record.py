"""What is edited here and may be edited at another station meanwhile: how it is saved, merged, asked about and settled.

What was typed last holds on the screen at once. The library merges it with what another station changed; where both
changed the same, theirs holds until somebody has chosen.
"""

import datetime
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Generic, TypeVar

from PySide6.QtCore import QObject, Signal

from app.editing.question import EditQuestion
from app.editing.words import others_message
from app.storage.three_way import Edited, MergeConflict, Values
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

T = TypeVar("T")
Answer = TypeVar("Answer")


class EditedRecord(QObject, Generic[T]):
    """Edits of a `T` of the library. What is edited differs by two methods, `_called` and `_choose`."""

    changed = Signal()  # what is on the screen, or how far it is saved
    refused = Signal(str, str)  # what the library refused, and what to do
    merged = Signal(str, str)  # what another station changed of the same meanwhile, in two sentences
    asked = Signal(object)  # an EditQuestion: what both changed

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller

    def _called(self, stored: T) -> str:
        """What is edited, as a sentence begins with it."""
        raise NotImplementedError

    def _choose(self, stored: T, base: Values, stated: Values) -> None:
        """Save what was chosen in a question: what it showed of the other side, and what is to hold instead."""
        raise NotImplementedError

    def _on_refused(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)

    def _run(self, call: "Callable[[OpenedLibrary], Answer]", done: Callable[[Answer], None]) -> None:
        """Let the library's thread make `call`, which holds values only: no QObject may end in that thread."""
        self._controller.run(call, done, self._on_refused, self)

    def _show_message(self, edited: Edited[T]) -> None:
        if edited.others:
            now = datetime.datetime.now().astimezone()
            self.merged.emit(*others_message(self._called(edited.stored), edited.others, now))

    def _ask(self, edited: Edited[T]) -> None:
        if edited.contests:
            settle = partial(self._settle, edited.stored, edited.contests)
            self.asked.emit(EditQuestion(self._called(edited.stored), edited.contests, settle))

    def _settle(self, stored: T, contests: Sequence[MergeConflict], fields: frozenset[str]) -> None:
        """Choose our own value in `fields`; a change made after the question leads to another question."""
        required = [contest for contest in contests if contest.field in fields]
        if required:
            self._choose(stored, {one.field: one.theirs for one in required}, {one.field: one.mine for one in required})
        else:
            self.changed.emit()

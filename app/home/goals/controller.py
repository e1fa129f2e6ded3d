"""What leads to the page of a patient's goals, and what of it is kept in the library."""

import datetime
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.editing.words import by_words, field_word
from app.home.goals.goals_page import GoalDraft, GoalsPage
from app.storage.edited_fields import goal_field, patient_fields
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from core.goals import Goal, GoalKey, taken_back, with_goal

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import StoredPatient
    from app.storage.three_way import Edited


def today() -> datetime.date:
    return datetime.datetime.now().astimezone().date()


class GoalsOfPatient(QObject):
    """One patient at a time."""

    kept = Signal()  # a goal holds, or holds no longer
    reported = Signal(str, str)  # what could not be done, and what to do

    def __init__(
        self,
        controller: LibraryController,
        parent: QObject,
        now: Callable[[], datetime.date] = today,
    ) -> None:
        super().__init__(parent)
        self._controller, self._now = controller, now
        self._patient: StoredPatient | None = None
        self._is_busy = False
        self.page = GoalsPage()
        self.page.agreed.connect(self._on_agreed)
        self.page.taken_back.connect(self._on_taken_back)

    @property
    def bar(self) -> BarState:
        return BarState(BarAction(tr("Add this goal"), self.page.submit, tr("Enter"), Icon.CHECK))

    def begin(self, patient: "StoredPatient") -> None:
        """Show what was agreed with a patient."""
        self._patient = patient
        self.page.show_patient(patient.details.code)
        self.page.show_goals(patient.details.goals)
        self._read()

    def forget(self) -> None:
        """Keep nothing of any patient."""
        self._patient = None
        self.page.show_patient("")

    def _read(self) -> None:
        """Show them as the library has them by now."""
        assert self._patient is not None  # who asks has one
        patient_id = self._patient.id

        def read(opened: "OpenedLibrary") -> "StoredPatient":
            return opened.library.patients.get(patient_id)

        self._controller.run(read, self._on_read, self._on_refused, self)

    def _on_read(self, stored: "StoredPatient") -> None:
        if self._patient is not None and stored.id == self._patient.id:
            self._patient = stored
            self.page.show_goals(stored.details.goals)

    def _on_agreed(self, draft: GoalDraft) -> None:
        day, until = self._now(), None
        if draft.weeks is not None:
            until = day + datetime.timedelta(weeks=draft.weeks)
        goal = Goal(
            draft.column, draft.of, draft.value, day, self._operator, draft.is_at_most, note=draft.note, until=until
        )
        self._save(goal.key, lambda goals: with_goal(goals, goal))

    def _on_taken_back(self, key: GoalKey) -> None:
        day, by = self._now(), self._operator
        self._save(key, lambda goals: taken_back(goals, key, day, by))

    @property
    def _operator(self) -> str:
        state = self._controller.state
        return state.operator.name if state is not None else ""

    def _save(self, key: GoalKey, change: Callable[[Sequence[Goal]], tuple[Goal, ...]]) -> None:
        """Set what is to hold of one figure, based on what was shown of it."""
        if self._patient is None or self._is_busy:
            return
        patient_id, reported, field = self._patient.id, self._patient.details, goal_field(key)
        base, stated = (
            patient_fields(reported)[field],
            patient_fields(replace(reported, goals=change(reported.goals)))[field],
        )
        self._is_busy = True

        def save(opened: "OpenedLibrary") -> "Edited[StoredPatient]":
            return opened.library.edits.patient(patient_id, {field: base}, {field: stated})

        self._controller.run(save, self._on_saved, self._on_refused, self)

    def _on_saved(self, edited: "Edited[StoredPatient]") -> None:
        self._is_busy = False
        self._on_read(edited.stored)
        if edited.contests:
            contest = edited.contests[0]
            now = datetime.datetime.now().astimezone()
            what = tr("{goal} was changed in the meantime ({who}). That change stays.")
            stated = what.format(goal=field_word(contest.field), who=by_words(contest.by, contest.at, now))
            self.reported.emit(stated, tr("Check the current value. Your value is in the history."))
        else:
            self.page.show_agreed()
        self.kept.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self._is_busy = False
        self.reported.emit(what, remedy)

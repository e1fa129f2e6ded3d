"""What the patient's earlier visits have of timed tests, as it was kept for the course: nothing is evaluated for
it."""

import datetime
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.summary.course import Course, CourseTest, timed_tests_of
from app.summary.course_lanes import CourseVisit
from app.wizard.resuming import current_courses
from app.wording.patients import time_of_session

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.wizard.visit import Visit


class EarlierTests(QObject):
    """Read once for each session. `changed`: they are there now."""

    changed = Signal()

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._session_id: UUID | None = None
        self._visits: tuple[CourseVisit, ...] = ()

    def read(self) -> None:
        """Ask the library for the visits before this one, unless they are known."""
        session = self._visit.session
        if session is None or session.id == self._session_id:
            return
        self._session_id, self._visits = session.id, ()
        patient_id, own_id, started = session.patient_id, session.id, session.details.started

        def read(opened: "OpenedLibrary") -> tuple[CourseVisit, ...]:
            now = datetime.datetime.now().astimezone()
            before = [
                line
                for line in reversed(opened.library.sessions.list(patient_id))
                if line.id != own_id and line.started < started
            ]
            courses = current_courses(opened.library, [line.id for line in before])
            return tuple(
                CourseVisit(line.id, at.date(), courses[line.id], f"{at:%H:%M}")
                for line in before
                if line.id in courses and (at := time_of_session(line.started, now)) is not None
            )

        self._visit.controller.run(read, self._on_read, self._on_refused, self)

    def latest(self, column: str, condition: str) -> tuple[CourseVisit, CourseTest] | None:
        """The latest earlier visit that has a test under a condition."""
        for visit in reversed(self._visits):
            walked = visit.course.condition(condition) if visit.course is not None else None
            test = walked.test(column) if walked is not None else None
            if test is not None and test.is_reported:
                return visit, test
        return None

    def with_this_one(self) -> tuple[CourseVisit, ...]:
        """All visits with their tests in order of time, this one the last; none where its day is not known."""
        session, evaluation = self._visit.session, self._visit.evaluation
        if session is None or evaluation.analysis is None or evaluation.session is None:
            return ()
        at = time_of_session(session.details.started, datetime.datetime.now().astimezone())
        if at is None:
            return ()
        conditions = timed_tests_of(evaluation.analysis, evaluation.session.recordings)
        course = Course(evaluation.analysis.affected_side, conditions)
        return (*self._visits, CourseVisit(session.id, at.date(), course, f"{at:%H:%M}"))

    def _on_read(self, found: tuple[CourseVisit, ...]) -> None:
        self._visits = found
        if found:
            self.changed.emit()

    def _on_refused(self, _what: str, _remedy: str) -> None:
        """No harm: what was before is not shown. It is asked for again when the step is entered again."""
        self._session_id = None

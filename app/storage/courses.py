"""The figures of each visit that stand in the patient's course, kept beside the session."""

import logging
from collections.abc import Collection
from uuid import UUID

from sqlalchemy import select

from app.storage.database.models import CourseRow
from app.storage.sessions import existing_session
from app.storage.stored import Role
from app.storage.unit_of_work import UnitOfWork
from app.summary.course import Course, course_from_json, course_in_json

_log = logging.getLogger(__name__)


class Courses:
    """One row per session, replaced when it is evaluated again."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def find(self, session_ids: Collection[UUID]) -> dict[UUID, tuple[str, Course]]:
        """Key and figures of those sessions that have some; the key shows whether they still hold (`kept_courses`)."""
        found = {}
        with self._unit.reading() as session:
            for row in session.scalars(select(CourseRow).where(CourseRow.session_id.in_(session_ids))):
                try:
                    found[row.session_id] = row.key, course_from_json(row.content)
                except ValueError:
                    _log.info("a course of another version is computed again")
        return found

    def keep(self, session_id: UUID, key: str, course: Course) -> None:
        """Replace a session's kept course, as any reader of the session may; raises LibraryError."""
        content = course_in_json(course)
        with self._unit.reading() as session:
            row = session.get(CourseRow, session_id)
            if row is not None and (row.key, row.content) == (key, content):
                return
        with self._unit.writing(Role.VIEWER) as session:
            existing_session(session, session_id)
            session.merge(CourseRow(session_id=session_id, key=key, content=content))

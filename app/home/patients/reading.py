"""What home shows of one patient: read from the library on its thread, and nothing is evaluated for it."""

import datetime
import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING
from uuid import UUID

from app.home.patients.lines import session_line
from app.storage.journal.header import JournalRefusedError
from app.storage.stored import LibraryError, SessionSummary
from app.summary.course import Course
from app.summary.course_lanes import CourseVisit, usual_condition
from app.summary.course_words import LatestVisit, NextStep, next_step, undecided_step
from app.summary.goals import reached_at
from app.summary.progress_words import ProgressWords, progress_words
from app.system.progress import Report
from app.widgets.line_list import SessionLine
from app.wizard.resuming import current_courses, read_analysed
from app.wording.patients import day_of_session, time_of_session, when
from core.goals import Goal, held

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class PatientReading:
    """The sessions of a patient, latest first, and by id what is known of them.

    `undecided`: those with a walk that nobody has kept or discarded yet. `courses`: figures that still hold.
    `reported`: those whose report was written. `goals`: all that were agreed, those that ended, too.
    """

    patient_id: UUID
    sessions: tuple[SessionSummary, ...]
    undecided: frozenset[UUID]
    courses: Mapping[UUID, Course]
    reported: frozenset[UUID]
    goals: tuple[Goal, ...] = ()
    has_video_consent: bool = False

    def visits(self, now: datetime.datetime) -> tuple[CourseVisit, ...]:
        """Those with a day, in order of time; without those that are known to hold no walk."""
        found = []
        for session in reversed(self.sessions):
            at, course = time_of_session(session.started, now), self.courses.get(session.id)
            if at is not None and session.recordings and (course is None or course.conditions):
                found.append(CourseVisit(session.id, at.date(), course, f"{at:%H:%M}"))
        return tuple(sorted(found, key=lambda visit: visit.day))

    @property
    def is_simulated(self) -> bool:
        """Whether one of the sessions is."""
        return any(one.is_simulated for one in self.sessions)

    def progress(self, now: datetime.datetime) -> ProgressWords:
        """The last change, under the usual condition."""
        visits = self.visits(now)
        return progress_words(visits, usual_condition(visits), self.goals)

    def lines(self, now: datetime.datetime) -> list[SessionLine]:
        return [
            session_line(one, now, self.undecided, self.courses.get(one.id), is_reported=one.id in self.reported)
            for one in self.sessions
        ]

    def next_step(self, now: datetime.datetime) -> NextStep | None:
        """What is to be done next."""
        days = {one.id: day_of_session(one.started, now) for one in self.sessions}
        waiting = next((one.id for one in self.sessions if one.id in self.undecided), None)
        undecided = undecided_step(waiting, days[waiting]) if waiting is not None else None
        visits = self.visits(now)
        if not visits:
            return undecided
        last = visits[-1]
        conditions = last.course.conditions if last.course is not None else ()
        not_reported = dict.fromkeys(joint for one in conditions for joint in one.not_reported)
        has_walk = last.course is not None and bool(conditions)
        before = [goal for goal in held(self.goals) if goal.is_chosen_before(last.day)]
        reached = reached_at(before, last.course) if last.course is not None else ()
        at = next(when(one.started, now) for one in self.sessions if one.id == last.id)
        latest = LatestVisit(last.id, last.day, at, tuple(not_reported), has_walk, last.id in self.reported, reached)
        return next_step(undecided, latest, now.date())


def read_patient(opened: "OpenedLibrary", patient_id: UUID) -> PatientReading:
    """Read the sessions of a patient, with the figures that were kept of them as far as they still hold."""
    library = opened.library
    sessions = library.sessions.list(patient_id)
    undecided = frozenset(
        walk.recording.session_id for walk in library.recordings.undecided() if walk.patient_id == patient_id
    )
    ids = [session.id for session in sessions]
    goals = library.patients.get(patient_id).details.goals
    reported, courses = library.audit.reported(ids), current_courses(library, ids)
    has_consent = library.clips.consent(patient_id).is_given
    return PatientReading(patient_id, sessions, undecided, courses, reported, goals, has_consent)


def compute_courses(opened: "OpenedLibrary", session_ids: Sequence[UUID], report: Report) -> int:
    """Evaluate sessions to keep what the course shows of them; give how many could not be read."""
    unread = 0
    for number, session_id in enumerate(session_ids):
        at = number / len(session_ids)

        def known(share: float, what: str, at: float = at) -> None:
            report(at + share / len(session_ids), what)

        try:
            read_analysed(opened, session_id, known)
        except (LibraryError, JournalRefusedError, OSError) as problem:
            _log.warning("a session could not be computed", exc_info=problem)
            unread += 1
    return unread

"""A patient and a session as a line of the home page's lists."""

import datetime
from collections.abc import Collection
from typing import TYPE_CHECKING
from uuid import UUID

from app.summary.course import Course
from app.summary.progress_words import ProgressWords
from app.widgets.line_list import PatientLine, SessionLine
from app.wording.dates import date
from app.wording.patients import day_of_session, person, when, when_in_brief
from app.wording.recordings import name_in_words
from app.wording.translation import tr, tr_n

if TYPE_CHECKING:
    from app.storage import stored


def patient_line(
    patient: "stored.StoredPatient", now: datetime.datetime, is_undecided: bool, progress: ProgressWords | None = None
) -> PatientLine:
    """One patient in the list; `progress` where it is known already, which gives the last change."""
    reported = patient.details
    who = person(reported)
    looked_into = " ".join([reported.code, str(reported.birth_year or ""), reported.device, reported.aids, who])
    return PatientLine(
        patient.id,
        reported.code,
        who,
        when_in_brief(patient.last_session, now) if patient.last_session or patient.sessions else tr("no session yet"),
        tr_n("{count} session", "{count} sessions", patient.sessions).format(count=patient.sessions),
        looked_into.casefold(),
        is_undecided,
        change=tr("One visit") if patient.sessions == 1 else progress.brief if progress is not None else "",
        arrow=progress.arrow if progress is not None else None,
    )


def session_line(
    line: "stored.SessionSummary",
    now: datetime.datetime,
    undecided: Collection[UUID],
    course: Course | None = None,
    *,
    is_reported: bool = False,
) -> SessionLine:
    """One session in a list; `course` where it is known, which gives how many strides there are."""
    is_undecided, has_walk = line.id in undecided, course is not None and bool(course.conditions)
    amount = tr_n("{count} recording", "{count} recordings", line.recordings).format(count=line.recordings)
    if course is not None and has_walk:
        strides = sum(condition.strides for condition in course.conditions)
        amount = tr_n("{count} stride", "{count} strides", strides).format(count=strides)
    state, written = tr("simulated") if line.is_simulated else "", None
    if is_undecided:
        state = tr("include or exclude?")
    elif is_reported or has_walk:
        state, written = tr("Report written") if is_reported else tr("Report pending"), is_reported
    day, stated = day_of_session(line.started, now), when(line.started, now)
    whole = date(day) if day is not None else stated
    conditions = "; ".join(map(name_in_words, line.conditions))  # which may hold commas
    return SessionLine(
        line.id,
        whole,
        conditions,
        amount,
        state,
        is_undecided,
        ago=stated if stated != whole else "",
        is_reported=written,
    )

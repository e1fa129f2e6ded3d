"""A patient and a session as a line of the home page's lists."""

import datetime
from collections.abc import Collection
from typing import TYPE_CHECKING
from uuid import UUID

from app.summary.course import Course
from app.theme.icons import Icon
from app.widgets.line_list import PatientLine, SessionLine
from app.wording.patients import person, when
from app.wording.recordings import name_in_words
from app.wording.translation import tr, tr_n

if TYPE_CHECKING:
    from app.storage import stored


def patient_line(patient: "stored.StoredPatient", now: datetime.datetime, is_undecided: bool) -> PatientLine:
    reported = patient.details
    who = person(reported)
    looked_into = " ".join([reported.code, str(reported.birth_year or ""), reported.device, reported.aids, who])
    return PatientLine(
        patient.id,
        reported.code,
        who,
        when(patient.last_session, now) if patient.last_session or patient.sessions else tr("no session yet"),
        tr_n("{count} session", "{count} sessions", patient.sessions).format(count=patient.sessions),
        looked_into.casefold(),
        is_undecided,
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
    state, mark = (tr("simulated"), None) if line.is_simulated else ("", None)
    if is_undecided:
        state = tr("include or exclude?")
    elif is_reported:
        state, mark = tr("report saved"), Icon.CHECK
    elif has_walk:
        state, mark = tr("report not saved"), Icon.INFO
    conditions = "; ".join(map(name_in_words, line.conditions))  # which may hold commas
    return SessionLine(line.id, when(line.started, now), conditions, amount, state, is_undecided, mark)

"""How are patients and sessions said in one line?"""

import datetime
from collections.abc import Collection
from typing import TYPE_CHECKING
from uuid import UUID

from app.home.patients.home_lists import PatientLine, SessionLine
from app.summary.course import Course
from app.theme.icons import Icon
from app.wording.dates import date
from app.wording.translation import tr, tr_n

if TYPE_CHECKING:
    from app.storage import stored
    from core.samples import Patient


def patient_line(patient: "stored.StoredPatient", now: datetime.datetime, is_undecided: bool) -> PatientLine:
    told = patient.details
    who = person(told)
    looked_into = " ".join([told.code, str(told.birth_year or ""), told.device, told.aids, who])
    return PatientLine(
        patient.id,
        told.code,
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
    """One session in a list; `course` where it is known, which tells how many strides there are."""
    is_undecided, has_walk = line.id in undecided, course is not None and bool(course.conditions)
    amount = tr_n("{count} recording", "{count} recordings", line.recordings).format(count=line.recordings)
    if course is not None and has_walk:
        strides = sum(condition.strides for condition in course.conditions)
        amount = tr_n("{count} stride", "{count} strides", strides).format(count=strides)
    state, mark = (tr("simulated"), None) if line.is_simulated else ("", None)
    if is_undecided:
        state = tr("keep or discard?")
    elif is_reported:
        state, mark = tr("report written"), Icon.CHECK
    elif has_walk:
        state, mark = tr("report not written"), Icon.INFO
    conditions = "; ".join(line.conditions)  # which may hold commas
    return SessionLine(line.id, when(line.started, now), conditions, amount, state, is_undecided, mark)


def day_of_session(started: str, now: datetime.datetime) -> datetime.date | None:
    """The day of a time as a file holds it, where `now` is; None for what is no time."""
    at = time_of_session(started, now)
    return at.date() if at is not None else None


def time_of_session(started: str, now: datetime.datetime) -> datetime.datetime | None:
    """A time as a file holds it, where `now` is; None for what is no time."""
    try:
        at = datetime.datetime.fromisoformat(started)
    except ValueError:
        return None
    return at.astimezone(now.tzinfo) if at.tzinfo is not None else at


def person(patient: "Patient") -> str:
    """Say what the clinic typed of a patient, but for code and device."""
    sexes = {"female": tr("female"), "male": tr("male")}
    sides = {"left": tr("left"), "right": tr("right"), "both": tr("both sides")}
    side = ""
    if patient.prosthetic_side in sides:
        side = tr("{side} prosthetic").format(side=sides[patient.prosthetic_side])
    elif patient.affected_side in sides:
        side = tr("{side} affected").format(side=sides[patient.affected_side])
    born = ", ".join(filter(None, [str(patient.birth_year or ""), sexes.get(patient.sex, patient.sex)]))
    return " · ".join(filter(None, [born, side]))


def about_and_device(patient: "Patient") -> str:
    """What the clinic typed of a patient, in one line beside the code."""
    return " · ".join(filter(None, [person(patient), patient.device]))


def when(started: str, now: datetime.datetime) -> str:
    """Say a time as a file holds it: "today 09:20", "yesterday", "24 Oct 2026"; what is no time stays as it is."""
    if not started:
        return tr("no date")
    try:
        at = datetime.datetime.fromisoformat(started)
    except ValueError:
        return started
    if at.tzinfo is not None:
        at = at.astimezone(now.tzinfo)
    days = (now.date() - at.date()).days
    if days == 0:
        return tr("today {time}").format(time=f"{at:%H:%M}")
    return tr("yesterday") if days == 1 else date(at.date())


def length(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes:02d}:{rest:02d}"

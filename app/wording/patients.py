"""Patients and the times of their sessions in words."""

import datetime
from typing import TYPE_CHECKING

from app.wording.dates import date
from app.wording.translation import tr

if TYPE_CHECKING:
    from core.session import Patient


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

"""Patients and the times of their sessions in words."""

import datetime
from typing import TYPE_CHECKING

from app.wording.dates import date, short_date
from app.wording.prostheses import worn_words
from app.wording.translation import later, tr, within_sentence

if TYPE_CHECKING:
    from core.session import Patient


AIDS = {  # as they stand in files
    "shoes": later("Shoes"),
    "barefoot": later("Barefoot"),
    "stick": later("Stick"),
    "crutches": later("Crutches"),
    "walker": later("Walker"),
    "parallel bars": later("Parallel bars"),
    "AFO": later("AFO"),
}


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
    born = ", ".join(filter(None, [str(patient.birth_year or ""), sexes.get(patient.sex, patient.sex)]))
    return " · ".join(filter(None, [born, _side(patient)]))


def _side(patient: "Patient") -> str:
    sides = {"left": tr("left"), "right": tr("right"), "both": tr("both sides")}
    if worn := worn_words(patient, is_whole=False):
        return " · ".join(worn)
    if patient.prosthetic_side in sides:
        return tr("{side} prosthetic").format(side=sides[patient.prosthetic_side])
    if patient.affected_side in sides:
        return tr("{side} affected").format(side=sides[patient.affected_side])
    return ""


def aids_in_words(aids: str) -> str:
    """Say which aids were worn: those that we offer in the user's language, others as they were typed."""
    known = {aid.lower(): within_sentence(tr(words)) for aid, words in AIDS.items()}
    known["afo"] = tr(AIDS["AFO"])  # an abbreviation stays one
    return ", ".join(known.get(aid.strip().lower(), aid.strip()) for aid in aids.split(","))


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


def when_in_brief(started: str, now: datetime.datetime) -> str:
    """The same without the year, where that is this year."""
    day = day_of_session(started, now)
    is_plain = day is not None and day.year == now.year and (now.date() - day).days > 1
    return short_date(day) if day is not None and is_plain else when(started, now)


def length(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes:02d}:{rest:02d}"

"""A library with a patient's course in it: four visits, two conditions, one joint that could not be read."""

import datetime
from pathlib import Path
from uuid import UUID

from app.storage.audit import REPORT_FORMAT, about
from app.storage.library import Library
from app.storage.stored import Action, RecordingState, StoredJournal
from app.summary.course import Course
from app.summary.course_lanes import CourseVisit
from app.wizard.resuming import current_course_key
from core.body import Joint
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.course_material import course, unsure, walked
from tests.quick_library import quick_library

PASSPHRASE = "four short words here"
SHOES, STICK = "Shoes", "Shoes, stick"
DAYS = ("2026-06-20", "2026-07-11", "2026-08-22", "2026-10-03", "2026-11-14")
SPEEDS_M_S = (0.71, 0.84, 0.97, 1.06, 1.12)
KNEES_DEG = (38.4, 41.2, 44.0, 47.1, 49.3)
STANCES_PERCENT = (53.9, 55.2, 56.4, 57.1, 57.9)
WITH_STICK = 3  # visits


def course_of_visit(number: int, *, is_knee_not_reported: bool = False) -> Course:
    """The visit of this number, with a stick as well at the first ones."""
    reported = unsure(Joint.LEFT_KNEE) if is_knee_not_reported else None
    speed_m_s, knee_deg, stance = SPEEDS_M_S[number], KNEES_DEG[number], STANCES_PERCENT[number]
    walk = walked(speed_m_s=speed_m_s, knee_deg=knee_deg, stance_percent=stance, reported=reported)
    if number >= WITH_STICK:
        return course((walk, SHOES), reported=reported)
    other = walked(
        "walk 2", speed_m_s=speed_m_s + 0.06, knee_deg=knee_deg + 2, stance_percent=stance, reported=reported
    )
    return course((walk, SHOES), (other, STICK), reported=reported)


VISITS = [
    CourseVisit(UUID(int=number), datetime.date.fromisoformat(day), course_of_visit(number))
    for number, day in enumerate(DAYS)
]


def add_visit(library: Library, patient_id: UUID, number: int, found: Course | None) -> UUID:
    """A session of one day with a walk of each condition, without its samples, and what is known of it."""
    day = datetime.datetime.fromisoformat(f"{DAYS[number]}T09:00:00")
    visit = library.sessions.create(patient_id, Session((), started=day.isoformat()))
    conditions = (SHOES,) if number >= WITH_STICK else (SHOES, STICK)
    for at, condition in enumerate(conditions, start=1):
        reported = Recording(f"walk {at}", RecordingKind.WALKING, f"walk_{at}", {}, condition=condition)
        recording = library.recordings.start(visit.id, reported, is_simulated=False)
        library.recordings.add_journal(recording.id, StoredJournal(recording.id, 0, None))
        library.recordings.close(recording.id, RecordingState.CLOSED, {0: ""})
    if found is not None:
        library.courses.keep(visit.id, current_course_key(library.sessions.get(visit.id)), found)
    return visit.id


def make_course_library(folder: Path, *, visits: int = 5, missing: frozenset[int] = frozenset()) -> Path:
    """A closed library of `hk`: a patient with `visits`, of which those `missing` are not computed, and another."""
    with quick_library(folder) as opened:
        library = opened.library
        for code, born, side in (("P-0147", 1968, "right"), ("P-0122", 1990, "right"), ("P-0107", 1962, "left")):
            library.patients.create(Patient(code=code, birth_year=born, affected_side=side))
        reported = Patient(
            code="P-0158", birth_year=1961, sex="female", affected_side="left", device="left knee replacement"
        )
        patient = library.patients.create(reported)
        for number in range(visits):
            found = None if number in missing else course_of_visit(number)
            session_id = add_visit(library, patient.id, number, found)
            if number < visits - 1:
                library.audit.note(Action.EXPORT, about("session", session_id), format=REPORT_FORMAT, is_document=True)
    return folder

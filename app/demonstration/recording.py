"""A visit of the demonstration's library as its sensors recorded it, and how it gets among the library's sessions."""

import datetime
import os
from dataclasses import replace
from uuid import UUID

from app.demonstration.patients import BY, ReportedOfWalk, SimulatedPatient, SimulatedVisit
from app.storage.audit import REPORT_FORMAT, about
from app.storage.exchange import import_session
from app.storage.opened import OpenedLibrary
from app.storage.stored import Action
from app.system.logs import version_of
from app.system.progress import nobody
from core.session import Recording, Session
from core.timed.protocols import PlannedTest

NICE = 5  # beside a live recording of a demonstration's patient nothing else is to be late
BETWEEN_WALKS = datetime.timedelta(minutes=2)


def record_visit(visit: SimulatedVisit) -> Session:
    """Let the patient move, and give what the sensors send, with what was stated about it."""
    from devices.simulation.replay import moved  # scipy, which home is not to wait for

    session = moved(visit.settings)
    recordings = tuple(
        _reported(recording, visit.reported.get(recording.name), visit.started + number * BETWEEN_WALKS)
        for number, recording in enumerate(session.recordings)
    )
    return replace(
        session,
        recordings=recordings,
        started=visit.started.isoformat(timespec="seconds"),
        operator=BY,
        software=f"gaitwright {version_of('gaitwright')}",
    )


def record_beside(visit: SimulatedVisit) -> Session:
    """The same in a process that lets the screen go first."""
    if hasattr(os, "nice") and os.nice(0) < NICE:
        os.nice(NICE)
    return record_visit(visit)


def add_patients(opened: OpenedLibrary, patients: tuple[SimulatedPatient, ...]) -> None:
    """Add patients without visits, the first last, as lists show the latest first; raises LibraryError."""
    for patient in reversed(patients):
        opened.library.patients.create(patient.details)


def take_in(opened: OpenedLibrary, visit: SimulatedVisit, session: Session) -> UUID:
    """Write a visit into the library's journals, its report only noted; raises as `import_session`."""
    known = opened.library.patients.find(visit.code)
    reported = replace(session, patient=known.details) if known is not None else session
    session_id = import_session(opened, reported, nobody, visit.code, limits=visit.limits).session_id
    if visit.is_reported:
        subject = about("session", session_id)
        opened.library.audit.note(Action.EXPORT, subject, format=REPORT_FORMAT, is_simulated=True)
    return session_id


def _reported(recording: Recording, reported: ReportedOfWalk | None, started: datetime.datetime) -> Recording:
    at = replace(recording, started=started.isoformat(timespec="seconds"))
    if reported is None:
        return at
    test = PlannedTest(reported.test) if reported.test is not None else None
    return replace(at, condition=reported.condition, alignment=reported.alignment, test=test)

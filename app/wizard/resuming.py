"""What the library holds of a session, read back for the screen: recordings, rests, and what came of them before."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple
from uuid import UUID

from app.cohort.repeatability.people import folded
from app.editing.session_recording import SessionRecording, counted
from app.storage.analysis_content import FORMAT, unpacked
from app.storage.exchange import recording_with_samples
from app.storage.kept_analyses import bare, find_analysis, inputs_of, keep_analysis
from app.storage.kept_courses import course_key, keep_course
from app.storage.stored import Limits, RecordingState, ResultKind, StoredPatient, StoredSession
from app.storage.videos.reader import open_clips
from app.summary.course import Course, course_of
from app.summary.course_lanes import CourseVisit
from app.summary.report_dates import date_of
from app.system.progress import Report
from core.analysis import analyse
from core.body import LEG_JOINTS
from core.calibration.rest import rest_of
from core.findings import Finding, Severity
from core.gait.chosen_strides import leave_out
from core.session import RecordingKind, Session
from devices.decoders import DECODERS

if TYPE_CHECKING:
    from app.storage.library import Library
    from app.storage.opened import OpenedLibrary
    from core.calibration.rest import Rest
    from core.results import Analysis
    from core.video.clip import Clip

USABLE = (RecordingState.CLOSED, RecordingState.RECOVERED)


class Resumed(NamedTuple):
    """A session of the library, and what came of it when it was computed last, if that is known."""

    patient: StoredPatient
    session: StoredSession
    recordings: tuple[SessionRecording, ...]
    known: "Analysis | None"


class EarlierVisit(NamedTuple):
    """A visit before this one: the session without samples, what came of it, and its videos that open."""

    session: Session
    analysis: "Analysis"
    clips: "tuple[Clip, ...]"


def read_session(opened: "OpenedLibrary", session_id: UUID) -> Resumed:
    """Read a session that somebody opens; raises as `exchange.session_with_samples`."""
    session = opened.library.sessions.view(session_id)
    recordings = read_recordings(opened, session)
    known = find_analysis(opened.library.results, session_id, evaluated(session, recordings))
    return Resumed(opened.library.patients.get(session.patient_id), session, recordings, known)


def read_analysed(opened: "OpenedLibrary", session_id: UUID, report: Report) -> "tuple[Session, Analysis]":
    """Read a session without samples, and its analysis: stored, or computed now and stored; less strides left out."""
    results, stored = opened.library.results, opened.library.sessions.get(session_id)
    reported = evaluated(stored, read_recordings(opened, stored))
    known = find_analysis(results, session_id, reported)
    if known is None:
        known = analyse(bare(reported), progress=report)
        keep_analysis(results, session_id, reported, known)
    return _keep_course(opened, stored, reported, known)


def read_earlier_visit(opened: "OpenedLibrary", session_id: UUID, report: Report) -> EarlierVisit:
    """Read a visit to be shown beside a later one; raises as `read_analysed`."""
    session, analysis = read_analysed(opened, session_id, report)
    return EarlierVisit(session, analysis, open_clips(opened, session_id)[0])


def sessions_of_condition(
    opened: "OpenedLibrary", condition: str
) -> "list[tuple[str, Callable[[Report], tuple[Session, Analysis]]]]":
    """The sessions with a walk of a condition, however it is written: what each is called, and what reads it."""
    return [
        (line.patient_code, partial(read_analysed, opened, line.id))
        for line in opened.library.sessions.list()
        if condition in map(folded, line.conditions)
    ]


def session_to_analyse(opened: "OpenedLibrary", session_id: UUID) -> "tuple[Session, Callable[[bytes], None]] | None":
    """Give a session with samples and what keeps its analysis, as `packed` writes it; None: it is kept already.

    What the patient's course needs of it is kept here; raises as `session_with_samples`.
    """
    stored = opened.library.sessions.get(session_id)
    reported = evaluated(stored, read_recordings(opened, stored))
    known = find_analysis(opened.library.results, session_id, reported)
    if known is not None:
        _keep_course(opened, stored, reported, known)
        return None
    without_samples, inputs = without_imu(reported), inputs_of(reported)

    def keep(content: bytes) -> None:
        opened.library.results.keep(session_id, ResultKind.ANALYSIS, inputs, FORMAT, content)
        _keep_course(opened, stored, without_samples, unpacked(content))

    return reported, keep


def without_imu(reported: Session) -> Session:
    return replace(reported, recordings=tuple(replace(recording, imu={}) for recording in reported.recordings))


def _keep_course(
    opened: "OpenedLibrary", stored: StoredSession, reported: Session, known: "Analysis"
) -> "tuple[Session, Analysis]":
    """Keep the course of a session; return the session without its samples, and what may be shown of it."""
    without_samples = without_imu(reported)
    analysis = leave_out(known, reported.recordings)
    key = course_key(without_samples, stored.recordings)
    keep_course(opened.library.courses, stored.id, key, course_of(analysis, reported.recordings))
    return without_samples, analysis


def current_course_key(session: StoredSession) -> str:
    """The key that what is kept of a session's course has to have, to hold for the session as stated now."""
    read_back = tuple(SessionRecording(one, one.details) for one in session.recordings if one.state in USABLE)
    return course_key(evaluated(session, read_back), session.recordings)


def current_courses(library: "Library", session_ids: Sequence[UUID]) -> dict[UUID, Course]:
    """What is kept of sessions' courses, as far as it still holds."""
    return {
        session_id: course
        for session_id, (key, course) in library.courses.find(session_ids).items()
        if key == current_course_key(library.sessions.get(session_id))
    }


def courses_before(opened: "OpenedLibrary", session: StoredSession) -> tuple[CourseVisit, ...]:
    """The patient's visits before this one in order of time, each with its course as far as that is known."""
    lines = opened.library.sessions.list(session.patient_id)  # latest first
    before = [line for line in reversed(lines) if line.id != session.id and line.started < session.details.started]
    found = current_courses(opened.library, [line.id for line in before])
    days = [(line.id, date_of(line.started)) for line in before]
    return tuple(CourseVisit(session_id, day, found.get(session_id)) for session_id, day in days if day is not None)


def course_to(
    before: Sequence[CourseVisit], stored: StoredSession, session: Session, analysis: "Analysis"
) -> tuple[CourseVisit, ...]:
    """The same with this visit at their end; none where there is no earlier one, or nobody knows this one's day."""
    day = date_of(session.started)
    if day is None or not before:
        return ()
    return (*before, CourseVisit(stored.id, day, course_of(analysis, session.recordings)))


def evaluated(session: StoredSession, recordings: Sequence[SessionRecording]) -> Session:
    """What is evaluated of a session of the library, as `Visit.evaluate` asks it when nothing is recorded."""
    return with_limits(replace(session.details, recordings=counted(recordings)), session.limits)


def with_limits(reported: Session, limits: Limits) -> Session:
    """With what no sensor shows of the patient's body, to be stated wherever the results are."""
    without = reported.patient.without_ankle(limits.without_ankle)
    rigid = [joint for joint in LEG_JOINTS if not joint.is_knee and joint.side in without]
    stated = tuple(Finding("foot_against_shank", Severity.INFO, str(joint)) for joint in rigid)
    return replace(reported, findings=(*reported.findings, *stated))


def read_recordings(opened: "OpenedLibrary", session: StoredSession) -> tuple[SessionRecording, ...]:
    """All recordings of a session that can be read, with their samples."""
    return tuple(
        SessionRecording(
            stored,
            recording_with_samples(opened, stored, DECODERS)[0],
            is_decided=stored.is_decided and not (stored.is_unjudged and stored.details.is_kept),
        )
        for stored in session.recordings
        if stored.state in USABLE
    )


def rests_of(recordings: Sequence[SessionRecording]) -> "dict[str, Rest]":
    """What each sensor reads at rest, by its name, as the latest standing shows."""
    rests: dict[str, Rest] = {}
    for recording in recordings:
        if (
            recording.details.kind is RecordingKind.STANDING
            and recording.read_back
            and recording.stored.placement
            and recording.details.is_kept
        ):
            worn = recording.stored.placement.sensors
            found = {worn[site].name: rest_of(block) for site, block in recording.read_back.imu.items() if site in worn}
            rests |= {name: rest for name, rest in found.items() if rest is not None}
    return rests

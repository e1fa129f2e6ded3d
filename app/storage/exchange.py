"""Bring a session into the library, and out of it, without losing a sample.

Samples become one journal per recording, one source per site; what `session.toml` states becomes rows. Both ways keep
every bit of a float64, and every key and column, those that mean nothing to us included.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from uuid import UUID

from app.storage.audit import about, canonical
from app.storage.database.ids import uuid7
from app.storage.journal.decoding import DecodedJournal, Decoders, decode
from app.storage.journal.disk import REPORTED, ROOM, Room, Trouble
from app.storage.journal.header import RESTORE, JournalRefusedError
from app.storage.journal.payloads import layout_of, with_keys
from app.storage.journal.writer import JournalSummary, JournalWriter, State
from app.storage.opened import OpenedLibrary
from app.storage.recovery import Interrupted
from app.storage.sessions import NO_LIMITS
from app.storage.stored import (
    Action,
    LibraryError,
    Limits,
    PlacedSensor,
    RecordingState,
    StoredJournal,
    StoredPatient,
    StoredRecording,
    StoredSession,
)
from app.system.progress import Report
from app.wording.translation import tr
from core.body import Site
from core.findings import Finding, Severity
from core.samples import ImuBlock, SensorInfo
from core.session import Recording, Session
from devices.files.imports import folder_for
from devices.files.session_toml import default_sensor
from devices.files.site_files import write_site
from devices.files.trial import SIMULATED_MARK
from devices.source import SourceInfo

DRIVER, VERSION = "session-folder", "1"
OWN_NAME = "sensor"  # the setting that holds what the folder calls the sensor
WHOLE = {"is_whole": True}  # of an export, in the audit: it was not broken off
READ_BACK = (RecordingState.CLOSED, RecordingState.RECOVERED)
PIECE_ROWS = 10_000  # so that a long recording is not held a second time


@dataclass(frozen=True, slots=True)
class Imported:
    """What came of an import. `differing`: what the library holds differently about the patient, and keeps."""

    session_id: UUID
    patient: StoredPatient
    differing: tuple[str, ...]


def import_session(
    opened: OpenedLibrary,
    session: Session,
    report: Report,
    code: str = "",
    room: Room = ROOM,
    limits: Limits = NO_LIMITS,
) -> Imported:
    """Import a session for the patient of `code`, else its own; on failure only a new patient stays.
    Raises LibraryError, JournalRefusedError (no room), FileRefusedError (file changed meanwhile), OSError.
    """
    library = opened.library
    required = replace(session.patient, code=code or session.patient.code)
    patient = library.patients.find(required.code) or library.patients.create(required)
    differing = tuple(
        name
        for name in type(required).__slots__
        if name not in ("code", "goals") and getattr(required, name) != getattr(patient.details, name)
    )
    if not set(required.goals) <= set(patient.details.goals):
        differing = (*differing, "goals")
    visit = library.sessions.create(patient.id, replace(session, recordings=(), sensors={}), limits)
    try:
        _import_recordings(opened, visit.id, session, report, room)
    except BaseException:
        with suppress(LibraryError):
            library.sessions.delete(library.sessions.get(visit.id))
        raise
    return Imported(visit.id, library.patients.get(patient.id), differing)


def session_with_samples(opened: OpenedLibrary, visit: StoredSession, decoders: Decoders, report: Report) -> Session:
    """Give a session with samples, without recordings that are destroyed or in progress.
    Raises JournalRefusedError (missing, damaged, another library's), LibraryError (no decoder) or OSError.
    """
    required = [recording for recording in visit.recordings if recording.state in READ_BACK]
    recordings, findings = [], list(visit.details.findings)
    for number, recording in enumerate(required):
        report(number / len(required), recording.details.name)
        read, noticed = recording_with_samples(opened, recording, decoders)
        recordings.append(read)
        findings += noticed
    return replace(visit.details, recordings=tuple(recordings), findings=tuple(findings))


def recording_with_samples(
    opened: OpenedLibrary, recording: StoredRecording, decoders: Decoders
) -> tuple[Recording, tuple[Finding, ...]]:
    """Give a recording with samples and findings; raises as `session_with_samples`, or LibraryError if gone."""
    paths = [opened.journal_path(journal) for journal in recording.journals]
    for path in paths:
        if not path.exists():
            opened.refuse_gone()
            raise JournalRefusedError(path.name, "this recording's file is missing", RESTORE)
    keys = [journal.wrapped_key for journal in recording.journals]
    decoded = decode(paths, opened.data_key, decoders, keys)
    _refuse_undecoded(recording.details.name, decoded)
    placement = recording.placement.site_of if recording.placement else {}
    read = decoded.recording(recording.details, placement)
    names = _own_names(decoded)
    imu = {site: replace(block, sensor=names.get(block.sensor, block.sensor)) for site, block in read.imu.items()}
    test = with_keys(read.test, ((mark.time_s, mark.text) for mark in decoded.marks))
    return replace(read, imu=imu, test=test), tuple(_file_findings(recording, decoded))


def export_orphan(opened: OpenedLibrary, orphan: Interrupted, folder: Path, decoders: Decoders, report: Report) -> None:
    """Write an orphan recording as one CSV file per sensor (sites unknown), audited before and after.
    Raises LibraryError (no decoder, not noted), JournalRefusedError (damaged, not this library's), OSError.
    """
    decoded = decode(list(orphan.segments.values()), opened.data_key, decoders)
    _refuse_undecoded(orphan.belonging.details.name if orphan.belonging else orphan.recording_id.hex, decoded)
    subject = about("recording", orphan.recording_id)
    opened.library.audit.note(Action.EXPORT, subject, format="one CSV per sensor")
    folder.mkdir(parents=True, exist_ok=True)
    names = _own_names(decoded)
    for number, (sensor, received) in enumerate(decoded.sensors.items()):
        report(number / len(decoded.sensors), sensor)
        write_site(received.block, folder / f"{folder_for(names.get(sensor, sensor))}.csv")
    if decoded.is_simulated:
        (folder / SIMULATED_MARK).write_text("Nobody was measured.\n", encoding="ascii")
    opened.library.audit.note(Action.EXPORT, subject, **WHOLE)


def was_exported(opened: OpenedLibrary, orphan: Interrupted) -> bool:
    """Whether all of an orphan is in files already, so that nobody has to be notified of it again."""
    reported = opened.library.audit.entries(about("recording", orphan.recording_id))
    return any(entry.action == Action.EXPORT and entry.details == canonical(WHOLE) for entry in reported)


def _refuse_undecoded(name: str, decoded: DecodedJournal) -> None:
    """Raise LibraryError where a driver of the journal is not known here."""
    if decoded.undecoded:
        what = tr("{recording} was recorded with {driver}, which this version cannot read")
        reported = what.format(recording=name, driver=decoded.undecoded[0])
        raise LibraryError(reported, "Install the Gaitwright version used for the recording, or a later one")


def _import_recordings(opened: OpenedLibrary, session_id: UUID, session: Session, report: Report, room: Room) -> None:
    known = _unique({site: default_sensor(session, site) for site in session.sensors})
    worn = _placed(session, known)
    if worn:  # a site that no recording has keeps what is known of its sensor
        opened.library.sessions.place(session_id, worn)
    for number, recording in enumerate(session.recordings):
        names = _unique({site: recording.imu[site].sensor for site in recording.imu})
        elsewhere = {site: name for site, name in known.items() if name not in names.values()}
        placed = _placed(session, elsewhere | names)
        if placed != worn:
            opened.library.sessions.place(session_id, placed)
            worn = placed

        def reported(share: float, number: int = number, name: str = recording.name) -> None:
            report((number + share) / len(session.recordings), name)

        _import_recording(opened, session_id, session, recording, names, reported, room)


def _import_recording(
    opened: OpenedLibrary,
    session_id: UUID,
    session: Session,
    recording: Recording,
    names: Mapping[Site, str],
    reported: Callable[[float], None],
    room: Room,
) -> None:
    recordings, recording_id = opened.library.recordings, uuid7()
    recordings.start(session_id, replace(recording, imu={}), session.is_simulated, recording_id)
    with JournalWriter.create(opened.recordings, recording_id, opened.data_key, room=room) as writer:
        header = writer.header
        recordings.add_journal(
            recording_id, StoredJournal(header.recording_id, header.segment, header.wrapped_key or None)
        )
        for done, (site, name) in enumerate(names.items()):
            block = recording.imu[site]
            info = SourceInfo(DRIVER, VERSION, "", (name,), {OWN_NAME: block.sensor}, session.is_simulated)
            source = writer.source(info, layout_of(block, session.sensors.get(site, SensorInfo()).rate_hz))
            for share, piece in _pieces(block):
                writer.samples(source, 0, piece, waits=True)
                reported((done + share) / len(names))
    summary = writer.stop()
    _refuse_incomplete(summary)
    recordings.close(recording_id, RecordingState.CLOSED, {header.segment: summary.sha256})


def _pieces(block: ImuBlock) -> Iterator[tuple[float, ImuBlock]]:
    """The block in parts, each with the share that is done with it; an empty block is one part."""
    for start in range(0, max(len(block), 1), PIECE_ROWS):
        end = start + PIECE_ROWS
        yield min(end / max(len(block), 1), 1.0), block.select(slice(start, end))


def _refuse_incomplete(summary: JournalSummary) -> None:
    """Raise LibraryError where the disk did not take everything."""
    if summary.state is State.CLOSED and not summary.dropped_records and summary.reason == "stopped":
        return
    what, remedy = REPORTED[Trouble(summary.reason)] if summary.reason in list(Trouble) else REPORTED[Trouble.DISK_GONE]
    raise LibraryError(what, remedy)


def _unique(names: Mapping[Site, str]) -> dict[Site, str]:
    """In the library one name is one sensor; a file may call two by the same."""
    unique: dict[Site, str] = {}
    for site, name in names.items():
        unique[site] = f"{name} ({site})" if name in unique.values() else name
    return unique


def _placed(session: Session, names: Mapping[Site, str]) -> dict[Site, PlacedSensor]:
    return {site: PlacedSensor(name, session.sensors.get(site, SensorInfo())) for site, name in names.items()}


def _file_findings(recording: StoredRecording, decoded: DecodedJournal) -> Iterator[Finding]:
    name = recording.details.name
    if recording.state is RecordingState.RECOVERED:
        yield Finding("recording_recovered", Severity.INFO, name)
    found = [report.sha256 for report in decoded.reports]
    if found != [journal.sha256 for journal in recording.journals]:
        yield Finding("recording_changed", Severity.WARNING, name)


def _own_names(decoded: DecodedJournal) -> dict[str, str]:
    """What a session folder called the sensors that have other names in the library."""
    return {
        source.sensors[0]: str(source.settings[OWN_NAME])
        for source in decoded.sources
        if source.driver == DRIVER and OWN_NAME in source.settings
    }

"""Turn rows into the plain values that leave `app.storage`."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session as OrmSession

from app.storage.database.models import OperatorRow, PatientRow, PlacementRow, RecordingRow, ResultRow, SessionRow
from app.storage.stored import (
    Limits,
    Operator,
    PlacedSensor,
    Placement,
    StoredJournal,
    StoredPatient,
    StoredRecording,
    StoredResult,
    StoredSession,
)
from core.alignment import alignment_of_text
from core.body import Side, Site
from core.findings import Finding, Severity
from core.goals import goals_of_text, goals_text
from core.prosthesis import prostheses_of_text, prostheses_text
from core.samples import SensorInfo
from core.session import Patient, Recording, Session
from core.timed.protocols import planned_of_text

PATIENT_FIELDS = tuple(field.name for field in fields(Patient) if field.name not in ("goals", "prostheses"))
SENSOR_FIELDS = tuple(field.name for field in fields(SensorInfo))
IN_OTHER_FORM = ("imu", "left_out_s", "alignment", "test")
RECORDING_FIELDS = tuple(field.name for field in fields(Recording) if field.name not in IN_OTHER_FORM)
SESSION_FIELDS = ("started", "operator", "surface", "notes", "software", "is_simulated", "unknown")


def reported_patient(row: PatientRow) -> Patient:
    return Patient(
        goals=goals_of_text(row.goals),
        prostheses=prostheses_of_text(row.prostheses),
        **{name: getattr(row, name) for name in PATIENT_FIELDS},
    )


def patient_in_row(reported: Patient, names: Sequence[str] = PATIENT_FIELDS) -> dict[str, object]:
    """Some fields of a patient, the goals and the prostheses, as the row holds them."""
    texts = {"goals": goals_text(reported.goals), "prostheses": prostheses_text(reported.prostheses)}
    return {name: getattr(reported, name) for name in names} | texts


def stored_patients(session: OrmSession, *is_required: ColumnElement[bool]) -> list[StoredPatient]:
    visits = (
        select(SessionRow.patient_id, func.count().label("count"), func.max(SessionRow.started).label("last"))
        .where(SessionRow.deleted_at.is_(None))
        .group_by(SessionRow.patient_id)
        .subquery()
    )
    required = (
        select(PatientRow, func.coalesce(visits.c.count, 0), func.coalesce(visits.c.last, ""))
        .outerjoin(visits, visits.c.patient_id == PatientRow.id)
        .where(*is_required)
    )
    return [
        StoredPatient(row.id, row.version, reported_patient(row), row.created_at, row.deleted_at, count, last)
        for row, count, last in session.execute(required)
    ]


def stored_patient(session: OrmSession, row: PatientRow) -> StoredPatient:
    (patient,) = stored_patients(session, PatientRow.id == row.id)
    return patient


def placement_of(row: PlacementRow) -> Placement:
    sensors = {
        sensor.site: PlacedSensor(sensor.name, SensorInfo(**{name: getattr(sensor, name) for name in SENSOR_FIELDS}))
        for sensor in row.sensors
    }
    return Placement(row.id, row.number, {site: sensors[site] for site in Site if site in sensors})


def stored_recording(row: RecordingRow) -> StoredRecording:
    return StoredRecording(
        row.id,
        row.version,
        row.session_id,
        Recording(
            imu={},
            left_out_s=left_out_of(row.left_out),
            alignment=alignment_of_text(row.alignment),
            test=planned_of_text(row.test),
            **{name: getattr(row, name) for name in RECORDING_FIELDS},
        ),
        row.state,
        row.is_simulated,
        placement_of(row.placement) if row.placement is not None else None,
        tuple(StoredJournal(row.id, j.segment, j.wrapped_key, j.sha256, j.kept_as) for j in row.journals),
        row.judged_by,
        row.is_decided,
    )


def left_out_in_row(left_out_s: Mapping[Side, Sequence[float]]) -> str:
    """Which strides were left out, as the row and its history hold it; empty where none was."""
    named = {side.value: sorted(left_out_s[side]) for side in Side if left_out_s.get(side)}
    return json.dumps(named, separators=(",", ":")) if named else ""


def left_out_of(in_row: str) -> dict[Side, tuple[float, ...]]:
    """What `left_out_in_row` was given."""
    return {Side(side): tuple(times_s) for side, times_s in json.loads(in_row or "{}").items()}


def stored_session(row: SessionRow) -> StoredSession:
    recordings = tuple(stored_recording(recording) for recording in row.recordings)
    placements = tuple(placement_of(placement) for placement in row.placements)
    worn: dict[Site, PlacedSensor] = {}
    for placement in placements:  # the latest word on each site
        worn |= placement.sensors
    reported = Session(
        recordings=tuple(recording.details for recording in recordings),
        patient=reported_patient(row.patient),
        sensors={site: worn[site].info for site in Site if site in worn and worn[site].info != SensorInfo()},
        zero_rad={joint.joint: joint.zero_rad for joint in row.joints if joint.zero_rad is not None},
        turned_sign={joint.joint: joint.turned_sign for joint in row.joints if joint.turned_sign is not None},
        findings=tuple(
            Finding(finding["key"], Severity(finding["severity"]), finding["where"], finding["numbers"])
            for finding in row.findings
        ),
        **{name: getattr(row, name) for name in SESSION_FIELDS},
    )
    return StoredSession(
        row.id,
        row.version,
        row.patient_id,
        reported,
        row.comment,
        row.created_at,
        row.deleted_at,
        placements,
        recordings,
        Limits(frozenset(joint.joint.side for joint in row.joints if joint.is_absent), row.cannot_stand),
        row.comment_confirmed,
    )


def stored_result(row: ResultRow) -> StoredResult:
    return StoredResult(
        row.id, row.session_id, row.kind, row.key, row.algorithm, row.created_at, row.format, row.content
    )


def operator_of(row: OperatorRow) -> Operator:
    return Operator(row.code, row.name, row.role, row.is_active, row.version)

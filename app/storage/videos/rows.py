"""The videos of a library's walks, and whether their patients agreed to them. The frames are in files, not here."""

import datetime
import math
from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import ColumnElement, Select, or_, select
from sqlalchemy.orm import Session as OrmSession

from app.storage.audit import about, note
from app.storage.corrections import unchanged
from app.storage.database.models import ClipRow, PatientRow, RecordingRow, SessionRow, VideoConsentRow
from app.storage.stored import (
    Action,
    ClipRefusedError,
    ClipState,
    LibraryError,
    RecordingState,
    Role,
    StoredClip,
    VideoConsent,
)
from app.storage.unit_of_work import UnitOfWork
from core.video.clip import Sync, SyncBy

BY_CLOCK = Sync(0.0, math.nan, SyncBy.CLOCK)
NO_CONSENT = VideoConsent()


class Clips:
    """One row for each video, beside its file (`app.storage.videos.writer`).

    What is discarded here is out of sight; `app.storage.videos.retention` destroys its file.
    """

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def start(
        self,
        clip_id: UUID,
        recording_id: UUID,
        camera: int,
        view: str,
        size: tuple[int, int],
        rate_hz: float,
        wrapped_key: bytes | None,
        *,
        is_imported: bool,
    ) -> StoredClip:
        """Add an open video, `size` width and height; ClipRefusedError: no walk, no consent, camera taken."""
        with self._unit.writing(Role.CLINICIAN) as session:
            recording = session.get(RecordingRow, recording_id)
            if recording is None or recording.state is RecordingState.DISCARDED:
                raise ClipRefusedError(
                    "This walk is not in the library, so no video is stored with it",
                    "Reload the session, or continue without video",
                )
            if not _consent_of(session, _patient_of(session, recording)).is_given:
                raise ClipRefusedError(
                    "The patient has not agreed to videos", "Ask the patient, then store the consent"
                )
            if session.scalars(_seen(ClipRow.recording_id == recording_id, ClipRow.camera == camera)).first():
                raise ClipRefusedError("This walk already has a video from this camera", "Delete that video first")
            sync = None if is_imported else BY_CLOCK
            row = ClipRow(
                id=clip_id,
                recording_id=recording_id,
                camera=camera,
                view=view,
                width=size[0],
                height=size[1],
                rate_hz=rate_hz,
                frames=0,
                length_s=0.0,
                is_imported=is_imported,
                state=ClipState.OPEN,
                wrapped_key=wrapped_key,
                sha256="",
                created_at=self._unit.now(),
                **_sync_in_row(sync),
            )
            session.add(row)
            session.flush()
            note(self._unit, session, Action.CREATE, about("clip", row.id))
            return _stored(row)

    def close(self, clip_id: UUID, state: ClipState, frames: int, length_s: float, sha256: str) -> StoredClip | None:
        """End a video with what its file holds; None where it was deleted meanwhile; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = session.get(ClipRow, clip_id)
            if row is None or row.state is ClipState.DISCARDED:
                return None
            row.state, row.frames, row.length_s, row.sha256 = state, frames, length_s, sha256
            session.flush()
            note(self._unit, session, Action.EDIT, about("clip", row.id), state=state.value)
            return _stored(row)

    def of_session(self, session_id: UUID) -> dict[UUID, tuple[StoredClip, ...]]:
        """The videos of a visit that are closed, by recording, camera 1 first."""
        with self._unit.reading() as session:
            required = _seen(ClipRow.state != ClipState.OPEN).join(RecordingRow)
            rows = session.scalars(required.where(RecordingRow.session_id == session_id)).all()
            return {
                recording_id: tuple(_stored(row) for row in rows if row.recording_id == recording_id)
                for recording_id in dict.fromkeys(row.recording_id for row in rows)
            }

    def synchronise(self, clip: StoredClip, sync: Sync) -> StoredClip:
        """Store what brings a video's times to those of the samples; raises ChangedMeanwhileError, LibraryError."""
        return self._changed(clip, "sync", **_sync_in_row(sync))

    def set_view(self, clip: StoredClip, view: str) -> StoredClip:
        """Store where the camera stood; raises ChangedMeanwhileError, LibraryError."""
        return self._changed(clip, "view", view=view)

    def note_export(self, clip_id: UUID, *, is_blurred: bool) -> None:
        """Note that a video leaves the library, and whether what shows faces was blurred; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            note(self._unit, session, Action.EXPORT, about("clip", clip_id), is_blurred=is_blurred)

    def delete(self, clip_id: UUID) -> StoredClip | None:
        """Take a video out of sight for good and forget its key; None where it is gone; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = session.get(ClipRow, clip_id)
            if row is None:
                return None
            self._discard(session, [row])
            return _stored(row)

    def forget(self, clip_id: UUID) -> None:
        """Remove the row of a deleted video, after its file; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = session.get(ClipRow, clip_id)
            if row is not None and row.state is ClipState.DISCARDED:
                session.delete(row)

    def of_recording(self, recording_id: UUID) -> tuple[StoredClip, ...]:
        """All of a walk, those that are open or being destroyed too."""
        return self._listed(ClipRow.recording_id == recording_id)

    def in_state(self, state: ClipState) -> tuple[StoredClip, ...]:
        return self._listed(ClipRow.state == state)

    def made_before(self, before: datetime.datetime) -> tuple[StoredClip, ...]:
        """Those that were made before an instant, but for one that is being recorded."""
        return self._listed(ClipRow.created_at <= before, ClipRow.state != ClipState.OPEN)

    def known(self) -> frozenset[UUID]:
        """All that have a row."""
        with self._unit.reading() as session:
            return frozenset(session.scalars(select(ClipRow.id)))

    def consent(self, patient_id: UUID) -> VideoConsent:
        """Whether a patient agreed to videos, as it was stated last, also under a code merged into this one."""
        with self._unit.reading() as session:
            return _consent_of(session, patient_id)

    def give_consent(self, patient_id: UUID) -> VideoConsent:
        """Note that the patient agrees to videos; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            if session.get(PatientRow, patient_id) is None:
                raise LibraryError("This patient is no longer in the library", "Reload the list")
            given = VideoConsent(self._unit.now(), self._unit.code)
            self._put_consent(session, patient_id, given)
            note(self._unit, session, Action.EDIT, about("patient", patient_id), is_video_consent=True)
            return given

    def withdraw_consent(self, patient_id: UUID) -> tuple[StoredClip, ...]:
        """Note that the patient agrees no longer, and discard all the patient's videos, which it gives."""
        with self._unit.writing(Role.CLINICIAN) as session:
            before = _consent_of(session, patient_id)
            if before.given_at is not None and before.withdrawn_at is None:
                withdrawn = VideoConsent(before.given_at, before.given_by, self._unit.now(), self._unit.code)
                self._put_consent(session, patient_id, withdrawn)
                note(self._unit, session, Action.EDIT, about("patient", patient_id), is_video_consent=False)
            own = _every(SessionRow.patient_id == patient_id).join(RecordingRow).join(SessionRow)
            rows = session.scalars(own).all()
            self._discard(session, rows)
            return tuple(_stored(row) for row in rows)

    def _changed(self, clip: StoredClip, field: str, **values: object) -> StoredClip:
        with self._unit.writing(Role.CLINICIAN) as session:
            row = session.get(ClipRow, clip.id)
            if row is None or row.state is ClipState.DISCARDED:
                raise ClipRefusedError("This video is no longer in the library", "Reload the session")
            unchanged(row, clip.version)
            for name, value in values.items():
                setattr(row, name, value)
            session.flush()
            note(self._unit, session, Action.EDIT, about("clip", row.id), fields=[field])
            return _stored(row)

    def _discard(self, session: OrmSession, rows: Sequence[ClipRow]) -> None:
        for row in rows:
            if row.state is not ClipState.DISCARDED:
                row.state, row.wrapped_key = ClipState.DISCARDED, None
                note(self._unit, session, Action.DELETE, about("clip", row.id), is_final=True)
        session.flush()

    def _put_consent(self, session: OrmSession, patient_id: UUID, stated: VideoConsent) -> None:
        assert stated.given_at is not None  # what was never given is not withdrawn
        row = VideoConsentRow(
            patient_id=patient_id,
            given_at=stated.given_at,
            given_by=stated.given_by,
            withdrawn_at=stated.withdrawn_at,
            withdrawn_by=stated.withdrawn_by,
        )
        session.merge(row)
        session.flush()

    def _listed(self, *is_required: ColumnElement[bool]) -> tuple[StoredClip, ...]:
        with self._unit.reading() as session:
            return tuple(_stored(row) for row in session.scalars(_every(*is_required)))


def _every(*is_required: ColumnElement[bool]) -> Select[ClipRow]:
    return select(ClipRow).where(*is_required).order_by(ClipRow.camera, ClipRow.id)


def _seen(*is_required: ColumnElement[bool]) -> Select[ClipRow]:
    return _every(ClipRow.state != ClipState.DISCARDED, *is_required)


def _patient_of(session: OrmSession, recording: RecordingRow) -> UUID:
    return session.get_one(SessionRow, recording.session_id).patient_id


def _consent_of(session: OrmSession, patient_id: UUID) -> VideoConsent:
    """The latest statement under any of the patient's codes: merging two can be undone, so each keeps its own."""
    required = select(VideoConsentRow).join(PatientRow, VideoConsentRow.patient_id == PatientRow.id)
    rows = session.scalars(required.where(or_(PatientRow.id == patient_id, PatientRow.merged_into_id == patient_id)))
    latest = max(rows, key=lambda row: row.withdrawn_at or row.given_at, default=None)
    if latest is None:
        return NO_CONSENT
    return VideoConsent(latest.given_at, latest.given_by, latest.withdrawn_at, latest.withdrawn_by)


def _sync_in_row(sync: Sync | None) -> dict[str, object]:
    if sync is None:
        return {"sync_offset_s": None, "sync_sd_s": None, "sync_by": None}
    sd_s = sync.sd_s if math.isfinite(sync.sd_s) else None
    return {"sync_offset_s": sync.offset_s, "sync_sd_s": sd_s, "sync_by": sync.by}


def _stored(row: ClipRow) -> StoredClip:
    sync = None
    if row.sync_offset_s is not None and row.sync_by is not None:
        sync = Sync(row.sync_offset_s, math.nan if row.sync_sd_s is None else row.sync_sd_s, row.sync_by)
    return StoredClip(
        row.id,
        row.version,
        row.recording_id,
        row.camera,
        row.view,
        row.width,
        row.height,
        row.rate_hz,
        row.frames,
        row.length_s,
        sync,
        row.is_imported,
        row.state,
        row.wrapped_key,
        row.sha256,
        row.created_at,
    )

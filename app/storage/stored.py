"""Values that the library hands out. Plain and frozen; nothing here knows of a database.

`details` is what the clinic or a file stated, in the core's own words and without samples: those are in the journals.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum
from typing import Self
from uuid import UUID

from app.storage.layout import segment_name
from core.body import Joint, Side, Site
from core.samples import SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from core.video.clip import Sync

KEPT_DELETED = timedelta(days=30)  # and can be restored


class LibraryError(Exception):
    """The library cannot do what was asked. States what is wrong and what to do; names no patient."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(f"{what}. {remedy}.")
        self.what, self.remedy = what, remedy


class ChangedMeanwhileError(LibraryError):
    """Somebody else changed it since it was read: nothing was written, so nothing of theirs is lost."""


class LibraryFaultError(LibraryError):
    """The database or its disk does not do what it is asked, whatever that is; nothing was written."""


class ServerSilentError(LibraryFaultError):
    """A clinic's server is not reached, or does not answer: it may be the network, and it may come back."""


class LibraryBusyError(LibraryFaultError):
    """Another program holds the library for longer than anyone waits."""


class NotAllowedError(LibraryError):
    """The operator's role does not allow it."""


class ClipRefusedError(LibraryError):
    """A video cannot be made or shown. The walk beside it goes on."""


class Role(StrEnum):
    """What an operator may do. Enforced by the application; whoever has the data key can read everything."""

    VIEWER = "viewer"
    CLINICIAN = "clinician"
    ADMINISTRATOR = "administrator"

    def includes(self, needed: "Role") -> bool:
        order = list(Role)
        return order.index(self) >= order.index(needed)


class RecordingState(StrEnum):
    """Discarded: its keys are destroyed. A walk that the clinician does not want is merely not kept."""

    OPEN = "open"
    CLOSED = "closed"
    RECOVERED = "recovered"
    DISCARDED = "discarded"


class ClipState(StrEnum):
    """Discarded: it is being destroyed, and nobody sees it any more. Not in backup: it was restored without videos."""

    OPEN = "open"
    CLOSED = "closed"
    RECOVERED = "recovered"
    DISCARDED = "discarded"
    NOT_IN_BACKUP = "not_in_backup"


class ResultKind(StrEnum):
    CALIBRATION = "calibration"
    ANALYSIS = "analysis"


class Action(StrEnum):
    VIEW = "view"
    CREATE = "create"
    EDIT = "edit"
    DELETE = "delete"
    EXPORT = "export"
    PRINT = "print"
    LOGIN = "login"
    BACKUP = "backup"


@dataclass(frozen=True, slots=True)
class Operator:
    """Who works here. `code` is that of the key slot and of the audit; `name` is printed on reports."""

    code: str
    name: str
    role: Role
    is_active: bool = True
    version: int = 1


@dataclass(frozen=True, slots=True)
class StoredPatient:
    """`last_session` is when the latest session started; empty where there is none."""

    id: UUID
    version: int
    details: Patient
    created_at: datetime
    deleted_at: datetime | None
    sessions: int
    last_session: str


@dataclass(frozen=True, slots=True)
class WhatGoes:
    """What goes out of sight with a patient, and what speaks for somebody who works with the patient now.

    `seen_by`: the operator, another than the one who asks, who opened or changed something of the patient within some
    hours; empty where nobody did.
    """

    patient_id: UUID
    code: str
    sessions: int
    recordings: int
    is_being_recorded: bool
    seen_by: str
    seen_at: datetime | None


@dataclass(frozen=True, slots=True)
class PlacedSensor:
    """A sensor as its driver or file calls it, and what is known of it."""

    name: str
    info: SensorInfo


@dataclass(frozen=True, slots=True)
class Placement:
    """Which sensor was worn where. Never changed: correcting it makes another one, and the old one stays."""

    id: UUID
    number: int
    sensors: Mapping[Site, PlacedSensor]

    @property
    def site_of(self) -> dict[str, Site]:
        """Site by the sensor's name."""
        return {sensor.name: site for site, sensor in self.sensors.items()}


@dataclass(frozen=True, slots=True)
class StoredJournal:
    """One segment of a recording. `sha256` is empty until it is closed; no `wrapped_key`: not sealed, or destroyed.

    `kept_as`: its name in the place that a clinic's stations share; empty where it is in the library's folder alone.
    """

    recording_id: UUID
    segment: int
    wrapped_key: bytes | None
    sha256: str = ""
    kept_as: str = ""

    @property
    def file(self) -> str:
        """Its name in the library's folder."""
        return segment_name(self.recording_id, self.segment)


@dataclass(frozen=True, slots=True)
class StoredRecording:
    """`judged_by`: who stated after a crash whether what was recovered is kept; empty until somebody has.

    Not `is_decided`: it is kept until somebody decides, and that is still to be asked.
    """

    id: UUID
    version: int
    session_id: UUID
    details: Recording
    state: RecordingState
    is_simulated: bool
    placement: Placement | None
    journals: tuple[StoredJournal, ...]
    judged_by: str = ""
    is_decided: bool = True

    @property
    def is_unjudged(self) -> bool:
        """Whether it was recovered, and nobody has looked at it since."""
        return self.state is RecordingState.RECOVERED and not self.judged_by


@dataclass(frozen=True, slots=True)
class StoredClip:
    """One video of a walk: `camera` 1 or 2, `view` what was entered of where it is.

    `frames`, `length_s`, `sha256`: of the file once it is closed; 0 and empty until then.
    `sync`: None for a video made elsewhere whose times are not known yet.
    `wrapped_key` None: not sealed, destroyed, or not in the backup that the library was restored from.
    """

    id: UUID
    version: int
    recording_id: UUID
    camera: int
    view: str
    width: int
    height: int
    rate_hz: float
    frames: int
    length_s: float
    sync: Sync | None
    is_imported: bool
    state: ClipState
    wrapped_key: bytes | None
    sha256: str
    created_at: datetime

    @property
    def file(self) -> str:
        """Its name in the folder of the videos."""
        return segment_name(self.id, 1)


@dataclass(frozen=True, slots=True)
class VideoConsent:
    """When a patient agreed to videos and who noted it, and when that was withdrawn; None and empty: never."""

    given_at: datetime | None = None
    given_by: str = ""
    withdrawn_at: datetime | None = None
    withdrawn_by: str = ""

    @property
    def is_given(self) -> bool:
        """Whether videos may be made and kept."""
        return self.given_at is not None and self.withdrawn_at is None


@dataclass(frozen=True, slots=True)
class UndecidedWalk:
    """A walk of which nobody has stated yet whether it is kept, recovered or closed before that, and whose it is."""

    recording: StoredRecording
    patient_id: UUID
    patient_code: str


@dataclass(frozen=True, slots=True)
class Limits:
    """What the patient's body does not allow on this visit: it has no key in a session folder, so it stays here.

    `without_ankle` holds the sides whose foot has no ankle joint.
    """

    without_ankle: frozenset[Side] = frozenset()
    cannot_stand: bool = False


@dataclass(frozen=True, slots=True)
class StoredSession:
    """One visit. `details` holds the recordings too, in order, without samples; `comment` is the clinician's.

    `comment_confirmed` is what was confirmed of it, and by whom, as `app.editing.confirmation` has it.
    """

    id: UUID
    version: int
    patient_id: UUID
    details: Session
    comment: str
    created_at: datetime
    deleted_at: datetime | None
    placements: tuple[Placement, ...]
    recordings: tuple[StoredRecording, ...]
    limits: Limits
    comment_confirmed: str = ""


@dataclass(frozen=True, slots=True)
class SessionSummary:
    """One line of a list of sessions."""

    id: UUID
    patient_id: UUID
    patient_code: str
    started: str
    operator: str
    conditions: tuple[str, ...]
    recordings: int
    is_simulated: bool
    deleted_at: datetime | None


@dataclass(frozen=True, slots=True)
class Change:
    """One value of one row, before and after."""

    table: str
    row: UUID
    field: str
    old: str | float | bool | None
    new: str | float | bool | None


@dataclass(frozen=True, slots=True)
class Correction:
    """What one operator changed in one go. `undoes` is the correction that this one takes back."""

    id: UUID
    at: datetime
    operator: str
    changes: tuple[Change, ...]
    undoes: UUID | None
    is_undone: bool


@dataclass(frozen=True, slots=True)
class AnalysedRecording:
    """One recording as an analysis saw it. `samples`: the SHA-256 of each site's, in order; `test`: as in its row."""

    name: str
    folder: str
    kind: RecordingKind
    is_kept: bool
    is_restrapped_before: bool
    samples: tuple[tuple[Site, str], ...]
    test: str = ""


@dataclass(frozen=True, slots=True)
class AnalysisInputs:
    """Everything that an analysis depends on: the same inputs give the same result, byte for byte.

    `details` is what was stated about patient, sensors and joints, `parameters` method and settings, both by name.
    """

    recordings: tuple[AnalysedRecording, ...]
    zero_rad: Mapping[Joint, float]
    turned_sign: Mapping[Joint, int]
    details: Mapping[str, str | float | bool | None]
    algorithm: str
    parameters: Mapping[str, str | float | bool]


@dataclass(frozen=True, slots=True)
class StoredResult:
    """What was computed from `key`'s inputs. `content` is the application's own, in the format that `format` names."""

    id: UUID
    session_id: UUID
    kind: ResultKind
    key: str
    algorithm: str
    created_at: datetime
    format: str
    content: bytes


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """One link of the chain: `hash` is over `previous_hash` and all other fields. `details` is canonical JSON."""

    number: int
    at: str
    operator: str
    action: str
    subject: str
    details: str
    previous_hash: str
    hash: str


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """How far the audit had come, to be kept elsewhere: without it nobody notices that its end is missing."""

    number: int
    hash: str

    def __str__(self) -> str:
        return f"gaitwright-audit/1 {self.number} {self.hash}"

    @classmethod
    def parsed(cls, text: str) -> Self:
        """Parse what `str` wrote; raises LibraryError for anything but a checkpoint."""
        match text.split():
            case ["gaitwright-audit/1", number, digest] if number.isdecimal() and len(digest) == 64:
                return cls(int(number), digest)
        raise LibraryError("This is not a checkpoint of an audit log", "Choose a file written by the audit log export")


BEGINNING = Checkpoint(0, "0" * 64)  # before the first entry


@dataclass(frozen=True, slots=True)
class AuditFault:
    """What is wrong at one number."""

    number: int
    what: str


@dataclass(frozen=True, slots=True)
class AuditReport:
    """What a verification found; `end` is where the chain ends now."""

    end: Checkpoint
    faults: tuple[AuditFault, ...]

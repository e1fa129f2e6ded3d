"""The library's tables, the same on SQLite and on PostgreSQL.

Samples are not here but in the journals. A walk is a recording of the kind `walking`, with its condition. Fields that
the session folder's format has are named as the core names them.
"""

import datetime
import tomllib
import unicodedata
from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import Any, ClassVar
from uuid import UUID

import tomli_w
from sqlalchemy import (
    JSON,
    BigInteger,
    CheckConstraint,
    DateTime,
    Dialect,
    Enum,
    ForeignKey,
    Integer,
    LargeBinary,
    MetaData,
    Text,
    TypeDecorator,
    UniqueConstraint,
    false,
    true,
)
from sqlalchemy.engine.default import DefaultExecutionContext
from sqlalchemy.orm import DeclarativeBase, Mapped, declared_attr, mapped_column, relationship, validates
from sqlalchemy.orm import Session as OrmSession

from app.storage.database.ids import uuid7
from app.storage.layout import segment_name
from app.storage.stored import ClipState, RecordingState, ResultKind, Role
from core.body import Joint, Site
from core.samples import RateKind
from core.session import RecordingKind
from core.video.clip import SyncBy

SIDES = ("left", "right", "both", "none", "")
WORD = 20  # letters that the longest of our own words may have


class UtcDateTime(TypeDecorator[datetime.datetime]):
    """An instant: aware on the way in, UTC on the way out. SQLite keeps no zones."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime.datetime | None, dialect: Dialect) -> datetime.datetime | None:
        return None if value is None else value.astimezone(datetime.UTC)

    def process_result_value(self, value: datetime.datetime | None, dialect: Dialect) -> datetime.datetime | None:
        if value is None:
            return None
        return value.replace(tzinfo=datetime.UTC) if value.tzinfo is None else value.astimezone(datetime.UTC)


class TomlTable(TypeDecorator[Mapping[str, object]]):
    """Keys of a session folder that mean nothing to us, as the file had them: TOML knows dates, JSON does not."""

    impl = Text
    cache_ok = True

    def process_bind_param(self, value: Mapping[str, object] | None, dialect: Dialect) -> str:
        return tomli_w.dumps(value or {})

    def process_result_value(self, value: str | None, dialect: Dialect) -> Mapping[str, object]:
        return tomllib.loads(value or "")


def _words(allowed: type[StrEnum], name: str) -> Enum:
    return Enum(
        allowed,
        name=name,
        native_enum=False,
        create_constraint=True,
        length=WORD,
        values_callable=lambda kind: [word.value for word in kind],
    )


def _one_of(column: str, allowed: Iterable[str]) -> CheckConstraint:
    words = ", ".join(f"'{word}'" for word in allowed)
    return CheckConstraint(f"{column} IN ({words})", name=column)


def folded(text: str) -> str:
    """The same for all ways of typing a code."""
    return unicodedata.normalize("NFKC", text).strip().casefold()


class Base(DeclarativeBase):
    metadata = MetaData(
        naming_convention={
            "pk": "pk_%(table_name)s",
            "fk": "fk_%(table_name)s_%(column_0_name)s",
            "uq": "uq_%(table_name)s_%(column_0_N_name)s",
            "ck": "ck_%(table_name)s_%(constraint_name)s",
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        }
    )
    type_annotation_map: ClassVar = {str: Text, datetime.datetime: UtcDateTime, Mapping[str, object]: TomlTable}


class Versioned:
    """Rows that operators change: an update counts up, and one that started from an older count is refused."""

    version: Mapped[int]

    @declared_attr.directive
    def __mapper_args__(cls) -> dict[str, Any]:  # noqa: N805 - SQLAlchemy hands in the class
        return {"version_id_col": cls.version}


class PatientRow(Versioned, Base):
    """A patient whose double was merged into another stays, empty, so that merging can be undone.

    `goals`: what was agreed, as `core.goals` writes it; empty where nothing was. `prostheses`: what was stated of each
    side's, as `core.prosthesis` writes it.
    """

    __tablename__ = "patients"
    __table_args__ = (_one_of("affected_side", SIDES), _one_of("prosthetic_side", SIDES))

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    code: Mapped[str]
    code_folded: Mapped[str] = mapped_column(unique=True)
    birth_year: Mapped[int | None]
    sex: Mapped[str]
    height_m: Mapped[float | None]
    mass_kg: Mapped[float | None]
    device: Mapped[str]
    aids: Mapped[str]
    affected_side: Mapped[str]
    prosthetic_side: Mapped[str]
    goals: Mapped[str] = mapped_column(default="", server_default="")
    prostheses: Mapped[str] = mapped_column(default="", server_default="")
    unknown: Mapped[Mapping[str, object]]
    created_at: Mapped[datetime.datetime]
    deleted_at: Mapped[datetime.datetime | None]
    merged_into_id: Mapped[UUID | None] = mapped_column(ForeignKey("patients.id"))

    @validates("code")
    def _fold(self, _: str, code: str) -> str:
        self.code_folded = folded(code)
        return code


class SessionRow(Versioned, Base):
    __tablename__ = "sessions"

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    patient_id: Mapped[UUID] = mapped_column(ForeignKey("patients.id"), index=True)
    started: Mapped[str]
    operator: Mapped[str]
    surface: Mapped[str]
    notes: Mapped[str]
    software: Mapped[str]
    comment: Mapped[str]
    comment_confirmed: Mapped[str] = mapped_column(default="", server_default="")
    is_simulated: Mapped[bool]
    cannot_stand: Mapped[bool] = mapped_column(default=False, server_default=false())
    findings: Mapped[list[dict[str, Any]]] = mapped_column(JSON)
    unknown: Mapped[Mapping[str, object]]
    created_at: Mapped[datetime.datetime]
    deleted_at: Mapped[datetime.datetime | None]

    patient: Mapped[PatientRow] = relationship()
    joints: Mapped[list["JointRow"]] = relationship(order_by="JointRow.joint")
    placements: Mapped[list["PlacementRow"]] = relationship(order_by="PlacementRow.number")
    recordings: Mapped[list["RecordingRow"]] = relationship(order_by="RecordingRow.number")


class JointRow(Base):
    """What was stated about one joint: the goniometer while standing, and the turned sign. None: nothing was stated.

    `is_absent`: a foot without an ankle joint.
    """

    __tablename__ = "joints"
    __table_args__ = (
        UniqueConstraint("session_id", "joint"),
        CheckConstraint("turned_sign IN (-1, 1)", name="turned_sign"),
    )

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="CASCADE"))
    joint: Mapped[Joint] = mapped_column(_words(Joint, "joint"))
    zero_rad: Mapped[float | None]
    turned_sign: Mapped[int | None]
    is_absent: Mapped[bool] = mapped_column(default=False, server_default=false())


class PlacementRow(Base):
    """Never changed. A correction adds one and points the recordings to it: the old ones are the history."""

    __tablename__ = "placements"
    __table_args__ = (UniqueConstraint("session_id", "number"),)

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="CASCADE"))
    number: Mapped[int]
    made_at: Mapped[datetime.datetime]
    made_by: Mapped[str]

    sensors: Mapped[list["PlacedSensorRow"]] = relationship(order_by="PlacedSensorRow.site")


class PlacedSensorRow(Base):
    __tablename__ = "placed_sensors"
    __table_args__ = (UniqueConstraint("placement_id", "name"),)

    placement_id: Mapped[UUID] = mapped_column(ForeignKey("placements.id", ondelete="CASCADE"), primary_key=True)
    site: Mapped[Site] = mapped_column(_words(Site, "site"), primary_key=True)
    name: Mapped[str]
    serial: Mapped[str]
    model: Mapped[str]
    firmware: Mapped[str]
    rate_hz: Mapped[float | None]
    rate_kind: Mapped[RateKind | None] = mapped_column(_words(RateKind, "rate_kind"))
    clock: Mapped[str]
    unknown: Mapped[Mapping[str, object]]


class RecordingRow(Versioned, Base):
    """`is_decided`: nobody is to be asked any more whether it is kept.

    `judged_by`: the operator who stated after a crash whether what was recovered is kept; empty until then.

    `left_out`: the strides that were left out by hand, as `values` writes them.

    `alignment`: what was changed at the prosthesis before, as `core.alignment` writes it; empty where nothing was
    stated.

    `test`: which timed test it is, as `core.timed.protocols` writes it; empty where it is none.

    `station`: which station of a clinic recorded it; empty where a library has no stations.
    """

    __tablename__ = "recordings"
    __table_args__ = (UniqueConstraint("session_id", "number"), UniqueConstraint("session_id", "name"))

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="CASCADE"))
    placement_id: Mapped[UUID | None] = mapped_column(ForeignKey("placements.id"))
    number: Mapped[int]
    name: Mapped[str]
    kind: Mapped[RecordingKind] = mapped_column(_words(RecordingKind, "kind"))
    folder: Mapped[str]
    condition: Mapped[str]
    started: Mapped[str]
    is_kept: Mapped[bool]
    note: Mapped[str]
    is_restrapped_before: Mapped[bool]
    left_out: Mapped[str] = mapped_column(default="", server_default="")
    alignment: Mapped[str] = mapped_column(default="", server_default="")
    test: Mapped[str] = mapped_column(default="", server_default="")
    is_simulated: Mapped[bool]
    state: Mapped[RecordingState] = mapped_column(_words(RecordingState, "state"), index=True)
    judged_by: Mapped[str] = mapped_column(default="", server_default="")
    is_decided: Mapped[bool] = mapped_column(default=True, server_default=true())
    station: Mapped[str] = mapped_column(default="", server_default="")
    unknown: Mapped[Mapping[str, object]]

    placement: Mapped[PlacementRow | None] = relationship()
    journals: Mapped[list["JournalRow"]] = relationship(order_by="JournalRow.segment")


def _file_of(context: DefaultExecutionContext) -> str:
    row = context.get_current_parameters()  # type: ignore[no-untyped-call]  # has no types there
    return segment_name(row["recording_id"], row["segment"])


class JournalRow(Base):
    """`wrapped_key` is a copy of the file's own, in case that is damaged.

    `file_written` is for other programs: a row on a server may name any file, so it is never read here.

    `kept_as`: its name in the place that a clinic's stations share; empty until it was handed over.
    """

    __tablename__ = "journals"

    recording_id: Mapped[UUID] = mapped_column(ForeignKey("recordings.id", ondelete="CASCADE"), primary_key=True)
    segment: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    file_written: Mapped[str] = mapped_column("file", unique=True, default=_file_of)
    wrapped_key: Mapped[bytes | None] = mapped_column(LargeBinary)
    sha256: Mapped[str]
    kept_as: Mapped[str] = mapped_column(default="", server_default="")

    @property
    def file(self) -> str:
        return segment_name(self.recording_id, self.segment)


class ClipRow(Versioned, Base):
    """One video of a walk. `sync_offset_s` None: its times are not known; `sync_sd_s` None: nor is their error.

    `wrapped_key` is a copy of the file's own, as in `JournalRow`.
    """

    __tablename__ = "clips"
    __table_args__ = (CheckConstraint("camera IN (1, 2)", name="camera"),)

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    recording_id: Mapped[UUID] = mapped_column(ForeignKey("recordings.id", ondelete="CASCADE"), index=True)
    camera: Mapped[int]
    view: Mapped[str]
    width: Mapped[int]
    height: Mapped[int]
    rate_hz: Mapped[float]
    frames: Mapped[int]
    length_s: Mapped[float]
    sync_offset_s: Mapped[float | None]
    sync_sd_s: Mapped[float | None]
    sync_by: Mapped[SyncBy | None] = mapped_column(_words(SyncBy, "sync_by"))
    is_imported: Mapped[bool]
    state: Mapped[ClipState] = mapped_column(_words(ClipState, "state"), index=True)
    wrapped_key: Mapped[bytes | None] = mapped_column(LargeBinary)
    sha256: Mapped[str]
    created_at: Mapped[datetime.datetime]

    @property
    def file(self) -> str:
        return segment_name(self.id, 1)


class VideoConsentRow(Base):
    """Whether a patient agreed to videos, as it was stated last; the audit has what was stated before."""

    __tablename__ = "video_consents"

    patient_id: Mapped[UUID] = mapped_column(ForeignKey("patients.id", ondelete="CASCADE"), primary_key=True)
    given_at: Mapped[datetime.datetime]
    given_by: Mapped[str]
    withdrawn_at: Mapped[datetime.datetime | None]
    withdrawn_by: Mapped[str]


class ResultRow(Base):
    """What `identify` or `analyse` found, by the key of its inputs. Never changed."""

    __tablename__ = "results"
    __table_args__ = (UniqueConstraint("session_id", "kind", "key"),)

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="CASCADE"))
    kind: Mapped[ResultKind] = mapped_column(_words(ResultKind, "kind"))
    key: Mapped[str]
    inputs: Mapped[dict[str, Any]] = mapped_column(JSON)
    algorithm: Mapped[str]
    format: Mapped[str]
    content: Mapped[bytes] = mapped_column(LargeBinary)
    created_at: Mapped[datetime.datetime]


class CourseRow(Base):
    """What a session adds to its patient's course, as it resulted from all that `key` is a digest of."""

    __tablename__ = "courses"

    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str]
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class CorrectionRow(Base):
    """Who changed what from what to what. Goes when the patient or session that it is about is destroyed.

    `number` counts up in the order in which they were made; a clock may be set back.
    """

    __tablename__ = "corrections"

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    patient_id: Mapped[UUID] = mapped_column(ForeignKey("patients.id", ondelete="CASCADE"), index=True)
    session_id: Mapped[UUID | None] = mapped_column(ForeignKey("sessions.id", ondelete="CASCADE"), index=True)
    at: Mapped[datetime.datetime]
    operator: Mapped[str]
    changes: Mapped[list[dict[str, Any]]] = mapped_column(JSON)
    undoes_id: Mapped[UUID | None] = mapped_column(ForeignKey("corrections.id", ondelete="CASCADE"), unique=True)
    number: Mapped[int] = mapped_column(index=True, unique=True, server_default="0")


class OperatorRow(Versioned, Base):
    """Never deleted: the audit speaks of them."""

    __tablename__ = "operators"

    code: Mapped[str] = mapped_column(primary_key=True)
    name: Mapped[str]
    role: Mapped[Role] = mapped_column(_words(Role, "role"))
    is_active: Mapped[bool]
    created_at: Mapped[datetime.datetime]


class SettingRow(Versioned, Base):
    __tablename__ = "settings"

    name: Mapped[str] = mapped_column(primary_key=True)
    value: Mapped[Any] = mapped_column(JSON)

    @classmethod
    def of(cls, session: OrmSession, name: str, default: Any = None) -> Any:
        """What was set under this name."""
        row = session.get(cls, name)
        return default if row is None else row.value

    @classmethod
    def put(cls, session: OrmSession, name: str, value: Any) -> None:
        if (row := session.get(cls, name)) is None:
            session.add(cls(name=name, value=value))
        else:
            row.value = value


class AuditRow(Base):
    """Append-only: triggers refuse updates and deletions, and a server's function numbers it (see the migrations)."""

    __tablename__ = "audit"

    number: Mapped[int] = mapped_column(
        BigInteger().with_variant(Integer(), "sqlite"), primary_key=True, autoincrement=False
    )
    at: Mapped[str]
    operator: Mapped[str]
    action: Mapped[str]
    subject: Mapped[str] = mapped_column(index=True)
    details: Mapped[str]
    previous_hash: Mapped[str]
    hash: Mapped[str]


class ReadingRow(Base):
    """What a login that only looks has looked at, until a station adds it to the audit."""

    __tablename__ = "readings"

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid7)
    at: Mapped[str]
    login: Mapped[str]
    operator: Mapped[str]
    action: Mapped[str]
    subject: Mapped[str]
    details: Mapped[str]

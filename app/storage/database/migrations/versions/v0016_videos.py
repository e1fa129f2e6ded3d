"""Videos of walks, and whether a patient agreed to them."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision: str | None = "0015"
branch_labels = None
depends_on = None

OWNER, APP, READER = "gaitwright_owner", "gaitwright_app", "gaitwright_reader"


def _one_of(name: str, *words: str) -> sa.Enum:
    return sa.Enum(*words, name=name, native_enum=False, create_constraint=True, length=20)


def upgrade() -> None:
    op.create_table(
        "clips",
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("recording_id", sa.Uuid(), nullable=False),
        sa.Column("camera", sa.Integer(), nullable=False),
        sa.Column("view", sa.Text(), nullable=False),
        sa.Column("width", sa.Integer(), nullable=False),
        sa.Column("height", sa.Integer(), nullable=False),
        sa.Column("rate_hz", sa.Double(), nullable=False),
        sa.Column("frames", sa.Integer(), nullable=False),
        sa.Column("length_s", sa.Double(), nullable=False),
        sa.Column("sync_offset_s", sa.Double(), nullable=True),
        sa.Column("sync_sd_s", sa.Double(), nullable=True),
        sa.Column("sync_by", _one_of("sync_by", "clock", "motion", "hand"), nullable=True),
        sa.Column("is_imported", sa.Boolean(), nullable=False),
        sa.Column(
            "state", _one_of("state", "open", "closed", "recovered", "discarded", "not_in_backup"), nullable=False
        ),
        sa.Column("wrapped_key", sa.LargeBinary(), nullable=True),
        sa.Column("sha256", sa.Text(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.CheckConstraint("camera IN (1, 2)", name=op.f("ck_clips_camera")),
        sa.ForeignKeyConstraint(
            ["recording_id"], ["recordings.id"], name=op.f("fk_clips_recording_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_clips")),
    )
    op.create_index(op.f("ix_clips_recording_id"), "clips", ["recording_id"])
    op.create_index(op.f("ix_clips_state"), "clips", ["state"])
    op.create_table(
        "video_consents",
        sa.Column("patient_id", sa.Uuid(), nullable=False),
        sa.Column("given_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("given_by", sa.Text(), nullable=False),
        sa.Column("withdrawn_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("withdrawn_by", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["patient_id"], ["patients.id"], name=op.f("fk_video_consents_patient_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("patient_id", name=op.f("pk_video_consents")),
    )
    if op.get_context().dialect.name == "postgresql":
        for table in ("clips", "video_consents"):
            op.execute(f"ALTER TABLE {table} OWNER TO {OWNER}")
            op.execute(f"GRANT SELECT, INSERT, UPDATE, DELETE ON {table} TO {APP}")
            op.execute(f"GRANT SELECT ON {table} TO {READER}")


def downgrade() -> None:
    op.drop_table("video_consents")
    op.drop_table("clips")

"""In which order corrections were made, whatever the clock showed; and which walks wait to be kept or discarded."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision: str | None = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("recordings", sa.Column("is_decided", sa.Boolean(), server_default=sa.true(), nullable=False))
    op.add_column("corrections", sa.Column("number", sa.Integer(), server_default="0", nullable=False))
    order = "id" if op.get_context().dialect.name == "postgresql" else "rowid"  # which SQLite has counted up
    op.execute(
        f"""
        UPDATE corrections SET number = counted.number
        FROM (SELECT id, ROW_NUMBER() OVER (ORDER BY {order}) AS number FROM corrections) AS counted
        WHERE counted.id = corrections.id
        """
    )
    op.create_index(op.f("ix_corrections_number"), "corrections", ["number"], unique=True)


def downgrade() -> None:
    op.drop_index(op.f("ix_corrections_number"), "corrections")
    op.drop_column("corrections", "number")
    op.drop_column("recordings", "is_decided")

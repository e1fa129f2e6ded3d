"""Which timed test a recording is, and when its keys were pressed."""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision: str | None = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("recordings", sa.Column("test", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("recordings", "test")

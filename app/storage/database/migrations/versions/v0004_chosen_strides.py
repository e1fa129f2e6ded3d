"""Which strides of a recording were left out by hand."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision: str | None = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("recordings", sa.Column("left_out", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("recordings", "left_out")

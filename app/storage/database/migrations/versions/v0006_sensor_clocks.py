"""Which sensors share one clock."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision: str | None = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("placed_sensors", sa.Column("clock", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("placed_sensors", "clock")

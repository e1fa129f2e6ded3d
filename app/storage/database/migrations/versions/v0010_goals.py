"""What was agreed with a patient."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision: str | None = "0009"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("patients", sa.Column("goals", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("patients", "goals")

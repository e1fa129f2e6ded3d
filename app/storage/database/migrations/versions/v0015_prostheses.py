"""Level of amputation, knee and foot of each side's prosthesis."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision: str | None = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("patients", sa.Column("prostheses", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("patients", "prostheses")

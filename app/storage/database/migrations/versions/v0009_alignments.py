"""What was changed at a prosthesis before a recording."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision: str | None = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("recordings", sa.Column("alignment", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("recordings", "alignment")

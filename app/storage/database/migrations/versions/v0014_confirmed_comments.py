"""Who confirmed the clinical comment, and the words that were confirmed.

Comments typed before are confirmed by nobody: they are printed once somebody does.
"""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision: str | None = "0013"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("sessions", sa.Column("comment_confirmed", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("sessions", "comment_confirmed")

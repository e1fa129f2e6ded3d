"""What the wizard asks for and no session folder has: feet without an ankle, who cannot stand, who judged what."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision: str | None = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("joints", sa.Column("is_absent", sa.Boolean(), server_default=sa.false(), nullable=False))
    op.add_column("sessions", sa.Column("cannot_stand", sa.Boolean(), server_default=sa.false(), nullable=False))
    op.add_column("recordings", sa.Column("judged_by", sa.Text(), server_default="", nullable=False))


def downgrade() -> None:
    op.drop_column("recordings", "judged_by")
    op.drop_column("sessions", "cannot_stand")
    op.drop_column("joints", "is_absent")

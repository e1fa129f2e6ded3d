"""A sensor may be worn on the pelvis, and the hips are joints."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision: str | None = "0011"
branch_labels = None
depends_on = None

SITES = ("left_thigh", "left_shank", "left_foot", "right_thigh", "right_shank", "right_foot")
JOINTS = ("left_knee", "left_ankle", "right_knee", "right_ankle")
# what SQLite forgets of the other columns when a table is made again
OTHERS = {
    "placed_sensors": {"rate_kind": "rate_kind IN ('instantaneous', 'averaged')"},
    "joints": {"turned_sign": "turned_sign IN (-1, 1)"},
}


def upgrade() -> None:
    _allow("placed_sensors", "site", (*SITES, "pelvis"))
    _allow("joints", "joint", (*JOINTS, "left_hip", "right_hip"))


def downgrade() -> None:
    op.execute(sa.text("DELETE FROM placed_sensors WHERE site = 'pelvis'"))
    op.execute(sa.text("DELETE FROM joints WHERE joint IN ('left_hip', 'right_hip')"))
    _allow("placed_sensors", "site", SITES)
    _allow("joints", "joint", JOINTS)


def _allow(table: str, column: str, words: tuple[str, ...]) -> None:
    listed = ", ".join(f"'{word}'" for word in words)
    checks = {column: f"{column} IN ({listed})"}
    is_sqlite = op.get_bind().dialect.name == "sqlite"
    with op.batch_alter_table(table, recreate="always" if is_sqlite else "never") as altered:
        if is_sqlite:
            checks |= OTHERS[table]
        else:
            altered.drop_constraint(op.f(f"ck_{table}_{column}"), type_="check")
        for name, condition in checks.items():
            altered.create_check_constraint(op.f(f"ck_{table}_{name}"), condition)

"""Stations of a clinic: which one recorded what, where journals are kept for all, and who may do what on a server.

On PostgreSQL three roles are made, which own no password: `gaitwright_owner` has the tables and changes them,
`gaitwright_app` is what stations are given, `gaitwright_reader` what a screen is given that only looks. Each station's
own login is granted one of them. The audit is added to by all and changed by none.
"""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision: str | None = "0007"
branch_labels = None
depends_on = None

OWNER, APP, READER = "gaitwright_owner", "gaitwright_app", "gaitwright_reader"


def upgrade() -> None:
    op.add_column("recordings", sa.Column("station", sa.Text(), server_default="", nullable=False))
    op.add_column("journals", sa.Column("kept_as", sa.Text(), server_default="", nullable=False))
    if op.get_context().dialect.name == "postgresql":
        _make_roles()
        _grant()


def downgrade() -> None:
    if op.get_context().dialect.name == "postgresql":
        # the roles stay: they belong to the server, and another library may use them
        for table in _tables():
            op.execute(f'REVOKE ALL ON "{table}" FROM {APP}, {READER}')
            op.execute(f'ALTER TABLE "{table}" OWNER TO CURRENT_USER')
    op.drop_column("journals", "kept_as")
    op.drop_column("recordings", "station")


def _make_roles() -> None:
    for role in (OWNER, APP, READER):
        op.execute(
            f"""
            DO $$ BEGIN
                IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = '{role}') THEN CREATE ROLE {role} NOLOGIN; END IF;
            EXCEPTION WHEN duplicate_object OR unique_violation THEN NULL;  -- another library was quicker
            END $$
            """
        )
    op.execute(
        f"""
        DO $$ BEGIN
            IF NOT pg_has_role(CURRENT_USER, '{OWNER}', 'USAGE') THEN GRANT {OWNER} TO CURRENT_USER; END IF;
        END $$
        """
    )


def _grant() -> None:
    op.execute(
        f"""
        DO $$ BEGIN
            EXECUTE 'GRANT USAGE, CREATE ON SCHEMA ' || quote_ident(current_schema()) || ' TO {OWNER}';
            EXECUTE 'GRANT USAGE ON SCHEMA ' || quote_ident(current_schema()) || ' TO {APP}, {READER}';
        END $$
        """
    )
    for table in _tables():
        op.execute(f'ALTER TABLE "{table}" OWNER TO {OWNER}')
        changes = {"audit": "SELECT, INSERT", "alembic_version": "SELECT"}.get(table, "SELECT, INSERT, UPDATE, DELETE")
        op.execute(f'GRANT {changes} ON "{table}" TO {APP}')
        op.execute(f'GRANT {"SELECT, INSERT" if table == "audit" else "SELECT"} ON "{table}" TO {READER}')


def _tables() -> list[str]:
    return sorted(sa.inspect(op.get_bind()).get_table_names())

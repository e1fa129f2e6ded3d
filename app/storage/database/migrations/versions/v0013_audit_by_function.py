"""Keep the audit's numbers out of anybody's hands: on a server entries are added by a function alone.

A login that could insert rows could take the last number there is, and nobody added an entry after it. `append_audit`
adds the entry that follows the last one, and no other; stations may call it. `note_reading` is for logins that only
look: what they looked at waits in `readings` until a station adds it to the audit. They hold no lock meanwhile.
"""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision: str | None = "0012"
branch_labels = None
depends_on = None

OWNER, APP, READER = "gaitwright_owner", "gaitwright_app", "gaitwright_reader"
WAITING = 10_000  # readings of one login: a screen that shows one patient a minute fills them in a week
APPEND = "append_audit(bigint, text, text, text, text, text, text, text)"
NOTE = "note_reading(text, text, text, text)"


def upgrade() -> None:
    op.create_table(
        "readings",
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("at", sa.Text(), nullable=False),
        sa.Column("login", sa.Text(), nullable=False),
        sa.Column("operator", sa.Text(), nullable=False),
        sa.Column("action", sa.Text(), nullable=False),
        sa.Column("subject", sa.Text(), nullable=False),
        sa.Column("details", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_readings")),
    )
    if op.get_context().dialect.name != "postgresql":
        return
    op.alter_column("audit", "number", type_=sa.BigInteger(), existing_nullable=False)
    op.execute(f"ALTER TABLE readings OWNER TO {OWNER}")
    op.execute(f"GRANT SELECT, DELETE ON readings TO {APP}")
    op.execute(f"REVOKE INSERT ON audit FROM {APP}, {READER}")
    _make_functions()


def downgrade() -> None:
    if op.get_context().dialect.name == "postgresql":
        op.execute(f"DROP FUNCTION {APPEND}, {NOTE}")
        op.execute(f"GRANT INSERT ON audit TO {APP}, {READER}")
        op.alter_column("audit", "number", type_=sa.Integer(), existing_nullable=False)
    op.drop_table("readings")


def _make_functions() -> None:
    op.execute(
        """
        CREATE FUNCTION append_audit(
            its_number bigint, its_at text, its_operator text, its_action text, its_subject text, its_details text,
            its_previous text, its_hash text
        ) RETURNS void LANGUAGE plpgsql SECURITY DEFINER AS $$
        DECLARE last_number bigint; last_hash text;
        BEGIN
            SELECT number, hash INTO last_number, last_hash FROM audit ORDER BY number DESC LIMIT 1;
            IF its_number IS DISTINCT FROM COALESCE(last_number, 0) + 1
               OR its_previous IS DISTINCT FROM COALESCE(last_hash, repeat('0', 64)) THEN
                RAISE EXCEPTION 'this is not the next entry' USING ERRCODE = 'integrity_constraint_violation';
            END IF;
            INSERT INTO audit (number, at, operator, action, subject, details, previous_hash, hash) VALUES
                (its_number, its_at, its_operator, its_action, its_subject, its_details, its_previous, its_hash);
        END $$
        """
    )
    op.execute(
        f"""
        CREATE FUNCTION note_reading(its_operator text, its_action text, its_subject text, its_details text)
        RETURNS void LANGUAGE plpgsql SECURITY DEFINER AS $$
        BEGIN
            IF octet_length(its_operator || its_action || its_subject || its_details) > 4096
               OR (SELECT count(*) FROM readings WHERE login = session_user) >= {WAITING} THEN
                RAISE EXCEPTION 'too much' USING ERRCODE = 'insufficient_privilege';
            END IF;
            INSERT INTO readings (id, at, login, operator, action, subject, details) VALUES
                (gen_random_uuid(), to_char(clock_timestamp() AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS.US"+00:00"'),
                 session_user, its_operator, its_action, its_subject, its_details);
        END $$
        """
    )
    # a table of the caller's own must not stand in for ours
    for function in (APPEND, NOTE):
        op.execute(
            f"""
            DO $$ BEGIN
                EXECUTE 'ALTER FUNCTION {function} SET search_path = ' || quote_ident(current_schema()) || ', pg_temp';
            END $$
            """
        )
    for function, roles in ((APPEND, APP), (NOTE, f"{APP}, {READER}")):
        op.execute(f"ALTER FUNCTION {function} OWNER TO {OWNER}")
        op.execute(f"REVOKE ALL ON FUNCTION {function} FROM PUBLIC")
        op.execute(f"GRANT EXECUTE ON FUNCTION {function} TO {roles}")

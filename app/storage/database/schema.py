"""Check that the tables are those that this version knows. Older ones are brought up to date, in one go."""

from sqlalchemy import Connection, inspect, text

from app.storage.database.engine import Database
from app.storage.stored import LibraryError

NEWEST = "0016"


def bring_up_to_date(database: Database) -> None:
    """Apply missing migrations, all or none; LibraryError: a later version's library, or not all letters fit."""
    if is_up_to_date(database):
        return
    from app.storage.database.steps import move, refuse_unknown  # Alembic, which only an update needs

    _refuse_other_encodings(database)
    with database.rebuilding() as connection:
        if (found := step_of(connection)) == NEWEST:
            return  # somebody else was quicker
        refuse_unknown(found)
        move(connection, "head")


def is_up_to_date(database: Database) -> bool:
    """Give whether the tables are this version's; raises LibraryError."""
    with database.reading() as session:
        return step_of(session.connection()) == NEWEST


def _refuse_other_encodings(database: Database) -> None:
    if database.engine.dialect.name != "postgresql":
        return
    with database.reading() as session:
        encoding = session.scalar(
            text("SELECT pg_encoding_to_char(encoding) FROM pg_database WHERE datname = current_database()")
        )
    if encoding not in ("UTF8", b"UTF8"):
        raise LibraryError(
            "The server's database cannot store all characters: it does not use UTF-8",
            "Create the database again: CREATE DATABASE ... ENCODING 'UTF8' TEMPLATE template0",
        )


def step_of(connection: Connection) -> str | None:
    """The latest step that the tables have taken."""
    if not inspect(connection).has_table("alembic_version"):
        return None
    return connection.execute(text("SELECT version_num FROM alembic_version")).scalar()

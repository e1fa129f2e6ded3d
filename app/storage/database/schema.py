"""Check that the tables are those that this version knows. Older ones are brought up to date, in one go."""

from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy import Connection, inspect, text

from app.storage.database.engine import Database
from app.storage.stored import LibraryError

if TYPE_CHECKING:  # it takes long to load, and is needed after an update only
    from alembic.config import Config

NEWEST = "0014"


def bring_up_to_date(database: Database) -> None:
    """Take the steps that are missing, all or none; two stations may ask at once.

    Raises
    ------
    LibraryError
        A later version of Gaitwright has written the library, or the server's database does not hold all letters.
    """
    if is_up_to_date(database):
        return
    _refuse_other_encodings(database)
    with database.rebuilding() as connection:
        if (found := _step_of(connection)) == NEWEST:
            return  # somebody else was quicker
        _refuse_unknown(found)
        move(connection, "head")


def is_up_to_date(database: Database) -> bool:
    """Whether the tables are those of this version.

    Raises
    ------
    LibraryError
        The database cannot be read.
    """
    with database.reading() as session:
        return _step_of(session.connection()) == NEWEST


def move(connection: Connection, step: str) -> None:
    """Go to `step`, forwards or back ("base" has no tables), in the transaction that `connection` is in."""
    from alembic import command

    config = alembic_config()
    config.attributes["connection"] = connection
    current = _step_of(connection)
    if step == "base" or (step != "head" and current is not None and step < current):
        command.downgrade(config, step)
    else:
        command.upgrade(config, step)


def alembic_config() -> "Config":
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).with_name("migrations")).replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    return config


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


def _step_of(connection: Connection) -> str | None:
    if not inspect(connection).has_table("alembic_version"):
        return None
    return connection.execute(text("SELECT version_num FROM alembic_version")).scalar()


def _refuse_unknown(step: str | None) -> None:
    from alembic.script import ScriptDirectory

    known = {script.revision for script in ScriptDirectory.from_config(alembic_config()).walk_revisions()}
    if step is not None and step not in known:
        raise LibraryError("This library was written by a newer version of Gaitwright", "Install the latest version")

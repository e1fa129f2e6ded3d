"""The steps that bring older tables up to date, or back: all that is done with Alembic."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.script import ScriptDirectory
from sqlalchemy import Connection

from app.storage.database.schema import step_of
from app.storage.stored import LibraryError


def move(connection: Connection, step: str) -> None:
    """Go to `step`, forwards or back ("base" has no tables), in the transaction that `connection` is in."""
    config = alembic_config()
    config.attributes["connection"] = connection
    current = step_of(connection)
    if step == "base" or (step != "head" and current is not None and step < current):
        command.downgrade(config, step)
    else:
        command.upgrade(config, step)


def alembic_config() -> Config:
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).with_name("migrations")).replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    return config


def refuse_unknown(step: str | None) -> None:
    """See that the tables are not of a later version.

    Raises
    ------
    LibraryError
        They are.
    """
    known = {script.revision for script in ScriptDirectory.from_config(alembic_config()).walk_revisions()}
    if step is not None and step not in known:
        raise LibraryError("This library was written by a newer version of Gaitwright", "Install the latest version")

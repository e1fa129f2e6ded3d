"""Which server a station's folder belongs to, and where the journals are that all stations reach.

station.json    the server's address, and this station's id; its owner's alone, for the address may hold a password
cache/          copies of journals that are in the shared place, fetched or handed over; they may go at any time

The environment variable GAITWRIGHT_DATABASE_URL replaces the address, GAITWRIGHT_JOURNALS the shared place
where it has another name on this computer.
"""

import json
import os
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from uuid import UUID

from sqlalchemy import make_url
from sqlalchemy.exc import ArgumentError

from app.storage.database.engine import Database, postgres_engine
from app.storage.files import replace_file
from app.storage.layout import DATABASE_VARIABLE, JOURNALS_VARIABLE, STATION
from app.storage.stored import LibraryError

JOURNALS_SETTING = "journals place"  # the library's setting that names the shared place
FORMAT = "gaitwright-station/1"
DRIVER = "postgresql+psycopg"


@dataclass(frozen=True, slots=True)
class Station:
    """One station of a clinic.

    `database`: the server's address, `postgresql://USER@HOST/DATABASE`. A password is better kept in the user's file of
    passwords (`~/.pgpass`), which the driver reads.
    `journals`: the shared place of the journals, where it has another name here than at the others; else empty.
    """

    id: str  # which station it is; drawn once
    database: str = field(repr=False)
    journals: str = ""

    def database_kept(self) -> Database:
        """The clinic's database, for as long as a library is open; raises as `database_once`."""
        return Database(postgres_engine(driver_url(self.database)))

    def database_once(self) -> Database:
        """Give the clinic's database for one step, no connection kept; raises LibraryError."""
        return Database(postgres_engine(driver_url(self.database), is_kept=False))

    def write(self, folder: Path) -> None:
        """Make `folder` this station's; raises OSError."""
        replace_file(folder / STATION, json.dumps({"format": FORMAT, **asdict(self)}, indent=1).encode())


def station_of(folder: Path) -> Station | None:
    """Give the station of a folder, None: it holds the library itself; raises LibraryError (damaged), OSError."""
    try:
        reported = json.loads((folder / STATION).read_bytes())
        if reported["format"] != FORMAT:
            raise ValueError(reported["format"])
        station = Station(str(UUID(reported["id"])), str(reported["database"]), str(reported["journals"]))
    except FileNotFoundError:
        return None
    except (ValueError, KeyError, TypeError):
        raise LibraryError(
            "The file with the address of the clinic's server is damaged", "Connect to the clinic's library again"
        ) from None
    return replace(
        station,
        database=os.environ.get(DATABASE_VARIABLE) or station.database,
        journals=os.environ.get(JOURNALS_VARIABLE) or station.journals,
    )


def driver_url(address: str) -> str:
    """Give the server's address for SQLAlchemy; raises LibraryError unless a PostgreSQL one."""
    try:
        url = make_url(address.strip())
    except ArgumentError:
        raise _no_address() from None
    if url.get_backend_name() != "postgresql" or not url.database:
        raise _no_address()
    return url.set(drivername=DRIVER).render_as_string(hide_password=False)


def with_password(address: str, password: str) -> str:
    """Add a typed password, if any, to the server's address; raises LibraryError unless a PostgreSQL one."""
    url = make_url(driver_url(address)).set(drivername="postgresql")
    return (url.set(password=password) if password else url).render_as_string(hide_password=False)


def server_name(address: str) -> str:
    """The server's name alone, to be shown to everybody; empty where it is this computer."""
    try:
        return make_url(address).host or ""
    except ArgumentError:
        return ""


def shown_address(address: str) -> str:
    """The server's address as it may be shown and logged: without its password."""
    try:
        return make_url(address).set(drivername="postgresql").render_as_string(hide_password=True)
    except ArgumentError:
        return ""


def _no_address() -> LibraryError:
    return LibraryError(
        "This is not the address of a PostgreSQL server", "Enter the address as postgresql://user@server/database"
    )

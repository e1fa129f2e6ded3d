"""Make a computer a station of the clinic, and make the server ready for its library."""

import os
from contextlib import closing
from pathlib import Path
from uuid import uuid4

from app.storage.clinic.journal_store import JournalStore, PlaceUnconfirmedError
from app.storage.clinic.key_slots import SharedKeySlots
from app.storage.clinic.server_state import refuse_closed
from app.storage.clinic.station import JOURNALS_SETTING, Station, driver_url
from app.storage.database.engine import Database, postgres_engine
from app.storage.database.models import SettingRow
from app.storage.database.schema import bring_up_to_date, is_up_to_date
from app.storage.files import replace_file
from app.storage.layout import JOURNALS_VARIABLE, KEYS, STATION
from app.storage.opened import made_beside
from app.storage.root import ID_FILE, ID_SETTING
from app.storage.stored import LibraryError


def new_station(address: str, journals: str = "") -> Station:
    """Make a station without a folder yet; raises LibraryError unless a PostgreSQL address."""
    driver_url(address)
    return Station(str(uuid4()), address.strip(), journals)


def join(folder: Path, address: str, journals: str = "") -> Station:
    """Make an empty or missing folder a new station's; `journals`: the shared place as called here.
    Raises LibraryError, PlaceMissingError or PlaceUnconfirmedError, which gives the place named there.
    """
    station = new_station(address, journals or os.environ.get(JOURNALS_VARIABLE, ""))
    database = station.database_once()
    if not is_up_to_date(database):
        raise LibraryError(
            "No library was found on the clinic's server",
            "First move a library to the server, in the settings of the workstation that has it",
        )
    with database.reading() as session:
        refuse_closed(session)
        library_id = str(session.get_one(SettingRow, ID_SETTING).value)
        named = str(SettingRow.of(session, JOURNALS_SETTING, ""))
    if not station.journals:
        raise PlaceUnconfirmedError(named)
    JournalStore(station.journals).refuse_missing()
    with made_beside(folder) as beside:
        _ = SharedKeySlots(beside / KEYS, database).codes  # which copies them
        replace_file(beside / ID_FILE, library_id.encode())
        station.write(beside)
    return station


def refuse_silent(station: Station) -> None:
    """Raise LibraryError where the clinic's server does not answer or has no library."""
    with station.database_once().reading() as session:
        refuse_closed(session)


def prepare_server(address: str) -> None:
    """Create or update a server's tables and roles, as stations' logins cannot; raises LibraryError."""
    with closing(Database(postgres_engine(driver_url(address)))) as database:
        bring_up_to_date(database)


def is_station(folder: Path) -> bool:
    return (folder / STATION).exists()

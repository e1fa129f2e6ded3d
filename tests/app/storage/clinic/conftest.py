"""A server of the test run's own, an empty database on it for each test, and a library that is taken there."""

import shutil
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path
from uuid import UUID

import pytest
from sqlalchemy import NullPool, create_engine, make_url, text

from app.storage.clinic.joining import join, new_station
from app.storage.clinic.moving import move_to_server
from app.storage.clinic.station import Station, driver_url
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, logged_in
from app.storage.slots import Cost
from app.storage.stored import Operator, Role
from app.system.progress import nobody
from core.session import Session
from tests.simulated import SHORT_VISIT, session_of

PASSPHRASE = "four short words here"
ANY_ROOM = Room(start_bytes=0, kept_bytes=0)


@pytest.fixture
def database_url(postgres_url: str) -> Iterator[str]:
    """The address of an empty database on the test run's own server, as a station's user types it."""
    name = f"clinic_{uuid.uuid4().hex}"
    server = create_engine(postgres_url, isolation_level="AUTOCOMMIT", poolclass=NullPool)
    with server.connect() as connection:
        connection.execute(text(f"CREATE DATABASE {name}"))
    yield make_url(postgres_url).set(drivername="postgresql", database=name).render_as_string(hide_password=False)
    with server.connect() as connection:
        connection.execute(text(f"DROP DATABASE {name} WITH (FORCE)"))
    server.dispose()


@pytest.fixture(scope="session")
def walked() -> Session:
    """A simulated patient who is, moves and walks."""
    return session_of(SHORT_VISIT)


@pytest.fixture(scope="session")
def untouched(tmp_path_factory: pytest.TempPathFactory, walked: Session) -> OpenedLibrary:
    """A library in a folder with two operators and a session in it, closed."""
    folder = tmp_path_factory.mktemp("untouched")
    slots = KeySlots(folder / KEYS, Cost(passes=1, memory_kib=64))
    data_key, _ = slots.create("hk", PASSPHRASE)
    slots.add(data_key, "ab", PASSPHRASE + " too")
    library = Library.create(folder, data_key, Operator("hk", "H. Keller", Role.ADMINISTRATOR))
    library.operators.add(Operator("ab", "A. Bauer", Role.CLINICIAN))
    import_session(OpenedLibrary(library, folder, data_key), walked, nobody, "DEMO-1", room=ANY_ROOM)
    library.close()
    return OpenedLibrary(library, folder, data_key)


@pytest.fixture
def folder(untouched: OpenedLibrary, tmp_path: Path) -> Path:
    """A library in a folder, to be taken to the server."""
    return Path(shutil.copytree(untouched.folder, tmp_path / "library"))


@pytest.fixture
def shared_place(tmp_path: Path) -> Path:
    place = tmp_path / "shared recordings"
    place.mkdir()
    return place


OpenAt = Callable[[Path], OpenedLibrary]


@pytest.fixture
def open_at(untouched: OpenedLibrary) -> Iterator[OpenAt]:
    """Opens folders for `hk`; what is still open at the end is closed."""
    opened: list[OpenedLibrary] = []

    def open_(folder: Path) -> OpenedLibrary:
        assert untouched.data_key is not None
        opened.append(logged_in(folder, untouched.data_key, "hk", is_to_be_moved=True))
        return opened[-1]

    yield open_
    for one in opened:
        one.library.close()


@pytest.fixture
def moved(folder: Path, database_url: str, shared_place: Path, open_at: OpenAt) -> Station:
    """The station that the library's folder has become."""
    station = new_station(database_url, str(shared_place))
    move_to_server(open_at(folder), station, nobody)
    return station


@pytest.fixture
def stations(moved: Station, folder: Path, tmp_path: Path, open_at: OpenAt) -> tuple[OpenedLibrary, OpenedLibrary]:
    """Two stations of one library, both opened by `hk`: where it came from, and one that joined."""
    join(tmp_path / "second", moved.database, moved.journals)
    return open_at(folder), open_at(tmp_path / "second")


@pytest.fixture
def session_id(stations: tuple[OpenedLibrary, OpenedLibrary]) -> UUID:
    (line,) = stations[0].library.sessions.list()
    return line.id


def change_row(station: Station, statement: str) -> None:
    """Do what whoever has a station's login can do on the server."""
    server = create_engine(driver_url(station.database))
    with server.begin() as connection:
        connection.execute(text(statement))
    server.dispose()


Login = Callable[[str, str], str]


@pytest.fixture
def login(moved: Station, postgres_url: str) -> Login:
    """Makes a login of its own in one of the three roles; gives the address with it."""
    made: list[str] = []

    def make(role: str, name: str) -> str:
        server = create_engine(postgres_url, isolation_level="AUTOCOMMIT")
        with server.connect() as connection:
            connection.execute(text(f"DROP ROLE IF EXISTS {name}"))
            connection.execute(text(f"CREATE ROLE {name} LOGIN PASSWORD 'secret' IN ROLE {role}"))
        server.dispose()
        made.append(name)
        url = make_url(moved.database).set(username=name, password="secret")
        return url.render_as_string(hide_password=False)

    return make

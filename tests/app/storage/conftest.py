"""Libraries to test with: on an encrypted file, and on a PostgreSQL of the test run's own."""

import shutil
import tempfile
import uuid
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from sqlalchemy import Engine, create_engine, event, text

from app.storage.database.engine import Database, postgres_engine, sqlite_engine
from app.storage.database.schema import bring_up_to_date
from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.stored import Operator, Role

DATA_KEY = bytes(range(32))
ADMINISTRATOR = Operator("hk", "H. Keller", Role.ADMINISTRATOR)

MakeEngine = Callable[[], Engine]


@pytest.fixture(scope="session")
def postgres_url() -> Iterator[str]:
    """Where a PostgreSQL listens, on a socket in a folder of its own."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it minds that a machine without desktop has no folder for sockets
        pgserver = pytest.importorskip("pgserver", reason="there is no PostgreSQL for this Python")
    folder = Path(tempfile.mkdtemp(prefix="pg"))  # pytest's own is too deep: a socket's path has 107 letters at most
    try:
        server = pgserver.get_server(folder, cleanup_mode="stop")
    except Exception as error:  # whatever a machine has against it
        shutil.rmtree(folder, ignore_errors=True)
        pytest.skip(f"PostgreSQL does not start here: {error}")
    yield server.get_uri().replace("postgresql://", "postgresql+psycopg://", 1)
    server.cleanup()
    shutil.rmtree(folder, ignore_errors=True)


# what stations share is in no program yet, and takes a tenth of the default run
@pytest.fixture(params=["sqlite", pytest.param("postgres", marks=pytest.mark.endurance)])
def make_engine(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[MakeEngine]:
    """Makes engines on one new, empty database, as many stations as are required."""
    made: list[Engine] = []
    if request.param == "sqlite":

        def make() -> Engine:
            made.append(sqlite_engine(tmp_path / DATABASE, DATA_KEY, try_s=0.1))
            return made[-1]

        yield make
    else:
        url: str = request.getfixturevalue("postgres_url")
        name = f"t{uuid.uuid4().hex}"
        server = create_engine(url)
        with server.begin() as connection:
            connection.execute(text(f"CREATE SCHEMA {name}"))

        def make() -> Engine:
            made.append(postgres_engine(f"{url}&options=-csearch_path%3D{name}", try_s=0.1))
            return made[-1]

        yield make
    for engine in made:
        engine.dispose()
    if request.param == "postgres":
        with server.begin() as connection:
            connection.execute(text(f"DROP SCHEMA {name} CASCADE"))
        server.dispose()


@pytest.fixture
def database(make_engine: MakeEngine) -> Database:
    """A new, empty database, without tables."""
    return Database(make_engine(), busy_s=1.0)


@pytest.fixture(scope="session")
def ddl() -> dict[str, list[str]]:
    """What the migrations say to each kind of database: saying it again is quicker than migrating for every test."""
    return {}


@pytest.fixture
def tables(database: Database, ddl: dict[str, list[str]]) -> Database:
    """A new database with tables and nothing in them."""
    kind = database.engine.dialect.name
    if kind in ddl:
        with database.rebuilding() as connection:
            for statement in ddl[kind]:
                connection.exec_driver_sql(statement)
        return database
    stated: list[str] = []

    def listen(connection: object, cursor: object, statement: str, *_: object) -> None:
        if statement.lstrip().startswith(("CREATE", "ALTER", "DROP", "INSERT", "UPDATE", "DO", "GRANT", "REVOKE")):
            stated.append(statement)

    event.listen(database.engine, "before_cursor_execute", listen)
    bring_up_to_date(database)
    event.remove(database.engine, "before_cursor_execute", listen)
    ddl[kind] = stated
    return database


@pytest.fixture
def library(tables: Database) -> Iterator[Library]:
    """An empty library with an administrator logged in."""
    with Library(tables, DATA_KEY) as library:
        library.begin(ADMINISTRATOR)
        yield library

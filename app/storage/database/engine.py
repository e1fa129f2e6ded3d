"""Open, lock and close the library's database, and interpret its trouble."""

import datetime
import logging
import time
import traceback
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import sqlcipher3.dbapi2 as sqlite
from sqlalchemy import Connection, Engine, NullPool, QueuePool, create_engine, event, func, make_url, select, text
from sqlalchemy.exc import DBAPIError, IntegrityError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlalchemy.orm import Session as OrmSession
from sqlalchemy.orm.exc import StaleDataError

from app.storage.data_key import KeyMaterial, checked
from app.storage.database.finite_json import finite_json, from_finite_json
from app.storage.stored import (
    ChangedMeanwhileError,
    LibraryBusyError,
    LibraryError,
    LibraryFaultError,
    ServerSilentError,
)
from app.wording.translation import tr

if TYPE_CHECKING:
    from psycopg import Connection as PgConnection

OLDEST_SQLITE = (3, 51, 3)  # before it a reset of the write-ahead log could lose pages
BUSY_S = 30.0  # a scanner or backup may hold the file for so long; a clinician waits no longer
TRY_S = 5.0  # how long one attempt waits
WAL_AGAIN_S = 0.02
PG_IDLE_S = (
    20.0  # a station that is silent for so long while it holds the write lock loses it: the others wait for less
)
PG_BUILD_LOCK = 0x6761_6974  # any number, the same at all stations
# a lock on a table needs the right to change it, which a login that only looks has not; reading goes on beside it
PG_MAY_WRITE = "SELECT has_table_privilege(to_regclass('settings'), 'UPDATE')"
PG_WRITE_LOCK = "LOCK TABLE settings IN SHARE ROW EXCLUSIVE MODE"
ONLY_READS = "only_reads"  # in the `info` of a connection whose login may change nothing
# a server that was unplugged sends nothing more: after ten seconds it counts as gone
PG_SILENT = {
    "keepalives_idle": 5,
    "keepalives_interval": 2,
    "keepalives_count": 3,
    "tcp_user_timeout": 10_000,
}
# one whose program hangs goes on being there: the longest that it may say nothing amid a statement
PG_SILENT_S = 30.0
HEX = b"0123456789abcdef"
PG_LOCKED = "55P03"  # lock_not_available
PG_NOT_ALLOWED = "42501"  # insufficient_privilege
PG_SENTENCES = (
    (
        ("authentication failed", "no pg_hba.conf entry", "no password supplied", "is not permitted to log in"),
        ("The clinic's server does not let this station in", "Compare its user and password with those of the server"),
    ),
    (
        ("certificate", "does not support SSL", "SSL error: wrong", "SSL error: sslv3", "SSL error: tlsv1"),
        ("The clinic's server could not prove who it is", "Name its root certificate: sslrootcert=FILE in its address"),
    ),
    (
        ('database "',),
        ("The clinic's server has no such database", "Compare its name with the server's"),
    ),
)
PG_NO_HOST = ("translate host name", "resolve host")
AS_WRITER = {"takes_write_lock": True}
AS_BUILDER = {"takes_write_lock": True, "leaves_references": True}

_log = logging.getLogger(__name__)


def _nothing() -> None:
    """Guards nothing: a server, and what is not yet known where it is, are always there."""


class Database:
    """One library's database. Sessions of any thread; what `writing` yields holds the one write lock.

    A server's login that only looks gets no lock: all it can do there is note what it looked at.

    `guard` raises a LibraryError where the library's folder is gone: connections that are open may still reach its
    file, under another name or as one that is deleted already, and what they wrote would be lost from sight.
    """

    def __init__(self, engine: Engine, busy_s: float = BUSY_S) -> None:
        self.engine, self._busy_s = engine, busy_s
        self.guard: Callable[[], None] = _nothing
        self._write_engine = engine.execution_options(**AS_WRITER)
        self._build_engine = engine.execution_options(**AS_BUILDER)

    @contextmanager
    def reading(self) -> Iterator[OrmSession]:
        """Give a session that sees one instant of the database; raises LibraryError."""
        try:
            with _reported(), OrmSession(self.engine) as session:
                yield session
        except LibraryFaultError:
            self.guard()  # this is then why
            raise

    @contextmanager
    def writing(self) -> Iterator[OrmSession]:
        """Hold the write lock, write all or nothing; raises LibraryError, or its LibraryBusyError after `busy_s`."""
        self.guard()
        with _reported(), self._locked_session(self._write_engine) as session:
            yield session
            _commit(session)

    @contextmanager
    def rebuilding(self) -> Iterator[Connection]:
        """Like `writing`, to alter tables: SQLite copies and drops them, so references are checked at the end."""
        with _reported(), self._locked_session(self._build_engine) as session:
            yield session.connection()
            if self.engine.dialect.name == "sqlite" and (lost := _dangling(session)):
                raise LibraryError(
                    tr("The library cannot be updated: {why}").format(why=lost[0]), "Restore the library from a backup"
                )
            session.commit()

    def _locked_session(self, engine: Engine) -> OrmSession:
        deadline = time.monotonic() + self._busy_s
        while True:
            session = OrmSession(engine)
            try:
                session.connection()  # begins, and so takes the lock
                return session
            except DBAPIError as error:
                session.close()
                if not _is_locked(error) or time.monotonic() >= deadline:
                    raise

    def clock(self, now: Callable[[], datetime.datetime]) -> Callable[[], datetime.datetime]:
        """Give `now` corrected by the server's clock, which is read once; raises LibraryError."""
        with self.reading() as session:
            ahead: datetime.timedelta = session.scalars(select(func.now())).one() - now()
        return lambda: now() + ahead

    def faults(self) -> tuple[str, ...]:
        """Read every page and check every reference; what is wrong, in the database's own words."""
        with self.reading() as session:
            if self.engine.dialect.name != "sqlite":
                return ()  # the server's business: it has checksums and tools of its own
            sealed = session.connection().execute(text("PRAGMA cipher_integrity_check"))
            found = [row[0] for row in sealed] if sealed.returns_rows else []  # none where nothing is sealed
            if not found:  # what does not open cannot be looked into
                found = [row[0] for row in session.execute(text("PRAGMA integrity_check")) if row[0] != "ok"]
                found += _dangling(session)
            return tuple(found)

    def close(self) -> None:
        """Let go of all connections: what is asked next opens the file that is there now."""
        self.engine.dispose()


def sqlite_engine(path: Path, data_key: KeyMaterial | None, try_s: float = TRY_S, *, creates: bool = True) -> Engine:
    """Open an owner-only engine; no `data_key`: unencrypted, not `creates`: no new file; raises LibraryError."""
    refuse_old_sqlite(sqlite.sqlite_version_info)

    def connect() -> sqlite.Connection:
        if creates:
            path.touch(mode=0o600)  # the log beside it takes its mode
        existing = f"{path.absolute().as_uri()}?mode=rw"
        connection = sqlite.connect(existing, timeout=try_s, isolation_level=None, check_same_thread=False, uri=True)
        try:
            _prepare(connection, data_key)
        except BaseException:
            connection.close()
            raise
        return connection

    engine = create_engine("sqlite://", module=sqlite, creator=connect, poolclass=QueuePool, hide_parameters=True)
    event.listen(engine, "begin", _begin_sqlite)
    return engine


def postgres_engine(url: str, try_s: float = TRY_S, *, is_kept: bool = True) -> Engine:
    """Open an engine (`postgresql+psycopg://...`), verified unless the URL opts out; raises LibraryError."""
    arguments: dict[str, object] = {"connect_timeout": max(2, round(try_s)), "client_encoding": "utf8", **PG_SILENT}
    asked = make_url(url)
    if asked.host and "sslmode" not in asked.query:
        arguments["sslmode"] = "verify-full"
    pool = QueuePool if is_kept else NullPool
    try:
        engine = create_engine(
            asked,
            hide_parameters=True,
            pool_pre_ping=is_kept,
            connect_args=arguments,
            poolclass=pool,
            json_serializer=finite_json,
            json_deserializer=from_finite_json,
        )
    except ImportError:
        raise LibraryError(
            "The component for the clinic's server is not installed", "Run: pip install .[clinic]"
        ) from None

    def begin(connection: Connection) -> None:
        if connection.get_execution_options().get("takes_write_lock"):
            connection.exec_driver_sql(f"SET LOCAL lock_timeout = {round(try_s * 1000)}")
            connection.exec_driver_sql(f"SET LOCAL idle_in_transaction_session_timeout = {round(PG_IDLE_S * 1000)}")
            may_write = connection.exec_driver_sql(PG_MAY_WRITE).scalar()
            connection.info[ONLY_READS] = may_write is False
            if may_write is None:  # no tables yet
                connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({PG_BUILD_LOCK})")
            elif may_write:
                connection.exec_driver_sql(PG_WRITE_LOCK)
        else:
            connection.exec_driver_sql("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ READ ONLY")

    def connect(_dialect: object, _record: object, args: tuple[Any, ...], options: dict[str, Any]) -> object:
        return _impatient_connection().connect(*args, **options)

    event.listen(engine, "begin", begin)
    event.listen(engine, "do_connect", connect)
    return engine


@cache
def _impatient_connection() -> "type[PgConnection[Any]]":
    """A connection that is closed once the server has sent nothing for `PG_SILENT_S`."""
    import psycopg  # an extra, of clinics

    class ImpatientConnection(psycopg.Connection[Any]):
        def wait(self, gen: Generator[Any, Any, Any], *args: Any, **options: Any) -> Any:
            return super().wait(self._until_silent(gen), *args, **options)

        def _until_silent(self, gen: Generator[Any, Any, Any]) -> Generator[Any, Any, Any]:
            """Pass on what the connection waits for; zero comes back several times a second while nothing happens."""
            try:
                asked, received_s = next(gen), time.monotonic()
                while True:
                    ready = yield asked
                    if ready:
                        received_s = time.monotonic()
                    elif time.monotonic() - received_s > PG_SILENT_S:
                        self.pgconn.finish()
                        raise psycopg.OperationalError("the connection was closed: the server sent nothing")
                    asked = gen.send(ready)
            except StopIteration as done:
                return done.value

    return ImpatientConnection


def refuse_old_sqlite(version: tuple[int, ...]) -> None:
    """Raise LibraryError where SQLite is older than `OLDEST_SQLITE` and may lose data."""
    if version < OLDEST_SQLITE:
        found, needed = (".".join(map(str, numbers)) for numbers in (version, OLDEST_SQLITE))
        raise LibraryError(
            tr("SQLite {found} is installed and can lose saved data; {needed} or later is required").format(
                found=found, needed=needed
            ),
            "Run packaging/start.py again to install the required version",
        )


def _prepare(connection: sqlite.Connection, data_key: KeyMaterial | None) -> None:
    connection.execute("PRAGMA cipher_log_level = NONE")  # it would write to the terminal
    if data_key is not None:
        _unlock(connection, data_key)
    connection.create_function("lower", 1, _lower, deterministic=True)
    connection.execute("PRAGMA temp_store = MEMORY")
    connection.execute("PRAGMA secure_delete = ON")
    _go_over_to_wal(connection)
    connection.execute("PRAGMA synchronous = FULL")


def _unlock(connection: sqlite.Connection, data_key: KeyMaterial) -> None:
    """Give SQLCipher the key itself, as x'HEX', in memory that is overwritten: a statement would stay as text."""
    given = bytearray(b"x'" + bytes(2 * len(data_key)) + b"'")
    for k, byte in enumerate(checked(data_key)):
        given[2 + 2 * k], given[3 + 2 * k] = HEX[byte >> 4], HEX[byte & 15]
    try:
        connection.set_key(given)
    finally:
        given[:] = bytes(len(given))


def _go_over_to_wal(connection: sqlite.Connection) -> None:
    """Keep a write-ahead log. Of two who go over to it at once SQLite refuses one, without waiting as elsewhere."""
    deadline = time.monotonic() + TRY_S
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            return
        except sqlite.OperationalError as error:
            if not _is_locked(error) or time.monotonic() >= deadline:
                raise
            time.sleep(WAL_AGAIN_S)


def _lower(value: object) -> object:
    # SQLite's own knows only the letters of ASCII
    return value.lower() if isinstance(value, str) else value


def _begin_sqlite(connection: Connection) -> None:
    options = connection.get_execution_options()
    connection.exec_driver_sql(f"PRAGMA foreign_keys = {'OFF' if options.get('leaves_references') else 'ON'}")
    connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get("takes_write_lock") else "BEGIN")


def _dangling(session: OrmSession) -> list[str]:
    return [f"{row[0]} refers to nothing" for row in session.execute(text("PRAGMA foreign_key_check"))]


@contextmanager
def _reported() -> Iterator[None]:
    """Turn the database's own errors into sentences. They are not chained: some quote what was to be written."""
    try:
        yield
    except StaleDataError:
        raise changed_meanwhile() from None
    except (DBAPIError, PoolTimeoutError, sqlite.Error) as error:
        cause = error.orig if isinstance(error, DBAPIError) else error
        _log.warning("the database refused: %s (%s)", type(cause), getattr(cause, "sqlite_errorcode", None))
        raise _sentence(error) from None
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        # whoever writes on a server may put anything into a row; a message about it would quote it
        _log.warning("a row cannot be read: %s", "".join(traceback.format_tb(error.__traceback__)))
        raise LibraryFaultError(
            "The library has an entry that Gaitwright did not write", "Restore the library from a backup"
        ) from None


def _commit(session: OrmSession) -> None:
    session.flush()  # what is refused here was not written
    try:
        session.commit()
    except DBAPIError as error:
        if error.connection_invalidated:
            raise LibraryFaultError(
                "The connection to the clinic's server was lost while saving",
                "Check whether your change was saved before you repeat it",
            ) from None
        raise


def changed_meanwhile() -> ChangedMeanwhileError:
    return ChangedMeanwhileError(
        "Someone else has changed this in the meantime", "Check the new values, then make your change again"
    )


def _is_locked(error: Exception) -> bool:
    if isinstance(error, PoolTimeoutError):
        return True  # all connections wait for somebody
    cause = error.orig if isinstance(error, DBAPIError) else error
    return getattr(cause, "sqlstate", "") == PG_LOCKED or "is locked" in str(cause)


def _sentence(error: DBAPIError | PoolTimeoutError | sqlite.Error) -> LibraryError:
    cause = error.orig if isinstance(error, DBAPIError) else error
    words = str(cause)
    if getattr(cause, "sqlstate", "") == PG_NOT_ALLOWED:
        return LibraryError(
            "The clinic's server does not permit this action for this workstation",
            "Ask the administrator of the server",
        )
    if isinstance(error, IntegrityError):
        return LibraryError(
            "This change conflicts with data already in the library", "Reload this view, then try again"
        )
    if _is_locked(error):
        return LibraryBusyError("Another program is using the library", "Wait a moment, then try again")
    if "NUL (0x00)" in words:
        return LibraryError(
            "The clinic's server cannot store text with the NUL character", "Remove this character from the text"
        )
    if "not a database" in words:
        return LibraryFaultError(
            "This key does not open the library, or the start of its file is damaged",
            "Restore the library from a backup",
        )
    if "malformed" in words:
        return LibraryFaultError("The library file is damaged", "Restore the library from a backup")
    if "is full" in words:
        return LibraryFaultError(
            "The disk is full, so this was not saved in the library", "Free up disk space, then try again"
        )
    if "readonly" in words or "unable to open" in words:
        return LibraryFaultError("The library file cannot be opened for writing", "Check the permissions of its folder")
    if type(cause).__module__.startswith("psycopg"):  # while connecting, the server gives the reason, if it answers
        for stated, (what, remedy) in PG_SENTENCES:
            if any(one in words for one in stated):
                return LibraryFaultError(what, remedy)
        if any(one in words for one in PG_NO_HOST):
            return ServerSilentError(
                "There is no server of this name in the network", "Compare the address with the server's"
            )
    if (isinstance(error, DBAPIError) and error.connection_invalidated) or "connection" in words:
        return ServerSilentError("The clinic's server does not respond", "Try again when it is back")
    if "disk I/O" in words:
        return LibraryFaultError("The library file cannot be read or written", "Check the disk, then try again")
    return LibraryFaultError(
        "The library database rejected this action",
        "Try again. If the problem persists, restore the library from a backup",
    )

"""The database file is sealed, locked, patient, and in trouble it states what to do."""

import random
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import sqlcipher3.dbapi2 as sqlite
from sqlalchemy import Engine, select, text

from app.storage.database.engine import Database, postgres_engine, refuse_old_sqlite, sqlite_engine
from app.storage.database.models import SettingRow
from app.storage.database.schema import bring_up_to_date
from app.storage.layout import DATABASE
from app.storage.stored import ChangedMeanwhileError, LibraryBusyError, LibraryError

DATA_KEY = bytes(range(32))
HOLD = """
import sys
import sqlcipher3.dbapi2 as sqlite
connection = sqlite.connect(sys.argv[1], isolation_level=None)
connection.execute("PRAGMA key = \\"x'" + bytes(range(32)).hex() + "'\\"")
connection.execute("BEGIN IMMEDIATE")
print("locked", flush=True)
sys.stdin.readline()
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / DATABASE


@pytest.fixture
def encrypted(file: Path) -> Iterator[Database]:
    database = Database(sqlite_engine(file, DATA_KEY, try_s=0.1), busy_s=0.3)
    bring_up_to_date(database)
    yield database
    database.close()


@contextmanager
def locked(file: Path) -> Iterator[Callable[[], None]]:
    """Another process holds the write lock until it is given to let go."""
    with subprocess.Popen([sys.executable, "-c", HOLD, file], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdin is not None
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"locked\n"
        yield holder.stdin.close
        holder.stdin.close()
        assert holder.wait() == 0


def put(database: Database, name: str, value: object) -> None:
    with database.writing() as session:
        session.merge(SettingRow(name=name, value=value))


def names(database: Database) -> set[str]:
    with database.reading() as session:
        return set(session.scalars(select(SettingRow.name)))


def test_an_old_sqlite_is_refused_and_this_one_is_not() -> None:
    with pytest.raises(LibraryError, match=r"SQLite 3\.51\.2.*packaging/start\.py"):
        refuse_old_sqlite((3, 51, 2))
    refuse_old_sqlite((3, 51, 3))
    refuse_old_sqlite(sqlite.sqlite_version_info)


def test_what_is_written_is_synced_wiped_and_checked(encrypted: Database) -> None:
    expected = {"journal_mode": "wal", "synchronous": 2, "foreign_keys": 1, "secure_delete": 1, "temp_store": 2}
    with encrypted.reading() as session:
        assert {name: session.scalar(text(f"PRAGMA {name}")) for name in expected} == expected


def test_only_the_owner_can_read_the_files(encrypted: Database, file: Path) -> None:
    put(encrypted, "one", 1)
    files = list(file.parent.iterdir())
    assert {path.name for path in files} == {DATABASE, f"{DATABASE}-wal", f"{DATABASE}-shm"}
    assert [path.name for path in files if path.stat().st_mode & 0o077] == []


@pytest.mark.parametrize("data_key", [bytes(32), None])
def test_another_key_or_none_does_not_open(encrypted: Database, file: Path, data_key: bytes | None) -> None:
    encrypted.close()
    stranger = Database(sqlite_engine(file, data_key))
    with pytest.raises(LibraryError, match="This key does not open the library, or the start of its file is damaged"):
        names(stranger)
    stranger.close()


def test_a_key_does_not_open_what_is_not_encrypted(file: Path) -> None:
    plain = Database(sqlite_engine(file, None))
    bring_up_to_date(plain)
    assert plain.faults() == ()
    plain.close()
    stranger = Database(sqlite_engine(file, DATA_KEY))
    with pytest.raises(LibraryError, match="This key does not open the library, or the start of its file is damaged"):
        names(stranger)
    stranger.close()


def test_who_started_from_an_older_version_is_refused(tables: Database, make_engine: Callable[[], Engine]) -> None:
    other = Database(make_engine(), busy_s=1.0)
    put(tables, "clinic", "first")
    with tables.reading() as session:
        mine = session.get_one(SettingRow, "clinic")
    with other.reading() as session:
        theirs = session.get_one(SettingRow, "clinic")
    theirs.value = "theirs"
    with other.writing() as session:
        session.add(theirs)
    mine.value = "mine"
    with pytest.raises(ChangedMeanwhileError), tables.writing() as session:
        session.add(mine)
    with tables.reading() as session:
        assert session.get_one(SettingRow, "clinic").value == "theirs"


def test_what_fails_midway_leaves_nothing(tables: Database) -> None:
    def fail() -> None:
        with tables.writing() as session:
            session.add(SettingRow(name="half", value=1))
            session.flush()
            _ = 1 / 0

    with pytest.raises(ZeroDivisionError):
        fail()
    assert names(tables) == set()


def test_whoever_holds_the_lock_for_too_long_is_reported_of(encrypted: Database, file: Path) -> None:
    with locked(file) as let_go:
        start = time.monotonic()
        with pytest.raises(LibraryBusyError):
            put(encrypted, "one", 1)
        assert 0.3 <= time.monotonic() - start < 2.0
        assert names(encrypted) == set()  # reading goes on
        let_go()
        busy = Database(encrypted.engine, busy_s=10.0)
        put(busy, "one", 1)
    assert names(encrypted) == {"one"}


def test_a_locked_server_is_waited_for_too(tables: Database, make_engine: Callable[[], Engine]) -> None:
    impatient = Database(make_engine(), busy_s=0.2)
    with tables.writing(), pytest.raises(LibraryBusyError):
        put(impatient, "one", 1)
    put(impatient, "one", 1)
    assert names(tables) == {"one"}


@pytest.mark.parametrize("held_s", [0.5, pytest.param(10.0, marks=pytest.mark.endurance)])
def test_what_is_written_while_the_database_is_locked_waits_and_is_kept(file: Path, held_s: float) -> None:
    database = Database(sqlite_engine(file, DATA_KEY, try_s=0.1))
    bring_up_to_date(database)
    failed: list[Exception] = []

    def write(writer: int) -> None:
        try:
            for k in range(5):
                put(database, f"{writer}-{k}", k)
        except LibraryError as error:
            failed.append(error)

    writers = [threading.Thread(target=write, args=(writer,)) for writer in range(4)]
    with locked(file) as let_go:
        for writer in writers:
            writer.start()
        timer = threading.Timer(held_s, let_go)
        timer.start()
        for writer in writers:
            writer.join()
        timer.join()
    assert failed == []
    assert names(database) == {f"{writer}-{k}" for writer in range(4) for k in range(5)}
    database.close()


def test_a_full_disk_is_stated_to_be_full_and_nothing_is_half_written(encrypted: Database) -> None:
    with encrypted.reading() as session:
        pages = session.scalar(text("PRAGMA page_count"))
        session.execute(text(f"PRAGMA max_page_count = {pages}"))
    with pytest.raises(LibraryError, match="disk is full"):
        put(encrypted, "large", "x" * 1_000_000)
    assert names(encrypted) == set()


def test_errors_do_not_quote_what_was_to_be_written(tables: Database, caplog: pytest.LogCaptureFixture) -> None:
    def write() -> None:
        with tables.writing() as session:
            session.add(SettingRow(name="Mustermann", value="Mustermann"))

    write()
    with pytest.raises(LibraryError, match="conflicts with data already in the library") as caught:
        write()
    assert "Mustermann" not in "".join(traceback.format_exception(caught.value))
    assert "Mustermann" not in caplog.text
    assert tables.engine.hide_parameters


def test_a_server_that_does_not_answer_is_stated_not_to(tmp_path: Path) -> None:
    nowhere = Database(postgres_engine(f"postgresql+psycopg://gaitwright@/gaitwright?host={tmp_path}"))
    with pytest.raises(LibraryError, match="server does not respond"):
        names(nowhere)
    nowhere.close()


@pytest.mark.parametrize("flips", [200, pytest.param(3_000, marks=pytest.mark.endurance)])
def test_every_flipped_bit_in_the_file_is_noticed(encrypted: Database, file: Path, flips: int) -> None:
    for k in range(100):
        put(encrypted, f"setting {k}", "x" * 2000)
    assert encrypted.faults() == ()
    encrypted.close()
    whole = file.read_bytes()
    rng = random.Random(1)
    unnoticed = []
    for _ in range(flips):
        at, bit = rng.randrange(len(whole)), rng.randrange(8)
        with file.open("r+b") as opened:
            opened.seek(at)
            opened.write(bytes([whole[at] ^ 1 << bit]))
        damaged = Database(sqlite_engine(file, DATA_KEY))
        try:
            if not damaged.faults():
                unnoticed.append((at, bit))
        except LibraryError:
            pass  # the first page: it does not even open
        damaged.close()
        with file.open("r+b") as opened:
            opened.seek(at)
            opened.write(whole[at : at + 1])
    assert unnoticed == []
    assert encrypted.faults() == ()
    assert len(names(encrypted)) == 100


def test_a_damaged_page_is_not_read_as_if_it_were_whole(encrypted: Database, file: Path) -> None:
    for k in range(100):
        put(encrypted, f"setting {k}", "x" * 2000)
    encrypted.close()
    content = bytearray(file.read_bytes())
    for page in range(1, len(content) // 4096):
        content[4096 * page + 2000] ^= 1
    file.write_bytes(content)
    with pytest.raises(LibraryError, match="damaged"):
        names(encrypted)


@pytest.mark.parametrize(
    ("url", "mode"),
    [
        ("postgresql+psycopg://gaitwright@clinic.example/gaitwright", "verify-full"),
        ("postgresql+psycopg://gaitwright@clinic.example/gaitwright?sslmode=require", "require"),
        ("postgresql+psycopg://gaitwright@/gaitwright?host=/tmp", None),
    ],
)
def test_a_server_on_the_network_has_to_prove_who_it_is(
    url: str, mode: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, object] = {}

    def stop(_connection: object, /, **arguments: object) -> None:
        asked.update(arguments)
        raise ConnectionAbortedError  # what would be sent is all there is to see

    monkeypatch.setattr("psycopg.Connection.connect", classmethod(stop))
    with pytest.raises(ConnectionAbortedError):
        postgres_engine(url).connect()
    assert asked.get("sslmode") == mode

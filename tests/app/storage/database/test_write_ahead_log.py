"""What was saved before a crash and is damaged is missed; what is whole, old or was taken back is not."""

import random
import shutil
from pathlib import Path

import pytest
import sqlcipher3.dbapi2 as sqlite

from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.models import SettingRow
from app.storage.database.write_ahead_log import is_end_lost
from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.stored import Operator, Role

DATA_KEY = bytes(range(32))
LOG = f"{DATABASE}-wal"


def crashed(folder: Path, times: int) -> Path:
    """A library as a crash leaves it, after `times` changes since its tables were made."""
    with Library.create(folder / "made", DATA_KEY, Operator("hk", "", Role.ADMINISTRATOR)) as library:
        library.close()  # what came before is in the database now, not in the log
        for k in range(times):
            put(library.database, f"setting {k}")
        shutil.copytree(folder / "made", folder / "crashed", ignore=shutil.ignore_patterns("*-shm"))
    return folder / "crashed"


def put(database: Database, name: str) -> None:
    with database.writing() as session:
        session.merge(SettingRow(name=name, value="x" * 100))


def settings(folder: Path) -> tuple[int, Library]:
    library = Library.open(folder, DATA_KEY)
    library.log_in("hk")
    return sum(library.settings.get(f"setting {k}") is not None for k in range(30)), library


@pytest.mark.endurance
def test_every_flipped_bit_in_the_log_is_noticed(tmp_path: Path) -> None:
    log = crashed(tmp_path, 10) / LOG
    whole = log.read_bytes()
    assert not is_end_lost(log)
    rng = random.Random(1)
    frame = 24 + 4096
    headers = [*range(32 + 24), *range(len(whole) - frame, len(whole) - 4096)]  # of the log, its first and last frame
    unnoticed = []
    for at in [*headers, *(rng.randrange(len(whole)) for _ in range(3_000))]:
        bit = rng.randrange(8)
        log.write_bytes(whole[:at] + bytes([whole[at] ^ 1 << bit]) + whole[at + 1 :])
        if not is_end_lost(log):
            unnoticed.append((at, bit))
    assert unnoticed == []


def test_a_library_states_that_its_end_is_lost_and_the_audit_states_so_too(tmp_path: Path) -> None:
    folder = crashed(tmp_path, 10)
    whole = (folder / LOG).read_bytes()
    (folder / LOG).write_bytes(whole[:-2000] + bytes([whole[-2000] ^ 1]) + whole[-1999:])
    left, library = settings(folder)
    with library:
        assert left < 10
        assert library.is_end_lost
        assert library.audit.entries()[-1].details == '{"failed_before":0,"is_end_lost":true}'
    left_again, library = settings(folder)
    with library:
        assert left_again == left
        assert not library.is_end_lost


def test_a_crash_alone_loses_nothing(tmp_path: Path) -> None:
    left, library = settings(crashed(tmp_path, 10))
    with library:
        assert left == 10
        assert not library.is_end_lost


def test_what_is_half_written_at_the_end_had_not_been_saved(tmp_path: Path) -> None:
    folder = crashed(tmp_path, 10)
    whole = (folder / LOG).read_bytes()
    for cut in (1, 24, 2000, 4119):
        (folder / LOG).write_bytes(whole[:-cut])
        assert not is_end_lost(folder / LOG)
    (folder / LOG).write_bytes(whole + bytes(4120))
    assert not is_end_lost(folder / LOG)
    (folder / LOG).write_bytes(b"")
    assert not is_end_lost(folder / LOG)


def test_frames_of_an_older_log_or_of_a_change_taken_back_are_not_missed(tmp_path: Path) -> None:
    database = Database(sqlite_engine(tmp_path / DATABASE, DATA_KEY))
    log = tmp_path / LOG
    with database.rebuilding() as connection:
        SettingRow.__table__.create(connection)  # type: ignore[attr-defined]  # it is a table, typed as what it selects from
    for k in range(10):
        put(database, f"setting {k}")
    other = sqlite.connect(str(tmp_path / DATABASE), isolation_level=None)
    other.execute(f"PRAGMA key = \"x'{DATA_KEY.hex()}'\"")
    assert other.execute("PRAGMA wal_checkpoint(RESTART)").fetchone()[0] == 0
    long = log.stat().st_size
    put(database, "after")
    assert log.stat().st_size == long  # older frames are behind the new ones
    assert not is_end_lost(log)
    other.execute("PRAGMA cache_size = 5")  # so that what is not committed is in the log already
    other.execute("BEGIN IMMEDIATE")
    other.executemany("INSERT INTO settings VALUES (?, ?, 1)", [(f"x{k}", '"' + "x" * 3000 + '"') for k in range(50)])
    assert log.stat().st_size > long
    assert not is_end_lost(log)
    other.execute("ROLLBACK")
    put(database, "after that")
    assert not is_end_lost(log)
    other.close()
    database.close()
    assert not is_end_lost(log)

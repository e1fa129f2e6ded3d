"""Move a library to the server and back, killed on the way again and again. Check that all of it is at one end.

After each kill at most one end can be written: the folder, or the server. Then it is run again, until it is not killed;
then rows and journals have to be what they were, as both databases say themselves.
"""

import datetime
import hashlib
import json
import random
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from uuid import UUID

import sqlcipher3.dbapi2 as sqlite

from app.storage.clinic.joining import new_station, prepare_server
from app.storage.clinic.moving import bring_back, move_to_server
from app.storage.layout import DATABASE, MOVING, RECORDINGS, STATION, SUFFIX
from app.storage.opened import open_library
from app.system.progress import nobody
from tests.driver import KILLED, Found, end_of_child
from tests.safety.clinic_material import (
    OPERATORS,
    PASSPHRASE,
    OwnServer,
    Row,
    copy_of,
    make_library,
    name_of,
    rows_of,
)

FIRST_S, LONGER = 1.0, 1.1  # in which a move may be done; it is then measured
TABLES = [
    *("patients", "sessions", "joints", "placements", "placed_sensors", "recordings", "journals"),
    *("results", "courses", "corrections", "operators"),
]
PLACES = {"kept_as", "station"}  # columns that report where something is


def move_killed(server: OwnServer, folder: Path, kills: int, seed: int) -> Found:
    """There and back with one library, until so many children were killed."""
    found, rng = Found(), random.Random(seed)
    untouched = folder / "untouched"
    make_library(untouched)
    with open_library(untouched, PASSPHRASE, OPERATORS[0]) as opened:
        assert opened.data_key is not None
        key = bytes(opened.data_key).hex()
    template = server.database()
    prepare_server(template)
    while found.count["kills"] < kills:
        with tempfile.TemporaryDirectory(dir=folder) as here:
            _Journey(server, Path(here), copy_of(untouched, Path(here) / "library"), key, found, rng).go(
                server.database(name_of(template))
            )
    return found


class _Journey:
    """One library, there and back."""

    longest_s = FIRST_S

    def __init__(
        self, server: OwnServer, here: Path, library: Path, key: str, found: Found, rng: random.Random
    ) -> None:
        self._server, self._library, self._key, self._found, self._rng = server, library, key, found, rng
        self._place, self._back = here / "place", here / "back"
        self._place.mkdir()

    def go(self, address: str) -> None:
        rows, journals = folder_rows(self._library, self._key), _journals(self._library / RECORDINGS)
        station = new_station(address, str(self._place))

        def there() -> None:
            if (self._library / STATION).exists():
                with open_library(self._library, PASSPHRASE, OPERATORS[0]):
                    return  # killed at its very end
            with open_library(self._library, PASSPHRASE, OPERATORS[0], is_to_be_moved=True) as opened:
                move_to_server(opened, station, nobody)

        def back() -> None:
            if self._back.exists():
                return
            with open_library(self._library, PASSPHRASE, OPERATORS[0], is_to_be_moved=True) as opened:
                bring_back(opened, self._back, nobody)

        self._until_done(there, address)
        self._compare("on the server", rows, server_rows(address))
        kept = rows_of(address, "SELECT file, kept_as FROM journals")
        if {row["file"]: row["kept_as"] for row in kept} != {name: sha + SUFFIX for name, sha in journals.items()}:
            self._found.faults.append("journals are kept as something else")
        if {sha + SUFFIX for sha in journals.values()} != {path.name for path in self._place.glob(f"*{SUFFIX}")}:
            self._found.faults.append("in the shared place are other journals")
        self._until_done(back, address)
        self._compare("back in a folder", rows, folder_rows(self._back, self._key))
        if _journals(self._back / RECORDINGS) != journals:
            self._found.faults.append("other journals came back")
        self._found.count["moves there or back"] += 2
        self._server.drop(address)

    def _until_done(self, work: Callable[[], None], address: str) -> None:
        is_done = False
        while not is_done:
            begin_s = time.monotonic()
            ended = end_of_child(work, self._rng.uniform(0.0, _Journey.longest_s * 1.1))
            is_done = ended == 0
            if not is_done and ended != KILLED:
                self._found.faults.append("a child ended by itself, and not well")
                return
            if is_done:
                _Journey.longest_s = time.monotonic() - begin_s
            else:
                self._found.count["kills"] += 1
                _Journey.longest_s *= LONGER  # the machine may be busy: some day it has to get through
                self._found.count["amid the work"] += (self._library / MOVING).exists() or _state(address) == "closed"
            self._look_for_two_ends(address)

    def _look_for_two_ends(self, address: str) -> None:
        """Where can somebody write now? By the files and the server's state alone."""
        ends = []
        if (self._library / DATABASE).exists() and not any((self._library / one).exists() for one in (MOVING, STATION)):
            ends.append("the folder")
        if _state(address) == "open":
            ends.append("the server")
        if (self._back / DATABASE).exists():
            ends.append("the folder that came back")
        if len(ends) > 1:
            self._found.faults.append(f"{' and '.join(ends)} can be written at once")

    def _compare(self, where: str, required: dict[str, list[str]], got: dict[str, list[str]]) -> None:
        self._found.faults += [
            f"{table} {where} is not what it was" for table in required if required[table] != got[table]
        ]


def _state(address: str) -> str:
    (known,) = rows_of(address, "SELECT to_regclass('settings') IS NOT NULL AS is_there")
    found = rows_of(address, "SELECT value FROM settings WHERE name = 'server state'") if known["is_there"] else []
    return str(found[0]["value"]) if found else ""


def server_rows(address: str) -> dict[str, list[str]]:
    return {table: _plain(rows_of(address, f"SELECT * FROM {table}")) for table in TABLES}


def folder_rows(folder: Path, key: str) -> dict[str, list[str]]:
    connection = sqlite.connect(folder / DATABASE)
    try:
        connection.execute(f"PRAGMA key = \"x'{key}'\"")
        found = {}
        for table in TABLES:
            cursor = connection.execute(f"SELECT * FROM {table}")
            names = [column[0] for column in cursor.description]
            found[table] = _plain([dict(zip(names, row, strict=True)) for row in cursor])
        return found
    finally:
        connection.close()


def _plain(rows: list[Row]) -> list[str]:
    """Rows as words, the same for both kinds of database, sorted."""
    return sorted(
        json.dumps({name: _word(name, row[name]) for name in sorted(row) if name not in PLACES}) for row in rows
    )


def _word(name: str, value: Any) -> object:
    if isinstance(value, UUID):
        return value.hex
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, bytes | memoryview):
        return bytes(value).hex()
    if isinstance(value, str) and name.endswith("_at"):
        value = datetime.datetime.fromisoformat(value).replace(tzinfo=datetime.UTC)
    if isinstance(value, datetime.datetime):
        return value.astimezone(datetime.UTC).isoformat()
    if isinstance(value, str) and value[:1] in ("{", "["):
        return json.loads(value)
    return value


def _journals(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.glob(f"*{SUFFIX}")}

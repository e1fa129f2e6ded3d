"""A clinic to be hard on: a PostgreSQL of its own that is stopped without warning, a library on it, and stations."""

import json
import shutil
import subprocess
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import psycopg

from app.storage.clinic.joining import join, new_station
from app.storage.clinic.moving import move_to_server
from app.storage.exchange import import_session
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, open_library
from app.storage.slots import Cost
from app.storage.stored import Operator, Role
from app.system.progress import nobody
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings, simulate
from tests.safety.journal_material import NO_ROOM_ASKED

if TYPE_CHECKING:
    from pgserver.postgres_server import PostgresServer

PASSPHRASE = "four short words here"
OPERATORS = ("hk", "ab")
CODES = ("DEMO-1", "DEMO-2")
Row = dict[str, Any]


class OwnServer:
    """A PostgreSQL in `folder`, on a socket there; the folder's path has to be short."""

    def __init__(self, folder: Path) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it minds that a machine without desktop has no folder for sockets
            from pgserver.postgres_server import get_server

            self._server: PostgresServer = get_server(folder, cleanup_mode="stop")

    def database(self, template: str = "template1") -> str:
        """Make a database; gives its address, as a station's user types it."""
        name = f"clinic_{uuid4().hex}"
        self.say(f"CREATE DATABASE {name} TEMPLATE {template}")
        return self._server.get_uri(name)

    def say(self, statement: str) -> None:
        with psycopg.connect(self._server.get_uri(), autocommit=True) as connection:
            connection.execute(statement.encode())

    def drop(self, address: str) -> None:
        self.say(f"DROP DATABASE {name_of(address)} WITH (FORCE)")

    def kill(self) -> None:
        """Stop at once, as after a crash: whoever is connected is cut off, and no transaction is ended."""
        import pgserver

        program = Path(pgserver.__file__).parent / "pginstall" / "bin" / "pg_ctl"
        command: list[str | Path] = [program, "-D", self._server.pgdata, "-w", "-m", "immediate", "stop"]
        subprocess.run(command, user=self._server.system_user, check=True, capture_output=True, timeout=60)

    def start(self) -> None:
        self._server.ensure_postgres_running()

    def close(self) -> None:
        self._server.cleanup()


@contextmanager
def own_server(folder: Path) -> Iterator[OwnServer]:
    server = OwnServer(folder)
    try:
        yield server
    finally:
        server.start()  # what is not there cannot be stopped well
        server.close()


def name_of(address: str) -> str:
    return address.partition("?")[0].rpartition("/")[2]


def rows_of(address: str, query: str) -> list[Row]:
    """What the server itself states."""
    with psycopg.connect(address) as connection, connection.cursor(row_factory=psycopg.rows.dict_row) as cursor:
        return list(cursor.execute(query.encode()))


def make_library(folder: Path) -> None:
    """A library with two administrators, two patients and a session of three recordings each."""
    folder.mkdir()
    slots = KeySlots(folder / KEYS, Cost(passes=1, memory_kib=64))
    data_key, _ = slots.create(OPERATORS[0], PASSPHRASE)
    slots.add(data_key, OPERATORS[1], PASSPHRASE)
    walked = simulate(
        WalkerSettings(seed=5, recordings=(Standing(), FreeMotion(duration_s=4.0), Walk(strides=3)))
    ).session
    with Library.create(folder, data_key, Operator(OPERATORS[0], "", Role.ADMINISTRATOR)) as library:
        library.operators.add(Operator(OPERATORS[1], "", Role.ADMINISTRATOR))
        for code in CODES:
            import_session(OpenedLibrary(library, folder, data_key), walked, nobody, code, room=NO_ROOM_ASKED)


@dataclass(frozen=True, slots=True)
class Clinic:
    """A library on a server, and the folders of its stations, one for each of `OPERATORS`."""

    address: str
    place: Path
    stations: tuple[Path, ...]


def make_clinic(folder: Path, server: OwnServer) -> Clinic:
    """A new library, taken to the server from the first station, which the second joins."""
    stations = tuple(folder / f"station-{code}" for code in OPERATORS)
    place, address = folder / "place", server.database()
    place.mkdir()
    make_library(stations[0])
    station = new_station(address, str(place))
    with open_library(stations[0], PASSPHRASE, OPERATORS[0], is_to_be_moved=True) as opened:
        move_to_server(opened, station, nobody)
    for other in stations[1:]:
        join(other, address, str(place))
    return Clinic(address, place, stations)


def read_lines(path: Path) -> list[Row]:
    """What a station noted, one JSON in each line; a last line that was cut off by a kill is left out."""
    if not path.exists():
        return []
    *whole, _ = path.read_text().split("\n")
    return [json.loads(line) for line in whole]


def copy_of(folder: Path, target: Path) -> Path:
    return Path(shutil.copytree(folder, target))

"""All rows of a library, copied from one database to another and compared, whatever kinds the two are."""

import datetime
import hashlib
import math
from collections.abc import Iterator, Mapping
from enum import Enum
from itertools import chain
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, Table, insert, select, update

from app.storage.audit import canonical
from app.storage.clinic.key_slots import SLOTS_SETTING
from app.storage.clinic.server_state import STATE_SETTING, TARGET_SETTING
from app.storage.clinic.station import JOURNALS_SETTING
from app.storage.database.engine import Database
from app.storage.database.models import Base, SettingRow
from app.storage.stored import LibraryError
from app.wording.translation import tr

MANY = 1000  # rows held at a time
SERVERS_OWN = (
    SLOTS_SETTING,
    JOURNALS_SETTING,
    STATE_SETTING,
    TARGET_SETTING,
)  # settings that a library in a folder has no use for
# columns that give where something is rather than what it is
PLACES: Mapping[str, frozenset[str]] = {"journals": frozenset({"kept_as"}), "recordings": frozenset({"station"})}


def copy_rows(source: Connection, target: Connection) -> None:
    """Put all rows of `source` into `target`, which has the tables and nothing in them."""
    for table in Base.metadata.sorted_tables:
        # of two rows of one table that refer to each other the later one is not there yet
        own = [column.name for column in table.columns if any(key.column.table is table for key in column.foreign_keys)]
        later: list[dict[str, Any]] = []
        for rows in _batches(source, table):
            later += [row for row in rows if any(row[name] is not None for name in own)]
            target.execute(insert(table), [row | dict.fromkeys(own) for row in rows])
        for row in later:
            target.execute(update(table).where(table.c.id == row["id"]).values({name: row[name] for name in own}))


def differing_tables(one: Database, other: Database) -> tuple[str, ...]:
    """The tables whose rows are not the same in both, but for where things are kept."""
    return tuple(table.name for table in Base.metadata.sorted_tables if _digest(one, table) != _digest(other, table))


def refuse_nul(database: Database) -> None:
    """Raise LibraryError where text has a NUL, the one character a server refuses."""
    with database.reading() as session:
        for table in Base.metadata.sorted_tables:
            for row in chain.from_iterable(_batches(session.connection(), table)):
                if name := next((name for name, value in row.items() if isinstance(value, str) and "\0" in value), ""):
                    where = f"{table.name}.{name} {'/'.join(str(row[key.name]) for key in table.primary_key)}"
                    raise LibraryError(
                        tr("A text contains the NUL character, which the server cannot store: {where}").format(
                            where=where
                        ),
                        "Remove this character from the text, then move the library",
                    )


def _batches(source: Connection, table: Table) -> Iterator[list[dict[str, Any]]]:
    required = select(table)
    if table.name == SettingRow.__tablename__:
        required = required.where(table.c.name.not_in(SERVERS_OWN))
    found = source.execution_options(yield_per=MANY).execute(required)
    for rows in found.mappings().partitions():
        yield [dict(row) for row in rows]


def _digest(database: Database, table: Table) -> str:
    """SHA-256 of all rows, in whichever order: two databases sort words differently."""
    left_out = PLACES.get(table.name, frozenset())

    def row_digest(row: Mapping[str, Any]) -> bytes:
        plain = {name: _plain(value) for name, value in row.items() if name not in left_out}
        return hashlib.sha256(canonical(plain).encode()).digest()

    with database.reading() as session:
        rows = sorted(row_digest(row) for batch in _batches(session.connection(), table) for row in batch)
    return hashlib.sha256(b"".join(rows)).hexdigest()


def _plain(value: object) -> object:
    match value:
        case bytes() | memoryview():
            return bytes(value).hex()
        case Enum():
            return value.value
        case UUID():
            return value.hex
        case datetime.datetime():
            return value.astimezone(datetime.UTC).isoformat()
        case Mapping():
            return {str(key): _plain(one) for key, one in value.items()}
        case list() | tuple():
            return [_plain(one) for one in value]
        case float() if not math.isfinite(value):
            return repr(value)
        case datetime.date() | datetime.time():  # what a session's unknown keys may hold
            return value.isoformat()
    return value

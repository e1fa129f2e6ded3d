"""Who may open a clinic's library: the slots' file is a row on the server, and each station keeps a copy of it.

With the copy a station distinguishes a wrong passphrase from a right one, and lets somebody in again after a lock,
while the server does not answer. A change is made on the server, under its write lock, or not at all.
"""

import json
import logging
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sqlalchemy.orm import Session as OrmSession

from app.storage.clinic.server_state import refuse_closed
from app.storage.database.engine import Database
from app.storage.database.models import SettingRow
from app.storage.files import replace_file
from app.storage.keys import KeySlots
from app.storage.slots import COST, Cost
from app.storage.stored import LibraryFaultError

SLOTS_SETTING = "key slots"

_log = logging.getLogger(__name__)


class SharedKeySlots(KeySlots):
    """As `KeySlots`; `path` is the station's copy. What was read is kept: one of these serves one step."""

    def __init__(self, path: Path, database: Database, cost: Cost = COST) -> None:
        super().__init__(path, cost)
        self._database = database
        self._known: bytes | None = None
        self._changed_in: OrmSession | None = None

    @property
    def exists(self) -> bool:
        try:
            self._load()
        except FileNotFoundError:
            return False
        return True

    @contextmanager
    def _alone(self) -> Iterator[None]:
        with self._database.writing() as session:
            refuse_closed(session)
            self._changed_in = session
            try:
                self._known = _content_of(session)
                yield
                session.flush()
            finally:
                self._changed_in = None
        self._copy()

    def _load(self) -> bytes:
        if self._known is None:
            self._known = self._on_server()
        if self._known is None:  # the server does not answer
            return super()._load()
        if self._changed_in is None:
            self._copy()
        return self._known

    def _save(self, content: bytes) -> None:
        if self._changed_in is None:
            raise ValueError("a clinic's keys are changed under its write lock")
        put_slots(self._changed_in, content)
        self._known = content

    def _on_server(self) -> bytes | None:
        """Read the server's slots; None: no answer; raises FileNotFoundError where it has no library."""
        try:
            with self._database.reading() as session:
                content = _content_of(session)
        except LibraryFaultError:
            _log.info("the clinic's server does not answer: the station's copy of the keys is used")
            return None
        if content is None:
            raise FileNotFoundError
        return content

    def _copy(self) -> None:
        if self._known is None:
            return
        with suppress(OSError):  # it is there for when the server is not
            if not self._path.exists() or self._path.read_bytes() != self._known:
                replace_file(self._path, self._known)


def put_slots(session: OrmSession, content: bytes) -> None:
    """Keep the slots' file on the server."""
    SettingRow.put(session, SLOTS_SETTING, json.loads(content))


def _content_of(session: OrmSession) -> bytes | None:
    row = session.get(SettingRow, SLOTS_SETTING)
    return None if row is None else json.dumps(row.value, indent=1).encode()

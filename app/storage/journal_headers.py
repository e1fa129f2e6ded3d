"""The keys in the journals' own headers, after a change of the library's data key (`app.storage.key_change`)."""

import os
from pathlib import Path

from sqlalchemy import select

from app.storage.database.engine import Database
from app.storage.database.models import JournalRow, SettingRow
from app.storage.journal.header import HEADER_BYTES, JournalHeader, JournalRefusedError

HEADERS_DUE = "journal_headers_due"  # the setting that states that headers still hold the old wrapping


def write_headers(database: Database, recordings: Path) -> None:
    """Write the database's keys into journal headers, as left by a key change; OSError: retried at next start."""
    with database.reading() as session:
        if session.get(SettingRow, HEADERS_DUE) is None:
            return
        rows = [(row.file, row.wrapped_key) for row in session.scalars(select(JournalRow)) if row.wrapped_key]
    for file, wrapped_key in rows:
        path = recordings / file
        if not path.exists():
            continue
        with path.open("r+b", buffering=0) as journal:
            found = journal.read(HEADER_BYTES)
            try:
                required = JournalHeader.parsed(found, file, wrapped_key).packed()
            except JournalRefusedError:
                continue  # damaged before, and reported as such wherever it is read
            if required != found:
                journal.seek(0)
                journal.write(required)
                os.fsync(journal.fileno())
    with database.writing() as session:
        if (row := session.get(SettingRow, HEADERS_DUE)) is not None:
            session.delete(row)

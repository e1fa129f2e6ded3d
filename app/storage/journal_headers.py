"""The keys in the headers of journals and videos, after a change of the data key (`app.storage.key_change`)."""

import os
from pathlib import Path

from sqlalchemy import select

from app.storage.database.engine import Database
from app.storage.database.models import ClipRow, JournalRow, SettingRow
from app.storage.journal.header import HEADER_BYTES, JournalHeader, JournalRefusedError
from app.storage.layout import RECORDINGS, VIDEOS

HEADERS_DUE = "journal_headers_due"  # the setting that states that headers still hold the old wrapping


def write_headers(database: Database, library: Path) -> None:
    """Write the database's keys into the files' headers, as left by a key change; OSError: retried at next start."""
    with database.reading() as session:
        if session.get(SettingRow, HEADERS_DUE) is None:
            return
        rows = [(f"{RECORDINGS}/{row.file}", row.wrapped_key) for row in session.scalars(select(JournalRow))]
        rows += [(f"{VIDEOS}/{row.file}", row.wrapped_key) for row in session.scalars(select(ClipRow))]
    for file, wrapped_key in rows:
        path = library / file
        if not wrapped_key or not path.exists():
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

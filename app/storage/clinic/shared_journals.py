"""A station's copies of the journals in the clinic's shared place: fetched to be read, gone when they may go."""

import os
from collections.abc import Collection, Mapping
from contextlib import suppress
from functools import cached_property
from pathlib import Path

from app.storage.clinic.journal_store import JournalStore, name_in_place
from app.storage.data_key import KeyMaterial
from app.storage.journal.header import RESTORE, JournalRefusedError, destroy_key, read_header
from app.storage.layout import CACHE, SUFFIX
from app.storage.stored import StoredJournal
from app.wording.translation import later

CACHED_BYTES = 20_000_000_000  # of copies on a station's disk: some hundred sessions
NOT_YET_HERE = later("this recording is still on the workstation that recorded it")
ANOTHER = later("the file in the clinic's shared storage belongs to another recording")
START_THERE = later("Start Gaitwright on the workstation that made the recording, connected to the clinic's server")


class SharedJournals:
    """`folder` is the station's, `place` the shared one; `data_key` proves what was fetched to be this library's."""

    def __init__(self, folder: Path, place: str, data_key: KeyMaterial | None) -> None:
        self.cache, self.place, self._data_key = folder / CACHE, place, data_key

    @cached_property
    def store(self) -> JournalStore:
        """Made when it is first needed: what reads an S3 bucket takes a second to load."""
        return JournalStore(self.place)

    def path(self, journal: StoredJournal) -> Path:
        """Give a journal's path, fetched if need be; raises JournalRefusedError, LibraryError or OSError."""
        path = self.cache / journal.file
        if path.exists() and journal.kept_as in ("", name_in_place(path)):
            os.utime(path)  # it was used now
        elif not journal.kept_as:
            raise JournalRefusedError(journal.file, NOT_YET_HERE, START_THERE)
        else:
            self.store.fetch(journal.kept_as, path)
        try:
            self._refuse_other(journal, path)
        except JournalRefusedError:
            path.unlink()
            raise
        return path

    def _refuse_other(self, journal: StoredJournal, path: Path) -> None:
        """Check that a copy is this segment of this recording: a row on the server may name another's bytes."""
        header = read_header(path, journal.wrapped_key)
        if (header.recording_id, header.segment) != (journal.recording_id, journal.segment):
            raise JournalRefusedError(journal.file, ANOTHER, RESTORE)
        header.key(self._data_key, journal.file)

    def destroy(self, journal: StoredJournal) -> None:
        """Remove a journal from the shared place and its copy here; raises LibraryError or OSError."""
        if journal.kept_as:
            self.store.destroy(journal.kept_as)
        destroy_copy(self.cache / journal.file)

    def take(self, path: Path) -> None:
        """Turn a handed-over file of the station into a removable copy; raises OSError."""
        self.cache.mkdir(mode=0o700, exist_ok=True)
        path.replace(self.cache / path.name)

    def tidy(self, known: Collection[str], most_bytes: int = CACHED_BYTES) -> None:
        """Remove copies of journals not in `known` (destroyed), then those unused for longest; raises OSError."""
        used: Mapping[Path, os.stat_result] = {path: path.stat() for path in self.cache.glob(f"*{SUFFIX}")}
        room = most_bytes
        for path in sorted(used, key=lambda path: used[path].st_mtime, reverse=True):
            room -= used[path].st_size
            if path.name not in known:
                destroy_copy(path)
            elif room < 0:
                path.unlink()
        for unfinished in self.cache.glob(".fetching-*"):
            unfinished.unlink()


def destroy_copy(path: Path) -> None:
    """Make a journal unreadable and remove it; one that is not there is left at that."""
    if not path.exists():
        return
    with suppress(JournalRefusedError):  # its beginning is damaged
        destroy_key(path)
    path.unlink()

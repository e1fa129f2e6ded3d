"""What was deleted thirty days ago is destroyed: the keys of its samples, its files, its rows.

A journal opens with its own key only, which stands wrapped in its header and in its row. Both are overwritten, then
the file is removed; after a kill in between the next start goes on. A disk that writes elsewhere than it is told to
(flash, snapshots) may keep the old bytes, and backups hold what was deleted until they are themselves removed, ninety
days later (`app.storage.backup`). Whoever is asked to delete for good has to be told so.
"""

import datetime
import os
from collections.abc import Callable
from pathlib import Path

from app.storage.files import sync_folder
from app.storage.journal.header import HEADER_BYTES, JournalRefusedError, destroy_key
from app.storage.library import now_utc
from app.storage.opened import OpenedLibrary
from app.storage.sessions import KEPT_DELETED
from app.storage.stored import RecordingState, StoredRecording


def destroy_overdue(opened: OpenedLibrary, now: Callable[[], datetime.datetime] = now_utc) -> int:
    """Destroy what was deleted too long ago to be restored; how many sessions that were. To be done at every start.

    Raises
    ------
    LibraryError
        The operator may not, or the database cannot be written.
    OSError
        A file cannot be overwritten or removed.
    """
    library = opened.library
    overdue = library.sessions.overdue()
    for visit in overdue:
        for recording in visit.recordings:
            destroy_recording(opened, recording)
        library.sessions.destroy(visit.id)
    for patient in library.patients.search(is_deleted=True):
        if patient.deleted_at is not None and now() - patient.deleted_at >= KEPT_DELETED:
            library.patients.destroy(patient.id)
    return len(overdue)


def destroy_recording(opened: OpenedLibrary, recording: StoredRecording) -> None:
    """Make a recording's samples unreadable for good. A recording that is destroyed already is left as it is.

    Raises
    ------
    LibraryError, OSError
        As in `destroy_overdue`.
    """
    for journal in recording.journals:
        _destroy_file(opened.recordings / journal.file)
    if recording.state is not RecordingState.DISCARDED:
        opened.library.recordings.discard(recording.id)


def _destroy_file(path: Path) -> None:
    if not path.exists():
        return  # an earlier try came as far
    try:
        destroy_key(path)
    except JournalRefusedError:  # not sealed, or its beginning is damaged, which may still hold the key
        with path.open("r+b", buffering=0) as file:
            file.write(bytes(HEADER_BYTES))
            os.fsync(file.fileno())
    path.unlink()
    sync_folder(path.parent)

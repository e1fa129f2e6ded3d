"""What was deleted thirty days ago is destroyed: the keys of its samples, its files, its rows.

A journal opens with its own key only, which is kept wrapped in its header and in its row. Both are overwritten, then
the file is removed; after a kill in between the next start goes on.

A clock that is wrong destroys nothing. Stations go by their server's. A library in a folder goes by its audit: a time
without an entry counts for a week at most, and as long as it ended less than a day ago for nothing. So a library that
is used once a month destroys what was deleted half a year later.

A disk that writes elsewhere (flash, snapshots) may keep the old bytes, and backups hold what was deleted until they are
themselves removed, ninety days later (`app.storage.backup`). Whoever is asked to delete for good has to know that.
"""

import datetime
from collections.abc import Callable
from dataclasses import replace

from app.storage.clinic.handing_over import one_at_a_time
from app.storage.clinic.journal_store import name_in_place
from app.storage.journal.destroying import destroy_file
from app.storage.library import now_utc
from app.storage.opened import OpenedLibrary
from app.storage.stored import KEPT_DELETED, RecordingState, StoredRecording, StoredSession
from app.storage.videos.destroying import destroy_clips_of

UNUSED = datetime.timedelta(days=7)  # a longer time without use may be a clock that was set
SETTLED = datetime.timedelta(days=1)  # in which somebody notices that the date is wrong


def destroy_overdue(opened: OpenedLibrary, now: Callable[[], datetime.datetime] = now_utc) -> int:
    """Destroy what is past restoring, at every start; give the number of sessions; LibraryError or OSError."""
    library = opened.library
    before = overdue_before(opened, now())
    if before is None:
        return 0
    overdue = [visit for visit in library.sessions.deleted_before(before) if not _is_at_another_station(opened, visit)]
    for visit in overdue:
        for recording in visit.recordings:
            destroy_recording(opened, recording)
        library.sessions.destroy(visit.id)
    for patient in library.patients.search(is_deleted=True):
        if patient.deleted_at is not None and patient.deleted_at <= before:
            library.patients.destroy(patient.id)
    return len(overdue)


def overdue_before(
    opened: OpenedLibrary, now: datetime.datetime, kept: datetime.timedelta = KEPT_DELETED
) -> datetime.datetime | None:
    """Give the instant since which `kept` has passed, None: not yet by a trusted clock; raises LibraryError."""
    if opened.shared is not None:  # by the server's clock, which `now` of its library goes by
        return opened.library.now() - kept
    left, later = kept, now
    for at in opened.library.audit.times():
        gap = max(later - at, datetime.timedelta(0))
        is_doubtful = gap > UNUSED and now - later < SETTLED
        counted = datetime.timedelta(0) if is_doubtful else min(gap, UNUSED)
        if counted >= left:
            return later - left
        left, later = left - counted, min(at, later)
    return None


def destroy_recording(opened: OpenedLibrary, recording: StoredRecording) -> None:
    """Make a recording's samples and videos unreadable for good; raises LibraryError, OSError."""
    destroy_clips_of(opened, recording.id)
    with one_at_a_time:
        # what was handed over since it was listed is in the shared place, too
        now = opened.library.recordings.find(recording.id) if opened.shared is not None else None
        for journal in (now or recording).journals:
            path = opened.recordings / journal.file
            if opened.shared is not None:
                if not journal.kept_as and path.exists():  # a station killed amid handing over may have put it there
                    journal = replace(journal, kept_as=name_in_place(path))
                opened.shared.destroy(journal)
            destroy_file(path)
        if recording.state is not RecordingState.DISCARDED:
            opened.library.recordings.discard(recording.id)


def _is_at_another_station(opened: OpenedLibrary, visit: StoredSession) -> bool:
    """Whether something of it is still at the station that recorded it, which then destroys it itself."""
    return opened.shared is not None and any(
        journal.wrapped_key is not None and not journal.kept_as and not (opened.recordings / journal.file).exists()
        for recording in visit.recordings
        for journal in recording.journals
    )

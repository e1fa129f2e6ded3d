"""What a station recorded is handed over to the clinic's shared place, each journal once.

A journal is put there under the hash of its bytes and read back; then its row records it; then the file here is a copy.
Killed anywhere in between, the next time goes on: what is there already is not put again.
"""

import logging
from contextlib import suppress
from pathlib import Path
from threading import Lock
from uuid import UUID

from app.storage.clinic.journal_store import name_in_place
from app.storage.clinic.shared_journals import destroy_copy
from app.storage.journal.header import find_segments
from app.storage.opened import OpenedLibrary
from app.storage.stored import LibraryError, RecordingState

ENDED = (RecordingState.CLOSED, RecordingState.RECOVERED)
one_at_a_time = Lock()  # what is destroyed must not be handed over meanwhile
_log = logging.getLogger(__name__)


def hand_over(opened: OpenedLibrary) -> frozenset[UUID]:
    """Hand over journals of ended recordings and give these; raises LibraryError or OSError, earlier ones are there."""
    shared = opened.shared
    if shared is None:
        return frozenset()
    done = set()
    with one_at_a_time:
        for recording_id, segments in sorted(_waiting(opened).items()):
            recording = opened.library.recordings.find(recording_id)
            if recording is None or recording.state not in ENDED:
                continue  # it is being recorded, or its row is still to come
            for journal in recording.journals:
                if journal.segment in segments and not journal.kept_as:
                    kept_as = shared.store.put(segments[journal.segment])
                    opened.library.recordings.note_kept(recording_id, journal.segment, kept_as)
                    done.add(recording_id)
    return frozenset(done)


def count_waiting(opened: OpenedLibrary) -> int:
    """Count recordings on this station's disk alone; raises LibraryError."""
    return len(_waiting(opened)) if opened.shared is not None else 0


def _waiting(opened: OpenedLibrary) -> dict[UUID, dict[int, Path]]:
    """Recordings of which a segment is on this station's disk alone, with all that are on it."""
    own = find_segments(opened.recordings)
    if not own:
        return {}
    kept = opened.library.recordings.kept(own)
    return {one: segments for one, segments in own.items() if not segments.keys() <= kept.get(one, {}).keys()}


def begin_station(opened: OpenedLibrary) -> None:
    """Make handed-over journals copies and remove those destroyed elsewhere, before any search for journals."""
    shared = opened.shared
    if shared is None:
        return
    with one_at_a_time, suppress(FileNotFoundError):
        own = find_segments(opened.recordings)
        kept = opened.library.recordings.kept(own)
        for recording_id, segments in own.items():
            for segment in kept.get(recording_id, {}).keys() & segments.keys():
                if name_in_place(segments[segment]) == kept[recording_id][segment]:
                    shared.take(segments[segment])
                else:  # the shared place has another: this one may be the longer, and stays
                    _log.error("%s is not what was handed over", segments[segment].name)
        for recording_id in opened.library.recordings.destroyed(own):
            for path in own[recording_id].values():
                destroy_copy(path)
        try:
            shared.tidy(opened.library.recordings.readable_files())
            shared.store.tidy()
        except (LibraryError, OSError) as error:
            _log.warning("copies of recordings that were destroyed are still here", exc_info=error)

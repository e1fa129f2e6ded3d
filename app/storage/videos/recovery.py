"""Videos of a program or machine that ended without stopping: found at the next start, and closed with what they hold.

Only the program that holds the library alone may ask (`opened.held_alone`).
"""

import logging
from dataclasses import dataclass, field
from pathlib import Path
from uuid import UUID

from app.storage.journal.destroying import destroy_file
from app.storage.journal.header import JournalRefusedError, find_segments
from app.storage.layout import SUFFIX
from app.storage.opened import OpenedLibrary
from app.storage.stored import ClipState, RecordingState, StoredClip
from app.storage.videos.destroying import destroy_clip
from app.storage.videos.reader import ClipContents, read_clip

running: set[UUID] = set()
"""The videos that this program is recording."""

_log = logging.getLogger(__name__)


@dataclass(slots=True)
class FoundClips:
    """What came of the videos that nobody stopped.

    `closed`: which now can be shown; `removed`: how many held no picture, or belonged to nobody any more; `left`: files
    that nothing is known of, each with why. Those stay where they are.
    """

    closed: list[StoredClip] = field(default_factory=list)
    removed: int = 0
    left: dict[str, str] = field(default_factory=dict)


def recover_clips(opened: OpenedLibrary) -> FoundClips:
    """Close every open video, and look whose files without a row are; raises LibraryError, OSError."""
    found = FoundClips()
    if opened.shared is not None or opened.away_from is not None:
        return found
    opened.refuse_gone()  # else all files would seem to be missing
    for clip in opened.library.clips.in_state(ClipState.OPEN):
        if clip.id not in running:
            try:
                _note(found, close_by_file(opened, clip))
            except JournalRefusedError as refusal:  # it stays open, as a recording does
                found.left[clip.file] = refusal.what
            except OSError as error:  # as a disk has it that is worn out: the others are not kept by it
                found.left[clip.file] = error.strerror or "it cannot be read"
    for path in opened.videos.glob(f"*{SUFFIX}.new"):  # a kill while a header was written: nothing is in it
        if not any(path.name.startswith(str(clip_id)) for clip_id in running):
            path.unlink(missing_ok=True)
    known = opened.library.clips.known()
    for clip_id, segments in find_segments(opened.videos).items():
        if clip_id not in known and clip_id not in running:
            for path in segments.values():
                _look_whose(opened, clip_id, path, found)
    if found.closed or found.removed or found.left:
        _log.warning("videos recovered: %d, removed: %d, left: %d", len(found.closed), found.removed, len(found.left))
    for file, why in found.left.items():
        _log.warning("%s is left where it is: %s", file, why)
    return found


def close_by_file(opened: OpenedLibrary, clip: StoredClip) -> StoredClip | None:
    """Close a video with what its file holds; None: no picture, so it is gone; JournalRefusedError, OSError."""
    path = opened.videos / clip.file
    contents = read_clip(path, clip.id, opened.data_key, clip.wrapped_key) if path.exists() else None
    if contents is None or not contents.frames:
        destroy_clip(opened, clip.id)
        return None
    return _closed(opened, clip.id, contents)


def _closed(opened: OpenedLibrary, clip_id: UUID, contents: ClipContents) -> StoredClip | None:
    # whole: only its row was left over
    state = ClipState.CLOSED if contents.report.is_whole else ClipState.RECOVERED
    return opened.library.clips.close(clip_id, state, contents.frames, contents.length_s, contents.report.sha256)


def _look_whose(opened: OpenedLibrary, clip_id: UUID, path: Path, found: FoundClips) -> None:
    """Give a file without a row to its walk, destroy it where that is gone, leave it where nobody knows."""
    library = opened.library
    try:
        contents = read_clip(path, clip_id, opened.data_key)
    except JournalRefusedError as refusal:
        found.left[path.name] = refusal.what
        return
    except OSError as error:
        found.left[path.name] = error.strerror or "it cannot be read"
        return
    mark = contents.mark
    if mark is None and contents.frames:
        found.left[path.name] = "it does not state whose it is"
        return
    recording = library.recordings.find(mark.recording) if mark is not None else None
    if mark is None or not contents.frames or _is_unwanted(opened, mark.recording):
        destroy_file(path)
        found.removed += 1
    elif recording is None:
        found.left[path.name] = "its walk waits to be recovered"
    elif not library.clips.consent(library.sessions.get(recording.session_id).patient_id).is_given:
        found.left[path.name] = "nobody noted that the patient agreed"
    elif any(one.camera == mark.camera for one in library.clips.of_recording(recording.id)):
        found.left[path.name] = "its walk has another video from this camera"
    else:
        size, key = (mark.width, mark.height), contents.header.wrapped_key or None
        library.clips.start(
            clip_id, recording.id, mark.camera, mark.view, size, mark.rate_hz, key, is_imported=mark.is_imported
        )
        _note(found, _closed(opened, clip_id, contents))


def _is_unwanted(opened: OpenedLibrary, recording_id: UUID) -> bool:
    """Whether the walk of a video is destroyed, or its patient agrees no longer."""
    library = opened.library
    recording = library.recordings.find(recording_id)
    if recording is None:
        return recording_id not in find_segments(opened.recordings)
    patient_id = library.sessions.get(recording.session_id).patient_id
    return recording.state is RecordingState.DISCARDED or library.clips.consent(patient_id).withdrawn_at is not None


def _note(found: FoundClips, closed: StoredClip | None) -> None:
    if closed is None:
        found.removed += 1
    else:
        found.closed.append(closed)

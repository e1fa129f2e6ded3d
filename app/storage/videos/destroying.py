"""Videos are made unreadable for good: one, all of a walk, or all of a patient who agrees no longer.

First the row is discarded, which takes the video out of sight and forgets its key; then the key in the file's header is
overwritten and the file removed; then the row goes. Killed anywhere in between, the next start goes on.
"""

from collections.abc import Iterable, Sequence
from uuid import UUID

from app.storage.journal.destroying import destroy_file
from app.storage.opened import OpenedLibrary
from app.storage.stored import ClipState, StoredClip


def destroy_clip(opened: OpenedLibrary, clip_id: UUID) -> None:
    """Destroy one video at once; raises LibraryError, OSError (the next start goes on)."""
    clip = opened.library.clips.delete(clip_id)
    if clip is not None:
        _finish(opened, clip)


def destroy_clips_of(opened: OpenedLibrary, recording_id: UUID) -> None:
    """Destroy all videos of a walk; raises as `destroy_clip`."""
    for clip in opened.library.clips.of_recording(recording_id):
        destroy_clip(opened, clip.id)


def withdraw_consent(opened: OpenedLibrary, patient_id: UUID) -> int:
    """Note that a patient agrees no longer and destroy the patient's videos; how many; raises as `destroy_clip`."""
    return _finish_all(opened, opened.library.clips.withdraw_consent(patient_id))


def destroy_all(opened: OpenedLibrary, clip_ids: Iterable[UUID]) -> int:
    """Destroy many at once; how many; raises as `destroy_clip`, after all were tried."""
    clips = opened.library.clips
    return _finish_all(opened, [one for clip_id in clip_ids if (one := clips.delete(clip_id)) is not None])


def finish_destroying(opened: OpenedLibrary) -> int:
    """Go on with what a kill left; how many videos; raises as `destroy_clip`."""
    return _finish_all(opened, opened.library.clips.in_state(ClipState.DISCARDED))


def _finish_all(opened: OpenedLibrary, clips: Sequence[StoredClip]) -> int:
    """One whose file another program holds keeps none of the others."""
    failed: OSError | None = None
    for clip in clips:
        try:
            _finish(opened, clip)
        except OSError as error:
            failed = failed or error
    if failed is not None:
        raise failed
    return len(clips)


def _finish(opened: OpenedLibrary, clip: StoredClip) -> None:
    opened.refuse_gone()  # else its file would seem to be gone
    destroy_file(opened.videos / clip.file)
    opened.library.clips.forget(clip.id)

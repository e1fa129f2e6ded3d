"""Write a camera's frames onto the disk, sealed, beside the walk's samples and never in their way.

A frame is put into a bounded queue and written by the journal's own thread. Where the disk is too slow a frame is
dropped and counted; where it gets full the video ends, while the walk still has room.
"""

from collections.abc import Callable
from typing import Protocol, Self
from uuid import UUID

from app.storage.database.ids import uuid7
from app.storage.journal.destroying import destroy_file
from app.storage.journal.disk import FULL_RATE_BYTES_S, ROOM, Room, Trouble
from app.storage.journal.header import JournalRefusedError
from app.storage.journal.writer import JournalStatus, JournalWriter, State
from app.storage.opened import OpenedLibrary
from app.storage.stored import ClipRefusedError, ClipState, StoredClip
from app.storage.videos.content import FRAME, MOST_BYTES, NO_PTS, ClipMark
from app.storage.videos.destroying import destroy_clip
from app.storage.videos.recovery import close_by_file, running
from app.wording.translation import tr
from devices.clocks.host_clock import host_time_ns
from devices.source import SourceInfo

BYTES_PER_PIXEL = 0.09  # 1280 x 720 pixels 30 times a second are 2.5 MB/s
QUEUE_BYTES = 20 << 20  # eight seconds of them
# A walk may begin where there is room for ten minutes of samples and what a walk leaves free besides. A video ends
# before less than that is left: so the walk that it is of has its ten minutes, and a next one can begin.
LEFT_TO_WALKS = ROOM.start_bytes + round(ROOM.start_s * FULL_RATE_BYTES_S)
CLIP_ROOM = Room(start_s=60.0, start_bytes=LEFT_TO_WALKS, warn_s=0.0, kept_bytes=LEFT_TO_WALKS)
DRIVER, VERSION = "camera", "1"


class ClipFrame(Protocol):
    """A picture as it came. `pts_ns`: by the camera's own clock, None where it states none."""

    @property
    def arrival_ns(self) -> int: ...
    @property
    def pts_ns(self) -> int | None: ...
    @property
    def jpeg(self) -> bytes: ...


class ClipMode(Protocol):
    """What a camera was asked for."""

    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def rate_hz(self) -> float: ...


class ClipWriter:
    """One video while it is made. `add` may be called from any one thread, and waits for no disk.

    `on_trouble` is called as a journal's is, from any thread; a video that `has_ended` takes no more frames.
    """

    def __init__(self, opened: OpenedLibrary, stored: StoredClip, journal: JournalWriter, source: int) -> None:
        self._opened, self._stored, self._journal, self._source = opened, stored, journal, source
        self.id = stored.id
        self.frames = self.dropped_frames = 0
        self._first_ns = self._last_ns = 0
        self._closed: StoredClip | None = None

    @classmethod
    def create(
        cls,
        opened: OpenedLibrary,
        recording_id: UUID,
        recording_opened_ns: int,
        camera: int,
        view: str,
        mode: ClipMode,
        *,
        is_imported: bool = False,
        on_trouble: Callable[[Trouble], None] | None = None,
        room: Room = CLIP_ROOM,
        now_ns: Callable[[], int] = host_time_ns,
        queue_bytes: int = QUEUE_BYTES,
    ) -> Self:
        """Begin a video of a walk; `recording_opened_ns`: of its journal's header. Waits for the disk.
        Raises ClipRefusedError (no row, no consent, no room, a clinic's library, folder gone) or LibraryError.
        """
        _refuse_elsewhere(opened)
        clip_id = uuid7()
        running.add(clip_id)
        rate_bytes_s = BYTES_PER_PIXEL * mode.width * mode.height * mode.rate_hz
        size = (mode.width, mode.height)
        try:
            journal = _begun(opened, clip_id, rate_bytes_s, room, on_trouble, now_ns, queue_bytes)
            mark = ClipMark(recording_id, recording_opened_ns, camera, view, *size, mode.rate_hz, is_imported)
            journal.mark(mark.text())
            source = journal.source(SourceInfo(DRIVER, VERSION))
            key = journal.header.wrapped_key or None
            try:
                stored = opened.library.clips.start(
                    clip_id, recording_id, camera, view, size, mode.rate_hz, key, is_imported=is_imported
                )
            except BaseException:
                journal.stop()
                destroy_file(journal.path)
                raise
        except BaseException:
            running.discard(clip_id)
            raise
        return cls(opened, stored, journal, source)

    def add(self, frame: ClipFrame, *, waits: bool = False) -> bool:
        """Keep one frame; whether it was taken. `waits` (imports): for room in the queue instead of dropping it."""
        pts_ns = NO_PTS if frame.pts_ns is None else frame.pts_ns
        is_taken = len(frame.jpeg) <= MOST_BYTES and self._journal.received(
            self._source, FRAME.pack(frame.arrival_ns, pts_ns) + frame.jpeg, waits=waits
        )
        if not is_taken:
            self.dropped_frames += 1
            return False
        self._first_ns = frame.arrival_ns if not self.frames else self._first_ns
        self._last_ns = frame.arrival_ns
        self.frames += 1
        return True

    @property
    def status(self) -> JournalStatus:
        return self._journal.status

    @property
    def has_ended(self) -> bool:
        """Whether it takes nothing more: the disk is full or gone, or it was stopped."""
        return self._journal.status.state is not State.RECORDING

    def stop(self) -> StoredClip | None:
        """Write what waits and close; None: it holds no picture, or was deleted. Repeatable; raises LibraryError."""
        if self._closed is not None:
            return self._closed
        summary = self._journal.stop()
        running.discard(self.id)
        is_known = summary.state is State.CLOSED and summary.reason in ("stopped", Trouble.NO_ROOM)
        if is_known and self.frames:
            length_s = (self._last_ns - self._first_ns) / 1e9
            clips = self._opened.library.clips
            self._closed = clips.close(self.id, ClipState.CLOSED, self.frames, length_s, summary.sha256)
        else:
            self._closed = self._closed_by_file()
        if self._closed is None:
            destroy_clip(self._opened, self.id)
        return self._closed

    def _closed_by_file(self) -> StoredClip | None:
        """What is on the disk counts: not all that was taken may be."""
        try:
            return close_by_file(self._opened, self._stored)
        except JournalRefusedError:
            raise ClipRefusedError(
                "The video cannot be read back", "Check the disk. The next start of Gaitwright tries again"
            ) from None


def _refuse_elsewhere(opened: OpenedLibrary) -> None:
    """Raise ClipRefusedError where a library keeps no videos, or cannot now."""
    if opened.shared is not None or opened.away_from is not None:
        raise ClipRefusedError(
            "A clinic's shared library stores no videos", "Continue without video, or use a library on this computer"
        )
    if not opened.is_there:
        raise ClipRefusedError(
            "The library folder is not available, so no video is stored", "Put its folder back, or connect its disk"
        )


def _begun(
    opened: OpenedLibrary,
    clip_id: UUID,
    bytes_per_s: float,
    room: Room,
    on_trouble: Callable[[Trouble], None] | None,
    now_ns: Callable[[], int],
    queue_bytes: int,
) -> JournalWriter:
    """The file, with its header; raises ClipRefusedError."""
    try:
        return JournalWriter.create(
            opened.videos,
            clip_id,
            opened.data_key,
            bytes_per_s=bytes_per_s,
            room=room,
            on_trouble=on_trouble,
            now_ns=now_ns,
            queue_bytes=queue_bytes,
        )
    except JournalRefusedError as refusal:
        raise ClipRefusedError("There is not enough disk space for a video", refusal.remedy) from None
    except OSError as error:
        raise ClipRefusedError(
            tr("The video cannot be written ({why})").format(why=error.strerror), "Check the disk, then try again"
        ) from error

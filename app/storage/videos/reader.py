"""A video as its file holds it: where each frame is, and when it was taken. A frame is opened when it is shown."""

from dataclasses import dataclass
from errno import EIO
from pathlib import Path
from uuid import UUID

import numpy as np
from numpy.typing import NDArray

from app.storage.data_key import KeyMaterial
from app.storage.journal.header import HEADER_BYTES, TAG_BYTES, JournalHeader, JournalRefusedError, read_header
from app.storage.journal.payloads import STREAM
from app.storage.journal.reader import Damage, JournalReader, ReadReport
from app.storage.journal.records import CHECKSUM, RECORD_HEADER, RecordKind, Seal
from app.storage.opened import OpenedLibrary
from app.storage.stored import ClipRefusedError, ClipState, StoredClip
from app.storage.videos.content import FRAME, NO_PTS, ClipMark
from app.wording.translation import later, tr
from core.video.clip import Clip

USUAL_DELAY_NS = 200_000_000  # a camera whose frames mostly come later than this after its own times has another clock
MISSING = later("Restore the library from a backup with videos")

IntArray = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Places:
    """Where the frames' records are in the file, and their numbers, each of shape (frames,)."""

    offset: IntArray
    size: IntArray
    number: IntArray


@dataclass(frozen=True, slots=True)
class ClipContents:
    """What one pass over a video's file shows. `taken_ns`, shape (frames,), on the computer's clock."""

    header: JournalHeader
    mark: ClipMark | None  # None: it is damaged
    places: Places
    taken_ns: IntArray
    report: ReadReport

    @property
    def frames(self) -> int:
        return len(self.taken_ns)

    @property
    def length_s(self) -> float:
        return float(self.taken_ns[-1] - self.taken_ns[0]) / 1e9 if self.frames else 0.0


class StoredPictures:
    """The frames of one file. Nothing is kept open: the file may be destroyed meanwhile."""

    def __init__(self, path: Path, places: Places, seal: Seal) -> None:
        self._path, self._places, self._seal = path, places, seal

    def __len__(self) -> int:
        return len(self._places.number)

    def jpeg(self, number: int) -> bytes:
        """Give one frame's JPEG; raises IndexError, or OSError where it is damaged or gone."""
        offset, size = int(self._places.offset[number]), int(self._places.size[number])
        with self._path.open("rb") as file:
            file.seek(offset)
            found = self._seal.opened(memoryview(file.read(size)), None)
        if found is None or found[0].number != self._places.number[number]:
            raise OSError(EIO, f"picture {number} is damaged", str(self._path))
        return found[0].payload[STREAM.size + FRAME.size :]


def open_clip(opened: OpenedLibrary, stored: StoredClip, recording_name: str) -> Clip:
    """Read where a video's frames are, in one pass over its file; raises ClipRefusedError, LibraryError, OSError."""
    if stored.state is ClipState.NOT_IN_BACKUP:
        raise ClipRefusedError(
            tr("The video of {recording} is not in the backup that this library was restored from").format(
                recording=recording_name
            ),
            MISSING,
        )
    path = opened.videos / stored.file
    if not path.exists():
        opened.refuse_gone()
        raise ClipRefusedError(
            tr("The file of the video of {recording} is missing").format(recording=recording_name), MISSING
        )
    try:
        contents = read_clip(path, stored.id, opened.data_key, stored.wrapped_key)
        key = contents.header.key(opened.data_key, path.name)
        mark = contents.mark
        opened_ns = mark.recording_opened_ns if mark else recording_opened_ns(opened, stored.recording_id)
    except JournalRefusedError:
        raise ClipRefusedError(
            tr("The video of {recording} is damaged and cannot be opened").format(recording=recording_name), MISSING
        ) from None
    return Clip(
        stored.id,
        recording_name,
        stored.camera,
        stored.view,
        stored.width,
        stored.height,
        stored.rate_hz,
        (contents.taken_ns - opened_ns) / 1e9,
        stored.sync,
        StoredPictures(path, contents.places, Seal(contents.header, key)),
    )


def open_clips(opened: OpenedLibrary, session_id: UUID) -> tuple[tuple[Clip, ...], tuple[ClipRefusedError, ...]]:
    """Open the videos of all walks of a session, and why others do not open; raises LibraryError or OSError."""
    clips, refused = [], []
    stored = opened.library.clips.of_session(session_id)
    for recording in opened.library.sessions.get(session_id).recordings:
        for clip in stored.get(recording.id, ()):
            try:
                clips.append(open_clip(opened, clip, recording.details.name))
            except ClipRefusedError as refusal:
                refused.append(refusal)
    return tuple(clips), tuple(refused)


def read_clip(
    path: Path, clip_id: UUID, data_key: KeyMaterial | None, wrapped_key: bytes | None = None
) -> ClipContents:
    """Read all of a video's file but the pictures; raises JournalRefusedError (also another's file) or OSError."""
    reader = JournalReader(path, data_key, wrapped_key)
    if reader.header.recording_id != clip_id:
        raise JournalRefusedError(path.name, tr("this is the file of another video"), MISSING)
    around = RECORD_HEADER.size + CHECKSUM.size + (TAG_BYTES if reader.header.is_sealed else 0)
    offset, mark = HEADER_BYTES, None
    rows: list[tuple[int, int, int, int, int]] = []
    for record in reader.records():
        if isinstance(record, Damage):
            offset += record.size
            continue
        size = around + len(record.payload)
        if record.kind is RecordKind.MARK:
            mark = mark or ClipMark.parsed(record.payload)
        elif record.kind is RecordKind.BYTES and len(record.payload) > STREAM.size + FRAME.size:
            rows.append((offset, size, record.number, *FRAME.unpack_from(record.payload, STREAM.size)))
        offset += size
    columns = np.array(rows, dtype=np.int64).reshape(-1, 5).T
    places = Places(*(np.ascontiguousarray(column) for column in columns[:3]))
    return ClipContents(reader.header, mark, places, taken_ns(columns[3], columns[4]), reader.report)


def taken_ns(arrival_ns: IntArray, pts_ns: IntArray) -> IntArray:
    """When frames were taken, on the clock of their arrivals, never before the frame before; all of shape (frames,).

    While the camera's own times increase, the least delayed frame ties its clock to the arrivals'. A camera that states
    no times, or times by a clock that does not go as fast, is taken by its arrivals.
    """
    taken = arrival_ns.copy()
    is_cut = np.flatnonzero((np.diff(pts_ns) <= 0) | (np.diff(pts_ns == NO_PTS) != 0)) + 1
    for run in np.split(np.arange(len(arrival_ns)), is_cut):
        if len(run) and pts_ns[run[0]] >= 0:
            delay = arrival_ns[run] - pts_ns[run]
            if np.median(delay) - delay.min() <= USUAL_DELAY_NS:
                taken[run] = pts_ns[run] + delay.min()
    return np.maximum.accumulate(taken)


def recording_opened_ns(opened: OpenedLibrary, recording_id: UUID) -> int:
    """Give where the times of a walk's samples begin, by its own file; raises JournalRefusedError or OSError."""
    recording = opened.library.recordings.find(recording_id)
    if recording is None or not recording.journals:
        raise JournalRefusedError(str(recording_id), tr("this recording's file is missing"), MISSING)
    first = recording.journals[0]
    return read_header(opened.journal_path(first), first.wrapped_key).opened_ns

"""Write what sensors send onto the disk, whatever the disk is doing.

Whoever reads a port only puts into a bounded queue; one thread seals, writes and syncs. A disk that stalls fills the
queue, never a port; what no longer fits is dropped, counted and reported. A kill costs what was not yet written, a
power cut what was not yet synced.

Where the library's folder is gone, or can no longer be written, the recording goes on in its shelter, in a segment of
its own that continues the one before. A disk that was pulled out costs what a power cut does, a renamed folder nothing.
"""

import contextlib
import json
import logging
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from errno import EDQUOT, EFBIG, ENOSPC
from pathlib import Path
from types import TracebackType
from typing import Self
from uuid import UUID

from app.storage.data_key import KeyMaterial
from app.storage.journal.disk import FULL_RATE_BYTES_S, ROOM, JournalFile, Room, Trouble
from app.storage.journal.header import JournalHeader, find_segments
from app.storage.journal.inlet import Inlet, Waiting
from app.storage.journal.payloads import STREAM, Footer, Rows, SampleLayout, SourceEntry, rows_of
from app.storage.journal.records import FIRST_NUMBER, MAX_PAYLOAD, Record, RecordKind, Seal
from app.storage.journal.shelter import DrawnSegment, Shelter
from core.samples import ImuBlock
from devices.clocks.host_clock import host_time_ns
from devices.source import SourceInfo

WRITE_EVERY_S, SYNC_EVERY_S = 0.02, 0.5
QUEUE_BYTES = 8 << 20  # ten seconds and more of six sensors at 400 Hz
WRITE_BYTES = 1 << 20  # at most so much at a time, for memory's sake
SLOW_S = 1.0
MEASURED_S = 10.0  # after which the rate is what was seen, not what was expected
OUT_OF_SPACE = {ENOSPC, EDQUOT, EFBIG}

_log = logging.getLogger(__name__)


class State(StrEnum):
    RECORDING = "recording"
    CLOSED = "closed"
    BROKEN = "broken"  # without a footer; readable all the same


@dataclass(frozen=True, slots=True)
class JournalStatus:
    """How the journal is doing.

    `written_s`, `synced_s`: when the last record that was written, or is known to be on the disk, came, since the
    journal was opened.
    """

    state: State
    records: int
    bytes: int
    stuck_s: float  # for how long records have waited and none was written, while the process ran
    left_s: float  # until there is no more room
    written_s: float
    synced_s: float
    dropped_records: int
    dropped_bytes: int
    troubles: frozenset[Trouble]


@dataclass(frozen=True, slots=True)
class JournalSummary:
    """What is kept once all is written. `sha256` of the file, for its row; empty where it has no footer.

    Where it `is_away`, the last segment is in the shelter, and `path`, `sha256` and `bytes` are that one's.
    """

    path: Path
    state: State
    reason: str
    sha256: str
    records: int
    bytes: int
    dropped_records: int
    dropped_bytes: int
    is_away: bool = False


class _LibraryGoneError(Exception):
    """The library's folder is not where it was; the file that is open may still take what it is given."""


class JournalWriter:
    """One segment of one recording, and its continuation where its library goes away.

    Every method may be called from any thread and, `stop` aside, waits for no disk. `received`, `sent`, `samples` and
    `mark` return whether the record was taken. `on_trouble` is called once for each kind of trouble, from whichever
    thread meets it, within a second of it; it must not call `stop`.
    """

    def __init__(
        self,
        file: JournalFile,
        segment: DrawnSegment,
        bytes_per_s: float,
        room: Room,
        on_trouble: Callable[[Trouble], None] | None,
        inlet: Inlet,
        shelter: Shelter | None = None,
        next_segment: DrawnSegment | None = None,
    ) -> None:
        self.path, self.header = segment.path, segment.header
        self._file, self._seal, self._room = file, Seal(segment.header, segment.key), room
        self._shelter, self._next = shelter, next_segment
        self._sources: dict[int, SourceEntry] = {}  # as the file describes them
        self._last_ns = segment.header.opened_ns
        self._dropped_before = self._dropped_bytes_before = 0  # described by the segment before
        self._expected_bytes_s, self._on_trouble = bytes_per_s, on_trouble
        self._inlet = inlet
        self._troubles: set[Trouble] = set()
        self._number = FIRST_NUMBER
        self._records = 0
        self._written_s = self._known_s = 0.0
        self._left_s = float("inf")
        self._reason = "stopped"
        self._state = State.RECORDING
        self._began_s = self._synced_s = time.monotonic()
        self._looked_s, self._looked_size = 0.0, 0
        self._is_stopping = False
        self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
        self._thread.start()

    @classmethod
    def create(
        cls,
        folder: Path,
        recording_id: UUID,
        data_key: KeyMaterial | None,
        *,
        bytes_per_s: float = FULL_RATE_BYTES_S,
        room: Room = ROOM,
        on_trouble: Callable[[Trouble], None] | None = None,
        now_ns: Callable[[], int] = host_time_ns,
        wall_ns: Callable[[], int] = time.time_ns,
        queue_bytes: int = QUEUE_BYTES,
        shelter: Shelter | None = None,
        awake_s: Callable[[], float] = time.monotonic,
    ) -> Self:
        """Open the recording's next segment under its own key; raises JournalRefusedError (no room), OSError.
        `folder` may be missing, not its parent; `data_key` None: unsealed; `shelter` None: may end early.
        `bytes_per_s`: for the room; `awake_s`: a clock that stops with the process, to judge the disk by.
        """
        opened_wall_ns, opened_ns = wall_ns(), now_ns()

        def drawn(place: Path, number: int) -> DrawnSegment:
            return DrawnSegment.of(place, JournalHeader(recording_id, number, opened_wall_ns, opened_ns), data_key)

        def begun(place: Path, is_held: bool = False) -> tuple[DrawnSegment, JournalFile]:
            room.check(place, bytes_per_s)
            segment = drawn(place, 1 + max(find_segments(place).get(recording_id, {}), default=0))
            return segment, segment.begun(is_held)

        following = None
        if shelter is not None and not shelter.is_home():
            segment, file = begun(shelter.made(), is_held=True)
        else:
            try:
                folder.mkdir(mode=0o700, exist_ok=True)
                segment, file = begun(folder)
                # drawn now, so that the library's key need not be kept until then
                following = drawn(shelter.folder, segment.header.segment + 1) if shelter is not None else None
            except OSError as error:
                if shelter is None or error.errno in OUT_OF_SPACE:
                    raise
                _log.warning("the library's folder cannot be written: the recording is begun in the shelter")
                segment, file = begun(shelter.made(), is_held=True)
        inlet = Inlet(queue_bytes, now_ns, opened_ns, awake_s)
        return cls(file, segment, bytes_per_s, room, on_trouble, inlet, shelter, following)

    def source(self, info: SourceInfo, layout: SampleLayout | None = None) -> int:
        """Describe a source before its first byte, with a `layout` if it gives samples; give its number."""
        return self._inlet.source(info, layout)

    def change(self, source: int, info: SourceInfo, layout: SampleLayout | None = None) -> None:
        """Describe a source whose settings changed, or which came back: what follows does not join what was before."""
        self._inlet.change(source, info, layout)

    def received(self, source: int, data: bytes, *, waits: bool = False) -> bool:
        """Keep what was read from a source, before anything looks at it; `waits` (imports): never drop."""
        return self._stream(RecordKind.BYTES, source, data, waits=waits)

    def sent(self, source: int, data: bytes) -> bool:
        """Keep what was written to a source."""
        return self._stream(RecordKind.SENT, source, data)

    def samples(self, source: int, sensor: int, block: ImuBlock, *, waits: bool = False) -> bool:
        """Keep samples of a source's sensor, times in seconds since opening; `waits` (imports): never drop."""
        entry = self._inlet.sources[source]
        if entry.layout is None or not 0 <= sensor < len(entry.info.sensors):
            raise ValueError(f"source {source} gives no samples of a sensor {sensor}")
        numbers, texts = rows_of(block, entry.layout)
        return self._rows(Rows(source, sensor, numbers, texts), waits)

    def mark(self, text: str) -> bool:
        """Keep what the operator noted, at this moment."""
        return self._inlet.put_mark(json.dumps(text).encode())

    def stop(self) -> JournalSummary:
        """Write all that is waiting, the footer, and close. Waits for the disk."""
        self._is_stopping = True
        self._thread.join()
        is_closed = self._state is State.CLOSED
        return JournalSummary(
            path=self.path,
            state=self._state,
            reason=self._reason,
            sha256=self._file.sha256() if is_closed else "",
            records=self._records,
            bytes=self._file.size,
            dropped_records=self._inlet.dropped_records,
            dropped_bytes=self._inlet.dropped_bytes,
            is_away=self.is_away,
        )

    @property
    def is_away(self) -> bool:
        """Whether it writes in the shelter."""
        return self._shelter is not None and self._next is None

    @property
    def status(self) -> JournalStatus:
        return JournalStatus(
            state=self._state,
            records=self._records,
            bytes=self._file.size,
            stuck_s=self._inlet.stuck_s,
            left_s=self._left_s,
            written_s=self._written_s,
            synced_s=self._known_s,
            dropped_records=self._inlet.dropped_records,
            dropped_bytes=self._inlet.dropped_bytes,
            troubles=frozenset(self._troubles.copy()),
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.stop()

    # whoever calls

    def _stream(self, kind: RecordKind, source: int, data: bytes, *, waits: bool = False) -> bool:
        if len(data) > MAX_PAYLOAD - STREAM.size:
            k = len(data) // 2
            return self._stream(kind, source, data[:k], waits=waits) & self._stream(kind, source, data[k:], waits=waits)
        return self._put(kind, source, STREAM.pack(source) + data, waits=waits)

    def _rows(self, rows: Rows, waits: bool) -> bool:
        payload = rows.packed()
        if len(payload) > MAX_PAYLOAD and len(rows.numbers) > 1:
            first, second = rows.halves()
            return self._rows(first, waits) & self._rows(second, waits)  # both, whatever became of the first
        return self._put(RecordKind.SAMPLES, rows.source, payload, waits)

    def _put(self, kind: RecordKind, source: int, payload: bytes, waits: bool) -> bool:
        is_taken = self._inlet.put(kind, source, payload, waits=waits)
        if self._inlet.stuck_s > SLOW_S:
            self._show_message(Trouble.DISK_SLOW)
        if not is_taken and self._inlet.is_open:
            self._show_message(Trouble.DROPPED)
        return is_taken

    def _show_message(self, trouble: Trouble) -> None:
        if trouble in self._troubles:
            return
        self._troubles.add(trouble)
        if self._on_trouble is not None:
            try:
                self._on_trouble(trouble)
            except Exception:  # whoever listens must not end the recording
                _log.exception("a listener failed on %s", trouble)

    # the journal's thread

    def _run(self) -> None:
        try:
            while not self._is_written():
                self._go_into_shelter()
        except OSError as error:
            self._give_up(Trouble.DISK_FULL if error.errno in OUT_OF_SPACE else Trouble.DISK_GONE)
        except Exception:  # the thread's edge: whatever it is, it is reported
            _log.exception("the journal's thread failed")
            self._give_up(Trouble.DISK_GONE)

    def _is_written(self) -> bool:
        """Write until it is stopped, and close; False: what follows belongs into the shelter."""
        try:
            self._write_until_stopped()
            self._close(self._reason)
        except _LibraryGoneError:
            self._end_segment()
            return False
        except OSError as error:
            if error.errno in OUT_OF_SPACE or self._next is None:
                raise
            _log.warning("the journal cannot be written any more: it goes on in the shelter", exc_info=error)
            with contextlib.suppress(OSError):
                self._file.close()  # no footer: what was not yet synced may be missing
            return False
        return True

    def _write_until_stopped(self) -> None:
        while not self._is_stopping and self._has_room():
            if self._inlet.waiting_bytes < WRITE_BYTES:
                time.sleep(WRITE_EVERY_S)  # a tenth of the cost of waiting for an event, fifty times a second
            self._write_batch()
            if time.monotonic() - self._synced_s >= SYNC_EVERY_S:
                self._sync()
                if self._next is not None and self._shelter is not None and not self._shelter.is_home():
                    raise _LibraryGoneError
        self._inlet.close()
        while not self._inlet.is_empty:
            self._write_batch()

    def _write_batch(self) -> None:
        batch = self._inlet.take(WRITE_BYTES)
        out = bytearray()
        for kind, time_ns, payload in batch:
            out += self._sealed(kind, time_ns, payload)
        if out:
            self._file.append(out)
            self._records += len(batch)
            self._last_ns = batch[-1][1]
            self._written_s = (self._last_ns - self.header.opened_ns) / 1e9
            self._inlet.written(len(batch))
            self._note_sources(batch)

    def _sync(self) -> None:
        self._file.sync()
        self._synced_s, self._known_s = time.monotonic(), self._written_s

    def _sealed(self, kind: RecordKind, time_ns: int, payload: bytes) -> bytes:
        # a number is spent when it is used, not when it is written: its nonce must not come again
        number, self._number = self._number, self._number + 1
        return self._seal.closed(Record(number, kind, time_ns, payload))

    def _note_sources(self, batch: Sequence[Waiting]) -> None:
        for kind, _, payload in batch:
            if kind is RecordKind.SOURCE:
                entry = SourceEntry.parsed(payload)
                self._sources[entry.number] = replace(entry, dropped_records=0, dropped_bytes=0)

    def _end_segment(self) -> None:
        """Close a file whose folder is gone; if deleted, copy it, as a copy of the library lacks the latest."""
        assert self._shelter is not None  # else nobody looks where the library is
        try:
            self._append_footer(Trouble.MOVED)
            if self._file.is_deleted:
                self._file.copy_to(self._shelter.made() / self.path.name)
        except OSError as error:
            _log.warning("the journal of a library that is gone has no footer", exc_info=error)
        with contextlib.suppress(OSError):
            self._file.close()

    def _go_into_shelter(self) -> None:
        """Go on in the shelter, in the next segment, in which the sources are described as in the one before."""
        assert self._shelter is not None  # without one nothing else was drawn
        assert self._next is not None
        self._shelter.made()
        segment, self._next = self._next, None
        self._file = segment.begun(is_held=True)
        self.path, self.header, self._seal = segment.path, segment.header, Seal(segment.header, segment.key)
        self._number = FIRST_NUMBER
        self._began_s, self._looked_s, self._looked_size = time.monotonic(), 0.0, 0
        reported = (self._sealed(RecordKind.SOURCE, self._last_ns, entry.packed()) for entry in self._sources.values())
        if out := b"".join(reported):
            self._file.append(out)
        self._show_message(Trouble.MOVED)

    def _has_room(self) -> bool:
        """Whether the recording may go on; looked at twice a second, and sooner where much was written since."""
        now_s, size = time.monotonic(), self._file.size
        if now_s - self._looked_s < SYNC_EVERY_S and size - self._looked_size <= self._room.kept_bytes / 8:
            return True
        self._looked_s, self._looked_size = now_s, size
        elapsed_s = now_s - self._began_s
        rate = size / elapsed_s if elapsed_s > MEASURED_S else self._expected_bytes_s
        spare = self._file.free_bytes() - self._room.kept_bytes
        self._left_s = max(spare, 0) / max(rate, 1.0)
        if spare <= 0:
            self._reason = Trouble.NO_ROOM
            self._show_message(Trouble.NO_ROOM)
        elif self._left_s < self._room.warn_s:
            self._show_message(Trouble.LITTLE_ROOM)
        return spare > 0

    def _close(self, reason: str) -> None:
        self._append_footer(reason)
        self._file.close()
        self._state = State.CLOSED

    def _append_footer(self, reason: str) -> None:
        records, size = self._inlet.dropped_records, self._inlet.dropped_bytes
        footer = Footer(reason, records - self._dropped_before, size - self._dropped_bytes_before)
        # of a segment that is gone on with: what still waits is the next one's, and as old as it is
        now_ns = self._last_ns if reason == Trouble.MOVED else self._inlet.last_ns()
        self._file.append(self._sealed(RecordKind.FOOTER, now_ns, footer.packed()))
        self._sync()
        self._dropped_before, self._dropped_bytes_before = records, size

    def _give_up(self, trouble: Trouble) -> None:
        """End on a disk that fails: nothing more is taken, what was not written is counted, the file is let go."""
        self._inlet.abandon()
        self._reason = trouble
        self._show_message(trouble)
        try:
            if trouble is Trouble.DISK_FULL:
                self._close(trouble)  # the cut-off piece is gone again, which most often leaves room for a footer
                return
        except OSError:
            _log.warning("there was no room for the journal's footer")
        self._state = State.BROKEN
        with contextlib.suppress(OSError):
            self._file.close()

"""How does what sensors send get onto the disk, whatever the disk is doing?

Whoever reads a port only puts into a bounded queue; one thread seals, writes and syncs. A disk that stalls fills the
queue, never a port; what no longer fits is dropped, counted and told. A kill costs what was not yet written, a power
cut what was not yet synced.
"""

import json
import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from errno import EDQUOT, EFBIG, ENOSPC
from pathlib import Path
from types import TracebackType
from typing import Self
from uuid import UUID

from app.storage.journal.disk import FULL_RATE_BYTES_S, ROOM, JournalFile, Room, Trouble
from app.storage.journal.header import JournalHeader, find_segments, segment_path
from app.storage.journal.payloads import STREAM, Footer, Rows, SampleLayout, SourceEntry, rows_of
from app.storage.journal.records import FIRST_NUMBER, MAX_PAYLOAD, OVERHEAD_BYTES, Kind, Record, Seal
from core.samples import ImuBlock
from devices.source import SourceInfo

WRITE_EVERY_S, SYNC_EVERY_S = 0.02, 0.5
QUEUE_BYTES = 8 << 20  # ten seconds and more of six sensors at 400 Hz
WRITE_BYTES = 1 << 20  # at most so much at a time, for memory's sake
SLOW_NS = 1_000_000_000
MEASURED_S = 10.0  # after which the rate is what was seen, not what was expected
OUT_OF_SPACE = {ENOSPC, EDQUOT, EFBIG}

_log = logging.getLogger(__name__)


class State(StrEnum):
    RECORDING = "recording"
    CLOSED = "closed"
    BROKEN = "broken"  # without a footer; readable all the same


@dataclass(frozen=True, slots=True)
class JournalStatus:
    """`waiting_s`: how old the oldest record is that is not yet written. `left_s`: until there is no more room."""

    state: State
    records: int
    bytes: int
    waiting_s: float
    left_s: float
    dropped_records: int
    dropped_bytes: int
    troubles: frozenset[Trouble]


@dataclass(frozen=True, slots=True)
class JournalSummary:
    """What is kept once all is written. `sha256` of the file, for its row; empty where it has no footer."""

    path: Path
    state: State
    reason: str
    sha256: str
    records: int
    bytes: int
    dropped_records: int
    dropped_bytes: int


class JournalWriter:
    """One segment of one recording. Every method may be called from any thread and, `stop` aside, waits for no disk.

    `received`, `sent`, `samples` and `mark` return whether the record was taken. `on_trouble` is called once for each
    kind of trouble, from whichever thread meets it, within a second of it; it must not call `stop`.
    """

    def __init__(
        self,
        file: JournalFile,
        path: Path,
        header: JournalHeader,
        key: bytes | None,
        bytes_per_s: float,
        room: Room,
        on_trouble: Callable[[Trouble], None] | None,
        now_ns: Callable[[], int],
        queue_bytes: int,
    ) -> None:
        self.path, self.header = path, header
        self._file, self._seal, self._room = file, Seal(header, key), room
        self._expected_bytes_s, self._on_trouble, self._now_ns = bytes_per_s, on_trouble, now_ns
        self._queue_bytes = queue_bytes

        self._lock = threading.Lock()  # of all below up to the thread
        self._queue: list[tuple[Kind, int, bytes]] = []
        self._queued_bytes = 0  # those being written included
        self._oldest_ns: int | None = None
        self._last_ns = header.opened_ns
        self._sources: dict[int, SourceEntry] = {}
        self._dropped_records = self._dropped_bytes = 0
        self._troubles: set[Trouble] = set()
        self._takes_records = True

        # the thread's own
        self._number = FIRST_NUMBER
        self._records = 0
        self._left_s = float("inf")
        self._reason = "stopped"
        self._state = State.RECORDING
        self._began_s = self._synced_s = time.monotonic()
        self._looked_s, self._looked_size = 0.0, 0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
        self._thread.start()

    @classmethod
    def create(
        cls,
        folder: Path,
        recording_id: UUID,
        data_key: bytes | None,
        *,
        bytes_per_s: float = FULL_RATE_BYTES_S,
        room: Room = ROOM,
        on_trouble: Callable[[Trouble], None] | None = None,
        now_ns: Callable[[], int] = time.monotonic_ns,
        wall_ns: Callable[[], int] = time.time_ns,
        queue_bytes: int = QUEUE_BYTES,
    ) -> Self:
        """Open the next segment of a recording, under a key of its own.

        Parameters
        ----------
        data_key
            The library's, to wrap the journal's key with; None for the demonstration's library: nothing is sealed.
        bytes_per_s
            What the sources are expected to send, for the question whether there is room.

        Raises
        ------
        JournalRefusedError
            There is too little room.
        OSError
            The folder cannot be written.
        """
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        room.check(folder, bytes_per_s)
        segment = 1 + max(find_segments(folder).get(recording_id, {}), default=0)
        header, key = JournalHeader(recording_id, segment, wall_ns(), now_ns()), None
        if data_key is not None:
            header, key = header.with_new_key(data_key)
        path = segment_path(folder, recording_id, segment)
        file = JournalFile(path, header.packed())
        return cls(file, path, header, key, bytes_per_s, room, on_trouble, now_ns, queue_bytes)

    def source(self, info: SourceInfo, layout: SampleLayout | None = None) -> int:
        """Tell of a source before its first byte; returns its number. `layout` for one that gives samples.

        Raises
        ------
        ValueError, TypeError
            The settings are more than JSON can hold.
        """
        with self._lock:
            entry = SourceEntry(len(self._sources), info, layout)
            self._put(Kind.SOURCE, entry.packed())
            self._sources[entry.number] = entry
        return entry.number

    def change(self, source: int, info: SourceInfo, layout: SampleLayout | None = None) -> None:
        """Tell of a source whose settings changed, or which came back: what follows does not join what was before."""
        with self._lock:
            was = self._sources[source]
            entry = replace(was, info=info, layout=layout)
            self._put(Kind.SOURCE, entry.packed())
            self._sources[source] = replace(entry, dropped_records=0, dropped_bytes=0)

    def received(self, source: int, data: bytes) -> bool:
        """Keep what was read from a source, before anything looks at it."""
        return self._stream(Kind.BYTES, source, data)

    def sent(self, source: int, data: bytes) -> bool:
        """Keep what was written to a source."""
        return self._stream(Kind.SENT, source, data)

    def samples(self, source: int, sensor: int, block: ImuBlock) -> bool:
        """Keep samples of the source's sensor of that index; their times are seconds since the journal was opened.

        Raises
        ------
        ValueError
            The source gives no samples, has no such sensor, or the block's columns are not those of its layout.
        """
        entry = self._sources[source]
        if entry.layout is None or not 0 <= sensor < len(entry.info.sensors):
            raise ValueError(f"source {source} gives no samples of sensor {sensor}: {entry.info.sensors}")
        numbers, texts = rows_of(block, entry.layout)
        return self._rows(Rows(source, sensor, numbers, texts))

    def mark(self, text: str) -> bool:
        """Keep what the operator noted, at this moment."""
        with self._lock:
            return self._put(Kind.MARK, json.dumps(text).encode())

    def stop(self) -> JournalSummary:
        """Write all that is waiting, the footer, and close. Waits for the disk."""
        self._stop.set()
        self._thread.join()
        is_closed = self._state is State.CLOSED
        return JournalSummary(
            path=self.path,
            state=self._state,
            reason=self._reason,
            sha256=self._file.sha256() if is_closed else "",
            records=self._records,
            bytes=self._file.size,
            dropped_records=self._dropped_records,
            dropped_bytes=self._dropped_bytes,
        )

    @property
    def status(self) -> JournalStatus:
        with self._lock:
            waiting_ns = self._now_ns() - self._oldest_ns if self._oldest_ns is not None else 0
            return JournalStatus(
                state=self._state,
                records=self._records,
                bytes=self._file.size,
                waiting_s=max(waiting_ns, 0) / 1e9,
                left_s=self._left_s,
                dropped_records=self._dropped_records,
                dropped_bytes=self._dropped_bytes,
                troubles=frozenset(self._troubles),
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.stop()

    # whoever calls

    def _stream(self, kind: Kind, source: int, data: bytes) -> bool:
        if len(data) > MAX_PAYLOAD - STREAM.size:
            half = len(data) // 2
            return all([self._stream(kind, source, data[:half]), self._stream(kind, source, data[half:])])
        return self._put_for(source, kind, STREAM.pack(source) + data)

    def _rows(self, rows: Rows) -> bool:
        payload = rows.packed()
        if len(payload) > MAX_PAYLOAD and len(rows.numbers) > 1:
            half = len(rows.numbers) // 2
            head, tail = [texts[:half] for texts in rows.texts], [texts[half:] for texts in rows.texts]
            first = replace(rows, numbers=rows.numbers[:half], texts=head)
            return all([self._rows(first), self._rows(replace(rows, numbers=rows.numbers[half:], texts=tail))])
        return self._put_for(rows.source, Kind.SAMPLES, payload)

    def _put_for(self, source: int, kind: Kind, payload: bytes) -> bool:
        """Put a source's record; after some had to be dropped, the source is told of anew, with their count."""
        news: list[Trouble] = []
        with self._lock:
            entry = self._sources[source]
            has_room = self._queued_bytes + len(payload) + OVERHEAD_BYTES <= self._queue_bytes
            is_taken = has_room and self._takes_records
            if is_taken:
                if entry.dropped_records:
                    self._put(Kind.SOURCE, entry.packed())
                    self._sources[source] = replace(entry, dropped_records=0, dropped_bytes=0)
                self._put(kind, payload)
                if self._last_ns - (self._oldest_ns or 0) > SLOW_NS:
                    news.append(Trouble.DISK_SLOW)
            else:
                self._drop(1, len(payload))
                self._sources[source] = replace(
                    entry,
                    dropped_records=entry.dropped_records + 1,
                    dropped_bytes=entry.dropped_bytes + len(payload),
                )
                if self._takes_records:
                    news.append(Trouble.DROPPED)
        if news:
            self._tell(*news)
        return is_taken

    def _put(self, kind: Kind, payload: bytes) -> bool:
        """Queue a record, the lock being held. Sources and marks, being few and small, are never too many."""
        if len(payload) > MAX_PAYLOAD:
            raise ValueError(f"a record holds {len(payload)} bytes, expected {MAX_PAYLOAD} at most")
        if not self._takes_records:
            self._drop(1, len(payload))
            return False
        self._last_ns = max(self._now_ns(), self._last_ns)  # inside the lock: the order of numbers is that of times
        if self._oldest_ns is None:
            self._oldest_ns = self._last_ns
        self._queue.append((kind, self._last_ns, payload))
        self._queued_bytes += len(payload) + OVERHEAD_BYTES
        return True

    def _drop(self, records: int, size: int) -> None:
        self._dropped_records += records
        self._dropped_bytes += size

    def _tell(self, *troubles: Trouble) -> None:
        for trouble in troubles:
            with self._lock:
                is_known = trouble in self._troubles
                self._troubles.add(trouble)
            if not is_known and self._on_trouble is not None:
                try:
                    self._on_trouble(trouble)
                except Exception:  # whoever listens must not end the recording
                    _log.exception("a listener failed on %s", trouble)

    # the journal's thread

    def _run(self) -> None:
        try:
            self._write_until_stopped()
            self._close(self._reason)
        except OSError as error:
            self._give_up(Trouble.DISK_FULL if error.errno in OUT_OF_SPACE else Trouble.DISK_GONE)
        except Exception:  # the thread's edge: whatever it is, it is told
            _log.exception("the journal's thread failed")
            self._give_up(Trouble.DISK_GONE)

    def _write_until_stopped(self) -> None:
        while not self._stop.wait(WRITE_EVERY_S) and self._has_room():
            self._write_waiting()
            if time.monotonic() - self._synced_s >= SYNC_EVERY_S:
                self._file.sync()
                self._synced_s = time.monotonic()
        with self._lock:
            self._takes_records = False
        self._write_waiting()

    def _write_waiting(self) -> None:
        with self._lock:
            batch, self._queue = self._queue, []
        first = 0
        while first < len(batch):
            out, last = bytearray(), first
            while last < len(batch) and len(out) < WRITE_BYTES:
                out += self._sealed(*batch[last])
                last += 1
            try:
                self._file.append(out)
            except OSError:
                with self._lock:
                    self._queue[:0] = batch[first:]  # not written: counted as dropped with the rest
                raise
            with self._lock:
                self._records += last - first
                self._queued_bytes -= sum(len(payload) + OVERHEAD_BYTES for _, _, payload in batch[first:last])
                waiting = batch[last:] or self._queue
                self._oldest_ns = waiting[0][1] if waiting else None
            first = last

    def _sealed(self, kind: Kind, time_ns: int, payload: bytes) -> bytes:
        # a number is spent when it is used, not when it is written: its nonce must not come again
        number, self._number = self._number, self._number + 1
        return self._seal.closed(Record(number, kind, time_ns, payload))

    def _has_room(self) -> bool:
        is_looked_at_lately = time.monotonic() - self._looked_s < SYNC_EVERY_S
        if is_looked_at_lately and self._file.size - self._looked_size <= self._room.kept_bytes / 8:
            return True
        self._looked_s, self._looked_size = time.monotonic(), self._file.size
        elapsed_s = time.monotonic() - self._began_s
        rate = self._file.size / elapsed_s if elapsed_s > MEASURED_S else self._expected_bytes_s
        spare = self._file.free_bytes() - self._room.kept_bytes
        self._left_s = max(spare, 0) / max(rate, 1.0)
        if spare <= 0:
            self._reason = Trouble.NO_ROOM
            self._tell(Trouble.NO_ROOM)
        elif self._left_s < self._room.warn_s:
            self._tell(Trouble.LITTLE_ROOM)
        return spare > 0

    def _close(self, reason: str) -> None:
        with self._lock:
            footer = Footer(reason, self._dropped_records, self._dropped_bytes)
            self._last_ns = max(self._now_ns(), self._last_ns)
        self._file.append(self._sealed(Kind.FOOTER, self._last_ns, footer.packed()))
        self._file.sync()
        self._file.close()
        self._state = State.CLOSED

    def _give_up(self, trouble: Trouble) -> None:
        """End on a disk that fails: nothing more is taken, what was not written is counted, the file is let go."""
        with self._lock:
            self._takes_records = False
            self._drop(len(self._queue), sum(len(payload) for _, _, payload in self._queue))
            self._queue, self._queued_bytes, self._oldest_ns = [], 0, None
        self._reason = trouble
        self._tell(trouble)
        try:
            if trouble is Trouble.DISK_FULL:
                self._close(trouble)  # the cut-off piece is gone again, which most often leaves room for a footer
        except OSError:
            _log.warning("there was no room for the journal's footer")
        if self._state is not State.CLOSED:
            self._state = State.BROKEN
            self._let_go()

    def _let_go(self) -> None:
        try:
            self._file.close()
        except OSError:
            _log.warning("the journal's file did not close")

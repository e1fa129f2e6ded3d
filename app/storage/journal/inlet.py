"""Rules for what may be put in, and what waits to be written. A queue that holds up nobody, bounded in bytes."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace

from app.storage.journal.payloads import SampleLayout, SourceEntry
from app.storage.journal.records import MAX_PAYLOAD, OVERHEAD_BYTES, RecordKind
from devices.source import SourceInfo

Waiting = tuple[RecordKind, int, bytes]
"""Kind, time and payload of a record that has no number yet."""


class Inlet:
    """Between whoever reads a source and the one thread that writes. Every method may be called from any thread.

    A record waits here until it is written, so one whose writing failed is still here to be counted. What does not fit
    is dropped and counted; before its source's next record the source is described again, with how many it lacks.
    """

    def __init__(
        self,
        limit_bytes: int,
        now_ns: Callable[[], int],
        opened_ns: int,
        awake_s: Callable[[], float] = time.monotonic,
    ) -> None:
        """`awake_s` is the clock that records wait by: one that stops with the process blames no disk for it."""
        self._limit_bytes, self._now_ns, self._last_ns, self._awake_s = limit_bytes, now_ns, opened_ns, awake_s
        self._change = threading.Condition()
        self._waiting: deque[Waiting] = deque()
        self.waiting_bytes = 0
        self._stuck_since_s: float | None = None
        self.is_open = True
        self.sources: dict[int, SourceEntry] = {}
        self.dropped_records = self.dropped_bytes = 0

    def source(self, info: SourceInfo, layout: SampleLayout | None) -> int:
        with self._change:
            entry = SourceEntry(len(self.sources), info, layout)
            self._append(RecordKind.SOURCE, entry.packed())
            self.sources[entry.number] = entry
        return entry.number

    def change(self, source: int, info: SourceInfo, layout: SampleLayout | None) -> None:
        with self._change:
            self._show_again(replace(self.sources[source], info=info, layout=layout))

    def put(self, kind: RecordKind, source: int, payload: bytes, *, waits: bool = False) -> bool:
        """Put in a source's record; whether it was taken. `waits` for room instead of dropping it."""
        size = len(payload) + OVERHEAD_BYTES
        with self._change:
            while waits and self.is_open and self._waiting and self.waiting_bytes + size > self._limit_bytes:
                self._change.wait()
            entry = self.sources[source]
            if not self.is_open or self.waiting_bytes + size > self._limit_bytes:
                self._drop(len(payload))
                self.sources[source] = replace(
                    entry,
                    dropped_records=entry.dropped_records + 1,
                    dropped_bytes=entry.dropped_bytes + len(payload),
                )
                return False
            if entry.dropped_records:
                self._show_again(entry)
            return self._append(kind, payload)

    def put_mark(self, payload: bytes) -> bool:
        """Put in a mark: few and small as they are, there is always room for them."""
        with self._change:
            return self._append(RecordKind.MARK, payload)

    def take(self, most_bytes: int) -> list[Waiting]:
        """The oldest records, some `most_bytes` of them. They go on waiting until they are `written`."""
        taken: list[Waiting] = []
        size = 0
        with self._change:
            for record in self._waiting:
                if size >= most_bytes:
                    break
                taken.append(record)
                size += len(record[2])
        return taken

    def written(self, count: int) -> None:
        with self._change:
            for _ in range(count):
                _, _, payload = self._waiting.popleft()
                self.waiting_bytes -= len(payload) + OVERHEAD_BYTES
            self._stuck_since_s = self._awake_s() if self._waiting else None
            self._change.notify_all()

    def close(self) -> None:
        """Take nothing more."""
        with self._change:
            self.is_open = False
            self._change.notify_all()

    def abandon(self) -> None:
        """Take nothing more, and count what waits as dropped."""
        self.close()
        with self._change:
            for _, _, payload in self._waiting:
                self._drop(len(payload))
            self._waiting.clear()
            self.waiting_bytes, self._stuck_since_s = 0, None

    def last_ns(self) -> int:
        """Now, and never before the latest record."""
        with self._change:
            self._last_ns = max(self._now_ns(), self._last_ns)
            return self._last_ns

    @property
    def is_empty(self) -> bool:
        return not self._waiting

    @property
    def stuck_s(self) -> float:
        """For how long records have been waiting and none was written."""
        since_s = self._stuck_since_s
        return 0.0 if since_s is None else self._awake_s() - since_s

    def _append(self, kind: RecordKind, payload: bytes) -> bool:
        if len(payload) > MAX_PAYLOAD:
            raise ValueError(f"a record holds {len(payload)} bytes, expected {MAX_PAYLOAD} at most")
        if not self.is_open:
            self._drop(len(payload))
            return False
        self._last_ns = max(self._now_ns(), self._last_ns)  # under the lock: records are in order of their times
        self._waiting.append((kind, self._last_ns, payload))
        self.waiting_bytes += len(payload) + OVERHEAD_BYTES
        if self._stuck_since_s is None:
            self._stuck_since_s = self._awake_s()
        return True

    def _show_again(self, entry: SourceEntry) -> None:
        self._append(RecordKind.SOURCE, entry.packed())
        self.sources[entry.number] = replace(entry, dropped_records=0, dropped_bytes=0)

    def _drop(self, size: int) -> None:
        self.dropped_records += 1
        self.dropped_bytes += size

"""Read what a journal holds, however it ended.

Records come one by one, in bounded memory. Where bytes are damaged the next record is looked for; it counts only if its
number, its checksum and, in a sealed journal, its tag prove it.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from app.storage.data_key import KeyMaterial
from app.storage.journal.header import HEADER_BYTES, JournalHeader
from app.storage.journal.payloads import Footer
from app.storage.journal.records import (
    FIRST_NUMBER,
    MAX_PAYLOAD,
    OVERHEAD_BYTES,
    RECORD_MAGIC,
    Record,
    RecordKind,
    Seal,
)

CHUNK_BYTES = 2 * MAX_PAYLOAD


@dataclass(frozen=True, slots=True)
class Damage:
    """Bytes that are no record, where one was expected."""

    offset: int
    size: int


@dataclass(slots=True)
class ReadReport:
    """What was found, complete once all records were read."""

    records: int = 0
    missing_records: int = 0  # how many numbers are not there, of those before the last one that is
    damaged_stretches: int = 0
    damaged_bytes: int = 0
    footer: Footer | None = None  # None where the journal was not stopped cleanly, or its end is lost
    sha256: str = ""  # of the whole file, for its row

    @property
    def is_whole(self) -> bool:
        """Whether every record is there, up to the footer."""
        return self.footer is not None and not (self.damaged_bytes or self.missing_records)


class JournalReader:
    """Reads one segment, once, from its beginning to its end.

    Parameters
    ----------
    data_key
        The library's; None for the demonstration's library.
    wrapped_key
        The journal's key from its row, where the header's own is damaged.

    Raises
    ------
    JournalRefusedError
        Not a journal, or it does not open with this key.
    OSError
        The file cannot be read.
    """

    def __init__(self, path: Path, data_key: KeyMaterial | None = None, wrapped_key: bytes | None = None) -> None:
        with path.open("rb") as file:
            self.header = JournalHeader.parsed(file.read(HEADER_BYTES), path.name, wrapped_key)
        self._path = path
        self._seal = Seal(self.header, self.header.key(data_key, path.name))
        self.report = ReadReport()

    def records(self) -> Iterator[Record | Damage]:
        """Yield all records in order, the footer last, with damaged stretches in place; raises OSError."""
        report = self.report = ReadReport()
        with self._path.open("rb") as file:
            window = _Window(file)
            window.skip(HEADER_BYTES)
            last: Record | None = None
            while window.fill(1):
                found = None if report.footer else self._seal.opened(window.view(), last)
                if found is None:
                    damage = self._pass_damage(window, last)
                    report.damaged_stretches += 1
                    report.damaged_bytes += damage.size
                    yield damage
                    continue
                record, size = found
                window.skip(size)
                report.records += 1
                report.missing_records += record.number - (last.number + 1 if last else FIRST_NUMBER)
                if record.kind is RecordKind.FOOTER:
                    report.footer = Footer.parsed(record.payload)
                last = record
                yield record
            report.sha256 = window.sha256()

    def _pass_damage(self, window: "_Window", last: Record | None) -> Damage:
        """Go on to the next record that is proved, or to the end; after a footer nothing is."""
        begin = window.offset
        window.skip(1)
        while window.fill(1):
            if self.report.footer is None and self._seal.opened(window.view(), last):
                break
            window.skip_to(RECORD_MAGIC)
        return Damage(begin, window.offset - begin)


class _Window:
    """A stretch of the file, long enough for the longest record, that moves towards its end."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._hash = hashlib.sha256()
        self._held = b""
        self._place = 0
        self._is_at_end = False
        self.offset = 0

    def fill(self, required: int) -> bool:
        """Read on where little is left; whether `required` bytes are there."""
        if not self._is_at_end and len(self._held) - self._place < MAX_PAYLOAD + OVERHEAD_BYTES:
            more = self._file.read(CHUNK_BYTES)
            self._is_at_end = not more
            self._hash.update(more)
            self._held, self._place = self._held[self._place :] + more, 0
        return len(self._held) - self._place >= required

    def view(self) -> memoryview:
        return memoryview(self._held)[self._place :]

    def skip(self, count: int) -> None:
        self.fill(count)
        self._place += count
        self.offset += count

    def skip_to(self, mark: bytes) -> None:
        """Leave the place that was looked at, for where `mark` occurs next or may begin."""
        found = self._held.find(mark, self._place + 1)
        end = found if found >= 0 else max(len(self._held) - len(mark) + 1, self._place + 1)
        self.skip(end - self._place)

    def sha256(self) -> str:
        return self._hash.hexdigest()

"""Layout of one record in the file, and the proof that it is whole and ours.

    magic 4 | number 8 | length 4 | kind 1 | host monotonic time 8 (ns) | payload | CRC32C 4

Little-endian. `length` is the payload's as it is in the file. In a sealed journal the payload is AES-256-GCM: its
nonce is the record's number, which is never used twice under the journal's own key; associated data are the
recording's id and the record's header. The CRC starts from the journal's header, so that a record of another journal,
or of an older file whose place on the disk this one took, fails it even where nothing is sealed.
"""

import struct
from enum import IntEnum
from typing import NamedTuple

from crc32c import crc32c
from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM

from app.storage.journal.header import NONCE_BYTES, TAG_BYTES, JournalHeader

RECORD_MAGIC = b"\xa7GWr"
RECORD_HEADER = struct.Struct("<4sQIBq")
CHECKSUM = struct.Struct("<I")
OVERHEAD_BYTES = RECORD_HEADER.size + TAG_BYTES + CHECKSUM.size
MAX_PAYLOAD = 1 << 20
FIRST_NUMBER = 1


class RecordKind(IntEnum):
    SOURCE = 1
    BYTES = 2
    SENT = 3
    SAMPLES = 4
    MARK = 5
    FOOTER = 6


KINDS = frozenset(RecordKind)


class Record(NamedTuple):
    """One record as it was given to the writer; `time_ns` on the host's monotonic clock."""

    number: int
    kind: RecordKind
    time_ns: int
    payload: bytes


class Seal:
    """Closes and opens the records of one journal; `key` None: nothing is sealed, only checked."""

    def __init__(self, header: JournalHeader, key: bytes | None) -> None:
        self._cipher = AESGCM(key) if key is not None else None
        self._recording = header.recording_id.bytes
        self._checksum_start = crc32c(header.identity)

    def closed(self, record: Record) -> bytes:
        """The record as it is in the file."""
        number, kind, time_ns, payload = record
        length = len(payload) + (TAG_BYTES if self._cipher else 0)
        head = RECORD_HEADER.pack(RECORD_MAGIC, number, length, kind, time_ns)
        if self._cipher:
            payload = self._cipher.encrypt(number.to_bytes(NONCE_BYTES, "big"), payload, self._recording + head)
        body = head + payload
        return body + CHECKSUM.pack(crc32c(body, self._checksum_start))

    def opened(self, content: memoryview, after: Record | None) -> tuple[Record, int] | None:
        """The record that `content` begins with and the bytes it takes; None unless it is proved to follow `after`."""
        if len(content) < RECORD_HEADER.size:
            return None
        magic, number, length, kind, time_ns = RECORD_HEADER.unpack_from(content)
        if magic != RECORD_MAGIC or kind not in KINDS or length > MAX_PAYLOAD + TAG_BYTES:
            return None
        if number < FIRST_NUMBER or (after and (number <= after.number or time_ns < after.time_ns)):
            return None
        end = RECORD_HEADER.size + length
        if len(content) < end + CHECKSUM.size:
            return None
        if crc32c(content[:end], self._checksum_start) != CHECKSUM.unpack_from(content, end)[0]:
            return None
        payload = bytes(content[RECORD_HEADER.size : end])
        if self._cipher:
            bound = self._recording + content[: RECORD_HEADER.size]
            try:
                payload = self._cipher.decrypt(number.to_bytes(NONCE_BYTES, "big"), payload, bound)
            except InvalidTag:
                return None
        return Record(number, RecordKind(kind), time_ns, payload), end + CHECKSUM.size

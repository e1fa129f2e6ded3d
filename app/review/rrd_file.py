"""Make the same log give the same bytes. Overwrites what Rerun writes into a file by chance or by the clock.

Rerun names the layout's store by chance, stamps every store with the time, and lists the stores and their columns in
the table of contents at the file's end in random order. Whoever checks a file or reads parts of it needs that table,
so it is put in order rather than cut off. A file is "RRF2" and its version, then messages, each with its kind and
length before it; the last holds the table, and 32 bytes behind it say where it is.
"""

import errno
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import pyarrow as pa

FILE_HEADER_BYTES = 12
MESSAGE_HEADER = struct.Struct("<QQ")
END, STORE_INFO = 0, 1
LONGEST_ENVELOPE = 128  # a message names its store within its first bytes
ROW_ID = slice(3, 20)  # in a store's info: eight bytes of time, a tag, eight bytes of chance
NO_ROW_ID = b"\0" * 8 + b"\x11" + b"\0" * 8
PLACE_OF_TABLE = struct.Struct("<QQI8sI")  # where it begins, its length, its checksum, "RRF2FOOT", how many there are
CHECKSUM_SEED = 7850921  # "RERUN" in base 26

# The table is a protobuf message, one manifest per store, of which field 1 is the store's name, 2 the names of the
# columns as an Arrow schema in a message of its own, 3 their hash whatever their order, 4 the rows
MANIFEST, SCHEMA, ARROW = 1, 2, 1
BYTES = 2  # protobuf's kind of a field that has a length


def remove_chance(path: Path, layout_name: bytes, name: bytes) -> None:
    """Make a finished file reproducible, its layout store renamed to `name` of equal length.

    Raises OSError without an end, and ValueError for a file of another version of Rerun.
    """
    with path.open("r+b") as file:
        position = FILE_HEADER_BYTES
        while True:
            file.seek(position)
            header = file.read(MESSAGE_HEADER.size)
            if len(header) < MESSAGE_HEADER.size:
                raise OSError(errno.EIO, "the log ends too early", str(path))
            kind, length = MESSAGE_HEADER.unpack(header)
            position += MESSAGE_HEADER.size
            if kind == END:
                _put_in_order(file, position, length, layout_name, name)
                return
            envelope = bytearray(file.read(min(length, LONGEST_ENVELOPE)))
            if kind == STORE_INFO:
                if envelope[:3] != b"\x0a\x12\x09" or envelope[11] != NO_ROW_ID[8]:
                    raise ValueError(f"store info begins with {bytes(envelope[:20])!r}, expected a row's name")
                envelope[ROW_ID] = NO_ROW_ID
            file.seek(position)
            file.write(envelope.replace(layout_name, name))
            position += length


def _put_in_order(file: BinaryIO, position: int, length: int, layout_name: bytes, name: bytes) -> None:
    """Write the table of contents, at `position` to the end of the file, with everything in it in order."""
    table, behind = file.read(length), file.read()
    if len(behind) != PLACE_OF_TABLE.size or PLACE_OF_TABLE.unpack(behind)[:3] != (position, length, checksum(table)):
        raise ValueError(f"the table of contents is followed by {behind[:64]!r}, expected its place and checksum")
    manifests = sorted(_ordered(manifest).replace(layout_name, name) for _, manifest in _fields(table))
    table = b"".join(_field(MANIFEST, manifest) for manifest in manifests)
    *_, mark, count = PLACE_OF_TABLE.unpack(behind)
    file.seek(position - MESSAGE_HEADER.size)
    file.write(MESSAGE_HEADER.pack(END, len(table)) + table)
    file.write(PLACE_OF_TABLE.pack(position, len(table), checksum(table), mark, count))
    file.truncate()


def _ordered(manifest: bytes) -> bytes:
    """Give the same manifest with its columns, and what is stated about each, in the order of their names."""
    parts = []
    for number, part in _fields(manifest):
        if number == SCHEMA:
            ((_, schema),) = _fields(part)
            part = _field(ARROW, _ordered_schema(pa.ipc.read_schema(pa.py_buffer(schema))).serialize().to_pybytes())
        parts.append(_field(number, part))
    return b"".join(parts)


def _ordered_schema(schema: pa.Schema) -> pa.Schema:
    columns = [column.with_metadata(dict(sorted((column.metadata or {}).items()))) for column in schema]
    return pa.schema(sorted(columns, key=lambda column: column.name))


def _fields(message: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield number and content of each field of a protobuf message whose fields all have a length."""
    at = 0
    while at < len(message):
        key, at = _varint(message, at)
        length, at = _varint(message, at)
        if key & 7 != BYTES or at + length > len(message):
            raise ValueError(f"a part of the table of contents begins with {message[:20]!r}, expected fields of bytes")
        yield key >> 3, message[at : at + length]
        at += length


def _field(number: int, content: bytes) -> bytes:
    return _as_varint(number << 3 | BYTES) + _as_varint(len(content)) + content


def _varint(message: bytes, at: int) -> tuple[int, int]:
    """Give the number that begins at `at`, seven bits a byte, and where it ends."""
    value, shift = 0, 0
    while True:
        value |= (message[at] & 0x7F) << shift
        shift, at = shift + 7, at + 1
        if message[at - 1] < 0x80:
            return value, at


def _as_varint(value: int) -> bytes:
    parts = bytearray()
    while value >= 0x80:
        parts.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*parts, value])


def checksum(data: bytes, seed: int = CHECKSUM_SEED) -> int:
    """XXH32 (Collet, github Cyan4973/xxHash, doc/xxhash_spec.md), of which Python's library has no part."""
    primes = (2654435761, 2246822519, 3266489917, 668265263, 374761393)
    mask = 0xFFFFFFFF

    def turned(value: int, bits: int) -> int:
        return (value << bits | value >> (32 - bits)) & mask

    whole = len(data) - len(data) % 16
    words = struct.unpack(f"<{whole // 4}I", data[:whole])
    lanes = [seed + primes[0] + primes[1], seed + primes[1], seed, seed - primes[0]]
    for number, lane in enumerate(lanes):
        for word in words[number::4]:
            lane = lane + word * primes[1] & mask  # turned here, not by a call: there are many words
            lane = (lane << 13 | lane >> 19) * primes[0] & mask
        lanes[number] = lane
    value = sum(map(turned, lanes, (1, 7, 12, 18))) if whole else seed + primes[4]
    value = value + len(data) & mask
    rest = len(data) - len(data) % 4
    for word in struct.unpack(f"<{(rest - whole) // 4}I", data[whole:rest]):
        value = turned(value + word * primes[2] & mask, 17) * primes[3] & mask
    for byte in data[rest:]:
        value = turned(value + byte * primes[4] & mask, 11) * primes[0] & mask
    for bits, prime in ((15, primes[1]), (13, primes[2])):
        value = (value ^ value >> bits) * prime & mask
    return value ^ value >> 16

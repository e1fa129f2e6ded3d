"""Check that the end of what was saved is still there after a crash.

What SQLite wrote last is in the write-ahead log until it is copied into the database. After a crash SQLite takes
from the log what is whole and ends, without a word, at the first frame that is not: behind a flipped bit everything
is lost that had been saved. So the log is looked at before it is opened.
https://www.sqlite.org/fileformat2.html#walformat
"""

import struct
from pathlib import Path

HEADER = struct.Struct(">IIII8s8s")  # magic, version, page size, number, salts, checksum
FRAME = struct.Struct(">II8s8s")  # page, pages in the database after a commit (else 0), salts, checksum
MAGIC = 0x377F0682  # and 1: words of the checksums are big-endian
Sums = tuple[int, int]


def is_end_lost(log: Path) -> bool:
    """Give whether the log holds saved changes that SQLite will drop; a power cut may seem so; raises OSError."""
    try:
        content = log.read_bytes()
        while content[: HEADER.size] != (now := log.read_bytes())[: HEADER.size]:
            content = now  # another program has restarted the log meanwhile
    except FileNotFoundError:
        return False  # it was closed well
    if len(content) <= HEADER.size:
        return False
    magic, _, page_size, _, salts, found = HEADER.unpack_from(content)
    order = ">" if magic & 1 else "<"
    sums = _summed((0, 0), content[: HEADER.size - 8], order)
    if magic & ~1 != MAGIC or page_size < 512 or struct.pack(">II", *sums) != found:
        return True  # SQLite takes none of it
    is_whole = True
    step = FRAME.size + page_size
    for start in range(HEADER.size, len(content) - step + 1, step):
        _, pages, own_salts, found = FRAME.unpack_from(content, start)
        if is_whole:
            sums = _summed(sums, content[start : start + 8], order)
            sums = _summed(sums, content[start + FRAME.size : start + step], order)
            is_whole = own_salts == salts and struct.pack(">II", *sums) == found
        # older frames share neither salt with this log; those of a change that was taken back end with no commit
        if not is_whole and pages and (own_salts[:4] == salts[:4] or own_salts[4:] == salts[4:]):
            return True
    return False


def _summed(sums: Sums, content: bytes, order: str) -> Sums:
    first, second = sums
    words = struct.unpack(f"{order}{len(content) // 4}I", content)
    for k in range(0, len(words), 2):
        first = (first + words[k] + second) & 0xFFFFFFFF
        second = (second + words[k + 1] + first) & 0xFFFFFFFF
    return first, second

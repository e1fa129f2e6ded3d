"""T2 and T10: what is left of a journal whose end was torn or scrambled. Check that every flipped bit is noticed.

    python -m tests.safety.journal_tails --tails 20000 --flips 10000

A journal is cut at a record that counts as synced; what comes after it is damaged as disks and file systems do it.
Every synced record has to be found, every record that was not touched too, and none that was never written.
"""

import argparse
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from app.storage.journal.header import HEADER_BYTES, JournalRefusedError
from app.storage.journal.records import CHECKSUM, RECORD_HEADER, Record
from tests.driver import Found, drive
from tests.safety.journal_material import KEY, OTHER_ID, read_all, record_some

BLOCK = 512  # what a disk writes at once


@dataclass(frozen=True, slots=True)
class Original:
    """A whole journal, with what its records are and where they end; `stranger` another one under the same key."""

    key: bytes | None
    content: bytes
    stranger: bytes
    records: tuple[Record, ...]
    ends: tuple[int, ...]

    @classmethod
    def recorded(cls, folder: Path, key: bytes | None) -> "Original":
        content = record_some(folder, key).path.read_bytes()
        stranger = record_some(folder, key, recording_id=OTHER_ID).path.read_bytes()
        (folder / "original").write_bytes(content)
        records, _, report = read_all(folder / "original", key)
        assert report.is_whole
        ends, place = [], HEADER_BYTES
        while place < len(content):
            _, _, length, _, _ = RECORD_HEADER.unpack_from(content, place)
            place += RECORD_HEADER.size + length + CHECKSUM.size
            ends.append(place)
        assert len(ends) == len(records)
        return cls(key, content, stranger, tuple(records), tuple(ends))


Damaging = Callable[[bytearray, int, Original, random.Random], None]


def cut(content: bytearray, synced: int, _: Original, rng: random.Random) -> None:
    del content[rng.randint(synced, len(content)) :]


def blank(content: bytearray, synced: int, _: Original, rng: random.Random) -> None:
    """Pages that were given to the file but never written."""
    begin = rng.randint(synced, len(content))
    content[begin:] = bytes(len(content) - begin + rng.choice([0, 4096]))


def scribble(content: bytearray, synced: int, _: Original, rng: random.Random) -> None:
    for _k in range(rng.randint(1, 4)):
        begin = rng.randint(synced, len(content))
        end = min(begin + rng.randint(1, 600), len(content))
        content[begin:end] = rng.randbytes(end - begin)


def flip(content: bytearray, synced: int, _: Original, rng: random.Random) -> None:
    for _k in range(rng.randint(1, 20)):
        content[rng.randrange(synced, len(content))] ^= 1 << rng.randrange(8)


def stranger_blocks(content: bytearray, synced: int, original: Original, rng: random.Random) -> None:
    """Blocks that another journal left on the disk."""
    for block in tail_blocks(content, synced):
        if rng.random() < 0.3:
            content[block] = original.stranger[block].ljust(block.stop - block.start, b"\0")


def shuffled_blocks(content: bytearray, synced: int, _: Original, rng: random.Random) -> None:
    blocks = [block for block in tail_blocks(content, synced) if block.stop - block.start == BLOCK]
    pieces = [bytes(content[block]) for block in blocks]
    rng.shuffle(pieces)
    for block, piece in zip(blocks, pieces, strict=True):
        content[block] = piece


def earlier_pieces(content: bytearray, synced: int, _: Original, rng: random.Random) -> None:
    """Records of this very journal once more, in the place of others."""
    begin = rng.randint(synced, len(content))
    length = rng.randint(1, 2000)
    source = rng.randint(HEADER_BYTES, len(content))
    content[begin : begin + length] = content[source : source + length]


DAMAGES: tuple[Damaging, ...] = (
    cut,
    blank,
    scribble,
    flip,
    stranger_blocks,
    shuffled_blocks,
    earlier_pieces,
)
IN_PLACE = (cut, blank, scribble, flip, stranger_blocks)  # what they do not touch is where it stood


def tail_blocks(content: bytearray, synced: int) -> list[slice]:
    first = -(-synced // BLOCK) * BLOCK
    return [slice(k, min(k + BLOCK, len(content))) for k in range(first, len(content), BLOCK)]


def tear_often(folder: Path, count: int, seed: int) -> Found:
    rng, tails = random.Random(seed), Found()
    originals = []
    for key in (KEY, None):
        place = folder / ("sealed" if key else "open")
        place.mkdir()
        originals.append(Original.recorded(place, key))
    for k in range(count):
        damage, original = DAMAGES[k % len(DAMAGES)], rng.choice(originals)
        last = rng.randrange(len(original.ends) - 1)
        content = bytearray(original.content)
        damage(content, original.ends[last], original, rng)
        path = folder / "torn"
        path.write_bytes(content)
        _judge(tails, original, last, content, path, damage)
    return tails


def _judge(tails: Found, original: Original, last: int, content: bytearray, path: Path, damage: Damaging) -> None:
    found, _, _ = read_all(path, original.key)
    untouched = []
    if damage in IN_PLACE:
        begins = (HEADER_BYTES, *original.ends)
        untouched = [
            record
            for record, begin, end in zip(original.records, begins, original.ends, strict=False)
            if record.number > original.records[last].number and content[begin:end] == original.content[begin:end]
        ]
    there = set(found)
    lost = len({*original.records[: last + 1]} - there)
    passed_over = len({*untouched} - there)
    false = len(there - {*original.records}) + len(found) - len(there)
    tails.count["tails"] += 1
    tails.count["synced records"] += last + 1
    tails.count["untouched records after damage"] += len(untouched)
    if lost or passed_over or false:
        tails.faults.append(f"{damage.__name__} after record {last}: {lost} lost, {passed_over} passed, {false} false")


def unnoticed_flips(folder: Path, count: int, seed: int, key: bytes | None) -> list[int]:
    """Flip one bit at a time, anywhere; the places where a journal still reads as whole."""
    rng = random.Random(seed)
    content = record_some(folder, key, rounds=4).path.read_bytes()
    path, unnoticed = folder / "flipped", []
    for _ in range(count):
        bit = rng.randrange(8 * len(content))
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        try:
            _, _, report = read_all(path, key)
        except JournalRefusedError:
            continue
        if report.is_whole:
            unnoticed.append(bit)
    return unnoticed


def run(asked: argparse.Namespace, folder: Path) -> Iterator[tuple[str, Found]]:
    yield "torn", tear_often(folder, asked.tails, asked.seed)
    for key, name in ((KEY, "sealed"), (None, "open")):
        (folder / f"{name} flipped").mkdir()
        unnoticed = unnoticed_flips(folder / f"{name} flipped", asked.flips, asked.seed, key)
        yield f"{name}, {asked.flips} bits flipped", Found(faults=[f"bit {bit} was not noticed" for bit in unnoticed])


if __name__ == "__main__":
    drive(__doc__, run, tails=20_000, flips=10_000, seed=1)

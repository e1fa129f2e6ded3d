"""T2 and T10: what is left of a journal whose end was torn or scrambled. Check that every flipped bit is noticed.

    python -m tests.safety.journal_tails --tails 20000 --flips 10000

A journal is cut at a record that counts as synced; what comes after it is damaged as disks and file systems do it.
Every synced record has to be found, every record that was not touched too, and none that was never written.
"""

import argparse
import random
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from app.storage.journal.header import HEADER_BYTES, JournalRefusedError
from app.storage.journal.records import CHECKSUM, RECORD_HEADER, Record
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


@dataclass(slots=True)
class Tails:
    count: int = 0
    synced: int = 0
    lost: int = 0
    untouched: int = 0
    passed_over: int = 0
    false: int = 0
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{self.count} tails: of {self.synced} synced records {self.lost} lost, of {self.untouched} untouched ones "
            f"after damage {self.passed_over} passed over, {self.false} false"
        )


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


def tear_often(folder: Path, count: int, seed: int) -> Tails:
    rng, tails = random.Random(seed), Tails()
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


def _judge(tails: Tails, original: Original, last: int, content: bytearray, path: Path, damage: Damaging) -> None:
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
    tails.count += 1
    tails.synced += last + 1
    tails.untouched += len(untouched)
    tails.lost, tails.passed_over, tails.false = tails.lost + lost, tails.passed_over + passed_over, tails.false + false
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tails", type=int, default=20_000)
    parser.add_argument("--flips", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    reported = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tails = tear_often(Path(folder), reported.tails, reported.seed)
        print(tails, *tails.faults, sep="\n")
    for key in (KEY, None):
        with tempfile.TemporaryDirectory() as folder:
            unnoticed = unnoticed_flips(Path(folder), reported.flips, reported.seed, key)
        print(f"{reported.flips} flipped bits in a {'sealed' if key else 'open'} journal: {len(unnoticed)} not noticed")


if __name__ == "__main__":
    main()

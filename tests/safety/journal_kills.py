"""T1: the cost of a kill. A child records six sensors at 200 Hz and is killed at a random instant, again and again.

    python -m tests.safety.journal_kills --count 1000

The child notes in shared memory when it last put something in; what the journal's last record lacks to that is lost.
"""

import mmap
import random
import time
from functools import partial
from pathlib import Path

from app.storage.journal.header import find_segments, read_header
from app.storage.journal.payloads import STREAM
from app.storage.journal.records import RecordKind
from app.storage.journal.writer import JournalWriter
from devices.clocks.host_clock import host_time_ns
from tests.driver import KILLED, Found, drive, end_of_child
from tests.safety.journal_material import ID, KEY, LAYOUT, LINES, NAMES, NO_ROOM_ASKED, WALKER, block, line, read_all

LONGEST_S = 1.2  # over two syncs; the first instants, before the journal is there, are among them
FORGOTTEN_S = 60  # after which a child whose parent is gone ends by itself
NOTE = "noted"


def kill_often(folder: Path, count: int, seed: int) -> Found:
    """Kill so many recorders; a loss for each, and faults of journals not whole up to their last complete record."""
    rng, found = random.Random(seed), Found()
    for k in range(count):
        place = folder / str(k)
        place.mkdir()
        (place / NOTE).write_bytes(bytes(8))
        ended = end_of_child(partial(record_until_killed, place), rng.uniform(0.0, LONGEST_S))
        assert ended == KILLED, f"the recorder ended by itself, with {ended}"
        loss_ms, fault = judge(place)
        found.count["kills"] += 1
        found.figures["loss, ms"].append(loss_ms)
        found.faults += [f"kill {k}: {fault}"] if fault else []
    return found


def judge(folder: Path) -> tuple[float, str]:
    """The loss in ms, and what is wrong with the journal, if anything is."""
    noted_ns = int.from_bytes((folder / NOTE).read_bytes(), "little")
    paths = find_segments(folder).get(ID, {})
    if not paths:
        return 0.0, "samples were taken before the journal was there" if noted_ns else ""
    records, damages, report = read_all(paths[1], KEY)
    # A write over the border of two pages can be cut by the kill: the record at the end of the file, unacknowledged.
    size = paths[1].stat().st_size
    if report.missing_records or any(one.offset + one.size < size for one in damages):
        return 0.0, f"{report}"
    received = [record.payload for record in records if record.kind is RecordKind.BYTES]
    if any(payload[STREAM.size :] != line(k) for k, payload in enumerate(received)):
        return 0.0, "what was read is not what was written"
    last_ns = records[-1].time_ns if records else read_header(paths[1]).opened_ns
    return (max(noted_ns - last_ns, 0) / 1e6 if noted_ns else 0.0), ""


def record_until_killed(folder: Path) -> None:
    with (folder / NOTE).open("r+b") as file:
        noted = mmap.mmap(file.fileno(), 8)
    journal = JournalWriter.create(folder, ID, KEY, room=NO_ROOM_ASKED)
    walker, lines = journal.source(WALKER, LAYOUT), journal.source(LINES)
    begin_s = time.monotonic()
    number = 0
    while number < FORGOTTEN_S * 200:
        for k, name in enumerate(NAMES):
            journal.samples(walker, k, block(name, number))
        journal.received(lines, line(number))
        noted[:] = host_time_ns().to_bytes(8, "little")
        number += 1
        time.sleep(max(begin_s + number / 200 - time.monotonic(), 0.0))


if __name__ == "__main__":
    drive(__doc__, lambda asked, folder: kill_often(folder, asked.count, asked.seed), count=1000, seed=1)

"""T1: the cost of a kill. A child records six sensors at 200 Hz and is killed at a random instant, again and again.

    python -m tests.safety.journal_kills --count 1000

The child notes in shared memory when it last put something in; what the journal's last record lacks to that is lost.
"""

import argparse
import mmap
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from app.storage.journal.header import find_segments, read_header
from app.storage.journal.payloads import STREAM
from app.storage.journal.records import RecordKind
from app.storage.journal.writer import JournalWriter
from devices.clocks.host_clock import host_time_ns
from tests.safety.journal_material import ID, KEY, LAYOUT, LINES, NAMES, NO_ROOM_ASKED, WALKER, block, line, read_all

LONGEST_S = 1.2  # over two syncs; the first instants, before the journal is there, are among them
FORGOTTEN_S = 60  # after which a child whose parent is gone ends by itself
NOTE = "noted"


@dataclass(slots=True)
class Kills:
    """`loss_ms` of every kill; `faults` in words: of journals not whole up to their last complete record."""

    loss_ms: list[float] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    @property
    def p99_ms(self) -> float:
        return float(np.quantile(self.loss_ms, 0.99))

    def __str__(self) -> str:
        return (
            f"{len(self.loss_ms)} kills, {len(self.faults)} journals at fault; loss median "
            f"{np.median(self.loss_ms):.0f} ms, p99 {self.p99_ms:.0f} ms, max {max(self.loss_ms):.0f} ms"
        )


def kill_often(folder: Path, count: int, seed: int) -> Kills:
    rng, kills = random.Random(seed), Kills()
    command = [sys.executable, "-m", "tests.safety.journal_kills", "--serve"]
    with subprocess.Popen(
        command, cwd=Path(__file__).parents[2], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as server:
        for k in range(count):
            place = folder / str(k)
            place.mkdir()
            _kill_one(server, place, rng.uniform(0.0, LONGEST_S))
            loss_ms, fault = judge(place)
            kills.loss_ms.append(loss_ms)
            if fault:
                kills.faults.append(f"kill {k}: {fault}")
            if k % 100 == 99:
                print(kills, file=sys.stderr)
    return kills


def _kill_one(server: subprocess.Popen[str], folder: Path, after_s: float) -> None:
    assert server.stdin is not None
    assert server.stdout is not None
    (folder / NOTE).write_bytes(bytes(8))
    print(folder, file=server.stdin, flush=True)
    child = int(server.stdout.readline())
    time.sleep(after_s)
    os.kill(child, signal.SIGKILL)
    status = int(server.stdout.readline())
    assert os.WIFSIGNALED(status), f"the recorder ended by itself, with {status}"


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


def serve() -> None:
    """Fork a recorder for every folder that is named, report its number, and how it ended: forking saves the
    imports."""
    for folder in sys.stdin:
        child = os.fork()
        if child == 0:
            try:
                record_until_killed(Path(folder.strip()))
            finally:
                os._exit(1)
        print(child, flush=True)
        print(os.waitpid(child, 0)[1], flush=True)


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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    reported = parser.parse_args()
    if reported.serve:
        serve()
        return
    with tempfile.TemporaryDirectory() as folder:
        kills = kill_often(Path(folder), reported.count, reported.seed)
    print(kills, *kills.faults, sep="\n")


if __name__ == "__main__":
    main()

"""T3: what is kept when the disk is full. A journal is filled into a disk of 8 MB until it stops itself.

    python -m tests.safety.journal_full_disk --count 200

The disk is a tmpfs where mounting is permitted; elsewhere the largest file that a process may write is set to 8 MB.
"""

import contextlib
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from app.storage.journal.disk import Room, Trouble
from app.storage.journal.records import RecordKind
from app.storage.journal.writer import JournalWriter, State
from devices.clocks.host_clock import host_time_ns
from tests.driver import Found, drive
from tests.safety.journal_material import ID, KEY, LINES, NO_ROOM_ASKED, read_all

DISK_BYTES = 8_000_000
PATIENCE_S = 30.0


def can_mount() -> bool:
    if sys.platform != "linux" or not shutil.which("mount"):
        return False
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.suppress(subprocess.CalledProcessError),
        small_disk(folder),
    ):
        return True
    return False


@contextlib.contextmanager
def small_disk(folder: str) -> Iterator[Path]:
    mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", folder]
    subprocess.run(mount, check=True, capture_output=True)
    try:
        yield Path(folder)
    finally:
        subprocess.run(["umount", folder], check=True)


@contextlib.contextmanager
def small_files(folder: str) -> Iterator[Path]:
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (DISK_BYTES, hard))
    try:
        yield Path(folder)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def fill_often(count: int, seed: int) -> Found:
    rng, fills = random.Random(seed), Found()
    is_disk = can_mount()
    fills.count["disks" if is_disk else "files of 8 MB at most"] = count
    for k in range(count):
        with tempfile.TemporaryDirectory() as folder, (small_disk if is_disk else small_files)(folder) as disk:
            # every other one leaves what a recording has to leave free, where there is a disk to be looked at
            room = Room(0.0, 0, 0.0, 2_000_000) if is_disk and k % 2 else NO_ROOM_ASKED
            fault = fill_once(disk, rng.randint(200, 60_000), room, fills)
        if fault:
            fills.faults.append(f"disk {k}: {fault}")
    return fills


def fill_once(folder: Path, piece_bytes: int, room: Room, fills: Found) -> str:
    """Record some 30 MB/s until the journal states that it stopped; what is wrong with what is kept, if anything is."""
    stated: list[tuple[Trouble, int]] = []
    journal = JournalWriter.create(
        folder, ID, KEY, room=room, on_trouble=lambda trouble: stated.append((trouble, host_time_ns()))
    )
    source = journal.source(LINES)
    begin_s, number, sent_bytes = time.monotonic(), 0, 0
    while journal.status.state is State.RECORDING and not stated:
        if time.monotonic() - begin_s > PATIENCE_S:
            journal.stop()
            return "it never stopped"
        journal.received(source, _piece(number, piece_bytes))
        number, sent_bytes = number + 1, sent_bytes + piece_bytes
        time.sleep(max(begin_s + sent_bytes / 30e6 - time.monotonic(), 0.0))
    summary = journal.stop()
    records, damages, report = read_all(summary.path, KEY)
    kept = [record for record in records if record.kind is RecordKind.BYTES]
    stopped_ms = (stated[0][1] - kept[-1].time_ns) / 1e6
    fills.figures["reported after, ms"].append(stopped_ms)
    fills.count["footers"] += report.footer is not None
    # a disk may be seen to be full to the last byte before it refuses one
    expected = (Trouble.NO_ROOM,) if room.kept_bytes else (Trouble.DISK_FULL, Trouble.NO_ROOM)
    wrong = {
        f"said {stated}": len(stated) != 1 or stated[0][0] not in expected,
        f"reported after {stopped_ms:.0f} ms": stopped_ms > 1000,
        f"damaged: {damages}": bool(damages),
        "not what was put in": [record.payload[2:] for record in kept]
        != [_piece(k, piece_bytes) for k in range(len(kept))],
        f"{summary.dropped_records} dropped, {len(kept)} of {number} kept": summary.dropped_records + len(kept)
        != number,
        "stopped before the disk was full, but without a footer": bool(room.kept_bytes) and not report.is_whole,
        "another file than was summed up": report.footer is not None and report.sha256 != summary.sha256,
        "too little was kept": sum(len(record.payload) for record in kept) < 0.5 * DISK_BYTES,
    }
    return "; ".join(what for what, is_wrong in wrong.items() if is_wrong)


def _piece(number: int, size: int) -> bytes:
    return number.to_bytes(8, "little") * (size // 8)


if __name__ == "__main__":
    drive(__doc__, lambda asked, _: fill_often(asked.count, asked.seed), count=200, seed=1)

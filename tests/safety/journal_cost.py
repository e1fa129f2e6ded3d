"""Measure the cost of recording. It is the share of a core that six sensors at 200 Hz take from input to disk.

    python -m tests.safety.journal_cost --seconds 30

A loop puts in what six sensors send in real time; what the same loop takes without a journal is taken off.
"""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from app.storage.journal.decoding import decode
from app.storage.journal.writer import JournalWriter
from core.samples import ImuBlock
from tests.driver import options
from tests.safety.journal_material import ID, KEY, LAYOUT, LINES, NAMES, RATE_HZ, WALKER, block


def main() -> None:
    seconds = options(__doc__, seconds=30.0).seconds
    for together in (4, 1):
        blocks, read = [block(name, 0, together) for name in NAMES], bytes(40 * together)

        def put_samples(journal: JournalWriter, blocks: list[ImuBlock] = blocks) -> None:
            for k, one in enumerate(blocks):
                journal.samples(0, k, one)

        def put_bytes(journal: JournalWriter, read: bytes = read) -> None:
            for _ in NAMES:
                journal.received(1, read)

        measure(f"bytes of {together} samples at a time", put_bytes, RATE_HZ / together, seconds)
        measure(f"{together} samples at a time", put_samples, RATE_HZ / together, seconds)


def measure(name: str, put: Callable[[JournalWriter], None], rate_hz: float, seconds: float) -> None:
    idle_s = cpu_s(lambda: None, rate_hz, seconds)
    with tempfile.TemporaryDirectory() as folder:
        with JournalWriter.create(Path(folder), ID, KEY) as journal:
            journal.source(WALKER, LAYOUT)
            journal.source(LINES)
            busy_s = cpu_s(lambda: put(journal), rate_hz, seconds)
        summary = journal.stop()
        begin_s = time.process_time()
        decode([summary.path], KEY, {})
        read_s = time.process_time() - begin_s
    print(
        f"{name}: {100 * (busy_s - idle_s) / seconds:.1f} % of a core, {summary.records} records, "
        f"{summary.bytes / seconds / 1000:.0f} kB/s; decoding takes {1000 * read_s / seconds:.1f} ms per second"
    )


def cpu_s(step: Callable[[], None], rate_hz: float, seconds: float) -> float:
    begin_s, begin_cpu_s = time.monotonic(), time.process_time()
    for number in range(round(seconds * rate_hz)):
        step()
        time.sleep(max(begin_s + (number + 1) / rate_hz - time.monotonic(), 0.0))
    return time.process_time() - begin_cpu_s


if __name__ == "__main__":
    main()

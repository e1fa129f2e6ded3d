"""Cost and length of the road of a sample, from source to disk and buffer. Six sensors at 200 Hz.

    python -m tests.safety.live_cost --seconds 60

The cost is that of readers and journal, without live work and screen; what the same program takes without sensors is
taken off. A delay runs from a sample's own stamp to when it can be taken from the buffer.
"""

import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

from app.acquisition.acquisition import Acquisition
from devices.simulation.replay import POLL_S, ReplaySource
from tests.driver import options
from tests.safety.journal_material import ID
from tests.safety.live_material import numbered_session, open_journal

SENSORS = 6


class Watching(threading.Thread):
    """Looks every millisecond for new samples of one sensor, and notes how old they are."""

    def __init__(self, acquisition: Acquisition) -> None:
        super().__init__(daemon=True)
        self._acquisition, self._sensor = acquisition, acquisition.sensors[-1]
        self.delays_ms: list[float] = []
        self.is_over = False

    def run(self) -> None:
        seen_s = self._acquisition.now_s
        while not self.is_over:
            block = self._acquisition.latest(self._sensor, 0.5)
            now_s = self._acquisition.now_s
            new_s = block.time_s[block.time_s > seen_s]
            if len(new_s):
                self.delays_ms += (1000 * (now_s - new_s)).tolist()
                seen_s = float(new_s[-1])
            time.sleep(0.001)


def measure_cost(folder: Path, sources: int, seconds: float) -> tuple[float, float]:
    """The share of a core that reading takes, and that reading and recording take, with so many sources."""
    each = SENSORS // sources
    made = [ReplaySource(numbered_session(f"s{k}", each), name=f"s{k}") for k in range(sources)]
    acquisition = Acquisition(made)
    acquisition.start()
    try:
        read_share = _share(seconds)
        acquisition.record(open_journal(folder, ID))
        both_share = _share(seconds)
        acquisition.stop_recording().path.unlink()
    finally:
        acquisition.close()
    return read_share, both_share


def measure_delay(folder: Path, seconds: float, busy: int = 0) -> list[float]:
    """Delays (ms) of one of six sensors, each its own source, while so many threads compute."""
    made = [ReplaySource(numbered_session(f"s{k}", 1), name=f"s{k}") for k in range(SENSORS)]
    acquisition = Acquisition(made)
    acquisition.start()
    watching = Watching(acquisition)
    computing = [threading.Thread(target=_compute, args=(watching,), daemon=True) for _ in range(busy)]
    try:
        acquisition.record(open_journal(folder, ID))
        for thread in (watching, *computing):
            thread.start()
        time.sleep(seconds)
        watching.is_over = True
        for thread in (watching, *computing):
            thread.join()
        acquisition.stop_recording().path.unlink()
    finally:
        acquisition.close()
    return watching.delays_ms


def _compute(watching: Watching) -> None:
    number = 0
    while not watching.is_over:
        number = (number * 31 + 7) % 1_000_003


def _share(seconds: float) -> float:
    time.sleep(1.0)
    begin_s, begin_cpu_s = time.monotonic(), time.process_time()
    time.sleep(seconds)
    return (time.process_time() - begin_cpu_s) / (time.monotonic() - begin_s)


def main() -> int:
    seconds = options(__doc__, seconds=30.0).seconds
    with tempfile.TemporaryDirectory(prefix="gaitwright-cost-") as name:
        folder = Path(name)
        for sources in (1, SENSORS):
            read, both = measure_cost(folder, sources, seconds)
            print(f"{sources} sources: reading {100 * read:.1f} % of a core, with the journal {100 * both:.1f} %")
        for busy in (0, 1):
            delays_ms = measure_delay(folder, seconds, busy)
            p50, p95, p99 = np.percentile(delays_ms, [50, 95, 99])
            print(
                f"beside {busy} busy threads: {len(delays_ms)} samples in the buffer after {p50:.0f} ms (median), "
                f"{p95:.0f} ms (p95), {p99:.0f} ms (p99), {max(delays_ms):.0f} ms (max); up to "
                f"{1000 * POLL_S:.0f} ms of it between two readings"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())

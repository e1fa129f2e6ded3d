"""T4: a source vanishes and returns while it is recorded. What do the others lose, and is the gap right to a sample?

    python -m tests.safety.source_vanishes --count 200

Six sources of one sensor each at 200 Hz; in each round four of them vanish once, at moments of their own.
"""

import argparse
import random
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from app.acquisition.acquisition import Acquisition
from devices.replay import ReplaySource
from tests.safety.journal_material import ID
from tests.safety.live_material import faults_of, numbered_session, open_journal, read_back

SOURCES, VANISHING = 6, 4
BACK_S = 3.0
PATIENCE_S = 30.0


@dataclass(slots=True)
class Vanished:
    """`back_ms` from a source's return to its next sample."""

    back_ms: list[float] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{len(self.back_ms)} sources vanished: {len(self.faults)} faults; back after "
            f"{np.median(self.back_ms):.0f} ms (median), {max(self.back_ms):.0f} ms (max)"
        )


def vanish_often(folder: Path, count: int, seed: int) -> Vanished:
    rng, vanished = random.Random(seed), Vanished()
    sources = [ReplaySource(numbered_session(f"s{k}", 1), name=f"s{k}") for k in range(SOURCES)]
    acquisition = Acquisition(sources)
    acquisition.start()
    try:
        while len(vanished.back_ms) < count:
            number = min(VANISHING, count - len(vanished.back_ms))
            _one_round(folder, acquisition, rng.sample(sources, number), rng, vanished)
    finally:
        acquisition.close()
    return vanished


def _one_round(
    folder: Path, acquisition: Acquisition, chosen: list[ReplaySource], rng: random.Random, vanished: Vanished
) -> None:
    acquisition.record(open_journal(folder, ID))
    plans = [(source, rng.uniform(0.1, 1.0), rng.uniform(0.05, 1.5)) for source in chosen]
    threads = [threading.Thread(target=_vanish_once, args=(acquisition, *plan, vanished)) for plan in plans]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    time.sleep(0.1)
    summary = acquisition.stop_recording()
    gone = {source.info.sensors[0] for source in chosen}
    wanted = {name: int(name in gone) for name in acquisition.sensors}
    vanished.faults += faults_of(read_back([summary.path]).sensors, wanted)
    summary.path.unlink()


def _vanish_once(
    acquisition: Acquisition, source: ReplaySource, after_s: float, away_s: float, vanished: Vanished
) -> None:
    (name,) = source.info.sensors
    time.sleep(after_s)
    source.vanish()
    time.sleep(away_s)
    before = acquisition.status()[name].counts.received
    source.come_back()
    back_s = time.monotonic()
    while acquisition.status()[name].counts.received == before and time.monotonic() - back_s < PATIENCE_S:
        time.sleep(0.005)
    took_s = time.monotonic() - back_s
    vanished.back_ms.append(1000 * took_s)
    if took_s > BACK_S:
        vanished.faults.append(f"{name}: back after {took_s:.1f} s")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gaitwright-vanish-") as folder:
        vanished = vanish_often(Path(folder), wanted.count, wanted.seed)
    for fault in vanished.faults:
        print(fault)
    print(vanished)
    return 1 if vanished.faults else 0


if __name__ == "__main__":
    sys.exit(main())

"""T7: what a recording of hours loses, and whether anything grows. Six sensors at 200 Hz, shown and worked on.

    python -m tests.safety.long_recording --hours 2
    python -m tests.safety.long_recording --hours 8 --speed 20

At 20 times the speed the clock of sensors, recording and journal runs 20 times as fast; disk and processor do not.
"""

import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.acquisition.acquisition import Acquisition
from core.samples import ImuBlock
from devices.simulation.replay import ReplaySource
from tests.driver import options
from tests.safety.journal_material import ID
from tests.safety.live_material import RATE_HZ, faults_of, numbered_session, open_journal, read_back

SENSORS = 6
WARM_S = 45.0  # until the buffers of the last seconds are full
SHOWN_S = 10.0
ALLOWED_MB = 20.0


@dataclass(frozen=True, slots=True)
class Held:
    """What the process holds. Where the system does not report, 0."""

    rss_mb: float
    threads: int
    handles: int
    none_references: int

    @classmethod
    def now(cls) -> "Held":
        has_proc = Path("/proc/self/statm").exists()
        pages = int(Path("/proc/self/statm").read_text().split()[1]) if has_proc else 0
        return cls(
            rss_mb=pages * os.sysconf("SC_PAGE_SIZE") / 1e6 if has_proc else 0.0,
            threads=threading.active_count(),
            handles=len(list(Path("/proc/self/fd").iterdir())) if has_proc else 0,
            none_references=sys.getrefcount(None),
        )


@dataclass(slots=True)
class LongRun:
    """`before` is after the warm-up, `most` the most of each that was held later, `after` what is held at the end."""

    before: Held
    most: Held
    after: Held
    samples: int
    dropped_from_preview: int
    core_share: float
    hours: float
    faults: list[str]

    def __str__(self) -> str:
        return (
            f"{self.hours:.2f} h, {self.samples} samples, {len(self.faults)} faults; memory "
            f"{self.before.rss_mb:.1f} MB + {self.most.rss_mb - self.before.rss_mb:.1f} MB, threads "
            f"{self.before.threads} to {self.most.threads}, handles {self.before.handles} to {self.most.handles}, "
            f"references to None {self.before.none_references} to {self.after.none_references}; "
            f"{self.dropped_from_preview} left out of the preview; {100 * self.core_share:.1f} % of a core"
        )


class Adding:
    """A live estimator that looks at every sample."""

    def __init__(self) -> None:
        self.total = 0.0

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        self.total += sum(float(block.gyr_rad_s.sum()) for block in blocks.values())


def record_long(
    folder: Path,
    hours: float,
    speed: float = 1.0,
    warm_s: float = WARM_S,
    show_message: Callable[[str], object] = print,
) -> LongRun:
    """Record for so long by the sensors' clock, pulling what a screen pulls."""
    source = ReplaySource(numbered_session("long", SENSORS), speed=speed)
    acquisition = Acquisition([source], now_ns=source.now_ns)
    acquisition.start()
    acquisition.set_estimator(Adding())
    acquisition.record(open_journal(folder, ID, now_ns=source.now_ns))
    _pull(acquisition, warm_s)
    before = most = Held.now()
    begin_cpu_s, begin_s = time.process_time(), time.monotonic()
    while acquisition.now_s < hours * 3600.0:
        _pull(acquisition, min(60.0, max((hours * 3600.0 - acquisition.now_s) / speed, 0.1)))
        held = Held.now()
        most = Held(
            rss_mb=max(most.rss_mb, held.rss_mb),
            threads=max(most.threads, held.threads),
            handles=max(most.handles, held.handles),
            none_references=max(most.none_references, held.none_references),
        )
        show_message(f"{acquisition.now_s / 3600:.2f} h {held}")
    core_share = (time.process_time() - begin_cpu_s) / (time.monotonic() - begin_s)
    after = Held.now()
    live = acquisition.status()
    summary = acquisition.stop_recording()
    dropped, sensors = acquisition.dropped_from_preview, acquisition.sensors
    acquisition.close()
    decoded = read_back([summary.path]).sensors
    faults = faults_of(decoded, dict.fromkeys(sensors, 0))
    faults += [f"{name}: {one.counts} live" for name, one in live.items() if one.counts.lost]
    faults += [f"{name} has {len(one.block)} samples" for name, one in decoded.items() if _is_short(one.block, hours)]
    if summary.dropped_records:
        faults.append(f"{summary.dropped_records} records were dropped")
    if most.rss_mb - before.rss_mb > ALLOWED_MB:
        faults.append("memory grew")
    if (most.threads, most.handles) != (before.threads, before.handles):
        faults.append("threads or handles grew")
    if abs(after.none_references - before.none_references) > 1000:
        faults.append("references to None grew or shrank")
    samples = sum(len(one.block) for one in decoded.values())
    return LongRun(before, most, after, samples, dropped, core_share, hours, faults)


def _pull(acquisition: Acquisition, seconds: float) -> None:
    """What a screen asks for, at 30 and 4 Hz."""
    until_s, number = time.monotonic() + seconds, 0
    while time.monotonic() < until_s:
        for name in acquisition.sensors:
            acquisition.latest(name, SHOWN_S)
        if number % 8 == 0:
            acquisition.status()
        number += 1
        time.sleep(1 / 30)


def _is_short(block: ImuBlock, hours: float) -> bool:
    return len(block) < (hours * 3600.0 - 1.0) * RATE_HZ or not np.isfinite(block.time_s).all()


def main() -> int:
    required = options(
        __doc__,
        hours=2.0,
        speed=1.0,
        folder={"type": Path, "help": "a disk with room for 1.5 GB per hour of 20 times the speed"},
    )
    with tempfile.TemporaryDirectory(prefix="gaitwright-long-", dir=required.folder) as folder:
        run = record_long(Path(folder), required.hours, required.speed)
    for fault in run.faults:
        print(fault)
    print(run)
    return 1 if run.faults else 0


if __name__ == "__main__":
    sys.exit(main())

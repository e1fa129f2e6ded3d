"""T4 at ports: a sensor is pulled out while it is recorded. What do the others lose, and is the gap right to a sample?

    python -m tests.safety.port_vanishes --count 200

Six emulated x-IMU3s at 200 Hz, each at a pseudo-terminal of its own; in each round four are pulled out once and put in
again, at moments of their own.
"""

import argparse
import random
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from app.acquisition.acquisition import Acquisition
from app.storage.journal.decoding import decode
from devices.decoders import DECODERS
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.emulators.ximu3 import Ximu3Voice
from devices.ports import PortInfo, SerialPort
from devices.source import DecodedSensor
from devices.stream import ByteSource
from devices.ximu3 import Ximu3
from tests.safety.journal_material import ID, KEY
from tests.safety.live_material import open_journal

SENSORS, VANISHING, RATE_HZ, LOOP = 6, 4, 200, 1900
BACK_S, NOTICED_S, PATIENCE_S = 3.0, 1.0, 30.0


@dataclass(slots=True)
class Vanished:
    """`back_ms` from a port's return to the sensor's next sample."""

    back_ms: list[float] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{len(self.back_ms)} ports vanished: {len(self.faults)} faults; back after "
            f"{np.median(self.back_ms):.0f} ms (median), {max(self.back_ms):.0f} ms (max)"
        )


def motion(number: int) -> tuple[float, ...]:
    """A rate that says which sample it is."""
    return (float(number % LOOP), 0.0, 0.0, 0.0, 0.0, 1.0)


def vanish_often(folder: Path, count: int, seed: int) -> Vanished:
    rng, vanished = random.Random(seed), Vanished()
    names = [f"EMU{k:05d}" for k in range(SENSORS)]
    emulations = {
        name: Emulation(Ximu3Voice(name, motion, rate_hz=RATE_HZ), partial(PseudoTerminal, folder / name))
        for name in names
    }
    sources = [ByteSource(Ximu3(), SerialPort(PortInfo(emulation.place))) for emulation in emulations.values()]
    acquisition = Acquisition(sources)
    acquisition.start()
    try:
        while len(vanished.back_ms) < count:
            number = min(VANISHING, count - len(vanished.back_ms))
            _one_round(folder, acquisition, emulations, rng.sample(names, number), rng, vanished)
    finally:
        acquisition.close()
        for emulation in emulations.values():
            emulation.close()
    return vanished


def _one_round(
    folder: Path,
    acquisition: Acquisition,
    emulations: dict[str, Emulation],
    chosen: list[str],
    rng: random.Random,
    vanished: Vanished,
) -> None:
    acquisition.record(open_journal(folder, ID))
    plans = [(name, rng.uniform(0.3, 1.0), rng.uniform(0.05, 1.5)) for name in chosen]
    threads = [
        threading.Thread(target=_vanish_once, args=(acquisition, emulations[name], name, after_s, away_s, vanished))
        for name, after_s, away_s in plans
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    time.sleep(0.5)
    summary = acquisition.stop_recording()
    sensors = decode([summary.path], KEY, DECODERS).sensors
    for name in emulations:
        if name not in sensors:
            vanished.faults.append(f"{name} is not there")
            continue
        vanished.faults += faults_of(name, sensors[name], gaps=int(name in chosen))
    summary.path.unlink()


def faults_of(name: str, decoded: DecodedSensor, gaps: int) -> list[str]:
    """What is wrong with a sensor that should have so many gaps."""
    number = np.degrees(decoded.block.gyr_rad_s[:, 0]).round().astype(np.int64)
    missing = np.diff(number) % LOOP - 1
    by_time = np.round(np.diff(decoded.block.time_s) * RATE_HZ).astype(np.int64) - 1
    faults = []
    if np.count_nonzero(missing) != gaps:
        faults.append(f"{name}: {np.count_nonzero(missing)} gaps, expected {gaps}")
    if not np.array_equal(missing, by_time):
        faults.append(f"{name}: gaps of {missing[missing != by_time]}, by their times {by_time[missing != by_time]}")
    if decoded.counts.lost != missing.sum() or decoded.counts.doubled or decoded.counts.late:
        faults.append(f"{name}: {decoded.counts}, missing {missing.sum()}")
    return faults


def _vanish_once(
    acquisition: Acquisition, emulation: Emulation, name: str, after_s: float, away_s: float, vanished: Vanished
) -> None:
    time.sleep(after_s)
    emulation.vanish()
    time.sleep(away_s)
    before = acquisition.status()[name].counts.received
    emulation.come_back()
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
    with tempfile.TemporaryDirectory(prefix="gaitwright-ports-") as folder:
        vanished = vanish_often(Path(folder), wanted.count, wanted.seed)
    for fault in vanished.faults:
        print(fault)
    print(vanished)
    return 1 if vanished.faults else 0


if __name__ == "__main__":
    sys.exit(main())

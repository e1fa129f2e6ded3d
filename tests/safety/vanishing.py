"""Sensors that are pulled out while they are recorded, and put in again: when each is back, and what the journals
report.

Of `source_vanishes.py` and `port_vanishes.py`, which say what is pulled out and what a journal has to hold then.
"""

import argparse
import random
import tempfile
import threading
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np

from app.acquisition.acquisition import Acquisition
from tests.safety.journal_material import ID
from tests.safety.live_material import open_journal

AT_ONCE = 4  # in each recording of six
LATEST_S, AWAY_S = 1.0, (0.05, 1.5)
BACK_S, PATIENCE_S = 3.0, 30.0


class Pulled(Protocol):
    """What can be pulled out: a source, or the port of one."""

    def vanish(self) -> None: ...
    def come_back(self) -> None: ...


FaultsIn = Callable[[Path, Collection[str]], list[str]]
"""What is wrong with a journal in which these sensors vanished once each."""


@dataclass(slots=True)
class Vanished:
    """`back_ms` from the return of a source or a port to the sensor's next sample."""

    back_ms: list[float] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{len(self.back_ms)} vanished: {len(self.faults)} faults; back after "
            f"{np.median(self.back_ms):.0f} ms (median), {max(self.back_ms):.0f} ms (max)"
        )


@dataclass(frozen=True, slots=True)
class Pulling:
    """What is pulled out of a running acquisition, by the sensor's name; and how long what is left takes to arrive.

    Attributes
    ----------
    earliest_s
        After the recording began.
    """

    acquisition: Acquisition
    sensors: Mapping[str, Pulled]
    faults_in: FaultsIn
    earliest_s: float
    settles_s: float

    def often(self, folder: Path, count: int, seed: int) -> Vanished:
        """Recordings until so many have vanished, at moments of their own."""
        rng, vanished = random.Random(seed), Vanished()
        while len(vanished.back_ms) < count:
            chosen = rng.sample(list(self.sensors), min(AT_ONCE, count - len(vanished.back_ms)))
            self._recorded(folder, chosen, rng, vanished)
        return vanished

    def _recorded(self, folder: Path, chosen: list[str], rng: random.Random, vanished: Vanished) -> None:
        self.acquisition.record(open_journal(folder, ID))
        plans = [(name, rng.uniform(self.earliest_s, LATEST_S), rng.uniform(*AWAY_S)) for name in chosen]
        threads = [threading.Thread(target=self._once, args=(*plan, vanished)) for plan in plans]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        time.sleep(self.settles_s)
        summary = self.acquisition.stop_recording()
        vanished.faults += self.faults_in(summary.path, chosen)
        summary.path.unlink()

    def _once(self, name: str, after_s: float, away_s: float, vanished: Vanished) -> None:
        time.sleep(after_s)
        self.sensors[name].vanish()
        time.sleep(away_s)
        before = self._received(name)
        self.sensors[name].come_back()
        back_s = time.monotonic()
        while self._received(name) == before and time.monotonic() - back_s < PATIENCE_S:
            time.sleep(0.005)
        took_s = time.monotonic() - back_s
        vanished.back_ms.append(1000 * took_s)
        if took_s > BACK_S:
            vanished.faults.append(f"{name}: back after {took_s:.1f} s")

    def _received(self, name: str) -> int:
        return self.acquisition.status()[name].counts.received


def run(description: str | None, vanish_often: Callable[[Path, int, int], Vanished]) -> int:
    """As a script: what was found, and whether something is wrong."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    required = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gaitwright-vanish-") as folder:
        vanished = vanish_often(Path(folder), required.count, required.seed)
    for fault in vanished.faults:
        print(fault)
    print(vanished)
    return 1 if vanished.faults else 0

"""Sensors that are pulled out while they are recorded, and put in again: when each is back, and what the journals
report.

Of `source_vanishes.py` and `port_vanishes.py`, which say what is pulled out and what a journal has to hold then.
"""

import random
import threading
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from app.acquisition.acquisition import Acquisition
from tests.driver import Found
from tests.safety.journal_material import ID
from tests.safety.live_material import open_journal

AT_ONCE = 4  # in each recording of six
LATEST_S, AWAY_S = 1.0, (0.05, 1.5)
BACK_S, PATIENCE_S = 3.0, 30.0
BACK = "back after, ms"  # from the return of a source or a port to the sensor's next sample


class Pulled(Protocol):
    """What can be pulled out: a source, or the port of one."""

    def vanish(self) -> None: ...
    def come_back(self) -> None: ...


FaultsIn = Callable[[Path, Collection[str]], list[str]]
"""What is wrong with a journal in which these sensors vanished once each."""


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

    def often(self, folder: Path, count: int, seed: int) -> Found:
        """Recordings until so many have vanished, at moments of their own."""
        rng, vanished = random.Random(seed), Found()
        while len(vanished.figures[BACK]) < count:
            chosen = rng.sample(list(self.sensors), min(AT_ONCE, count - len(vanished.figures[BACK])))
            self._recorded(folder, chosen, rng, vanished)
        return vanished

    def _recorded(self, folder: Path, chosen: list[str], rng: random.Random, vanished: Found) -> None:
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

    def _once(self, name: str, after_s: float, away_s: float, vanished: Found) -> None:
        time.sleep(after_s)
        self.sensors[name].vanish()
        time.sleep(away_s)
        before = self._received(name)
        self.sensors[name].come_back()
        back_s = time.monotonic()
        while self._received(name) == before and time.monotonic() - back_s < PATIENCE_S:
            time.sleep(0.005)
        took_s = time.monotonic() - back_s
        vanished.figures[BACK].append(1000 * took_s)
        if took_s > BACK_S:
            vanished.faults.append(f"{name}: back after {took_s:.1f} s")

    def _received(self, name: str) -> int:
        return self.acquisition.status()[name].counts.received

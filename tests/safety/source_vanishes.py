"""T4: a source vanishes and returns while it is recorded.

Check what the others lose and that the gap is right to a sample.

    python -m tests.safety.source_vanishes --count 200

Six sources of one sensor each at 200 Hz; in each round four of them vanish once, at moments of their own.
"""

from collections.abc import Collection
from pathlib import Path

from app.acquisition.acquisition import Acquisition
from devices.simulation.replay import ReplaySource
from tests.driver import Found, drive
from tests.safety.live_material import faults_of, numbered_session, read_back
from tests.safety.vanishing import Pulling

SOURCES = 6


def vanish_often(folder: Path, count: int, seed: int) -> Found:
    sources = [ReplaySource(numbered_session(f"s{k}", 1), name=f"s{k}") for k in range(SOURCES)]
    acquisition = Acquisition(sources)

    def faults_in(path: Path, gone: Collection[str]) -> list[str]:
        return faults_of(read_back([path]).sensors, {name: int(name in gone) for name in acquisition.sensors})

    acquisition.start()
    try:
        by_sensor = {source.info.sensors[0]: source for source in sources}
        return Pulling(acquisition, by_sensor, faults_in, earliest_s=0.1, settles_s=0.1).often(folder, count, seed)
    finally:
        acquisition.close()


if __name__ == "__main__":
    drive(__doc__, lambda asked, folder: vanish_often(folder, asked.count, asked.seed), count=200, seed=1)

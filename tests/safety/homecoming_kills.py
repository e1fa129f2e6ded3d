"""Check that what was recorded while the library was gone comes home once. Bringing it home is killed at any point.

    python -m tests.safety.homecoming_kills --count 500

A child brings sealed journals home from the shelter and is killed at a random instant; another goes on, and so do more,
until one is not killed. Each journal has to be in the library then, byte for byte, and nothing in the shelter.
"""

import argparse
import os
import random
from functools import partial
from pathlib import Path

from app.storage import root as root_module
from app.storage.bringing_home import bring_home
from app.storage.data_key import DataKey
from app.storage.database.ids import uuid7
from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.stored import Operator, Role
from tests.driver import KILLED, Found, drive, end_of_child
from tests.safety.journal_material import KEY, record_some

JOURNALS, ROUNDS = 4, 600  # of so many rounds each: half a megabyte
LONGEST_S = 0.04  # in which all of them can be home


def bring_home_killed(folder: Path, count: int, seed: int) -> Found:
    """Until `count` children were killed; `folder` holds the library and the user's data folder."""
    rng, found = random.Random(seed), Found()
    library = Library.create(folder / "library", KEY, Operator("hk", "", Role.ADMINISTRATOR))
    library.close()
    opened = OpenedLibrary(library, folder / "library", DataKey(KEY))  # bringing home asks the folder only
    while found.count["kills"] < count:
        _come_home(opened, rng, found)
    return found


def _come_home(opened: OpenedLibrary, rng: random.Random, found: Found) -> None:
    assert opened.shelter is not None
    shelter = opened.shelter.made()
    required = {}
    for _ in range(JOURNALS):
        path = record_some(shelter, KEY, recording_id=uuid7(), rounds=ROUNDS).path
        required[path.name] = path.read_bytes()
    while shelter.exists():
        ended = end_of_child(partial(bring_home, opened), rng.uniform(0.0, LONGEST_S))
        if ended == KILLED:
            found.count["kills"] += 1
            names = {path.name for path in shelter.glob("*")} if shelter.exists() else set()
            found.count["of them amid the work"] += names != set(required) and bool(names)
        elif ended:
            found.faults.append("it ended by itself, and not well")
            return
    got = {path.name: path.read_bytes() for path in opened.recordings.iterdir()}
    found.faults += [f"{name} is not as it was" for name in required if got.get(name) != required[name]]
    found.faults += [f"{name} is nobody's" for name in got.keys() - required.keys()]
    for path in opened.recordings.iterdir():
        path.unlink()


def run(asked: argparse.Namespace, folder: Path) -> Found:
    os.environ["XDG_DATA_HOME"] = str(folder)
    root_module.SHELTERS = f"kill test {os.getpid()}"  # of no library of this user's, on any system
    return bring_home_killed(folder, asked.count, asked.seed)


if __name__ == "__main__":
    drive(__doc__, run, count=500, seed=1)

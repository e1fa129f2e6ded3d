"""Check that what was recorded while the library was gone comes home once. Bringing it home is killed at any point.

    python -m tests.safety.homecoming_kills --count 500

A child brings sealed journals home from the shelter and is killed at a random instant; another goes on, and so do more,
until one is not killed. Each journal has to be in the library then, byte for byte, and nothing in the shelter.
"""

import argparse
import os
import random
import signal
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from app.storage import root as root_module
from app.storage.bringing_home import bring_home
from app.storage.data_key import DataKey
from app.storage.database.ids import uuid7
from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.stored import Operator, Role
from tests.safety.journal_material import KEY, record_some

JOURNALS, ROUNDS = 4, 600  # of so many rounds each: half a megabyte
LONGEST_S = 0.04  # in which all of them can be home


@dataclass(slots=True)
class Homecomings:
    """`amid`: how many kills found the work neither untouched nor done."""

    kills: int = 0
    amid: int = 0
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return f"{self.kills} kills, {self.amid} of them amid the work, {len(self.faults)} faults"


def bring_home_killed(folder: Path, count: int, seed: int) -> Homecomings:
    """Until `count` children were killed; `folder` holds the library and the user's data folder."""
    rng, found = random.Random(seed), Homecomings()
    library = Library.create(folder / "library", KEY, Operator("hk", "", Role.ADMINISTRATOR))
    library.close()
    opened = OpenedLibrary(library, folder / "library", DataKey(KEY))  # bringing home asks the folder only
    while found.kills < count:
        _come_home(opened, rng, found)
    return found


def _come_home(opened: OpenedLibrary, rng: random.Random, found: Homecomings) -> None:
    assert opened.shelter is not None
    shelter = opened.shelter.made()
    required = {}
    for _ in range(JOURNALS):
        path = record_some(shelter, KEY, recording_id=uuid7(), rounds=ROUNDS).path
        required[path.name] = path.read_bytes()
    while shelter.exists():
        child = os.fork()
        if not child:
            bring_home(opened)
            os._exit(0)
        time.sleep(rng.uniform(0.0, LONGEST_S))
        os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        if os.WIFSIGNALED(status):
            found.kills += 1
            names = {path.name for path in shelter.glob("*")} if shelter.exists() else set()
            found.amid += names != set(required) and bool(names)
        elif os.waitstatus_to_exitcode(status):
            found.faults.append("it ended by itself, and not well")
            return
    got = {path.name: path.read_bytes() for path in opened.recordings.iterdir()}
    found.faults += [f"{name} is not as it was" for name in required if got.get(name) != required[name]]
    found.faults += [f"{name} is nobody's" for name in got.keys() - required.keys()]
    for path in opened.recordings.iterdir():
        path.unlink()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    required = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_DATA_HOME"] = folder
        root_module.SHELTERS = f"kill test {os.getpid()}"  # of no library of this user's, on any system
        found = bring_home_killed(Path(folder), required.count, required.seed)
    print(found)
    for fault in found.faults:
        print(f"- {fault}")
    raise SystemExit(bool(found.faults))


if __name__ == "__main__":
    main()

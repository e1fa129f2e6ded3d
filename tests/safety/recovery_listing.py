"""T1: how long after the start of a program 50 interrupted recordings are listed.

    python -m tests.safety.recovery_listing --count 50 --rows 100000

A library with interrupted recordings is made, then a new process opens it with its passphrase (Argon2id at its full
cost) and lists them. Timed from the start of the process, with all that it imports; its modules are compiled before,
as those of an installed program are.
"""

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from uuid import UUID

import numpy as np

from app.storage.database.ids import uuid7
from app.storage.journal.writer import JournalWriter
from app.storage.opened import OpenedLibrary, create_library
from app.storage.stored import Operator, Role, StoredJournal
from core.samples import ImuBlock
from core.session import Patient, Recording, RecordingKind, Session
from tests.driver import options
from tests.safety.journal_material import LAYOUT, NAMES, NO_ROOM_ASKED, WALKER

ROOT = Path(__file__).parents[2]
PASSPHRASE = "four short words here"
LIST = """
import sys
from pathlib import Path
from uuid import UUID
from app.storage.opened import open_library
from app.storage.recovery import find_interrupted
with open_library(Path(sys.argv[1]), sys.argv[2]) as opened:
    found = find_interrupted(opened)
    print(len(found), sum(one.is_orphan for one in found), sum(bool(one.problem) for one in found))
"""


@dataclass(frozen=True, slots=True)
class Listing:
    """How many were listed, as what, and how long after the start of the process; `empty_s`: where there are none."""

    recordings: int
    orphans: int
    problems: int
    megabytes: float
    after_s: float
    empty_s: float

    def __str__(self) -> str:
        return (
            f"{self.recordings} recordings ({self.orphans} of them orphans, {self.problems} with a problem) of "
            f"{self.megabytes:.0f} MB listed {self.after_s:.2f} s after the start, empty: {self.empty_s:.2f} s"
        )


def list_in_new_process(folder: Path, count: int, rows: int) -> Listing:
    """Interrupt `count` recordings of `rows` samples, every fifth without a row, and let another process list them."""
    opened, _ = create_library(folder / "library", Operator("hk", "H. Keller", Role.ADMINISTRATOR), PASSPHRASE)
    with opened:
        patient = opened.library.patients.create(Patient(code="DEMO-1"))
        visit = opened.library.sessions.create(patient.id, Session((), is_simulated=True))
        sizes = [_interrupt(opened, visit.id, number, rows) for number in range(count)]
    empty, _ = create_library(folder / "empty", Operator("hk", "H. Keller", Role.ADMINISTRATOR), PASSPHRASE)
    empty.library.close()
    environment = {**os.environ, "PYTHONPYCACHEPREFIX": str(folder / "compiled")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    stated, after_s = dict[Path, str](), dict[Path, float]()
    for place in (opened.folder, opened.folder, empty.folder):  # the first one compiles
        command = [sys.executable, "-c", LIST, str(place), PASSPHRASE]
        began_s = time.monotonic()
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
        stated[place], after_s[place] = done.stdout, time.monotonic() - began_s
    recordings, orphans, problems = map(int, stated[opened.folder].split())
    taken = (after_s[opened.folder], after_s[empty.folder])
    return Listing(recordings, orphans, problems, sum(sizes) / 1e6, *taken)


def _interrupt(opened: OpenedLibrary, session_id: UUID, number: int, rows: int) -> int:
    recording_id = uuid7()
    with JournalWriter.create(opened.recordings, recording_id, opened.data_key, room=NO_ROOM_ASKED) as writer:
        if number % 5:
            reported = Recording(f"walk {number}", RecordingKind.WALKING, f"walk_{number}", {})
            opened.library.recordings.start(session_id, reported, True, recording_id)
            journal = StoredJournal(recording_id, writer.header.segment, writer.header.wrapped_key)
            opened.library.recordings.add_journal(recording_id, journal)
        source = writer.source(WALKER, LAYOUT)
        for first in range(0, rows, 1000):
            time_s = np.arange(first, min(first + 1000, rows)) / 200
            column = np.sin(time_s[:, None] + np.arange(3))
            writer.samples(source, 0, ImuBlock(NAMES[0], time_s, column, column), waits=True)
    size = writer.stop().bytes
    os.truncate(writer.path, size - 50)  # a torn footer, as a kill leaves it
    return size


def main() -> int:
    required = options(__doc__, count=50, rows=100_000)
    with tempfile.TemporaryDirectory(prefix="gaitwright-listing-") as folder:
        listing = list_in_new_process(Path(folder), required.count, required.rows)
    print(listing)
    return 1 if listing.recordings != required.count or listing.after_s > 2.0 else 0


if __name__ == "__main__":
    sys.exit(main())

"""Kill changes of the data key:

at every file operation, and at random instants. Check that the library opens and is whole.

python -m tests.safety.key_change_kills --count 100
"""

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path

from app.storage.database.engine import Database, sqlite_engine
from app.storage.journal.header import find_segments
from app.storage.journal.reader import JournalReader
from app.storage.journal.writer import JournalWriter
from app.storage.journal_headers import write_headers
from app.storage.key_change import change_data_key
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.layout import DATABASE, KEYS, NEW_DATABASE, NEW_KEYS
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, open_library
from app.storage.slots import Cost
from app.storage.stored import Operator, RecordingState, Role, StoredJournal
from core.session import Patient, Recording, RecordingKind, Session

PASSPHRASE, LEAVING = "four short words here", "another four short words"
EVENTS = ("open", "os.rename", "os.remove", "sqlite3.connect")
JOURNALS = 5


def silent(_share: float, _what: str) -> None:
    """Report to nobody."""


def make(folder: Path) -> None:
    """A library of two operators with a few recordings."""
    folder.mkdir()
    slots = KeySlots(folder / KEYS, Cost(passes=1, memory_kib=64))
    data_key, _ = slots.create("hk", PASSPHRASE)
    slots.add(data_key, "ab", LEAVING)
    with Library.create(folder, data_key, Operator("hk", "H. Keller", Role.ADMINISTRATOR)) as library:
        patient = library.patients.create(Patient(code="P-001"))
        visit = library.sessions.create(patient.id, Session((), started="2026-11-20T09:00:00"))
        opened = OpenedLibrary(library, folder, data_key)
        for number in range(JOURNALS):
            reported = Recording(f"walk {number}", RecordingKind.WALKING, f"walk_{number}", {})
            row = library.recordings.start(visit.id, reported, is_simulated=False)
            with JournalWriter.create(opened.recordings, row.id, data_key) as writer:
                for k in range(2000):
                    writer.mark(f"mark {k} of journal {number}")
            header, summary = writer.header, writer.stop()
            journal = StoredJournal(header.recording_id, header.segment, header.wrapped_key)
            library.recordings.add_journal(row.id, journal)
            library.recordings.close(row.id, RecordingState.CLOSED, {header.segment: summary.sha256})


def kill_in_child(folder: Path, at_event: int, after_s: float) -> bool:
    """Change the key in a child that is killed at its n-th file operation, or after a while; whether it was."""
    if (child := os.fork()) == 0:
        seen = 0

        def kill(event: str, _arguments: object) -> None:
            nonlocal seen
            if event in EVENTS:
                seen += 1
                if seen == at_event:
                    os.kill(os.getpid(), signal.SIGKILL)

        try:
            opened = open_library(folder, PASSPHRASE, "hk")
            sys.addaudithook(kill)
            if after_s:
                signal.signal(signal.SIGALRM, signal.SIG_DFL)  # which ends the process as a kill does
                signal.setitimer(signal.ITIMER_REAL, after_s)
            change_data_key(opened, ["hk"], silent)
        finally:
            os._exit(0)
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


def faults_after(folder: Path) -> tuple[bool, list[str]]:
    """Whether the key is the new one, and what is wrong."""
    faults: list[str] = []
    with open_library(folder, PASSPHRASE, "hk") as opened:
        database = Database(sqlite_engine(folder / DATABASE, opened.data_key))
        write_headers(database, opened.recordings)
        database.close()
        faults += opened.library.faults()
        faults += [fault.what for fault in opened.library.audit.verify().faults]
        journals = [path for paths in find_segments(opened.recordings).values() for path in paths.values()]
        if len(journals) != JOURNALS:
            faults.append(f"{len(journals)} journals")
        for path in journals:
            reader = JournalReader(path, opened.data_key)
            if sum(1 for _ in reader.records()) < 2000 or not reader.report.is_whole:
                faults.append(f"{path.name} is not whole")
    try:
        KeySlots(folder / KEYS).open("ab", LEAVING)
        is_new = False
    except KeyRefusedError:
        is_new = True
    if (folder / NEW_KEYS).exists() or (folder / NEW_DATABASE).exists():
        faults.append("something was left over")
    return is_new, faults


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="kills at random instants")
    parser.add_argument("--seed", type=int, default=7)
    required = parser.parse_args()
    rng = random.Random(required.seed)
    kills = new = at_fault = 0
    with tempfile.TemporaryDirectory() as place:
        untouched = Path(place) / "untouched"
        make(untouched)
        whole_s = -time.monotonic()
        kill_in_child(Path(shutil.copytree(untouched, Path(place) / "timed")), 0, 0.0)
        whole_s += time.monotonic()
        runs = [(k, 0.0) for k in range(1, 1000)] + [(0, rng.uniform(0.001, whole_s)) for _ in range(required.count)]
        is_through = False
        for number, (at_event, after_s) in enumerate(runs):
            if at_event and is_through:
                continue
            folder = Path(shutil.copytree(untouched, Path(place) / str(number)))
            was_killed = kill_in_child(folder, at_event, after_s)
            is_through = is_through or (bool(at_event) and not was_killed)
            is_new, faults = faults_after(folder)
            kills, new, at_fault = kills + was_killed, new + is_new, at_fault + bool(faults)
            if faults:
                print(f"event {at_event}, {after_s:.3f} s: {faults}")
            shutil.rmtree(folder)
    print(f"{kills} kills: {at_fault} libraries at fault; the new key in {new}, the old one in the others")
    return 1 if at_fault else 0


if __name__ == "__main__":
    sys.exit(main())

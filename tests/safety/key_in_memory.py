"""Count copies of the data key in a program's memory. They are sought raw and as hex, with the library open and locked.

    python -m tests.safety.key_in_memory --locks 3

A child opens a library as the window does, records, makes a backup, and locks; its memory is read through /proc. The
recording has to go on under the lock.
"""

import argparse
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.driver import Found, drive
from tests.quick_library import PASSPHRASE, quick_library

CHILD = """
import sys, time
from pathlib import Path
from PySide6.QtCore import QCoreApplication, QObject
from app.storage.backup import back_up
from app.storage.database.ids import uuid7
from app.storage.journal.disk import Room
from app.storage.journal.writer import JournalWriter
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.workers.library_controller import LibraryController
from core.session import Patient

app, folder, passphrase = QCoreApplication([]), Path(sys.argv[1]), sys.argv[2]
controller, said = LibraryController(), []
controller.not_opened.connect(lambda *words: sys.exit(str(words)))

class Asker(QObject):
    def on_done(self, result):
        said.append(result)
    def on_failed(self, what, remedy):
        sys.exit(what + remedy)

asker = Asker()

def wait(count):
    while len(said) < count:
        app.processEvents()
        time.sleep(0.01)

def tell(words):
    print(words, flush=True)
    sys.stdin.readline()

controller.open(lambda holder: holder.open(folder, passphrase, "hk"))
while controller.state is None:
    app.processEvents()
controller.run(
    lambda opened: len(KeySlots(folder / KEYS).open("hk", passphrase)),
    asker.on_done, asker.on_failed, asker,
)
controller.run(
    lambda opened: opened.library.patients.create(Patient(code="P-001")),
    asker.on_done, asker.on_failed, asker,
)
backups = folder.parent / "backups"
backups.mkdir()
controller.run(lambda opened: back_up(opened, backups), asker.on_done, asker.on_failed, asker)
controller.run(
    lambda opened: JournalWriter.create(opened.recordings, uuid7(), opened.data_key, room=Room(0, 0)),
    asker.on_done, asker.on_failed, asker,
)
wait(4)
writer = said[-1]
for k in range(int(sys.argv[3])):
    tell("open")
    controller.lock()
    controller.run(lambda opened: len(opened.library.patients.search()), asker.on_done, asker.on_failed, asker)
    until = time.monotonic() + 1.0
    while time.monotonic() < until:
        writer.mark("recorded under the lock")
        app.processEvents()
        time.sleep(0.01)
    assert len(said) == 4 + 2 * k, "the library answered under the lock"
    tell("locked")
    controller.call(lambda holder: holder.unlock("hk", passphrase, None), asker.on_done, asker.on_failed, asker)
    wait(6 + 2 * k)
    assert 1 in said[-2:], said
print("written", writer.stop().state, flush=True)
controller.finish()
"""


@dataclass(frozen=True, slots=True)
class Copies:
    """How often a key is in a process's memory."""

    raw: int
    lower_hex: int
    upper_hex: int

    @property
    def all(self) -> int:
        return self.raw + self.lower_hex + self.upper_hex

    def __str__(self) -> str:
        return f"{self.raw} raw, {self.lower_hex} as hex, {self.upper_hex} as hex in capitals"


def copies_of(key: bytes, process_id: int) -> Copies:
    """Count the key in all of a process's memory that can be written."""
    forms, counts = (key, key.hex().encode(), key.hex().upper().encode()), [0, 0, 0]
    places = Path(f"/proc/{process_id}/maps").read_text(encoding="utf-8").splitlines()
    with Path(f"/proc/{process_id}/mem").open("rb", buffering=0) as memory:
        for line in places:
            found = re.match(r"([0-9a-f]+)-([0-9a-f]+) rw", line)
            if found is None:
                continue
            start, end = (int(text, 16) for text in found.groups())
            try:
                memory.seek(start)
                content = memory.read(end - start)
            except (OSError, OverflowError):
                continue  # the kernel's own pages
            counts = [count + content.count(form) for count, form in zip(counts, forms, strict=True)]
    return Copies(*counts)


def measured(place: Path, locks: int) -> list[tuple[str, Copies]]:
    """What is found at each stop of the child: open, locked, open, ..."""
    with quick_library(place / "library") as opened:
        folder, data_key = opened.folder, opened.data_key
    assert data_key is not None
    command = [sys.executable, "-c", CHILD, str(folder), PASSPHRASE, str(locks)]
    found: list[tuple[str, Copies]] = []
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        for line in child.stdout:
            if line.startswith("written"):
                found.append((line.strip(), Copies(0, 0, 0)))
                break
            found.append((line.strip(), copies_of(bytes(data_key), child.pid)))
            child.stdin.write("\n")
            child.stdin.flush()
    return found


def run(asked: argparse.Namespace, place: Path) -> Found:
    found = measured(place, asked.locks)
    for state, copies in found:
        print(f"{state}: {copies}")
    faults = [f"locked: {copies}" for state, copies in found if state == "locked" and copies.all]
    if len(found) != 2 * asked.locks + 1:
        faults.append("the child ended by itself")
    return Found(faults=faults)


if __name__ == "__main__":
    drive(__doc__, run, locks=3)

"""Kill changes of the data key:

at every file operation, and at random instants. Check that the library opens and is whole.

python -m tests.safety.key_change_kills --count 100
"""

import itertools
import os
import random
import shutil
import signal
import sys
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
from app.storage.opened import open_library
from app.storage.stored import RecordingState, StoredJournal
from app.storage.videos.reader import open_clip, read_clip
from app.storage.videos.writer import ClipWriter
from app.system.progress import nobody
from core.session import Patient, Recording, RecordingKind, Session
from tests.driver import KILLED, Found, drive, end_of_child
from tests.quick_library import CHEAP, PASSPHRASE, quick_library
from tests.safety.clinic_material import copy_of
from tests.videos import MODE, NO_ROOM_ASKED, OPENED_NS, frame, picture

LEAVING = "another four short words"
EVENTS = ("open", "os.rename", "os.remove", "sqlite3.connect")
JOURNALS, FRAMES = 5, 20


def make(folder: Path) -> None:
    """A library of two operators with a few recordings, and a video."""
    with quick_library(folder) as opened:
        library, data_key = opened.library, opened.data_key
        assert data_key is not None
        KeySlots(folder / KEYS, CHEAP).add(data_key, "ab", LEAVING)
        patient = library.patients.create(Patient(code="P-001"))
        visit = library.sessions.create(patient.id, Session((), started="2026-11-20T09:00:00"))
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
        library.clips.give_consent(patient.id)
        video = ClipWriter.create(opened, row.id, OPENED_NS, 1, "", MODE, room=NO_ROOM_ASKED)
        for number in range(FRAMES):
            video.add(frame(number), waits=True)
        video.stop()


def kill_in_child(folder: Path, at_event: int, after_s: float | None) -> bool:
    """Change the key in a child that is killed at its n-th file operation, or after a while; whether it was."""
    seen = itertools.count(1)

    def kill(event: str, _arguments: object) -> None:
        if event in EVENTS and next(seen) == at_event:
            os.kill(os.getpid(), signal.SIGKILL)

    def change() -> None:
        opened = open_library(folder, PASSPHRASE, "hk")
        sys.addaudithook(kill)
        change_data_key(opened, ["hk"], nobody)

    ended = end_of_child(change, after_s)
    assert ended in (0, KILLED), "the change itself failed"
    return ended == KILLED


def faults_after(folder: Path) -> tuple[bool, list[str]]:
    """Whether the key is the new one, and what is wrong."""
    faults: list[str] = []
    with open_library(folder, PASSPHRASE, "hk") as opened:
        database = Database(sqlite_engine(folder / DATABASE, opened.data_key))
        write_headers(database, opened.folder)
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
        for clips in opened.library.clips.of_session(opened.library.sessions.list()[0].id).values():
            pictures = open_clip(opened, clips[0], "").pictures
            if [pictures.jpeg(k) for k in range(len(pictures))] != [picture(k) for k in range(FRAMES)]:
                faults.append("the video is not whole")
            if read_clip(opened.videos / clips[0].file, clips[0].id, opened.data_key).report.sha256 != clips[0].sha256:
                faults.append("the video is not what its row states")
    try:
        KeySlots(folder / KEYS).open("ab", LEAVING)
        is_new = False
    except KeyRefusedError:
        is_new = True
    if (folder / NEW_KEYS).exists() or (folder / NEW_DATABASE).exists():
        faults.append("something was left over")
    return is_new, faults


def change_killed(place: Path, count: int, seed: int) -> Found:
    """At every file operation, then `count` times at random."""
    rng, found = random.Random(seed), Found()
    untouched = place / "untouched"
    make(untouched)
    timed, began_s = copy_of(untouched, place / "timed"), time.monotonic()
    with open_library(timed, PASSPHRASE, "hk"):
        pass
    opening_s = time.monotonic() - began_s  # before the change begins
    kill_in_child(timed, 0, None)
    whole_s = time.monotonic() - began_s

    def try_once(at_event: int, after_s: float | None) -> bool:
        folder = copy_of(untouched, place / "killed")
        was_killed = kill_in_child(folder, at_event, after_s)
        is_new, faults = faults_after(folder)
        found.count["kills"] += was_killed
        found.count["new keys"] += is_new
        found.faults += [f"event {at_event}, {after_s} s: {fault}" for fault in faults]
        shutil.rmtree(folder)
        return was_killed

    at_event = 1
    while try_once(at_event, None):
        at_event += 1
    for _ in range(count):
        try_once(0, rng.uniform(opening_s, whole_s))
    return found


if __name__ == "__main__":
    drive(
        __doc__,
        lambda asked, folder: change_killed(folder, asked.count, asked.seed),
        count=(100, "kills at random instants"),
        seed=7,
    )

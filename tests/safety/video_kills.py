"""Videos beside a walk, killed: no picture is ever in the clear, no more than a last moment of a video is lost, and no
sample of the walk because of it.

    python -m tests.safety.video_kills --seconds 600

A child records a sensor at 200 Hz and two cameras of 30 pictures a second into one library, again and again. It is
killed at a random instant; or the largest file that it may write is so small that its videos end as on a full disk, or
the disk is so small, where mounting is permitted; or a camera is pulled out; or it is killed while the patient's
consent is withdrawn. After each the library is opened as at a start, and all its files, the temporary folder and the
shelter are searched for the pictures' bytes.

The child notes in shared memory what it last put in. Every kibibyte of a picture holds the same sixteen bytes.
"""

import mmap
import os
import random
import shutil
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from uuid import UUID

from app.storage.journal.reader import Damage, JournalReader
from app.storage.journal.records import RecordKind
from app.storage.journal.writer import JournalWriter
from app.storage.layout import SUFFIX
from app.storage.opened import OpenedLibrary, open_library
from app.storage.recovery import find_interrupted, recover
from app.storage.retention import destroy_recording
from app.storage.stored import RecordingState, StoredJournal
from app.storage.videos.destroying import withdraw_consent
from app.storage.videos.reader import open_clip
from app.storage.videos.writer import ClipWriter
from app.system.progress import nobody
from app.workers.library_opening import tidy
from core.session import Patient, Recording, RecordingKind, Session
from devices.clocks.host_clock import host_time_ns
from tests.driver import KILLED, Found, drive, end_of_child
from tests.quick_library import PASSPHRASE, quick_library
from tests.safety.journal_full_disk import can_mount, small_disk
from tests.safety.journal_material import LINES, NO_ROOM_ASKED, line
from tests.videos import END, MODE, START, Frame

KNOWN = b"known frame \x93\x0e\xf1\x5b"  # what is searched for; it comes nowhere else
PICTURE_BYTES = 80_000  # as a room at 1280 x 720
SAMPLES_HZ, PICTURES_HZ = 200, 30
LONGEST_S = 1.6  # opening the library takes some of it
WHOLE_S = 0.8  # how long what is not killed records
SMALL_FILE_BYTES = 1_000_000  # a quarter of a second of video, and more than the walk's samples take
FORGOTTEN_S = 60.0  # after which a child whose parent is gone ends by itself
MOST_LOST_S = 1.0
ROUNDS = 8  # with one library
LEFT_BYTES = 4_000_000  # of the small disk of 8 MB, before which a video ends
WAYS = {"killed": 4, "full": 1, "unplugged": 1, "withdrawn": 1}  # how often each is tried, to the others


@cache
def picture(number: int, camera: int) -> bytes:
    filler = random.Random(number * 2 + camera).randbytes(1024 - len(KNOWN) - 8)
    kibibyte = KNOWN + number.to_bytes(8, "little") + filler
    return START + kibibyte * (PICTURE_BYTES // 1024) + END


class Notes:
    """What the child put in last: lines, and pictures of each camera. In shared memory, so that a kill leaves it."""

    def __init__(self, path: Path) -> None:
        if not path.exists():
            path.write_bytes(bytes(24))
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), 24)

    def put(self, what: int, count: int) -> None:
        self._memory[8 * what : 8 * what + 8] = count.to_bytes(8, "little")

    def get(self, what: int) -> int:
        return int.from_bytes(self._memory[8 * what : 8 * what + 8], "little")

    def clear(self) -> None:
        self._memory[:] = bytes(24)


def kill_videos(folder: Path, seed: int, seconds: float = 0.0, rounds: int = 0) -> Found:
    """Go on for so many seconds or rounds, with a new library after every few."""
    rng, found, began_s = random.Random(seed), Found(), time.monotonic()
    trial = Trial(folder, found, Notes(folder / "noted"))
    with _own_places(folder) as places:
        number = 0
        while number < rounds or time.monotonic() - began_s < seconds:
            library = folder / f"library {number}"
            visit_id = _made(library)
            for number in range(number, number + (rounds or ROUNDS)):  # noqa: B020 - goes on from the library before
                way = list(WAYS)[number % len(WAYS)] if rounds else rng.choices([*WAYS], [*WAYS.values()])[0]
                is_killed = way in ("killed", "withdrawn")
                trial.go(library, visit_id, number, way, rng.uniform(0.0, LONGEST_S) if is_killed else None, places)
            trial.empty(library, visit_id, number)
            shutil.rmtree(library)
            if seconds and can_mount():
                with tempfile.TemporaryDirectory() as mounted, small_disk(mounted) as disk:
                    trial.go(disk / "library", _made(disk / "library"), number, "small disk", None, [disk])
            number += 1
    return found


def _made(folder: Path) -> UUID:
    """A new library with a patient who agreed; the visit's id."""
    with quick_library(folder) as opened:
        patient = opened.library.patients.create(Patient(code="P-001"))
        opened.library.clips.give_consent(patient.id)
        return opened.library.sessions.create(patient.id, Session(())).id


@dataclass(frozen=True, slots=True)
class Trial:
    """One walk after the other, and what is found."""

    folder: Path
    found: Found
    notes: Notes

    def go(
        self, library: Path, visit_id: UUID, number: int, way: str, killed_after_s: float | None, places: list[Path]
    ) -> None:
        self.notes.clear()
        ended = end_of_child(partial(_record, library, visit_id, f"walk {number}", way, self.notes), killed_after_s)
        self.found.count[way] += 1
        faults = [] if ended == (0 if killed_after_s is None else KILLED) else [f"it ended with {ended}"]
        searched = [library, *places]
        faults += [f"in the clear: {path}" for path in in_the_clear(searched)]
        with open_library(library, PASSPHRASE) as opened:
            faults += _judge(opened, visit_id, f"walk {number}", way, self.notes, self.found)
            faults += [f"in the clear, opened: {path}" for path in in_the_clear(searched)]
        self.found.faults += [f"round {number}, {way}: {fault}" for fault in faults]

    def empty(self, library: Path, visit_id: UUID, number: int) -> None:
        """Destroy everything, and see that nothing of it is left."""
        with open_library(library, PASSPHRASE) as opened:
            for recording in opened.library.sessions.get(visit_id).recordings:
                destroy_recording(opened, recording)
            left = [path.name for path in opened.videos.iterdir()] if opened.videos.is_dir() else []
            left += [path.name for path in opened.recordings.glob(f"*{SUFFIX}")]
            if left or opened.library.clips.known():
                self.found.faults.append(f"round {number}: left after all was destroyed: {left}")


@contextmanager
def _own_places(folder: Path) -> Iterator[list[Path]]:
    """Temporary files and the shelter in the harness's own folder, so that all of them can be searched."""
    temporary, data = folder / "tmp", folder / "data"
    for one in (temporary, data):
        one.mkdir()
    before = {name: os.environ.get(name) for name in ("TMPDIR", "XDG_DATA_HOME")}
    os.environ |= {"TMPDIR": str(temporary), "XDG_DATA_HOME": str(data)}
    tempfile.tempdir = None  # so that it is looked for again
    try:
        yield [temporary, data]
    finally:
        for name, value in before.items():
            os.environ.pop(name)
            if value is not None:
                os.environ[name] = value
        tempfile.tempdir = None


# the child


def _record(folder: Path, session_id: UUID, name: str, way: str, notes: Notes) -> None:
    """Record one walk with two videos; by `way` until it is killed, the disk is full or a camera is pulled out."""
    opened = open_library(folder, PASSPHRASE)
    library = opened.library
    row = library.recordings.start(
        session_id, Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {}), False
    )
    journal = JournalWriter.create(opened.recordings, row.id, opened.data_key, room=NO_ROOM_ASKED)
    header = journal.header
    library.recordings.add_journal(row.id, StoredJournal(row.id, header.segment, header.wrapped_key))
    source = journal.source(LINES)
    if way == "full":
        import resource  # not on Windows

        resource.setrlimit(resource.RLIMIT_FSIZE, (SMALL_FILE_BYTES, resource.RLIM_INFINITY))
    room = replace(NO_ROOM_ASKED, kept_bytes=LEFT_BYTES) if way == "small disk" else NO_ROOM_ASKED
    videos = [ClipWriter.create(opened, row.id, header.opened_ns, camera, "", MODE, room=room) for camera in (1, 2)]
    stopping = threading.Event()

    def take(camera: int) -> None:
        writer, begin_s, number = videos[camera - 1], time.monotonic(), 0
        while not stopping.is_set():
            if way == "unplugged" and camera == 2 and number == 5:
                return
            if writer.add(Frame(host_time_ns(), number * 33_333_333, picture(number, camera))):
                notes.put(camera, number + 1)
                number += 1
            stopping.wait(max(begin_s + number / PICTURES_HZ - time.monotonic(), 0.005))

    cameras = [threading.Thread(target=take, args=(camera,), daemon=True) for camera in (1, 2)]
    for one in cameras:
        one.start()
    begin_s, number = time.monotonic(), 0
    most_s = WHOLE_S if way == "unplugged" else FORGOTTEN_S
    while time.monotonic() - begin_s < most_s:
        if way in ("full", "small disk") and all(writer.has_ended for writer in videos):
            most_s = min(most_s, time.monotonic() - begin_s + WHOLE_S)  # the walk goes on
        if way == "withdrawn" and number == 60:
            withdraw_consent(opened, library.sessions.get(session_id).patient_id)
        journal.received(source, line(number))
        notes.put(0, number + 1)
        number += 1
        time.sleep(max(begin_s + number / SAMPLES_HZ - time.monotonic(), 0.0))
    stopping.set()
    for one in cameras:
        one.join()
    for writer in videos:
        writer.stop()
    summary = journal.stop()
    library.recordings.close(row.id, RecordingState.CLOSED, {header.segment: summary.sha256})
    opened.library.close()


# what is left of it


def _judge(opened: OpenedLibrary, session_id: UUID, name: str, way: str, notes: Notes, found: Found) -> Iterator[str]:
    """Begin as every start does; what is wrong with the walk and its videos then."""
    library = opened.library
    tidy(opened)
    for interrupted in find_interrupted(opened):
        if interrupted.problem:
            yield f"the walk: {interrupted.problem}"
        elif interrupted.segments:
            recover(opened, interrupted, nobody)
        else:
            library.recordings.withdraw(interrupted.recording_id)  # killed before it began
    visit = library.sessions.get(session_id)
    recording = next((one for one in visit.recordings if one.details.name == name), None)
    if recording is None or not recording.journals:
        if notes.get(0) > 0:
            yield "the walk is gone"
        return
    yield from _judge_walk(opened, opened.recordings / recording.journals[0].file, notes.get(0), way, found)
    is_agreed = library.clips.consent(visit.patient_id).is_given
    clips = {clip.camera: clip for clip in library.clips.of_session(session_id).get(recording.id, ())}
    for camera in (1, 2):
        put, kept = notes.get(camera), 0
        if (clip := clips.get(camera)) is not None:
            pictures = open_clip(opened, clip, name).pictures
            kept = len(pictures)
            if kept != clip.frames:
                yield f"video {camera}: {kept} pictures, its row states {clip.frames}"
            if any(pictures.jpeg(k) != picture(k, camera) for k in range(kept)):
                yield f"video {camera}: not what was put in"
        if not is_agreed:
            if kept:
                yield f"video {camera} is there though consent was withdrawn"
            continue
        if way == "killed":
            found.figures["video lost, pictures"].append(max(put - kept, 0))
            if (put - kept) / PICTURES_HZ > MOST_LOST_S:
                yield f"video {camera}: {kept} of {put} pictures"
        elif way == "unplugged" and kept != put:
            yield f"video {camera}: {kept} of {put} pictures"
        elif way in ("full", "small disk"):
            found.figures["video before the disk was full, pictures"].append(kept)
            if not 0 < kept <= put or (way == "small disk" and kept != put):
                yield f"video {camera}: {kept} of {put} pictures on a full disk"
    if not is_agreed:
        found.count["consents withdrawn"] += 1
        if library.clips.known() or any(opened.videos.iterdir()):
            yield "videos are left though consent was withdrawn"
        library.clips.give_consent(visit.patient_id)


def _judge_walk(opened: OpenedLibrary, path: Path, put: int, way: str, found: Found) -> Iterator[str]:
    reader = JournalReader(path, opened.data_key)
    records = list(reader.records())
    lines = [
        record.payload[2:] for record in records if not isinstance(record, Damage) and record.kind is RecordKind.BYTES
    ]
    if lines != [line(k) for k in range(len(lines))] or reader.report.missing_records:
        yield f"the walk is not what was put in: {reader.report}"
    lost = put - len(lines)
    if way in ("killed", "withdrawn"):
        found.figures["walk lost, ms"].append(max(lost, 0) * 1000 / SAMPLES_HZ)
        if lost / SAMPLES_HZ > MOST_LOST_S:
            yield f"the walk: {len(lines)} of {put} samples"
    elif lost or not reader.report.is_whole:
        yield f"the walk: {len(lines)} of {put} samples, {reader.report}"


def in_the_clear(places: list[Path]) -> Iterator[Path]:
    for place in places:
        for path in place.rglob("*"):
            with suppress(FileNotFoundError):
                if path.is_file() and (KNOWN in (content := path.read_bytes()) or START in content):
                    yield path


if __name__ == "__main__":
    drive(
        __doc__,
        lambda asked, folder: kill_videos(folder, asked.seed, seconds=asked.seconds),
        seconds=(600.0, "how long"),
        seed=1,
    )

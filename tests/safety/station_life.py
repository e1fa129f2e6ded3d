"""A clinic's station that records one walk after the other, whatever the server and the shared place do, until
reported.

It does what the window does: looks through what is left over, listens to the server, hands over, tries again what could
not be read back. It notes what it is at, so that whoever kills it can choose the moment, and what it has recorded.
"""

import json
import os
import random
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.context import ForkProcess
from pathlib import Path
from threading import Event, Timer
from uuid import UUID

import fsspec  # noqa: F401 - before the fork
import psycopg  # noqa: F401 - before the fork
from PySide6.QtCore import QCoreApplication, Qt

from app.acquisition.acquisition import Acquisition
from app.acquisition.recorder import Recorder
from app.storage import audit, corrections, operators, patients, results, sessions  # noqa: F401 - before the fork
from app.storage.bringing_home import bring_home
from app.storage.clinic.handing_over import begin_station
from app.storage.clinic.journal_store import JournalStore
from app.storage.exchange import recording_with_samples
from app.storage.journal.header import JournalRefusedError
from app.storage.opened import OpenedLibrary, held_alone, open_library
from app.storage.recovery import adopt_home, find_interrupted, recover
from app.storage.stored import LibraryError
from app.system.progress import nobody
from app.workers import library_watch
from app.workers.library_watch import LibraryWatch
from core.session import Recording, RecordingKind
from devices.decoders import DECODERS
from devices.simulation.replay import ReplaySource
from tests.safety.clinic_material import PASSPHRASE
from tests.safety.journal_material import NO_ROOM_ASKED
from tests.safety.live_material import numbered_session

RECORDING, HANDING_OVER, ADOPTING = range(3)  # where in the file of moments each has its byte
SHORTEST_S, LONGEST_S = 0.2, 1.0
AGAIN_S, PATIENCE_S = 0.2, 60.0
AMID_S = 0.03
STOP = "stop"


class Moments:
    """What a station is at, a byte each, in a file that others read.

    `wish` is there as long as somebody wishes that it be killed at the moment whose number is in it.
    """

    def __init__(self, path: Path, wish: Path) -> None:
        self._wish = wish
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)

    @contextmanager
    def at(self, moment: int) -> Iterator[None]:
        os.pwrite(self._descriptor, b"\1", moment)
        with suppress(FileNotFoundError):
            if self._wish.read_text() == str(moment):
                self._wish.unlink()
                Timer(random.uniform(0.0, AMID_S), os.kill, (os.getpid(), signal.SIGKILL)).start()
        try:
            yield
        finally:
            os.pwrite(self._descriptor, b"\0", moment)


def is_at(path: Path, moment: int) -> bool:
    return path.exists() and path.read_bytes()[moment : moment + 1] == b"\1"


def recover_all(opened: OpenedLibrary) -> list[str]:
    """Recover and adopt what can be; why the rest cannot."""
    refused = []
    for one in find_interrupted(opened):
        try:
            if one.stored is None:
                adopt_home(opened, one, nobody)
            else:
                recover(opened, one, nobody)
        except (JournalRefusedError, LibraryError) as refusal:
            refused.append(f"{one.recording_id}: {refusal}")
    return refused


class StationLife:
    """One life of a station, from its start to the word to stop, or to a kill."""

    def __init__(self, folder: Path, code: str, session_id: UUID, notes: Path) -> None:
        self._folder, self._code, self._session_id = folder, code, session_id
        self._notes = notes
        self._moments = Moments(notes / f"{code}.moments", notes / f"{code}.wish")
        self._rng = random.Random(os.getpid())
        self._unread: list[Recorder] = []
        self._is_back = Event()
        self._file = (notes / f"{code}.{os.getpid()}.{time.time_ns()}").open("w")

    def live(self) -> None:
        self._mark_handing_over()
        opened = self._open()
        with opened, held_alone(self._folder):
            self._until_done(lambda: begin_station(opened))
            self._until_done(lambda: bring_home(opened))
            self._until_done(lambda: self._recover(opened))
            watch = LibraryWatch(opened, QCoreApplication.instance() or QCoreApplication())
            watch.came_back.connect(self._on_back, Qt.ConnectionType.DirectConnection)
            watch.start()
            acquisition = Acquisition([ReplaySource(numbered_session("a", 2))])
            acquisition.start()
            number = 0
            while not (self._notes / STOP).exists():
                number += 1
                self._record(opened, acquisition, number)
                self._read_back(opened)
            acquisition.close()
            give_up_s = time.monotonic() + PATIENCE_S
            while self._unread and time.monotonic() < give_up_s:
                self._read_back(opened)
                time.sleep(AGAIN_S)
            watch.end()
            watch.ended()

    def _open(self) -> OpenedLibrary:
        while True:
            try:
                return open_library(self._folder, PASSPHRASE, self._code)
            except LibraryError:
                time.sleep(AGAIN_S)

    def _until_done(self, step: object) -> None:
        assert callable(step)
        while True:
            try:
                step()
                return
            except LibraryError:
                time.sleep(AGAIN_S)

    def _on_back(self, _brought: int) -> None:
        self._is_back.set()

    def _record(self, opened: OpenedLibrary, acquisition: Acquisition, number: int) -> None:
        name = f"{self._code} {os.getpid()} {number}"
        reported = Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {})
        recorder = Recorder.begin(opened, acquisition, self._session_id, reported, room=NO_ROOM_ASKED)
        with self._moments.at(RECORDING):
            time.sleep(self._rng.uniform(SHORTEST_S, LONGEST_S))
            recorder.halt()
        assert recorder.summary is not None
        self._note(id=str(recorder.id), sha256=recorder.summary.sha256, dropped=recorder.summary.dropped_records)
        self._unread.append(recorder)

    def _read_back(self, opened: OpenedLibrary) -> None:
        """What the visit does: the oldest first, again as long as the server does not answer."""
        while self._unread:
            try:
                self._unread[0].stop(opened)
            except LibraryError as refusal:
                self._note(refused=str(refusal), of=str(self._unread[0].id))
                return
            self._unread.pop(0)
        if self._is_back.is_set():
            self._is_back.clear()
            try:
                self._recover(opened)
            except LibraryError:
                self._is_back.set()

    def _recover(self, opened: OpenedLibrary) -> None:
        with self._moments.at(ADOPTING):
            for refused in recover_all(opened):
                self._note(not_recovered=refused)

    def _note(self, **stated: object) -> None:
        self._file.write(json.dumps(stated) + "\n")
        self._file.flush()

    def _mark_handing_over(self) -> None:
        put, moments = JournalStore.put, self._moments

        def marked(store: JournalStore, path: Path) -> str:
            with moments.at(HANDING_OVER):
                return put(store, path)

        JournalStore.put = marked  # type: ignore[method-assign,assignment]  # to be killed amid it


def read_all_of(opened: OpenedLibrary, session_id: UUID) -> Iterator[tuple[UUID, Recording]]:
    """Every recording of a session that has samples."""
    for stored in opened.library.sessions.get(session_id).recordings:
        if stored.journals:
            yield stored.id, recording_with_samples(opened, stored, DECODERS)[0]


def serve() -> None:
    """Fork a station for every line that reports one, or say how one has ended: forking saves the imports."""
    library_watch.LISTEN_EVERY_S = 0.5  # else a short outage is not known of
    library_watch.BRING_AGAIN_S = 1.0
    print("ready", flush=True)
    living: dict[int, ForkProcess] = {}
    for line in sys.stdin:
        reported = json.loads(line)
        if "ended" in reported:
            child = living.pop(reported["ended"])
            child.join()
            print(child.exitcode, flush=True)
            continue
        places = (Path(reported["folder"]), reported["code"], UUID(reported["session"]), Path(reported["notes"]))
        child = get_context("fork").Process(target=_live, args=places)
        child.start()
        assert child.pid is not None
        living[child.pid] = child
        print(child.pid, flush=True)


def _live(folder: Path, code: str, session_id: UUID, notes: Path) -> None:
    _application = QCoreApplication([])
    StationLife(folder, code, session_id, notes).live()


if __name__ == "__main__":
    serve()

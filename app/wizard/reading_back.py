"""Recordings that were stopped, until it has been read back what their journals hold: one at a time, oldest first.

What the library does not answer is asked again for a while, and then left to the next start. What is in the sensors'
memories still is passed over until it has been fetched, so that it holds up none that came after it.
"""

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from PySide6.QtCore import QObject, QTimer, Signal, Slot

from app.acquisition.recorder import Recorder
from app.editing.session_recording import SessionRecording
from app.storage.stored import StoredRecording
from app.wizard.journal_words import unread_message
from app.wizard.memory_fetches import MemoryFetches
from app.workers.library_controller import LibraryController
from core.body import Side
from core.session import Recording, RecordingKind
from core.signal.received import SamplesReceived, samples_received

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

READ_AGAIN_MS = 2000  # after the library did not answer
MOST_READINGS = 15


class StoppedRecording(NamedTuple):
    """What is to be read back; `strides` as in `SessionRecording`. Not kept: it was broken off."""

    recorder: Recorder
    details: Recording
    strides: Mapping[Side, int] | None
    is_kept: bool


class ReadingBack(QObject):
    """Reads what was recorded back from its journal, one recording after the other, and again where that fails.

    `failed`: what the matter is, where the recording is meanwhile, and whether that is news: at the first try, and
    where it is left to the next start.
    """

    read = Signal(object, object)  # a StoppedRecording, and the SessionRecording that it is now
    failed = Signal(str, str, bool)

    def __init__(self, controller: LibraryController, fetches: MemoryFetches, parent: QObject) -> None:
        super().__init__(parent)
        self._controller, self._fetches = controller, fetches
        self._waiting: list[StoppedRecording] = []  # oldest first
        self._given_up: set[str] = set()  # names that the library has still
        self._reading: StoppedRecording | None = None
        self._readings = 0  # of the one that is tried
        self._again = QTimer(self)
        self._again.setSingleShot(True)
        self._again.timeout.connect(self._read_next)
        fetches.fetched.connect(self._on_fetched)

    @property
    def is_idle(self) -> bool:
        """Whether all has been read back, what is in the sensors' memories included."""
        return not self._waiting

    @property
    def names(self) -> set[str]:
        """Of recordings that the library has and the screen does not show."""
        return {one.details.name for one in self._waiting} | self._given_up

    @property
    def in_sensors(self) -> tuple[Recording, ...]:
        """Those that are in the sensors' memories still, oldest first."""
        in_sensors = self._fetches.waiting
        return tuple(one.details for one in self._waiting if one.recorder in in_sensors)

    def awaits(self, kind: RecordingKind) -> bool:
        """Whether one of a kind that counts is still to be read back."""
        return any(one.recorder.kind is kind and one.is_kept for one in self._waiting)

    @property
    def where(self) -> str:
        """Where the oldest is that is still tried."""
        return unread_message((self._next or self._waiting[0]).recorder.status, is_tried_again=True)

    def add(self, stopped: StoppedRecording) -> None:
        """Read it back once `begin` is called, or it has been fetched."""
        self._waiting.append(stopped)

    def begin(self) -> None:
        """Read what can be read, unless it is about to be tried again anyway."""
        if not self._again.isActive():
            self._read_next()

    def leave_in_sensors(self) -> None:
        """Close the journals of what is still to be fetched: it does not count until it is fetched again."""
        left = self._fetches.give_up()
        self._waiting = [one for one in self._waiting if one.recorder not in left]
        for recorder in left:
            self._controller.run(partial(_without_samples, recorder), None, None, self._controller)

    @property
    def _next(self) -> StoppedRecording | None:
        return next((one for one in self._waiting if one.recorder.is_whole), None)

    @Slot()
    def _read_next(self) -> None:
        if self._reading is None and (stopped := self._next) is not None:
            self._reading = stopped
            self._readings += 1
            self._controller.run(partial(_read_and_counted, stopped.recorder), self._on_read, self._on_not_read, self)

    @Slot(object)
    def _on_fetched(self, _recorder: Recorder) -> None:
        self._read_next()

    def _on_read(self, result: tuple[StoredRecording, Recording, Mapping[str, SamplesReceived]]) -> None:
        stored, read_back, received = result
        stopped = self._taken()
        memory = stopped.recorder.memory
        lacks = memory.lacks() if memory is not None else ()
        self._readings = 0
        self._waiting.remove(stopped)
        self.read.emit(
            stopped, SessionRecording(stored, read_back, stopped.strides, stored.is_decided, lacks, received)
        )
        self._read_next()

    def _on_not_read(self, what: str, _remedy: str) -> None:
        stopped, is_first = self._taken(), self._readings == 1
        is_open = self._controller.state is not None
        is_tried_again = is_open and (self._controller.is_gone or self._readings < MOST_READINGS)
        if is_tried_again:
            self._again.start(READ_AGAIN_MS)
        else:
            self._readings = 0
            self._waiting.remove(stopped)
            self._given_up.add(stopped.details.name)
        where = unread_message(stopped.recorder.status, is_tried_again=is_tried_again)
        self.failed.emit(what, where, is_first or not is_tried_again)
        if not is_tried_again:
            self._read_next()

    def _taken(self) -> StoppedRecording:
        stopped, self._reading = self._reading, None
        assert stopped is not None  # it was asked for
        return stopped


def _read_and_counted(
    recorder: Recorder, opened: "OpenedLibrary"
) -> tuple[StoredRecording, Recording, dict[str, SamplesReceived]]:
    """What a journal holds, and by sensor how much was received of what was expected.

    Sensors that record in their memories begin and end one after the other; `SessionRecording.lacks` is theirs.
    """
    stored, recording = recorder.stop(opened)
    if recorder.memory is not None:
        return stored, recording, {}
    placed = stored.placement.sensors if stored.placement is not None else {}
    rates_hz = {site: one.info.rate_hz for site, one in placed.items()}
    counts = samples_received(recording, rates_hz, placed)
    return stored, recording, {placed[site].name: one for site, one in counts.items() if site in placed}


def _without_samples(recorder: Recorder, opened: "OpenedLibrary") -> None:
    recorder.leave_in_memory()
    stored, _ = recorder.stop(opened)
    opened.library.edits.decision(stored.id, is_kept=False)

"""The recordings of a visit: begun, stopped, kept or not. What is shown live is a preview of what comes back here."""

import datetime
from collections.abc import Callable, Collection, Mapping
from concurrent.futures import Future
from dataclasses import replace
from enum import Enum, auto
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, QTimer, Signal, Slot

from app.acquisition.recorder import Recorder
from app.editing.recordings import RecordingEdits
from app.editing.session_recording import Ongoing, SessionRecording, counted
from app.storage.edited_fields import recording_fields
from app.storage.journal.disk import REPORTED, Trouble
from app.storage.stored import StoredRecording, StoredSession
from app.wizard.journal_words import (
    ENDS,
    is_written,
    no_row_message,
    standstill_message,
    trouble_message,
)
from app.wizard.losses import NOTHING, Message
from app.wizard.memory_fetches import MemoryFetches
from app.wizard.reading_back import ReadingBack, StoppedRecording
from app.wording.recordings import OWN_NAMES, ShownName, shown_names
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from core.body import Side
from core.session import Recording, RecordingKind
from devices.source import SensorCounts

if TYPE_CHECKING:
    from app.acquisition.acquisition import Acquisition
    from app.acquisition.recorder import InMemory
    from app.storage.opened import OpenedLibrary
    from core.alignment import AlignmentChange
    from core.timed.protocols import PlannedTest


WAITED_MS = 3000  # for a recording to be read back, before the next may begin without it


class RecordingPhase(Enum):
    """How far the recording is that was asked for last."""

    IDLE = auto()  # nothing is recorded: the next may begin
    BEGINNING = auto()  # asked for; the library has not answered, so nothing is written yet
    BEGINNING_TO_STOP = auto()  # the same, and stopped already: it ends as soon as it has begun
    WRITING = auto()  # what comes in is written
    STOPPING = auto()  # stopped, and waited for: until it is read back, or for a few seconds
    CLOSED = auto()  # the visit ended before it had begun: the library ends it itself


class SessionRecordings(QObject):
    """A recording begins and ends at once, whatever the library is doing; what it holds is read back when it answers.

    All calls to the library are made by the controller's thread; this lives on the screen's."""

    changed = Signal()
    begun = Signal()
    ended = Signal(object)  # SessionRecording
    refused = Signal(str, str)
    merged = Signal(str, str)  # what another station changed of the same recording meanwhile
    asked = Signal(object)  # EditQuestion: what both changed
    troubled = Signal(str, str)  # of the disk, or of the library's folder: what happened, and what to do
    _met = Signal(str)  # Trouble; emitted by whichever thread meets it

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller
        self.session: StoredSession | None = None
        self.ongoing: Ongoing | None = None
        self.every: tuple[SessionRecording, ...] = ()
        self._phase = RecordingPhase.IDLE
        self._latest: Recorder | None = None  # also once it has been stopped; none before the library has answered
        self._trouble: Trouble | None = None  # of the latest
        self._is_without_row = False
        self._acquisition: Acquisition | None = None
        self._counts_before: Mapping[str, SensorCounts] = {}
        self._must_keep = True
        self._strides: Mapping[Side, int] | None = None
        self._is_restrapped = False
        self._beginning: Future[Recorder]
        self.fetches = MemoryFetches(self)
        """What is in the sensors' memories still."""
        self._edits = RecordingEdits(controller, self.find, self.called, self)
        self._edits.saved.connect(self._on_saved)
        self._edits.changed.connect(self.changed)
        self._edits.refused.connect(self.refused)
        self._edits.merged.connect(self.merged)
        self._edits.asked.connect(self.asked)
        self._reading_back = ReadingBack(controller, self.fetches, self)
        self._reading_back.read.connect(self._on_read)
        self._reading_back.failed.connect(self._on_not_read)
        self._waited = QTimer(self)
        self._waited.setSingleShot(True)
        self._waited.timeout.connect(self._on_waited)
        self._met.connect(self._on_met)
        controller.gone.connect(self.troubled)
        controller.back.connect(self.troubled)

    @property
    def is_recording(self) -> bool:
        return self.ongoing is not None

    @property
    def has_begun(self) -> bool:
        """Whether what comes now is being written; just asked for, it is not yet."""
        return self._phase is RecordingPhase.WRITING

    @property
    def is_stopping(self) -> bool:
        """Whether a recording has been stopped, or will be once it has begun, and is still waited for."""
        return self._phase in (RecordingPhase.BEGINNING_TO_STOP, RecordingPhase.STOPPING)

    @property
    def latest(self) -> "Recorder | None":
        """The latest recording, also once it has been stopped; None before the library has answered."""
        return self._latest

    @property
    def is_in_memory(self) -> bool:
        """Whether the latest recording is made in the sensors' memories."""
        return self._latest is not None and self._latest.memory is not None

    @property
    def in_sensors(self) -> tuple[Recording, ...]:
        """Those that have ended and are in the sensors' memories still, oldest first."""
        return self._reading_back.in_sensors

    @property
    def is_idle(self) -> bool:
        """Whether nothing is being recorded, and all that was has been read back."""
        return self.ongoing is None and self._reading_back.is_idle

    @property
    def walks(self) -> tuple[SessionRecording, ...]:
        return self._of(RecordingKind.WALKING)

    @property
    def reported(self) -> tuple[Recording, ...]:
        """What was stated about all of them, in order of time, the one that goes on included."""
        ongoing = (self.ongoing.details,) if self.ongoing is not None else ()
        return (*(recording.details for recording in self.every), *ongoing)

    @property
    def shown_names(self) -> dict[str, ShownName]:
        """What each is called on the screen, by its name."""
        reported = {one.name: one for one in (*self.reported[: len(self.every)], *self.in_sensors, *self.reported)}
        return shown_names(tuple(reported.values()))

    def find(self, recording_id: UUID) -> SessionRecording | None:
        """One that has ended, as it is on the screen."""
        return next((one for one in self.every if one.id == recording_id), None)

    def called(self, name: str) -> str:
        """What one of them is called on the screen, by its name."""
        return str(self.shown_names.get(name, name))

    @property
    def standing(self) -> SessionRecording | None:
        """The one in force."""
        return next(
            (recording for recording in reversed(self._of(RecordingKind.STANDING)) if recording.details.is_kept), None
        )

    @property
    def free_motion(self) -> SessionRecording | None:
        return next(
            (recording for recording in reversed(self._of(RecordingKind.FREE_MOTION)) if recording.details.is_kept),
            None,
        )

    @property
    def is_restrapped(self) -> bool:
        """Whether sensors were strapped again since the last recording: what was calibrated holds no longer."""
        return self._is_restrapped

    @property
    def has_moved(self) -> bool:
        """Whether a free motion holds: kept, and made since sensors were strapped last."""
        if self._is_restrapped:
            return False
        for recording in reversed(self.every):
            if recording.details.kind is RecordingKind.FREE_MOTION and recording.details.is_kept:
                return True
            if recording.details.is_restrapped_before:
                return False
        return False

    @property
    def must_move(self) -> bool:
        """Whether sensors were strapped again, and the free motion that this asks for is still to come."""
        return not self.has_moved and (
            self._is_restrapped or any(recording.details.is_restrapped_before for recording in self.every)
        )

    @property
    def since_strapped(self) -> tuple[SessionRecording, ...]:
        """All recordings since sensors were strapped last: what is stated now of who wears what holds for these."""
        if self._is_restrapped:
            return ()
        strapped = [number for number, recording in enumerate(self.every) if recording.details.is_restrapped_before]
        return self.every[strapped[-1] if strapped else 0 :]

    def awaits(self, kind: RecordingKind) -> bool:
        """Whether one of a kind that counts has been stopped, and is still to be read back."""
        return self._reading_back.awaits(kind)

    def take_over(self, session: StoredSession, recordings: tuple[SessionRecording, ...]) -> None:
        """Go on with a session of the library."""
        self.session, self.every = session, recordings
        self.changed.emit()

    def begin(
        self,
        acquisition: "Acquisition",
        kind: RecordingKind,
        condition: str = "",
        alignment: "AlignmentChange | None" = None,
        test: "PlannedTest | None" = None,
        fetched: "tuple[InMemory, str] | None" = None,
    ) -> None:
        """Record from now on; `begun` or `refused` follows. RuntimeError: already recording, or no session."""
        if self.session is None or self.ongoing is not None:
            raise RuntimeError("a recording needs a session, and is made one at a time")
        name = self._new_name(kind)
        reported = Recording(
            name=name,
            kind=kind,
            folder=name.replace(" ", "_"),
            imu={},
            condition=condition,
            started=fetched[1] if fetched is not None else _now(),
            is_restrapped_before=self._is_restrapped,
            alignment=alignment,
            test=test,
        )
        self.ongoing = Ongoing(reported, acquisition.now_s)
        if self._phase is not RecordingPhase.CLOSED:
            self._phase = RecordingPhase.BEGINNING
        self._must_keep, self._strides = True, None
        self._latest, self._trouble, self._is_without_row = None, None, False
        self._acquisition = acquisition
        self._counts_before = {name: one.counts for name, one in acquisition.status().items()}
        session_id = self.session.id
        begun = self._beginning = Future[Recorder]()

        def start(opened: "OpenedLibrary", turn: "Future[None]") -> Recorder:
            try:
                memory = fetched[0] if fetched is not None else None
                recorder = Recorder.begin(opened, acquisition, session_id, reported, self.meet, turn, fetched=memory)
                begun.set_result(recorder)
            except BaseException as error:
                begun.set_exception(error)
            return begun.result()

        self._controller.record(start, self._on_started, self._on_not_started, self)
        self.changed.emit()

    def stop(self, strides: Mapping[Side, int] | None = None, *, is_kept: bool = True) -> None:
        """Stop and read back, at once or once begun; `ended` follows. Not `is_kept`: not counted, not deleted."""
        if self._phase in (RecordingPhase.BEGINNING, RecordingPhase.BEGINNING_TO_STOP):
            self._phase, self._strides = RecordingPhase.BEGINNING_TO_STOP, strides
            self._must_keep = self._must_keep and is_kept  # what was broken off stays so
            self.changed.emit()
        if self._phase is not RecordingPhase.WRITING or self._latest is None or self.ongoing is None:
            return
        recorder = self._latest

        def halt(_opened: "OpenedLibrary", _turn: "Future[None]") -> None:
            recorder.halt()

        self._phase = RecordingPhase.STOPPING
        self._reading_back.add(StoppedRecording(recorder, self.ongoing.details, strides, is_kept))
        self._controller.record(halt, None, self._on_not_halted, self)
        if recorder.memory is not None:
            self.fetches.add(recorder)
        else:
            self._waited.start(WAITED_MS)
            self._reading_back.begin()
        self.changed.emit()

    def fetch_later(self) -> None:
        """Leave what is in the sensors where it is for now: the next may be recorded."""
        self.fetches.stop()
        self._go_on()
        self.changed.emit()

    def close(self) -> None:
        """Stop for good; a recording still beginning is ended by the library, or recovered at the next start."""
        if self.ongoing is None or self._phase in (RecordingPhase.WRITING, RecordingPhase.STOPPING):
            self.stop()
            self._reading_back.leave_in_sensors()
            return
        self._reading_back.leave_in_sensors()
        begun, self._phase = self._beginning, RecordingPhase.CLOSED

        def end(opened: "OpenedLibrary") -> None:
            begun.result().stop(opened)

        self._controller.run(end, self._on_closed, self._on_not_started, self)

    def trouble_message(self) -> Message:
        """What befell the latest recording's journal, as its counters have it by now; nothing where nothing did."""
        if self._latest is None:
            return NOTHING
        if self._trouble is Trouble.MOVED or (self._trouble is None and self._latest.is_away):
            return self._moved()
        if self._trouble is not None:
            return trouble_message(self._trouble, self._latest.status, self._lost())
        if self.is_recording and self._controller.gone_words is not None:
            return self._controller.gone_words
        if self._is_without_row and not self._latest.has_row:
            return no_row_message(self._latest.status)
        return NOTHING

    def standstill_message(self, worn: Collection[str]) -> Message:
        """What it cost that the process stood still amid what is recorded, of the sensors that are worn."""
        acquisition, ongoing = self._acquisition, self.ongoing
        if acquisition is None or ongoing is None or not acquisition.standstills:
            return NOTHING
        latest, now_s, lost = acquisition.standstills[-1], acquisition.now_s, acquisition.lost()
        status = {name: one for name, one in acquisition.status().items() if name in worn}
        return standstill_message(
            latest,
            ongoing.began_s,
            now_s,
            {name: count for name, count in lost.items() if name in status},
            all(one.silent_s < now_s - latest.ended_s for one in status.values()),
            all(one.details.rate_hz is not None for one in status.values()),
        )

    def _lost(self) -> int:
        """How many samples did not come since the latest recording began."""
        if self._acquisition is None:
            return 0
        now = self._acquisition.lost()
        before = self._counts_before
        return sum(max(count - before.get(name, SensorCounts()).lost, 0) for name, count in now.items())

    def received_so_far(self) -> dict[str, tuple[int, int]]:
        """Samples received and lost since the recording that goes on began, by sensor; of those whose loss shows."""
        if self._acquisition is None or not self.has_begun or self.is_in_memory:
            return {}
        counts = {}
        for name, one in self._acquisition.status().items():
            before = self._counts_before.get(name, SensorCounts())
            if one.details.is_loss_seen and one.details.rate_hz is not None:
                lost = max(one.counts.lost - before.lost, 0)
                counts[name] = one.counts.received - before.received, lost
        return counts

    @property
    def is_written(self) -> bool:
        """Whether the journal takes all that comes in, and nothing of it waits for long or was dropped."""
        return self.has_begun and self._latest is not None and is_written(self._latest.status)

    def mark(self, text: str) -> None:
        """Note in the journal what happens now."""
        if self.has_begun and self._latest is not None:
            self._latest.mark(text)

    def say_restrapped(self) -> None:
        """What is recorded next is a new calibration's."""
        self._is_restrapped = True
        self.changed.emit()

    def keep(self, recording: SessionRecording, is_kept: bool) -> None:
        """Say whether a recording counts; nothing is deleted, and it can be stated again at any time."""
        if recording.details.is_restrapped_before and not is_kept and recording.id == self.every[-1].id:
            self._is_restrapped = True  # what comes next is the first that counts
        is_asked = recording.stored.is_unjudged or not recording.stored.is_decided
        self._put(replace(recording, is_decided=True))
        if is_asked and not self._edits.is_saving(recording.id):
            self._edits.decide(recording.id, is_kept)
        else:  # also where it seems to be so already: what was stated a moment before may still be on its way
            self.change(recording, lambda reported: replace(reported, is_kept=is_kept))

    def ask_again(self, recording: SessionRecording) -> None:
        """Ask once more on this screen whether a recording is kept; until answered, it stays as it was stated."""
        self._put(replace(recording, is_decided=False))

    def stated(self, recording: SessionRecording) -> Recording:
        """What was stated about a recording, the last word of it on the screen."""
        return self._edits.stated(self.find(recording.id) or recording)

    def change(self, recording: SessionRecording, corrected: Callable[[Recording], Recording]) -> None:
        """Correct what a recording states; `changed` follows. `corrected` gets what the screen shows now."""
        shown = self.stated(recording)
        self._edits.save(recording.id, recording_fields(shown), recording_fields(corrected(shown)))

    def counted(self) -> tuple[Recording, ...]:
        """Those that count and have been read, as an analysis takes them."""
        return counted(self.every)

    def _of(self, kind: RecordingKind) -> tuple[SessionRecording, ...]:
        return tuple(recording for recording in self.every if recording.details.kind is kind)

    def _new_name(self, kind: RecordingKind) -> str:
        """`walk 2`, `free motion`, `standing 3`: the kind's name in files, numbered."""
        word = OWN_NAMES[kind]
        taken = {one.details.name for one in self.every} | self._reading_back.names
        first = f"{word} 1" if kind is RecordingKind.WALKING else word
        return next(name for name in [first, *(f"{word} {k}" for k in range(2, 10_000))] if name not in taken)

    def _put(self, recording: SessionRecording) -> None:
        """Show it as it is now; a new one in the order of beginning, which that of their ids is."""
        if any(other.id == recording.id for other in self.every):
            self.every = tuple(recording if other.id == recording.id else other for other in self.every)
        else:
            place = len(self.every)
            while place and self.every[place - 1].id > recording.id:  # one that was fetched later than it was made
                place -= 1
            self.every = (*self.every[:place], recording, *self.every[place:])
        self.changed.emit()

    def _go_on(self) -> None:
        """The next recording may begin."""
        if self._phase is RecordingPhase.STOPPING:
            self.ongoing, self._phase = None, RecordingPhase.IDLE
            self._waited.stop()

    def meet(self, trouble: Trouble) -> None:
        """Take note of what befell the journal; any thread may say it, and what follows is done by the screen's."""
        self._met.emit(str(trouble))

    @Slot(str)
    def _on_met(self, met: str) -> None:
        self._trouble = Trouble(met)
        if self._latest is not None:
            self.troubled.emit(*self.trouble_message())
        if self._trouble in ENDS:
            self.stop()

    def _on_closed(self, _nothing: None) -> None:
        self.ongoing = None
        self.changed.emit()

    def _on_started(self, recorder: Recorder) -> None:
        if self._phase is RecordingPhase.CLOSED:
            return
        must_stop = self._phase is RecordingPhase.BEGINNING_TO_STOP
        self._latest = recorder
        if not must_stop:
            self._phase = RecordingPhase.WRITING
        self._is_restrapped = False
        self._is_without_row = not recorder.has_row
        self.begun.emit()
        if self.trouble_message() != NOTHING:
            self.troubled.emit(*self.trouble_message())
        if must_stop:
            self._phase = RecordingPhase.WRITING
            self.stop(self._strides, is_kept=self._must_keep)

    def _moved(self) -> Message:
        """Say where the recording is kept while its library is gone, or cannot be written."""
        what, remedy = REPORTED[Trouble.MOVED]
        shelter = self._controller.state.library.shelter if self._controller.state is not None else None
        place = shelter.folder if shelter is not None else ""
        return f"{tr(what)}.", f"{tr(remedy)}.".format(shelter=place)

    @Slot(object, object)
    def _on_read(self, stopped: StoppedRecording, recording: SessionRecording) -> None:
        if stopped.recorder is self._latest:
            self._go_on()
        self._put(recording)
        self.ended.emit(recording)
        if not stopped.is_kept:
            self.keep(recording, is_kept=False)

    @Slot(str, str, bool)
    def _on_not_read(self, what: str, where: str, is_news: bool) -> None:
        """What was recorded is on the disk; the next may begin."""
        must_show = is_news or self._phase is RecordingPhase.STOPPING
        self._go_on()
        self.changed.emit()
        if must_show:
            self.refused.emit(what, where)

    def _on_waited(self) -> None:
        self._go_on()
        self.changed.emit()
        self.refused.emit(tr("The recording is not loaded yet."), self._reading_back.where)

    def _on_not_halted(self, _what: str, _remedy: str) -> None:
        """Whoever reads it back meets the same, and reports it."""

    @Slot(object)
    def _on_saved(self, stored: StoredRecording) -> None:
        if (before := self.find(stored.id)) is not None:
            self._put(replace(before, stored=stored))

    def _on_not_started(self, what: str, remedy: str) -> None:
        self.ongoing = None
        if self._phase is not RecordingPhase.CLOSED:
            self._phase = RecordingPhase.IDLE
        self.changed.emit()
        self.refused.emit(what, remedy)


def _now() -> str:
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")

"""Bring a recording into the library, whatever the database is doing, and out of its journal again.

Its row comes first, where the database answers within a second. Where it does not, whatever is the matter with it, the
journal is begun all the same and states itself which session it is of: the row follows, at the latest on stop; if the
program ends before that, the journal is found at the next start and put into its session.

Where the library's folder itself is gone, the journal is in its shelter; on stop it is brought home first.
"""

import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Protocol
from uuid import UUID

from app.acquisition.acquisition import Acquisition
from app.storage.bringing_home import bring_home
from app.storage.exchange import recording_with_samples
from app.storage.journal.disk import ROOM, Room, Trouble
from app.storage.journal.payloads import Belonging
from app.storage.journal.writer import JournalStatus, JournalSummary, JournalWriter, State
from app.storage.opened import OpenedLibrary
from app.storage.recovery import Interrupted, adopt, find_interrupted, recover
from app.storage.stored import LibraryError, LibraryFaultError, RecordingState, StoredJournal, StoredRecording
from app.system.progress import nobody
from core.session import Recording, RecordingKind
from devices.decoders import DECODERS

if TYPE_CHECKING:  # sensors with memories are few, and what they need is imported with them
    from app.acquisition.memory_fetching import Lack, Progress
    from app.storage.data_key import KeyMaterial
    from devices.live import SourceLostError, SourceRefusedError
    from devices.transport.bluetooth import Tick

ROW_WAIT_S = 1.0

_log = logging.getLogger(__name__)


class Recorder:
    """One recording, from its beginning to what its journal holds. Not for the screen's thread, `mark` aside.

    What is in the sensors' own memory is `memory`: once stopped, it is still to be fetched, into the same journal.

    `summary`: what was kept; None while it is recorded, or still to be fetched.
    """

    def __init__(
        self, acquisition: Acquisition, writer: JournalWriter, entry: "_Entry", memory: "InMemory | None" = None
    ) -> None:
        self._acquisition, self._writer, self._entry, self.memory = acquisition, writer, entry, memory
        self.id = writer.header.recording_id
        self.summary: JournalSummary | None = None
        self._stopping = threading.Lock()

    @property
    def is_away(self) -> bool:
        """Whether it is being recorded in the library's shelter, because the library is gone."""
        return self._writer.is_away

    @property
    def has_row(self) -> bool:
        """Whether the library knows of it. Where it does not, the journal is all there is, and enough."""
        return self._entry.has_row

    @classmethod
    def begin(
        cls,
        opened: OpenedLibrary,
        acquisition: Acquisition,
        session_id: UUID,
        reported: Recording,
        on_trouble: Callable[[Trouble], None] | None = None,
        turn: "Future[None] | None" = None,
        *,
        room: Room = ROOM,
        fetched: "InMemory | None" = None,
    ) -> "Recorder":
        """Record from now on, worn as the latest placement states; waits 1 s at most for `turn` and the row.
        `fetched`: recorded in memory before; `on_trouble`: called from any thread.
        Raises JournalRefusedError (no room), LibraryError, SourceRefusedError or OSError.
        """
        entry = _Entry(opened, session_id, reported, acquisition.is_simulated)
        entry.start(turn)
        memory: InMemory | None = None
        try:
            if fetched is not None:
                memory = fetched
            elif acquisition.is_in_memory:
                memory = acquisition.record_in_memory(round(datetime.fromisoformat(reported.started).timestamp()))
            writer = JournalWriter.create(
                opened.recordings,
                entry.id,
                opened.data_key,
                room=room,
                on_trouble=on_trouble,
                now_ns=acquisition.now_ns,
                shelter=opened.shelter,
                awake_s=acquisition.awake_s,
            )
        except BaseException:
            if memory is not None:
                memory.give_up()
            entry.withdraw()
            raise
        writer.mark(Belonging(session_id, reported).text())
        if memory is None:
            acquisition.record(writer)
        entry.add(writer)
        return cls(acquisition, writer, entry, memory)

    @property
    def status(self) -> JournalStatus:
        """How its journal is doing, or was when it was closed."""
        return self._writer.status

    @property
    def opened_ns(self) -> int:
        """When its journal was opened, on the host's clock: its samples' times count from there."""
        return self._writer.header.opened_ns

    @property
    def kind(self) -> RecordingKind:
        return self._entry.kind

    @property
    def is_whole(self) -> bool:
        """Whether its journal is to have nothing more: what was in the sensors' memories has been fetched."""
        return self.memory is None or self.summary is not None

    def mark(self, text: str) -> None:
        """Note in the journal what happens now."""
        self._writer.mark(text)

    def halt(self) -> None:
        """Stop, leaving the recording whole on disk for `stop`; the memories' end is noted for `finish`."""
        if self.memory is not None:
            self.memory.ask_to_end()
            return
        with self._stopping:
            if self.summary is None:
                with suppress(RuntimeError):  # the sources were closed, and the recording with them
                    self._acquisition.stop_recording()
                self.summary = self._writer.stop()

    def finish(self, progress: "Progress", tick: "Tick") -> "Mapping[str, SourceLostError | SourceRefusedError]":
        """End and fetch the memory recordings, giving failures; repeatable, also after `tick` raised."""
        assert self.memory is not None  # else there is nothing to fetch
        failed = self.memory.finish(self._writer, progress, tick)
        if not failed:
            self._writer.mark(self.memory.reported())
            self.summary = self._writer.stop()
        return failed

    def leave_in_memory(self) -> None:
        """Fetch no more: the journal ends with what is there; the sensors hold all of it still."""
        with self._stopping:
            self.summary = self.summary or self._writer.stop()

    def stop(self, opened: OpenedLibrary) -> tuple[StoredRecording, Recording]:
        """Stop and read the journal, repeatable; raises LibraryError (journal is kept) or JournalRefusedError."""
        self.halt()
        if self.summary is None:
            self.leave_in_memory()
        assert self.summary is not None  # halted
        if self.summary.is_away:
            bring_home(opened)
        stored = self._entry.close(opened, self.summary, self._writer.header.segment)
        recording, _ = recording_with_samples(opened, stored, DECODERS)
        if self.memory is not None:
            self.memory.look_into([opened.journal_path(one) for one in stored.journals], opened.data_key)
        if recording.test != stored.details.test:  # keys of a timed test, which its journal alone has known
            stored = opened.library.recordings.change(stored, replace(stored.details, test=recording.test))
        return stored, recording


class InMemory(Protocol):
    """What sensors hold of one recording, and how it gets out of them. Its methods wait, but for `ask_to_end`."""

    def ask_to_end(self) -> None:
        """It is to end now, if it goes on."""

    def give_up(self) -> None:
        """End it, if it goes on: nobody wants it."""

    def finish(
        self, writer: JournalWriter, progress: "Progress", tick: "Tick | None" = None
    ) -> "Mapping[str, SourceLostError | SourceRefusedError]":
        """End it, and fetch it; those sensors that it failed with, and why."""

    def look_into(self, segments: Sequence[Path], data_key: "KeyMaterial | None") -> object:
        """Find out whether its closed journal holds all that was fetched."""

    def lacks(self) -> "tuple[Lack, ...]":
        """What could not be had of it."""

    def reported(self) -> str:
        """What was fetched of each sensor, for the journal."""


class _Entry:
    """A recording's row, written by a thread of its own: the recording waits a second for it, and no longer."""

    def __init__(self, opened: OpenedLibrary, session_id: UUID, reported: Recording, is_simulated: bool) -> None:
        self._recordings = opened.library.recordings
        self._session_id, self._reported, self._is_simulated = session_id, reported, is_simulated
        self.id = self._recordings.new_id()
        self._thread = ThreadPoolExecutor(1, "recording's row")
        self._steps: list[Future[object]] = []

    def start(self, turn: "Future[None] | None") -> None:
        """Add the row after `turn`; raises LibraryError if refused, not if the library is merely unavailable.

        `on_trouble` is not called where it begins in the shelter: see `is_away`.
        """
        self._do(self._enter, turn)
        try:
            self._steps[0].result(ROW_WAIT_S)
        except (LibraryFaultError, OSError) as fault:  # OSError: too late, or the file itself does not open
            _log.warning("the library does not answer (%s): the recording begins without its row", type(fault).__name__)
        except BaseException:
            self._thread.shutdown()
            raise

    @property
    def kind(self) -> RecordingKind:
        return self._reported.kind

    @property
    def has_row(self) -> bool:
        entered = self._steps[0]
        return entered.done() and entered.exception() is None

    def _enter(self, turn: "Future[None] | None") -> None:
        if turn is not None:
            turn.result()
        self._recordings.start(
            self._session_id,
            self._reported,
            self._is_simulated,
            self.id,
            is_decided=self._reported.kind is not RecordingKind.WALKING,
        )

    def add(self, writer: JournalWriter) -> None:
        """Enter the journal, once the row is there."""
        header = writer.header
        journal = StoredJournal(header.recording_id, header.segment, header.wrapped_key or None)
        self._do(self._recordings.add_journal, self.id, journal)

    def withdraw(self) -> None:
        """Take the row back, of a recording that did not begin."""
        self._do(self._recordings.withdraw, self.id)
        self._thread.shutdown(wait=False)

    def close(self, opened: OpenedLibrary, summary: JournalSummary, segment: int) -> StoredRecording:
        """Close the row; where it or the journal is not as it should be, in the way that interrupted ones are."""
        self._thread.shutdown()
        is_entered = all(step.exception() is None for step in self._steps)
        if is_entered and summary.state is State.CLOSED and not summary.is_away:
            return opened.library.recordings.close(self.id, RecordingState.CLOSED, {segment: summary.sha256})
        interrupted = self._find(opened)
        if interrupted is None:
            stored = self._recordings.find(self.id)
            if stored is not None and stored.state is not RecordingState.OPEN:
                return stored  # an earlier try came as far
            raise LibraryError("This recording is no longer in the library", "Reload the session")
        if interrupted.is_orphan:
            return adopt(opened, interrupted, self._session_id, self._reported, nobody).stored
        return recover(opened, interrupted, nobody).stored

    def _find(self, opened: OpenedLibrary) -> Interrupted | None:
        return next((one for one in find_interrupted(opened) if one.recording_id == self.id), None)

    def _do(self, call: Callable[..., object], *arguments: object) -> None:
        self._steps.append(self._thread.submit(call, *arguments))

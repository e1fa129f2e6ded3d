"""What was stored can be played as if it were measured now: a session of the library, or a session folder.

The user chooses which; reading takes seconds, and is done beside the screen.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.acquisition.acquisition import Acquisition
from app.importing.untrusted_files import read_foreign_session
from app.storage.exchange import session_with_samples
from app.storage.stored import LibraryError, SessionSummary
from app.system.progress import Report
from app.wizard.worn_sensors import SourceChoice
from app.wording.translation import tr
from app.workers.library_controller import LibraryController
from devices.decoders import DECODERS
from devices.simulation.replay import ReplaySource, names_of

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from core.session import Session

MOST_LISTED = 100  # whoever wants an older one still exports it as a session folder


def replay_of(session: "Session", name: str) -> SourceChoice:
    """A stored session as a source, without what was discarded; `name` is what the user knows it by.

    Raises
    ------
    LibraryError
        Nothing of it can be played.
    """
    recordings = tuple(
        recording
        for recording in session.recordings
        if recording.is_kept and any(len(block) for block in recording.imu.values())
    )
    if not recordings:
        what = tr("This session has no recording that can be replayed")
        raise LibraryError(what, tr("Choose another session"))
    played = replace(session, recordings=recordings)

    def make() -> Acquisition:
        return Acquisition([ReplaySource(played, name=name)])

    return SourceChoice(
        f"replay:{name}",
        tr("Replay of {name}").format(name=name),
        make,
        is_simulated=True,
        worn={sensor: site for site, sensor in names_of(played).items()},
    )


class Replays(QObject):
    """
    Signals
    -------
    listed
        The latest sessions of the library that hold recordings, latest first, as `SessionSummary`s.
    read
        A `SourceChoice` that plays what was to be read.
    refused
        Why it could not be listed or read, and what to do.
    """

    listed = Signal(object)
    read = Signal(object)
    refused = Signal(str, str)

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller
        self.reading = ""
        """What is being read now, as the user knows it."""

    def list_sessions(self, without: UUID | None) -> None:
        """Ask which there are; a session is no replay of itself."""

        def listing(opened: "OpenedLibrary") -> list[SessionSummary]:
            every = opened.library.sessions.list()
            return [line for line in every if line.recordings and line.id != without][:MOST_LISTED]

        self._controller.run(listing, self._on_listed, self._on_refused, self)

    def read_session(self, session_id: UUID, name: str) -> None:
        """Read a session of the library; `read` or `refused` follows."""

        def reading(opened: "OpenedLibrary", report: Report) -> SourceChoice:
            stored = opened.library.sessions.view(session_id)
            return replay_of(session_with_samples(opened, stored, DECODERS, report), name)

        self._read(reading, name)

    def read_folder(self, folder: Path) -> None:
        """Read a session folder; `read` or `refused` follows."""

        def reading(_opened: "OpenedLibrary", report: Report) -> SourceChoice:
            report(0.0, folder.name)
            return replay_of(read_foreign_session(folder, lambda: report(0.0, folder.name)), folder.name)

        self._read(reading, folder.name)

    def stop(self) -> None:
        """Wait for it no longer."""
        if self.reading:
            self.reading = ""
            self._controller.stop_long()

    def _read(self, reading: "Callable[[OpenedLibrary, Report], SourceChoice]", name: str) -> None:
        self.reading = name
        self._controller.run_long(reading, self._on_read, self._on_refused, None, self)

    def _on_listed(self, lines: list[SessionSummary]) -> None:
        self.listed.emit(lines)

    def _on_read(self, choice: SourceChoice) -> None:
        self.reading = ""
        self.read.emit(choice)

    def _on_refused(self, what: str, then: str) -> None:
        self.reading = ""
        self.refused.emit(what, then)

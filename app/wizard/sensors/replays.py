"""A stored session in the place of sensors, played as if it were measured now: of the library, or a session folder.

The user chooses which; reading takes seconds, and is done beside the screen.
"""

import datetime
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.acquisition.acquisition import Acquisition
from app.importing.untrusted_files import read_foreign_session
from app.storage.exchange import session_with_samples
from app.storage.stored import LibraryError, SessionSummary
from app.system.progress import Report
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_folder
from app.widgets.line_list import PatientLine
from app.wizard.worn_sensors import SourceChoice
from app.wording.patients import when
from app.wording.recordings import name_in_words
from app.wording.translation import tr, tr_n
from devices.decoders import DECODERS
from devices.simulation.replay import ReplaySource, names_of

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.wizard.sensors.session_chooser import SessionChooser
    from app.wizard.visit import Visit
    from core.session import Session

MOST_LISTED = 100  # whoever wants an older one still exports it as a session folder


def replay_of(session: "Session", name: str) -> SourceChoice:
    """Give a stored session as a source, without discarded parts; LibraryError where nothing can be played."""
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


def offered(opened: "OpenedLibrary", without: UUID | None) -> list[SessionSummary]:
    """The latest sessions that hold recordings, latest first; a session is no replay of itself."""
    every = opened.library.sessions.list()
    return [line for line in every if line.recordings and line.id != without][:MOST_LISTED]


class StoredReplay(QObject):
    """Chooses a stored session, or one in a folder, to be played in the place of sensors."""

    changed = Signal()  # something else is shown, or can be done
    read = Signal(object)  # a `SourceChoice` that plays what was chosen
    left = Signal()  # no session is asked for after all

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._form: SessionChooser | None = None
        self._names: dict[UUID, str] = {}
        self.is_on = False
        self.dialog: QFileDialog | None = None
        self.reading = ""
        """What is being read now, as the user knows it; empty: nothing."""

    def show_on(self, form: "SessionChooser") -> None:
        """Have this show what can be chosen, from now on."""
        self._form = form
        form.sessions.chosen.connect(self.changed)
        form.sessions.opened.connect(self._replay)
        form.folder.clicked.connect(self._choose_folder)
        form.back.clicked.connect(self.left)

    def begin(self) -> None:
        """Ask which is to be played: what sends now goes on doing so meanwhile."""
        self.is_on = True
        if self._form is not None:
            self._form.show_message("")
        session = self._visit.session
        listing = partial(offered, without=session.id if session is not None else None)
        self._visit.controller.run(listing, self._on_listed, self._on_refused, self)

    def end(self) -> None:
        """Ask no more, and wait for nothing that is read."""
        self.is_on = False
        self.stop_reading()

    def stop_reading(self) -> None:
        if self.reading:
            self.reading = ""
            self._visit.controller.stop_long()

    def bar(self) -> BarState:
        if self.reading:
            return BarState()
        is_any = self._form is not None and self._form.session is not None
        replay = BarAction(tr("Replay"), self._replay_chosen, tr("Enter"), Icon.PLAY, is_enabled=is_any)
        return BarState(primary=replay)

    def _replay_chosen(self) -> None:
        if self._form is not None and not self.reading and (session := self._form.session) is not None:
            self._replay(session)

    def replay_folder(self, folder: Path) -> None:
        """Let a session folder be the sensors."""

        def reading(_opened: "OpenedLibrary", report: Report) -> SourceChoice:
            report(0.0, folder.name)
            return replay_of(read_foreign_session(folder, lambda: report(0.0, folder.name)), folder.name)

        self.is_on = True
        self._read(reading, folder.name)

    def _replay(self, session_id: UUID) -> None:
        name = self._names[session_id]

        def reading(opened: "OpenedLibrary", report: Report) -> SourceChoice:
            stored = opened.library.sessions.view(session_id)
            return replay_of(session_with_samples(opened, stored, DECODERS, report), name)

        self._read(reading, name)

    def _read(self, reading: "Callable[[OpenedLibrary, Report], SourceChoice]", name: str) -> None:
        self.reading = name
        self._visit.controller.run_long(reading, self._on_read, self._on_refused, None, self)
        self.changed.emit()

    def _choose_folder(self) -> None:
        if self._form is not None:
            self.dialog = ask_for_folder(self._form, tr("Replay a session folder"), self._on_folder_selected)

    def _on_folder_selected(self, folder: str) -> None:
        self.replay_folder(Path(folder))

    def _on_listed(self, lines: list[SessionSummary]) -> None:
        if self._form is None:
            return
        now = datetime.datetime.now().astimezone()
        shown = [_stored_line(line, now) for line in lines]
        self._names = {line.id: tr("{code}, {when}").format(code=line.code, when=line.when) for line in shown}
        self._form.show_sessions(shown)
        if self.is_on:
            self.changed.emit()
            self._focus()

    def _on_read(self, choice: SourceChoice) -> None:
        self.is_on, self.reading = False, ""
        self.read.emit(choice)

    def _on_refused(self, what: str, then: str) -> None:
        self.reading = ""
        if not self.is_on or self._form is None:
            return
        self._form.show_message(what, then)
        self.changed.emit()
        self._focus()

    def _focus(self) -> None:
        if self._form is not None and not self.reading:
            self._form.focus()


def _stored_line(line: SessionSummary, now: datetime.datetime) -> PatientLine:
    amount = tr_n("{count} recording", "{count} recordings", line.recordings).format(count=line.recordings)
    conditions = ", ".join(map(name_in_words, line.conditions))
    return PatientLine(line.id, line.patient_code, conditions, when(line.started, now), amount, searched="")

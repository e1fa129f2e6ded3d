"""A stored session in the place of sensors: offered, chosen of the library or as a folder, and read to be played."""

import datetime
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.folder_dialog import ask_for_folder
from app.widgets.line_list import PatientLine
from app.wizard.sensors.replays import Replays
from app.wording.patients import when
from app.wording.recordings import name_in_words
from app.wording.translation import tr, tr_n

if TYPE_CHECKING:
    from app.storage.stored import SessionSummary
    from app.wizard.sensors.session_chooser import SessionChooser
    from app.wizard.visit import Visit
    from app.wizard.worn_sensors import SourceChoice


class StoredReplay(QObject):
    """
    Signals
    -------
    changed
        Something else is shown, or can be done.
    read
        A `SourceChoice` that plays what was chosen.
    left
        No session is asked for after all.
    """

    changed = Signal()
    read = Signal(object)
    left = Signal()

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._form: SessionChooser | None = None
        self._names: dict[UUID, str] = {}
        self.is_on = False
        self.dialog: QFileDialog | None = None
        self._replays = Replays(visit.controller, self)
        self._replays.listed.connect(self._on_listed)
        self._replays.read.connect(self._on_read)
        self._replays.refused.connect(self._on_refused)

    @property
    def reading(self) -> str:
        """What is being read now, as the user knows it; empty: nothing."""
        return self._replays.reading

    def show_on(self, form: "SessionChooser") -> None:
        """Have this show what can be chosen, from now on."""
        self._form = form
        form.chosen.connect(self.changed)
        form.opened.connect(self._replay)
        form.folder_pressed.connect(self._choose_folder)
        form.back_pressed.connect(self.left)

    def begin(self) -> None:
        """Ask which is to be played: what sends now goes on doing so meanwhile."""
        self.is_on = True
        if self._form is not None:
            self._form.show_message("")
        session = self._visit.session
        self._replays.list_sessions(session.id if session is not None else None)

    def end(self) -> None:
        """Ask no more, and wait for nothing that is read."""
        self.is_on = False
        self.stop_reading()

    def stop_reading(self) -> None:
        self._replays.stop()

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
        self.is_on = True
        self._replays.read_folder(folder)
        self.changed.emit()

    def _replay(self, session_id: UUID) -> None:
        self._replays.read_session(session_id, self._names[session_id])
        self.changed.emit()

    def _choose_folder(self) -> None:
        if self._form is not None:
            self.dialog = ask_for_folder(self._form, tr("Replay a session folder"), self._on_folder_selected)

    def _on_folder_selected(self, folder: str) -> None:
        self.replay_folder(Path(folder))

    def _on_listed(self, lines: "list[SessionSummary]") -> None:
        if self._form is None:
            return
        now = datetime.datetime.now().astimezone()
        shown = [_stored_line(line, now) for line in lines]
        self._names = {line.id: tr("{code}, {when}").format(code=line.code, when=line.when) for line in shown}
        self._form.show_sessions(shown)
        if self.is_on:
            self.changed.emit()
            self._focus()

    def _on_read(self, choice: "SourceChoice") -> None:
        self.is_on = False
        self.read.emit(choice)

    def _on_refused(self, what: str, then: str) -> None:
        if not self.is_on or self._form is None:
            return
        self._form.show_message(what, then)
        self.changed.emit()
        self._focus()

    def _focus(self) -> None:
        if self._form is not None and not self.reading:
            self._form.focus()


def _stored_line(line: "SessionSummary", now: datetime.datetime) -> PatientLine:
    amount = tr_n("{count} recording", "{count} recordings", line.recordings).format(count=line.recordings)
    conditions = ", ".join(map(name_in_words, line.conditions))
    return PatientLine(line.id, line.patient_code, conditions, when(line.started, now), amount, searched="")

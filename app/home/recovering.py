"""What was being recorded when the library was last in use, or while it did not answer: brought back, and said."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.home.words import length
from app.widgets.banner import Banner
from app.widgets.folder_dialog import ask_for_folder
from app.wording import capitalised, tr, tr_n
from app.workers.background import Report
from app.workers.library_desk import LibraryDesk, OpenedState

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.recovery import Interrupted, Recovered


class _Outcome(NamedTuple):
    """What was recovered, what was put into the session it says it is of, and what is left of either."""

    recovered: "list[Recovered]"
    adopted: "list[Recovered]"
    refused: list[tuple[str, str]]
    lost: "list[Interrupted]"
    patients: frozenset[UUID]


class _Message(NamedTuple):
    what: str
    then: str
    verb: str = ""


class Recovering(QObject):
    """Says one thing after the other, each until it is dismissed."""

    recovered = Signal(object)  # the patients' ids

    def __init__(self, desk: LibraryDesk, banner: Banner, parent: QWidget) -> None:
        super().__init__(parent)
        self._desk, self._banner, self._window = desk, banner, parent
        self._waiting: list[_Message] = []
        self._lost: list[Interrupted] = []
        self._dialog: QFileDialog | None = None
        banner.dismissed.connect(self._say_next)
        banner.acted.connect(self._choose_folder)

    def begin(self, state: OpenedState) -> None:
        """Bring back what `state` tells of; `recovered` follows where there was anything."""
        self._waiting, self._lost = [], []
        if state.interrupted:
            interrupted = state.interrupted
            self._desk.run_long(
                lambda opened, report: _recover(opened, interrupted, report),
                self._on_recovered,
                self._on_refused,
                None,
                self,
            )

    def export(self, folder: Path) -> None:
        """Write what belongs to no session into `folder`, each recording into a folder of its own."""
        lost = tuple(self._lost)

        def work(opened: "OpenedLibrary", report: Report) -> str:
            from app.library_commands import DECODERS
            from app.storage.exchange import export_orphan

            for number, one in enumerate(lost, 1):
                began = f" {one.began_at.astimezone():%Y-%m-%d %H-%M}" if one.began_at else ""
                export_orphan(opened, one, folder / f"{number}{began}", DECODERS, report)
            return str(folder)

        self._desk.run_long(work, self._on_exported, self._on_refused, None, self)

    def _say(self, messages: Sequence[_Message]) -> None:
        self._waiting += messages
        if self._banner.isHidden():
            self._say_next()

    def _say_next(self) -> None:
        if self._waiting:
            self._banner.tell(*self._waiting.pop(0))

    def _choose_folder(self) -> None:
        self._dialog = ask_for_folder(
            self._window, tr("Export recordings that belong to no session"), self._on_folder_selected
        )

    def _on_folder_selected(self, folder: str) -> None:
        self.export(Path(folder))

    def _on_recovered(self, outcome: _Outcome) -> None:
        self._lost = outcome.lost
        self.recovered.emit(outcome.patients)
        heard = [one for one in outcome.recovered if one.recorded_s > 0]
        messages = [*_heard_messages(heard), *_adopted_messages(outcome.adopted)]
        for what, remedy in dict.fromkeys(outcome.refused):
            messages.append(_Message(f"{capitalised(tr(what))}.", f"{tr(remedy)}."))
        if self._lost:
            one = tr("{time} of a recording belong to no session.")
            many = tr("{count} recordings, {time} in all, belong to no session.")
            what = (one if len(self._lost) == 1 else many).format(
                count=len(self._lost), time=length(sum(one.recorded_s for one in self._lost))
            )
            then = tr("Export the samples as files, to import them where they belong. Nothing is taken away here.")
            messages.append(_Message(what, then, tr("Export")))
        self._say(messages)

    def _on_exported(self, folder: str) -> None:
        what = tr_n("{count} recording was exported.", "{count} recordings were exported.", len(self._lost))
        then = tr("Each sensor is a file in {folder}.").format(folder=folder)
        self._banner.tell(what.format(count=len(self._lost)), then)

    def _on_refused(self, what: str, remedy: str) -> None:
        self._banner.tell(what, remedy)


def _recover(opened: "OpenedLibrary", interrupted: "Sequence[Interrupted]", report: Report) -> _Outcome:
    from app.storage.exchange import was_exported
    from app.storage.journal.header import JournalRefusedError
    from app.storage.recovery import adopt_home, recover
    from app.storage.stored import LibraryError, LibraryFaultError

    outcome = _Outcome([], [], [], [], frozenset())
    for one in interrupted:
        if one.problem:
            outcome.refused.append((one.problem, one.remedy))
        elif one.stored is not None:
            try:
                outcome.recovered.append(recover(opened, one, report))
            except JournalRefusedError as refusal:  # the others are not held up by it
                outcome.refused.append((refusal.what, refusal.remedy))
        else:
            try:
                outcome.adopted.append(adopt_home(opened, one, report))
            except LibraryFaultError:
                raise
            except LibraryError:  # its session is gone, or it does not say which that is
                if not was_exported(opened, one):
                    outcome.lost.append(one)
    sessions = {one.stored.session_id for one in [*outcome.recovered, *outcome.adopted]}
    patients = frozenset(opened.library.sessions.get(session_id).patient_id for session_id in sessions)
    return outcome._replace(patients=patients)


def _heard_messages(heard: "Sequence[Recovered]") -> list[_Message]:
    if not heard:
        return []
    if len(heard) == 1:
        what = tr("The program was closed while recording. {time} of {name} was recovered.").format(
            time=length(heard[0].recorded_s), name=heard[0].stored.told.name
        )
        return [_Message(what, tr("It is kept up to the last 0.1 s. Look at it, then keep or discard."))]
    what = tr("The program was closed while recording. {count} recordings were recovered.").format(count=len(heard))
    return [_Message(what, tr("They are kept up to the last 0.1 s. Look at them, then keep or discard."))]


def _adopted_messages(adopted: "Sequence[Recovered]") -> list[_Message]:
    if not adopted:
        return []
    if len(adopted) == 1:
        what = tr("{time} of {name} was recorded while the library did not answer.").format(
            time=length(adopted[0].recorded_s), name=adopted[0].stored.told.name
        )
        return [_Message(what, tr("It is in its session now."))]
    what = tr("{count} recordings were made while the library did not answer.").format(count=len(adopted))
    return [_Message(what, tr("They are in their sessions now."))]

"""What was being recorded when the library was last in use, or while it did not answer: brought back, and reported.

What is not decided yet, recovered earlier or closed amid a walk, is reported too at every start: the library knows it.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.storage.exchange import export_orphan, was_exported
from app.storage.journal.header import JournalRefusedError
from app.storage.recovery import adopt_home, find_interrupted, recover
from app.storage.stored import LibraryError, LibraryFaultError, RecordingState
from app.system.progress import Report
from app.widgets.banner import Banner
from app.widgets.folder_dialog import ask_for_folder
from app.wizard.walk_messages import recovery_costs
from app.wording.patients import length
from app.wording.recordings import shown_names
from app.wording.translation import capitalised, tr, tr_n
from app.workers.library_controller import LibraryController
from app.workers.library_state import OpenedState
from devices.decoders import DECODERS

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.recovery import Interrupted, Recovered
    from app.storage.stored import StoredRecording, UndecidedWalk


NO_NAMES: Mapping[UUID, str] = {}


class _Outcome(NamedTuple):
    """What was recovered, what was put into the session that it names, and what is left of either.

    `undecided`: walks of earlier starts of which nobody has decided whether they are kept. `names`: what all
    are called in their sessions.
    """

    recovered: "list[Recovered]"
    adopted: "list[Recovered]"
    refused: list[tuple[str, str]]
    lost: "list[Interrupted]"
    undecided: "list[UndecidedWalk]"
    names: Mapping[UUID, str] = NO_NAMES


class _Message(NamedTuple):
    what: str
    then: str
    verb: str = ""


class Recovering(QObject):
    """Shows one thing after the other, each until it is dismissed."""

    recovered = Signal()

    def __init__(self, controller: LibraryController, banner: Banner, parent: QWidget) -> None:
        super().__init__(parent)
        self._controller, self._banner, self._window = controller, banner, parent
        self._waiting: list[_Message] = []
        self._lost: list[Interrupted] = []
        self._brought_home: frozenset[UUID] = frozenset()
        self._dialog: QFileDialog | None = None
        banner.dismissed.connect(self._say_next)
        banner.acted.connect(self._choose_folder)

    def begin(self, state: OpenedState) -> None:
        """Recover what `state` names and report undecided walks; `recovered` follows if anything was."""
        self._waiting, self._lost, self._brought_home = [], [], state.brought_home
        interrupted = state.interrupted
        if not interrupted:
            self._controller.run(_still_undecided, self._say_outcome, self._banner.show_message, self)
            return
        self._controller.run_long(
            lambda opened, report: _recover(opened, interrupted, report),
            self._on_recovered,
            self._banner.show_message,
            None,
            self,
        )

    def look_again(self) -> None:
        """Bring back what came home only now, because the library was gone; `recovered` follows."""

        def work(opened: "OpenedLibrary", report: Report) -> _Outcome:
            return _recover(opened, find_interrupted(opened), report)._replace(undecided=[])

        self._controller.run_long(work, self._on_come_home, self._banner.show_message, None, self)

    def export(self, folder: Path) -> None:
        """Write what belongs to no session into `folder`, each recording into a folder of its own."""
        lost = tuple(self._lost)

        def work(opened: "OpenedLibrary", report: Report) -> str:
            for number, one in enumerate(lost, 1):
                began = f" {one.began_at.astimezone():%Y-%m-%d %H-%M}" if one.began_at else ""
                export_orphan(opened, one, folder / f"{number}{began}", DECODERS, report)
            return str(folder)

        self._controller.run_long(work, self._on_exported, self._banner.show_message, None, self)

    def _say(self, messages: Sequence[_Message]) -> None:
        self._waiting += messages
        if self._banner.isHidden():
            self._say_next()

    def _say_next(self) -> None:
        if self._waiting:
            self._banner.show_message(*self._waiting.pop(0))

    def _choose_folder(self) -> None:
        self._dialog = ask_for_folder(self._window, tr("Export recordings without a session"), self._on_folder_selected)

    def _on_folder_selected(self, folder: str) -> None:
        self.export(Path(folder))

    def _on_recovered(self, outcome: _Outcome) -> None:
        self.recovered.emit()
        self._say_outcome(outcome)

    def _on_come_home(self, outcome: _Outcome) -> None:
        """Of what is whole nothing more is to be stated than that the library is back, and what is in it now."""
        self._brought_home |= {one.stored.id for one in [*outcome.recovered, *outcome.adopted]}
        recovered = [one for one in outcome.recovered if not self._is_home_and_whole(one)]
        adopted = [one for one in outcome.adopted if not self._is_home_and_whole(one)]
        self._on_recovered(outcome._replace(recovered=recovered, adopted=adopted))

    def _say_outcome(self, outcome: _Outcome) -> None:
        self._lost = outcome.lost
        received = [one for one in outcome.recovered if one.recorded_s > 0]
        home = [one for one in [*received, *outcome.adopted] if self._is_home_and_whole(one)]
        messages = [
            *_received_messages([one for one in received if one not in home], outcome.names),
            *_adopted_messages([one for one in outcome.adopted if one not in home], outcome.names),
            *_home_messages(home),
            *_undecided_messages(outcome.undecided, outcome.names),
        ]
        for what, remedy in dict.fromkeys(outcome.refused):
            messages.append(_Message(f"{capitalised(tr(what))}.", f"{tr(remedy)}."))
        if self._lost:
            one = tr("A recording of {time} is not assigned to a session.")
            many = tr("{count} recordings, {time} in total, are not assigned to a session.")
            what = (one if len(self._lost) == 1 else many).format(
                count=len(self._lost), time=length(sum(one.recorded_s for one in self._lost))
            )
            then = tr("Export the data as files, then import them where they belong. Nothing is deleted here.")
            messages.append(_Message(what, then, tr("Export")))
        self._say(messages)

    def _is_home_and_whole(self, one: "Recovered") -> bool:
        """Whether it was stopped, and only recorded elsewhere because the library was gone."""
        return one.stored.id in self._brought_home and one.stored.state is RecordingState.CLOSED

    def _on_exported(self, folder: str) -> None:
        what = tr_n("{count} recording was exported.", "{count} recordings were exported.", len(self._lost))
        then = tr("Each sensor has its own file in {folder}.").format(folder=folder)
        self._banner.show_message(what.format(count=len(self._lost)), then)


def _recover(opened: "OpenedLibrary", interrupted: "Sequence[Interrupted]", report: Report) -> _Outcome:
    outcome = _Outcome([], [], [], [], [])
    undecided = opened.library.recordings.undecided()  # before others join them
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
    reported = [one.stored for one in [*outcome.recovered, *outcome.adopted]]
    reported += [one.recording for one in undecided]
    return outcome._replace(undecided=list(undecided), names=_names(opened, reported))


def _still_undecided(opened: "OpenedLibrary") -> _Outcome:
    undecided = list(opened.library.recordings.undecided())
    return _Outcome([], [], [], [], undecided, _names(opened, [one.recording for one in undecided]))


def _names(opened: "OpenedLibrary", recordings: "Sequence[StoredRecording]") -> dict[UUID, str]:
    """What recordings are called in their sessions; of a session that cannot be read, nothing is known."""
    names: dict[UUID, str] = {}
    for session_id in {one.session_id for one in recordings}:
        try:
            of_session = opened.library.sessions.get(session_id).recordings
        except LibraryError:
            continue
        called = shown_names([one.details for one in of_session])
        names |= {one.id: str(called[one.details.name]) for one in of_session}
    return names


def _name(recording: "StoredRecording", names: Mapping[UUID, str]) -> str:
    return names.get(recording.id, recording.details.name)


def _received_messages(received: "Sequence[Recovered]", names: Mapping[UUID, str] = NO_NAMES) -> list[_Message]:
    if not received:
        return []
    is_whole = all(report.is_whole for one in received for report in one.reports)
    if len(received) == 1:
        what = tr("The program closed during recording. {time} of {name} was recovered.").format(
            time=length(received[0].recorded_s), name=_name(received[0].stored, names)
        )
        whole, cut = (
            tr("The recording is complete."),
            tr("The recording is complete up to the last data record on disk."),
        )
        look = tr("Review the recording, then include or exclude it.")
    else:
        several = tr("The program closed during recording. {count} recordings, {time} in total, were recovered.")
        what = several.format(count=len(received), time=length(sum(one.recorded_s for one in received)))
        whole, cut = tr("They are complete."), tr("They are complete up to the last data record on disk.")
        look = tr("Review them, then include or exclude them.")
    kept = [whole, look] if is_whole else [cut, _missing(received), look, recovery_costs()]
    return [_Message(what, " ".join(filter(None, kept)))]


def _missing(received: "Sequence[Recovered]") -> str:
    """Say how many records are missing before the last; empty where none is."""
    reports = [report for one in received for report in one.reports]
    missing = sum(report.missing_records for report in reports)
    if missing:
        stated = tr_n(
            "{count} record before it is missing and leaves a gap.",
            "{count} records before it are missing and leave gaps.",
            missing,
        )
        return stated.format(count=missing)
    return ""


def _adopted_messages(adopted: "Sequence[Recovered]", names: Mapping[UUID, str]) -> list[_Message]:
    if not adopted:
        return []
    if len(adopted) == 1:
        what = tr("{time} of {name} was recorded while the library did not respond.").format(
            time=length(adopted[0].recorded_s), name=_name(adopted[0].stored, names)
        )
        return [_Message(what, tr("The recording is now in its session."))]
    what = tr("{count} recordings were made while the library did not respond.").format(count=len(adopted))
    return [_Message(what, tr("They are now in their sessions."))]


def _home_messages(home: "Sequence[Recovered]") -> list[_Message]:
    if not home:
        return []
    what = tr_n(
        "{count} recording was made while the library was missing. It is now in its session.",
        "{count} recordings were made while the library was missing. They are now in their sessions.",
        len(home),
    ).format(count=len(home))
    return [_Message(what, tr("The temporary copy on this computer was removed."))]


def _undecided_messages(walks: "Sequence[UndecidedWalk]", names: Mapping[UUID, str]) -> list[_Message]:
    recovered = [walk for walk in walks if walk.recording.is_unjudged]
    closed = [walk for walk in walks if walk not in recovered]
    return [
        *_asked_messages(
            recovered,
            names,
            tr("{name} of {code} was recovered earlier and still awaits a decision."),
            tr("{count} walks were recovered earlier and still await a decision."),
        ),
        *_asked_messages(
            closed,
            names,
            tr("The program was closed before {name} of {code} was included or excluded."),
            tr("The program was closed before {count} walks were included or excluded."),
        ),
    ]


def _asked_messages(
    walks: "Sequence[UndecidedWalk]", names: Mapping[UUID, str], of_one: str, of_many: str
) -> list[_Message]:
    if not walks:
        return []
    if len(walks) > 1:
        return [_Message(of_many.format(count=len(walks)), tr("Review them, then include or exclude them."))]
    what = of_one.format(name=_name(walks[0].recording, names), code=walks[0].patient_code)
    return [_Message(what, tr("Review the recording, then include or exclude it."))]

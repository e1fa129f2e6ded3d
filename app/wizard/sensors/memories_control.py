"""What the sensors' memories hold: found out, held against the library, fetched where it was left, and erased.

Only what this program began is fetched here: it knows that those sensors were on one clock. Nothing is erased before
it was shown what that is and what of it is kept, and the button was pressed once more.
"""

import datetime
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal, Slot

from app.acquisition.dot_memories import DotMemories, HeldRecording, KnownRecording, known
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.sensors_progress import LineState, ProgressShown, SensorLine
from app.wizard.sensors.memories_form import HeldLine
from app.wording.patients import when
from app.wording.recordings import shown_names
from app.wording.translation import tr, tr_n
from app.workers.refusals import refusal_of
from devices.live import SourceLostError, SourceRefusedError

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import StoredRecording
    from app.system.progress import Report
    from app.widgets.sensors_progress import SensorsProgress
    from app.wizard.sensors.memories_form import MemoriesForm
    from app.wizard.visit import Visit

Asked = Callable[[DotMemories, Callable[[str], None], Callable[[], None]], object]


class MemoriesControl(QObject):
    """Finds recordings in the memories of sensors, and fetches or erases what is chosen."""

    changed = Signal()  # something else is shown, or can be done
    left = Signal(bool)  # the sensors are asked for, and whether they were live before

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._form: MemoriesForm | None = None
        self._progress: SensorsProgress | None = None
        self._memories: DotMemories | None = None
        self._held: tuple[HeldRecording, ...] = ()
        self._known: Mapping[int, KnownRecording] = {}
        self._title = self._now = ""  # what is done, with which sensor
        self._is_listed = self._is_warned = self._is_fetching = self._was_live = False
        self._error: Exception | None = None
        self._fetch = visit.fetch
        self._fetch.changed.connect(self._on_recordings_changed)
        visit.sensors.asking.progressed.connect(self._on_progressed)
        visit.sensors.asking.done.connect(self._on_asked)
        visit.sensors.asking.failed.connect(self._on_failed)
        visit.recordings.begun.connect(self._on_begun)
        visit.recordings.changed.connect(self._on_recordings_changed)

    @property
    def is_on(self) -> bool:
        return self._memories is not None

    @property
    def is_busy(self) -> bool:
        """Whether something is waited for."""
        return self.is_on and (self._is_fetching or (self._error is None and not self._is_listed))

    @property
    def cannot_leave(self) -> str:
        """Why the step cannot be left now; empty where it can."""
        if self._is_fetching and (fetched := self._fetch.cannot_leave):
            return fetched
        return tr("The sensors are being queried. Wait until they have answered, or cancel.") if self.is_busy else ""

    def show_on(self, form: "MemoriesForm", progress: "SensorsProgress") -> None:
        """Have these show what is found and done, from now on."""
        self._form, self._progress = form, progress
        form.list.chosen.connect(self.changed)
        progress.stop_pressed.connect(self._on_stop)

    def begin(self) -> None:
        """Ask the sensors that are open."""
        dots = self._visit.sensors.dots
        if dots is None or self._visit.recordings.is_recording:
            return
        self._was_live = not dots.is_recording_use
        self._memories, self._held, self._known = DotMemories(dots), (), {}
        self._look()

    def end(self) -> None:
        """Ask no more."""
        if self.is_on:
            self._memories, self._is_fetching = None, False
            self._visit.sensors.asking.stop()

    def focus(self) -> None:
        if self._form is not None and self._progress is not None:
            if self.is_busy:
                self._progress.focus()
            else:
                self._form.focus()

    def bar(self) -> BarState:
        if self._is_fetching:
            return self._fetch.bar() or BarState()
        if self.is_busy:
            return BarState()
        back = BarAction(tr("Back to the sensors"), self.leave)
        if self._error is not None:
            again = BarAction(tr("Try again"), self._look, tr("Enter"), Icon.REPEAT)
            return BarState(primary=again, quiet=(back,))
        if not self._held:
            return BarState(primary=replace(back, key=tr("Enter")))
        erase = BarAction(tr("Erase sensor memory"), self._warn, is_requested=False)
        if self._is_warned:
            words = tr("Erase now, losing unsaved data") if self._unkept else tr("Erase now")
            erase = BarAction(words, self._erase, is_requested=False)
        if self._chosen is None:
            return BarState(primary=replace(back, key=tr("Enter"), is_requested=False), others=(erase,))
        fetch = BarAction(tr("Fetch walk"), self._fetch_chosen, tr("Enter"))
        return BarState(primary=fetch, others=(erase,), quiet=(back,))

    def _warn(self) -> None:
        """Say what would be lost by erasing."""
        if self._form is not None:
            self._is_warned = True
            self._form.show_message(*_warning(self._held, self._unkept, self._lacking))
            self.changed.emit()

    # what is known

    @property
    def _chosen(self) -> "tuple[HeldRecording, StoredRecording] | None":
        """What is chosen, if it was left in the sensors by this session."""
        number = self._form.chosen_number if self._form is not None else -1
        if not 0 <= number < len(self._held):
            return None
        row = self._left_row(self._held[number])
        return (self._held[number], row) if row is not None else None

    def _left_row(self, held: HeldRecording) -> "StoredRecording | None":
        session = self._visit.session
        found = self._known[held.started_utc_s]
        if found.kept or session is None:
            return None
        return next((row for row in found.rows if row.session_id == session.id), None)

    @property
    def _unkept(self) -> list[HeldRecording]:
        return [one for one in self._held if one.files.keys() - self._known[one.started_utc_s].kept]

    @property
    def _lacking(self) -> list[HeldRecording]:
        return [one for one in self._held if self._known[one.started_utc_s].lacking & one.files.keys()]

    def _line(self, held: HeldRecording) -> HeldLine:
        found = self._known[held.started_utc_s]
        begun = datetime.datetime.fromtimestamp(held.started_utc_s).astimezone()
        is_kept = not held.files.keys() - found.kept
        is_left = self._left_row(held) is not None
        return HeldLine(
            when(begun.isoformat(), datetime.datetime.now().astimezone()),
            len(held.files),
            self._note(held, found),
            is_kept,
            is_left,
        )

    def _note(self, held: HeldRecording, found: KnownRecording) -> str:
        session = self._visit.session
        own = [row for row in found.rows if session is not None and row.session_id == session.id]
        if found.kept:
            missing = sorted(held.files.keys() - found.kept)
            if missing:
                return tr("Saved, except data from {sensors}.").format(sensors=", ".join(missing))
            if found.lacking:
                names = ", ".join(sorted(found.lacking & held.files.keys()))
                return tr("Saved. Samples of {sensors} could not be fetched.").format(sensors=names)
            counted = [row for row in own if row.details.is_kept] or own  # one that was left was fetched into another
            return tr("Saved: {recording}.").format(recording=self._called(counted[0])) if own else tr("Saved.")
        if own:
            return tr("Not fetched: {recording}.").format(recording=self._called(own[0]))
        if found.rows:
            return tr("Not fetched. The recording belongs to another session: fetch it there.")
        return tr("Not recorded with this library.")

    def _called(self, row: "StoredRecording") -> str:
        names = shown_names((row.details,))
        return str(self._visit.recordings.shown_names.get(row.details.name, names[row.details.name]))

    # what is done

    def _look(self) -> None:
        self._ask(
            tr("Checking what the sensors recorded"),
            lambda memories, show_message, tick: memories.held(show_message, tick),
        )

    def _erase(self) -> None:
        held = self._held
        names = {name for one in held for name in one.files}
        gone = {name: [one.started_utc_s for one in held if name in one.files] for name in names}
        utc_s = int(datetime.datetime.now().timestamp())

        def work(memories: DotMemories, show_message: Callable[[str], None], tick: Callable[[], None]) -> object:
            memories.erase(gone, utc_s, show_message, tick)
            return memories.held(show_message, tick)

        self._ask(tr("The sensor memory is being erased"), work)

    def _ask(self, title: str, asked: Asked) -> None:
        memories = self._memories
        assert memories is not None
        self._title, self._now, self._error = title, "", None
        self._is_listed = self._is_warned = False

        def work(report: "Report") -> object:
            return asked(memories, partial(report, 0.0), lambda: report(0.0, ""))

        self._visit.sensors.asking.start(work)
        self._show()

    def _fetch_chosen(self) -> None:
        """Into a recording of its own, which begins when that did; what was begun first holds nothing."""
        acquisition, chosen = self._visit.sensors.acquisition, self._chosen
        if acquisition is None or self._memories is None or chosen is None:
            return
        self._is_fetching, (held, row) = True, chosen
        reported, left = row.details, self._memories.left(held)
        self._visit.recordings.begin(
            acquisition,
            reported.kind,
            reported.condition,
            reported.alignment,
            reported.test,
            fetched=(left, reported.started),
        )
        self._show()

    @Slot()
    def _on_begun(self) -> None:
        if self._is_fetching and self._visit.recordings.is_in_memory:
            self._visit.recordings.stop()

    @Slot()
    def _on_recordings_changed(self) -> None:
        recordings = self._visit.recordings
        if self._is_fetching and recordings.ongoing is None and recordings.fetches.is_idle:
            self._is_fetching = False
            self._look()
        else:
            self._show()

    @Slot(float, str)
    def _on_progressed(self, _share: float, sensor: str) -> None:
        if self.is_on and sensor:
            self._now = sensor
            self._show()

    @Slot(object)
    def _on_asked(self, held: object) -> None:
        if not self.is_on or not isinstance(held, tuple):
            return
        self._held = held

        def find(opened: "OpenedLibrary") -> dict[int, KnownRecording]:
            return {one.started_utc_s: known(opened, one.started_utc_s) for one in held}

        self._visit.controller.run(find, self._on_found, self._on_not_found, self)

    def _on_found(self, found: dict[int, KnownRecording]) -> None:
        if not self.is_on or self._form is None:
            return
        self._known, self._is_listed = found, True
        self._form.show_message("")
        self._form.show_lines([self._line(one) for one in self._held])
        self._show()
        self.focus()

    def _on_not_found(self, what: str, remedy: str) -> None:
        self._on_failed(SourceRefusedError(what, remedy))

    @Slot(object)
    def _on_failed(self, error: Exception) -> None:
        if not self.is_on or self._form is None:
            return
        self._error = error
        what, then = tr("The sensors could not be queried."), tr("Try again. See the log for details.")
        if isinstance(error, SourceRefusedError):
            what, then = refusal_of(error)
        elif isinstance(error, SourceLostError):
            what = tr("A sensor is out of range.")
            then = tr("Bring all sensors closer to this computer, then try again.")
        self._form.show_unknown(what, then)
        self._show()

    @Slot()
    def _on_stop(self) -> None:
        if not self.is_on:
            return
        if self._is_fetching:
            self._fetch.put_off()
        elif self.is_busy:
            self.leave()

    def leave(self) -> None:
        """Go back to the sensors."""
        self.end()
        self.left.emit(self._was_live)

    @Slot()
    def _show(self) -> None:
        if not self.is_on or self._progress is None:
            return
        if (shown := self._shown) is not None:
            self._progress.show_state(shown)
        self.changed.emit()

    @property
    def _shown(self) -> ProgressShown | None:
        if self._is_fetching:
            return self._fetch.shown or ProgressShown(tr("The walk is being fetched from the sensors"))
        if not self.is_busy:
            return None
        names = self._visit.sensors.acquisition.sensors if self._visit.sensors.acquisition is not None else ()
        at = names.index(self._now) if self._now in names else -1
        lines = [SensorLine(name, _state(number, at)) for number, name in enumerate(names)]
        return ProgressShown(self._title, "", max(at, 0) / max(len(names), 1), tuple(lines), stop=tr("Cancel"))


def _state(number: int, at: int) -> LineState:
    if number == at:
        return LineState.NOW
    return LineState.DONE if number < at else LineState.TO_DO


def _warning(
    held: Sequence[HeldRecording], unkept: Sequence[HeldRecording], lacking: Sequence[HeldRecording]
) -> tuple[str, str]:
    """What is lost by erasing, and what to do."""
    then = tr("Press again to erase. This cannot be undone.")
    if unkept:
        count = len(unkept)
        what = tr_n(
            "{count} recording is not saved in this library and would be lost.",
            "{count} recordings are not saved in this library and would be lost.",
            count,
        )
        return what.format(count=count), then
    if lacking:
        return tr(
            "Everything is saved except samples that could not be fetched. Erasing would lose those samples."
        ), then
    count = len(held)
    what = tr_n(
        "{count} recording in the sensor memory is saved completely in this library.",
        "{count} recordings in the sensor memory are saved completely in this library.",
        count,
    )
    return what.format(count=count), then

"""Movella DOTs before they are opened: asked who they are, ticked where they are worn, and brought onto one clock."""

import time
from collections import deque
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.acquisition.dot_fleet import DotAsked, DotFleet, DotPlan, acquisition_of
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.wizard.sensor_sync import REASONS, SyncPurpose, progress_of
from app.wizard.sensors.dot_form import DotLine
from app.wording.translation import tr, tr_n
from app.workers.refusals import refusal_of
from devices.dot.synchronising import SyncFailure
from devices.live import SourceLostError, SourceRefusedError

if TYPE_CHECKING:
    from app.acquisition.dot_fleet import ReceivedDot
    from app.system.progress import Report
    from app.widgets.sensors_progress import SensorsProgress
    from app.wizard.sensors.dot_form import DotForm
    from app.wizard.worn_sensors import SourceChoice, WornSensors
    from devices.dot.source import DotGroup

LISTENS_S = 0.1  # so often it is looked whether somebody wants something of the sensors


class _RequiredError(Exception):
    """Something is required of the sensors before the next one is asked."""


class DotSetup(QObject):
    """Connects, sets up and synchronises DOT sensors before they measure."""

    changed = Signal()  # something else is shown, or can be done
    ready = Signal(object)  # a `SourceChoice` whose sensors are on one clock
    left = Signal()  # other sources are asked for

    def __init__(self, sensors: "WornSensors", parent: QObject) -> None:
        super().__init__(parent)
        self._sensors = sensors
        self._form: DotForm | None = None
        self._progress: SensorsProgress | None = None
        self._choice: SourceChoice | None = None
        self._fleet: DotFleet | None = None
        self._worn: set[int] = set()
        self._asked: dict[int, DotAsked] = {}  # by the thread that asks
        self._failed: Mapping[str, SyncFailure] = {}
        self._required: deque[Callable[[], object]] = deque()
        self._is_stopping = False
        self._refusal = ("", "")
        self._group: DotGroup | None = None
        self._group_numbers: tuple[int, ...] = ()
        sensors.asking.progressed.connect(self._on_asked)
        sensors.asking.failed.connect(self._on_asking_failed)
        sensors.sync.changed.connect(self._on_sync_changed)
        sensors.sync.done.connect(self._on_synchronised)

    @property
    def is_on(self) -> bool:
        return self._fleet is not None

    @property
    def dots(self) -> "tuple[ReceivedDot, ...]":
        """Those that were found."""
        return self._fleet.dots if self._fleet is not None else ()

    @property
    def is_synchronising(self) -> bool:
        """Whether sensors are being brought onto one clock, or let go again."""
        sync = self._sensors.sync
        return sync.is_running or sync.is_ending

    @property
    def choice(self) -> "SourceChoice | None":
        """What is being set up; None where nothing is."""
        return self._choice if self.is_on else None

    @property
    def cannot_leave(self) -> str:
        """Why the step cannot be left now; empty where it can."""
        if not self.is_synchronising:
            return ""
        return tr("The sensors are being synchronised. Wait, or cancel.")

    def show_on(self, form: "DotForm", progress: "SensorsProgress") -> None:
        """Have these show what is asked and done, from now on."""
        self._form, self._progress = form, progress
        form.turned.connect(self._on_turned)
        form.identify_pressed.connect(self._on_identify_pressed)
        form.back.clicked.connect(self.left)
        progress.stop_pressed.connect(self._sensors.sync.stop)

    def begin(self, choice: "SourceChoice", known: Collection[str]) -> None:
        """Ask the sensors of this choice who they are. `known` are names that are worn, if they are found."""
        self.end()
        self._sensors.sync.forget()
        assert choice.make_fleet is not None
        self._choice, fleet = choice, choice.make_fleet()
        self._fleet = fleet
        numbers = range(len(fleet.dots))
        self._worn = {number for number in numbers if fleet.dots[number].name in known} or set(numbers)
        self._ask()
        self._show()

    def end(self) -> None:
        """Let go of those that were asked."""
        fleet, group = self._fleet, self._group
        self._fleet = self._group = None
        if fleet is None:
            return
        self._sensors.asking.stop()
        self._sensors.sync.stop()
        wait = self._sensors.sync.over()

        def close() -> None:
            wait()
            if group is not None and group.renewal_due_s() is not None:
                group.end()  # they had followed already
            fleet.close()

        self._sensors.close_beside(close)
        self._failed, self._refusal = {}, ("", "")

    def set_back(self) -> None:
        """Bring the sensors that are open back from their memories to what is live."""
        if (dots := self._sensors.dots) is not None and not self.is_synchronising:
            self._sensors.sync.start(dots, SyncPurpose.STREAMS)

    def focus(self) -> None:
        if self._form is not None and self._progress is not None:
            if self.is_synchronising:
                self._progress.focus()
            else:
                self._form.focus()

    def identify_selected(self) -> bool:
        return self._form is not None and not self.is_synchronising and self._form.identify_selected()

    def bar(self) -> BarState:
        if self.is_synchronising:
            return BarState()
        count = len(self._worn)
        if self._recording:
            words, can_stop = tr("Stop these recordings"), not self._is_stopping
            stop = BarAction(words, self._want_stop, tr("Enter"), Icon.STOP, is_enabled=can_stop)
            return BarState(primary=stop, note=tr("The recordings stay in the sensor memory."))
        if self._failed and len(self._failed) < count:
            again = BarAction(tr("Try again"), self._synchronise, tr("Enter"), Icon.REPEAT)
            without = tr("Go on without {sensors}").format(sensors=", ".join(self._failed))
            return BarState(primary=again, others=(BarAction(without, self._leave_out_failed, is_requested=False),))
        words = tr("Use this sensor")
        if count != 1:
            words = tr_n("Synchronise {count} sensor", "Synchronise {count} sensors", count).format(count=count)
        return BarState(
            primary=BarAction(words, self._synchronise, tr("Enter"), is_enabled=count > 0),
            note="" if count else tr("Tick the sensors that are worn."),
        )

    def _want_stop(self) -> None:
        self._is_stopping = True
        self._required.append(self._stop_recordings)
        self._show()

    def _leave_out_failed(self) -> None:
        """Go on without those that did not follow."""
        assert self._fleet is not None
        self._worn -= {number for number, dot in enumerate(self._fleet.dots) if dot.name in self._failed}
        self._synchronise()

    @property
    def _recording(self) -> bool:
        return any(self._asked.get(number) is DotAsked.RECORDING for number in self._worn)

    def _ask(self) -> None:
        """Ask each until it has answered, and do meanwhile what is required of them."""
        fleet = self._fleet
        assert fleet is not None
        asked: dict[int, DotAsked] = {}
        required: deque[Callable[[], object]] = deque()
        self._asked, self._required = asked, required
        wait = self._sensors.closings()

        def work(report: "Report") -> object:
            def tick() -> None:
                report(0.0, "")
                if required:
                    raise _RequiredError

            wait()
            while True:
                while required:
                    report(0.0, "")
                    required.popleft()()
                for number in _unanswered(fleet, asked):
                    try:
                        asked[number] = fleet.ask(number, tick)
                        report(0.0, fleet.dots[number].name)
                    except _RequiredError:
                        break
                else:
                    time.sleep(LISTENS_S)
                    report(0.0, "")

        self._sensors.asking.start(work)

    def _stop_recordings(self) -> None:
        """By the thread that asks."""
        assert self._fleet is not None
        recording = [number for number in sorted(self._worn) if self._asked.get(number) is DotAsked.RECORDING]
        try:
            self._fleet.stop_recordings(recording)
        except SourceRefusedError as problem:
            self._refusal = refusal_of(problem)
        except SourceLostError:
            self._refusal = tr("A sensor is out of range."), tr("Bring the sensor closer, then try again.")
        else:
            self._refusal = ("", "")
        for number in recording:
            del self._asked[number]  # it is asked again
        self._is_stopping = False

    def _synchronise(self) -> None:
        fleet, form = self._fleet, self._form
        assert fleet is not None
        assert form is not None
        self._sensors.asking.stop()
        chosen = form.choice
        plan = DotPlan(chosen.rate_hz, chosen.record_hz or None, chosen.profile)
        self._failed, self._refusal = {}, ("", "")
        numbers = tuple(sorted(self._worn))
        self._group_numbers = numbers
        self._group = group = fleet.group(numbers, plan)
        closings = self._sensors.closings()

        def before() -> None:
            closings()
            fleet.wait()

        self._sensors.sync.start(group, SyncPurpose.STREAMS, before)
        self._show()

    def _show(self) -> None:
        fleet, form, progress = self._fleet, self._form, self._progress
        if form is None or progress is None:
            return
        if fleet is not None:
            form.show_dots([self._line(number) for number in range(len(fleet.dots))])
            form.show_message(*(self._refusal if self._refusal[0] else self._sensors.sync.failure))
        if self.is_synchronising:
            open_ones = self._sensors.acquisition.sensors if self._sensors.acquisition is not None else ()
            asked = fleet.dots if fleet is not None else ()
            names = [dot.name for number, dot in enumerate(asked) if number in self._group_numbers] or open_ones
            progress.show_state(progress_of(self._sensors.sync, names))
        self.changed.emit()

    def _line(self, number: int) -> DotLine:
        assert self._fleet is not None
        dot, asked = self._fleet.dots[number], self._asked.get(number)
        info = dot.sensor.info
        note = ""
        if dot.name in self._failed:
            note = tr(REASONS[self._failed[dot.name]])
        elif asked is not None:
            note = _note_of(asked)
        firmware = ".".join(map(str, info.firmware)) if info is not None else ""
        is_worn = number in self._worn
        return DotLine(dot.name, is_worn, dot.rssi_dbm, dot.sensor.battery, firmware, note)

    def _on_turned(self, number: int) -> None:
        self._worn ^= {number}
        self._show()

    def _on_identify_pressed(self, number: int) -> None:
        fleet = self._fleet
        if fleet is not None:
            self._required.append(lambda: fleet.identify(number))

    def _on_asked(self, _share: float, _what: str) -> None:
        self._show()

    def _on_asking_failed(self, _error: Exception) -> None:
        if self.is_on:
            self._is_stopping = False
            then = tr("Choose the sensor source again. See the log for details.")
            self._refusal = tr("The sensors could not be queried."), then
            self._show()

    def _on_sync_changed(self) -> None:
        sync = self._sensors.sync
        if self.is_on and sync.is_idle and not self._sensors.asking.is_busy:
            self._failed = sync.failed
            self._ask()
        self._show()

    def _on_synchronised(self) -> None:
        fleet, choice = self._fleet, self._choice
        group, kept = self._group, self._group_numbers
        if fleet is None or choice is None or group is None:
            return
        self._fleet = self._group = None
        self._sensors.close_beside(partial(fleet.close, kept))
        make = partial(acquisition_of, group, fleet.radio.now_ns)
        is_simulated = choice.is_simulated or fleet.is_simulated
        self.ready.emit(replace(choice, make=make, is_simulated=is_simulated))


def _unanswered(fleet: DotFleet, asked: Mapping[int, DotAsked]) -> list[int]:
    return [number for number in range(len(fleet.dots)) if asked.get(number, DotAsked.SILENT) is DotAsked.SILENT]


def _note_of(asked: DotAsked) -> str:
    match asked:
        case DotAsked.SILENT:
            return tr("does not respond: press its button")
        case DotAsked.RECORDING:
            return tr("recording to memory")
        case DotAsked.TOO_OLD:
            return tr("firmware too old to synchronise")
        case DotAsked.ANSWERED:
            return ""

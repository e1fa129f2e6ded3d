"""Sensors being brought onto one clock, beside the screen: what is done now, to which of them, for how long still."""

import math
import threading
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.system.progress import Report
from app.widgets.sensors_progress import LineState, ProgressShown, SensorLine
from app.wording.translation import later, tr
from app.workers.background import Background
from app.workers.refusals import refusal_of
from devices.dot.synchronising import NotSynchronisedError, SyncFailure, SyncStage
from devices.live import SourceLostError, SourceRefusedError

if TYPE_CHECKING:
    from devices.dot.source import DotGroup

SOON_S = 5.0  # step of the time left that is shown, and the least of it
REASONS = {
    SyncFailure.LOST: later("out of range"),
    SyncFailure.STAYS: later("not synchronised, keeps its old clock"),
    SyncFailure.FEW_SAMPLES: later("received too little from the others"),
    SyncFailure.SKEW_TOO_LARGE: later("clock rate differs too much"),
    SyncFailure.START_FAILED: later("started too late"),
    SyncFailure.NOT_STARTED: later("did not start"),
    SyncFailure.UNKNOWN: later("gives no result"),
    SyncFailure.NOT_BACK: later("did not reconnect"),
    SyncFailure.SILENT: later("does not start measuring"),
    SyncFailure.NOT_RECEIVED: later("no signal"),
    SyncFailure.CUT: later("its data arrive incomplete: use another Bluetooth adapter"),
    SyncFailure.OTHER_CLOCK: later("its clock differs"),
}


class SyncPurpose(StrEnum):
    """What the sensors are made ready for."""

    STREAMS = "streams"
    MEMORIES = "memories"


@dataclass(frozen=True, slots=True)
class SyncView:
    """How far it is; `share` of the time that it takes, about. Where some did not follow, all are tried once more."""

    stage: SyncStage = SyncStage.PREPARING
    sensor: str = ""
    left_s: float | None = None
    share: float = 0.0
    attempt: int = 1


class SensorSync(QObject):
    """Synchronises sensors step by step, and states how far it is."""

    changed = Signal()  # something else is shown
    done = Signal()  # the sensors are ready

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.purpose = SyncPurpose.STREAMS
        self.view = SyncView()
        self._reported: tuple[SyncStage, str, float] | None = None  # by the links' thread
        self._total_s = 0.0
        self._error: Exception | None = None
        self._is_over = threading.Event()
        self._is_over.set()
        self._background = Background(self)
        self._background.progressed.connect(self._on_progressed)
        self._background.done.connect(self._on_done)
        self._background.failed.connect(self._on_failed)
        self._background.idle.connect(self.changed)

    @property
    def is_running(self) -> bool:
        return self._background.is_busy

    @property
    def is_ending(self) -> bool:
        """Whether what was stopped still lets the sensors have clocks of their own again."""
        return not self._background.is_busy and not self._background.is_idle

    @property
    def is_idle(self) -> bool:
        return self._background.is_idle

    @property
    def failed(self) -> Mapping[str, SyncFailure]:
        """The sensors that did not follow, and why."""
        return self._error.failed if isinstance(self._error, NotSynchronisedError) else {}

    @property
    def failure(self) -> tuple[str, str]:
        """Why it ended early, and what to do; empty where it did not."""
        error = self._error
        if error is None:
            return "", ""
        if isinstance(error, NotSynchronisedError):
            stated = [f"{name} ({tr(REASONS[why])})" for name, why in error.failed.items()]
            what = tr("Not synchronised: {sensors}.").format(sensors=", ".join(stated))
            return what, tr(
                "Place all sensors side by side near this computer. Switch the named sensors off and on, then "
                "try again."
            )
        if isinstance(error, SourceRefusedError):
            return refusal_of(error)
        if isinstance(error, SourceLostError):
            return tr("A sensor is out of range."), tr("Bring all sensors closer to this computer, then try again.")
        return tr("Synchronisation stopped early."), tr("Try again. See the log for details.")

    def start(self, group: "DotGroup", purpose: SyncPurpose, before: Callable[[], None] = lambda: None) -> None:
        """Make them ready; `before` is waited for, beside the screen."""
        self.purpose, self.view, self._reported, self._error, self._total_s = purpose, SyncView(), None, None, 0.0
        wait_for_last, self._is_over = self.over(), threading.Event()
        is_over = self._is_over

        def work(report: Report) -> object:
            wait_for_last()
            try:
                bring_together(report)
            finally:
                is_over.set()
            return None

        def bring_together(report: Report) -> None:
            def tick() -> None:
                report(0.0, "")

            def wait() -> None:
                before()
                tick()

            wait()
            make = group.make_ready_to_record if purpose is SyncPurpose.MEMORIES else group.stream_again
            make(self._show_message, tick)

        self._background.start(work)
        self.changed.emit()

    def over(self) -> Callable[[], object]:
        """What waits, beside the screen, until all that was begun so far has let the sensors be."""
        return self._is_over.wait

    def stop(self) -> None:
        """Leave it; the sensors are let go beside the screen."""
        self._background.stop()
        self.changed.emit()

    def forget(self) -> None:
        """The last failure is shown no more."""
        if self._error is not None:
            self._error = None
            self.changed.emit()

    def finish(self) -> None:
        """Wait for the thread, at the end of the program."""
        self._background.finish()

    def _show_message(self, stage: SyncStage, sensor: str, left_s: float) -> None:
        self._reported = stage, sensor, left_s

    def _on_progressed(self, _share: float, _what: str) -> None:
        if self._reported is None:
            return
        stage, sensor, left_s = self._reported
        before = self.view
        is_again = stage is SyncStage.PREPARING and before.stage is not SyncStage.PREPARING
        attempt = before.attempt + is_again
        self._total_s = left_s if is_again else max(self._total_s, left_s)
        share = max(0.0 if is_again else before.share, 1.0 - left_s / self._total_s) if self._total_s > 0 else 0.0
        self.view = SyncView(stage, sensor, left_s, share, attempt)
        self.changed.emit()

    def _on_done(self, _nothing: object) -> None:
        self.done.emit()
        self.changed.emit()

    def _on_failed(self, error: Exception) -> None:
        self._error = error
        self.changed.emit()


def sentence_of(view: SyncView) -> str:
    """What is being done, and what to do meanwhile."""
    match view.stage:
        case SyncStage.PREPARING if view.sensor:
            return tr("{sensor} is being set up.").format(sensor=view.sensor)
        case SyncStage.PREPARING:
            return tr("Connecting to the sensors.")
        case SyncStage.WAITING:
            return tr("The sensors are comparing their clocks automatically. Leave them where they are.")
        case SyncStage.CONNECTING:
            return tr("Checking the result of {sensor}.").format(sensor=view.sensor)
        case SyncStage.LISTENING:
            return tr("Comparing the sensor clocks.")


def progress_of(sync: SensorSync, names: Collection[str]) -> ProgressShown:
    """What is shown while sensors of these names are brought onto one clock."""
    if sync.is_ending:
        return ProgressShown(tr("The sensors are being released"), tr("This takes a few seconds."))
    view = sync.view
    title = tr("The sensors are being synchronised")
    if view.attempt > 1:
        title = tr("Some sensors did not synchronise: all are being synchronised again")
    sentence = sentence_of(view)
    sentence = " ".join(filter(None, [sentence, time_left(view.left_s)]))
    return ProgressShown(title, sentence, view.share, lines_of(view, names), stop=tr("Cancel"))


def time_left(left_s: float | None) -> str:
    """About how long it takes still; empty where that is not known, or soon."""
    if left_s is None or left_s <= SOON_S:
        return ""
    return tr("About {seconds} s left.").format(seconds=math.ceil(left_s / SOON_S) * round(SOON_S))


def lines_of(view: SyncView, names: Collection[str]) -> tuple[SensorLine, ...]:
    """Done are those before the one that it is about."""
    if view.stage is SyncStage.WAITING:
        return tuple(SensorLine(name, LineState.NOW, tr("comparing clocks")) for name in names)
    order = list(names)
    if view.sensor not in order:
        state = LineState.DONE if view.stage is SyncStage.LISTENING else LineState.TO_DO
        return tuple(SensorLine(name, state) for name in order)
    at = order.index(view.sensor)
    done = tr("set up") if view.stage is SyncStage.PREPARING else tr("checked")
    before = (SensorLine(name, LineState.DONE, done) for name in order[:at])
    after = (SensorLine(name, LineState.TO_DO) for name in order[at + 1 :])
    return (*before, SensorLine(view.sensor, LineState.NOW), *after)

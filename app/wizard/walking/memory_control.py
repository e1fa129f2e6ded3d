"""Walks in the sensors' own memories: made ready before them, shown while they last, fetched after them."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal, Slot

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.sensors_progress import ProgressShown
from app.wizard.sensor_sync import SyncPurpose, progress_of
from app.wording.translation import tr
from core.body import Site

if TYPE_CHECKING:
    from app.wizard.visit import Visit

ROOTS = (Site.PELVIS, Site.LEFT_THIGH, Site.RIGHT_THIGH)  # nearest to all others


class MemoryControl(QObject):
    """Knows the visit and no page."""

    changed = Signal()  # something else is shown, or can be done
    done = Signal()  # no further walk is to follow
    lives = Signal()  # the sensors send again what they measure, as was asked

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self.fetch = visit.fetch
        self.fetch.changed.connect(self.changed)
        visit.sensors.sync.changed.connect(self.changed)
        visit.sensors.sync.done.connect(self._on_ready)

    @property
    def is_synchronising(self) -> bool:
        sync = self._visit.sensors.sync
        return sync.is_running or sync.is_ending

    @property
    def cannot_start(self) -> str:
        """What is missing for a walk, in a sentence; empty where nothing is."""
        if self.is_synchronising:
            return tr("The sensors are being synchronised.")
        if self.fetch.is_fetching:
            return tr("The walk is being fetched.")
        return tr("Prepare the sensors first.") if self._must_be_made_ready else ""

    @property
    def cannot_leave(self) -> str:
        """Why the step cannot be left now; empty where it can."""
        if self.is_synchronising:
            return tr("The sensors are being synchronised. Wait, or cancel.")
        return self.fetch.cannot_leave

    @property
    def shown(self) -> ProgressShown | None:
        """What is shown in the place of the curves; None: they are."""
        sensors, recordings = self._visit.sensors, self._visit.recordings
        if self.is_synchronising:
            return progress_of(sensors.sync, sensors.acquisition.sensors if sensors.acquisition is not None else ())
        if recordings.is_recording and sensors.are_in_memory and not recordings.is_stopping:
            return ProgressShown(
                tr("The sensors are recording to memory"),
                tr("The patient may walk out of range. Stop the walk near this computer; its data are then fetched."),
                is_running=False,
            )
        if (fetched := self.fetch.shown) is not None or not self._must_be_made_ready:
            return fetched
        what, then = sensors.sync.failure
        if what:
            return ProgressShown(tr("The sensors are not ready"), what=what, then=then, is_running=False)
        return ProgressShown(tr("Walks are recorded in the sensors"), self._price, is_running=False)

    def bar(self) -> BarState | None:
        """What can be done between two walks; None: nothing has to be."""
        recordings = self._visit.recordings
        if self.is_synchronising:
            return BarState()
        if (fetched := self.fetch.bar()) is not None or not self._must_be_made_ready:
            return fetched
        has_failed = bool(self._visit.sensors.sync.failure[0])
        words = tr("Try again") if has_failed else tr("Prepare the sensors")
        ready = BarAction(words, self._make_ready, tr("Enter"), Icon.REPEAT if has_failed else None)
        others = [BarAction(tr("Record walks live"), self.send_live, is_requested=False)]
        if any(recording.details.is_kept for recording in recordings.walks):
            others.append(BarAction(tr("Results"), self.done.emit, icon=Icon.NEXT, is_requested=False))
        return BarState(primary=ready, others=tuple(others))

    def quiet(self, *, wants_live: bool) -> BarAction | None:
        """The way to walks that were to be fetched later, to one clock, or where somebody `wants_live` to that."""
        sensors = self._visit.sensors
        if self.is_synchronising or self.fetch.is_fetching:
            return None
        if (later := self.fetch.later) is not None:
            return later
        if sensors.dots is not None and sensors.dots.record_hz is None and sensors.are_loose:
            return BarAction(tr("Synchronise again"), self.send_live)
        is_wish = wants_live and sensors.are_in_memory
        return BarAction(tr("Record walks live"), self.send_live, is_requested=False) if is_wish else None

    def _make_ready(self) -> None:
        self._synchronise(SyncPurpose.MEMORIES)

    def send_live(self) -> None:
        """Measure walks live, as everything else."""
        dots = self._visit.sensors.dots
        if dots is not None:
            dots.record_hz = None
            self.go_live()

    def go_live(self) -> None:
        """Let the sensors send again; `lives` follows."""
        self._synchronise(SyncPurpose.STREAMS)

    def stop(self) -> None:
        """The way out of what takes long."""
        if self._visit.sensors.sync.is_running:
            self._visit.sensors.sync.stop()
        else:
            self.fetch.put_off()

    def prepare(self) -> None:
        """Do what takes a moment only: where they are on one clock at this rate, they stop sending."""
        dots = self._visit.sensors.dots
        if dots is not None and self._must_be_made_ready and dots.record_hz and dots.are_one_at(dots.record_hz):
            self._make_ready()

    @property
    def _must_be_made_ready(self) -> bool:
        """Whether walks are for the memories, and sensors not ready for that."""
        dots = self._visit.sensors.dots
        return dots is not None and dots.record_hz is not None and not self._visit.sensors.are_ready_for_walks

    @property
    def _price(self) -> str:
        if self._visit.sensors.are_in_memory:
            return tr(
                "The sensor clocks drift apart, so they are synchronised every half hour. This takes about a "
                "minute. The patient stands near this computer meanwhile."
            )
        return tr(
            "For this the sensors are synchronised once more. This takes about a minute. The patient "
            "stands near this computer meanwhile."
        )

    def _synchronise(self, purpose: SyncPurpose) -> None:
        sensors = self._visit.sensors
        dots = sensors.dots
        if dots is None or self.is_synchronising:
            return
        root = next((sensors.sensor_at[site] for site in ROOTS if site in sensors.sensor_at), None)
        if root is not None:
            dots.set_root(root)
        sensors.sync.start(dots, purpose)
        self.changed.emit()

    @Slot()
    def _on_ready(self) -> None:
        sensors = self._visit.sensors
        if sensors.dots is not None and sensors.sync.purpose is SyncPurpose.STREAMS:
            self.lives.emit()
        self.changed.emit()

"""Walks in the sensors' own memories: made ready before them, told of while they last, fetched after them."""

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal, Slot

from app.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.sensors_progress import LineState, ProgressShown, SensorLine
from app.wizard.sensor_sync import SOON_S, SyncPurpose, progress_of
from app.wording import tr, tr_n
from core.body import Site

if TYPE_CHECKING:
    from app.wizard.memory_fetches import FetchView
    from app.wizard.visit import Visit

ROOTS = (Site.PELVIS, Site.LEFT_THIGH, Site.RIGHT_THIGH)  # nearest to all others


class MemoryControl(QObject):
    """Knows the visit and no page.

    Signals
    -------
    changed
        Something else is shown, or can be done.
    lives
        The sensors send again what they measure, as was asked.
    """

    changed = Signal()
    lives = Signal()

    def __init__(self, visit: "Visit", parent: QObject) -> None:
        super().__init__(parent)
        self._visit = visit
        self._is_put_off = False  # fetching, by the user
        visit.sensors.sync.changed.connect(self.changed)
        visit.sensors.sync.done.connect(self._on_ready)
        visit.recordings.fetches.changed.connect(self.changed)

    @property
    def is_synchronising(self) -> bool:
        sync = self._visit.sensors.sync
        return sync.is_running or sync.is_ending

    @property
    def is_fetching(self) -> bool:
        """Whether somebody speaks with the sensors about what they hold, or a walk's end waits for that."""
        recordings = self._visit.recordings
        is_waited_for = recordings.is_stopping and recordings.is_in_memory
        return is_waited_for or not recordings.fetches.is_idle

    @property
    def cannot_start(self) -> str:
        """What is missing for a walk, in a sentence; empty where nothing is."""
        sensors = self._visit.sensors
        if self.is_synchronising:
            return tr("The sensors are being synchronised.")
        if self.is_fetching:
            return tr("A walk is being fetched.")
        if self._must_be_made_ready:
            return tr("The sensors are to be made ready first.")
        return "" if sensors.acquisition is not None else tr("Choose the source of the sensors first.")

    @property
    def cannot_leave(self) -> str:
        """Why the step cannot be left now; empty where it can."""
        if self.is_synchronising:
            return tr("The sensors are being synchronised. Wait until they are, or cancel it.")
        if self.is_fetching:
            return tr("A walk is being fetched. Wait until it is, or fetch it later.")
        return ""

    @property
    def shown(self) -> ProgressShown | None:
        """What stands in the place of the curves; None: they do."""
        sensors, recordings = self._visit.sensors, self._visit.recordings
        if self.is_synchronising:
            return progress_of(sensors.sync, sensors.acquisition.sensors if sensors.acquisition is not None else ())
        if self.is_fetching and not recordings.fetches.failure[0]:
            return self._fetching
        if recordings.is_recording and sensors.are_in_memory and not recordings.is_stopping:
            return ProgressShown(
                tr("The sensors record in their memories"),
                tr("The patient may walk out of reach. Stop near this computer: then the walk is fetched."),
                is_running=False,
            )
        what, then = recordings.fetches.failure
        if what and not self._is_put_off:
            return ProgressShown(tr("The walk is in the sensors still"), what=what, then=then, is_running=False)
        what, then = sensors.sync.failure
        if what and self._must_be_made_ready:
            return ProgressShown(tr("The sensors are not ready"), what=what, then=then, is_running=False)
        if self._must_be_made_ready:
            return ProgressShown(tr("Walks are recorded in the sensors"), self._price, is_running=False)
        return None

    def bar(self) -> BarState | None:
        """What can be done about it; None: nothing has to be."""
        recordings = self._visit.recordings
        if self.is_synchronising:
            return BarState()
        if self.is_fetching and not recordings.fetches.failure[0]:
            return BarState(note=tr("The walk is being fetched."))
        if recordings.fetches.failure[0] and not self._is_put_off:
            again = BarAction(tr("Fetch again"), tr("Enter"), Icon.REPEAT)
            return BarState(primary=again, others=(BarAction(tr("Fetch later"), is_wished=False),))
        if not self._must_be_made_ready or recordings.is_recording:
            return None
        has_failed = bool(self._visit.sensors.sync.failure[0])
        words = tr("Try again") if has_failed else tr("Make the sensors ready")
        ready = BarAction(words, tr("Enter"), Icon.REPEAT if has_failed else None)
        others = [BarAction(tr("Send walks live"), is_wished=False)]
        if any(recording.details.is_kept for recording in recordings.walks):
            others.append(BarAction(tr("Results"), is_wished=False, icon=Icon.NEXT))
        return BarState(primary=ready, others=tuple(others))

    def quiet(self, *, wants_live: bool) -> BarAction | None:
        """The way to walks that were to be fetched later, to one clock, or where somebody `wants_live` to that."""
        if self.is_fetching or self.is_synchronising:
            return None
        count = len(self._visit.recordings.in_sensors)
        if count and self._is_put_off:
            return BarAction(tr_n("Fetch {count} walk", "Fetch {count} walks", count).format(count=count))
        sensors = self._visit.sensors
        if sensors.dots is not None and sensors.dots.record_hz is None and sensors.are_loose:
            return BarAction(tr("Synchronise again"))
        return BarAction(tr("Send walks live"), is_wished=False) if wants_live and sensors.are_in_memory else None

    def on_quiet(self) -> None:
        """The action of `quiet`."""
        if self._visit.recordings.in_sensors and self._is_put_off:
            self._is_put_off = False
            self._visit.recordings.fetches.start()
        else:
            self.send_live()

    def on_primary(self) -> None:
        """The primary action of `bar`."""
        if self.is_synchronising:
            return
        fetches = self._visit.recordings.fetches
        if fetches.failure[0] and not self._is_put_off:
            fetches.start()
        elif self._must_be_made_ready:
            self._synchronise(SyncPurpose.MEMORIES)

    def on_other(self, number: int) -> bool:
        """One of the others of `bar`; whether the walks are done with."""
        recordings = self._visit.recordings
        if recordings.fetches.failure[0] and not self._is_put_off:
            self.stop()
        elif number == 0:
            self.send_live()
        return number == 1

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
            self._is_put_off = True
            self._visit.recordings.fetch_later()
        self.changed.emit()

    def prepare(self) -> None:
        """Do what takes a moment only: where they are on one clock at this rate, they stop sending."""
        dots = self._visit.sensors.dots
        if dots is not None and self._must_be_made_ready and dots.record_hz and dots.are_one_at(dots.record_hz):
            self._synchronise(SyncPurpose.MEMORIES)

    def begun(self) -> None:
        """A walk begins: what was put off waits for its end."""
        self._is_put_off = False

    @property
    def _must_be_made_ready(self) -> bool:
        """Whether walks are for the memories, and sensors not ready for that."""
        dots = self._visit.sensors.dots
        return dots is not None and dots.record_hz is not None and not self._visit.sensors.are_ready_for_walks

    @property
    def _price(self) -> str:
        if self._visit.sensors.are_in_memory:
            return tr(
                "Their clocks drift apart, so they are synchronised anew every half hour. It takes about a minute; the "
                "patient stands near this computer meanwhile."
            )
        return tr(
            "They are synchronised once more for that. It takes about a minute; the patient stands near this computer "
            "meanwhile."
        )

    @property
    def _fetching(self) -> ProgressShown:
        sensors, fetches = self._visit.sensors, self._visit.recordings.fetches
        names = sensors.acquisition.sensors if sensors.acquisition is not None else ()
        view = fetches.view(len(names))
        title = tr("The walk is being fetched from the sensors")
        if view.waiting > 1:
            title = tr("{count} walks are being fetched from the sensors").format(count=view.waiting)
        if not fetches.waiting:
            return ProgressShown(tr("The walk is being read back"))
        if not fetches.is_running:
            return ProgressShown(tr("The sensors are being let be"), tr("This takes some seconds."))
        return ProgressShown(title, _sentence(view), _share(view, len(names)), _lines(view, names), stop=_later())

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


def _later() -> str:
    return tr("Fetch later")


def _sentence(view: "FetchView") -> str:
    if not view.sensor:
        return tr("The sensors are told to end, and asked what they hold.")
    said = tr("{sensor}: {done} of about {of} samples.").format(sensor=view.sensor, done=view.done, of=view.of)
    if view.left_s is None or view.left_s <= SOON_S:
        return said
    seconds = math.ceil(view.left_s / SOON_S) * round(SOON_S)
    return said + " " + tr("About {seconds} s are left.").format(seconds=seconds)


def _share(view: "FetchView", sensors: int) -> float | None:
    if not view.sensor:
        return None
    now = min(view.done / view.of, 1.0) if view.of else 0.0
    return (len(view.fetched) + now) / max(sensors, len(view.fetched) + 1)


def _lines(view: "FetchView", names: tuple[str, ...]) -> tuple[SensorLine, ...]:
    lines = []
    for name in names:
        state = LineState.NOW if name == view.sensor else LineState.TO_DO
        lines.append(SensorLine(name, LineState.DONE if name in view.fetched else state))
    return tuple(lines)

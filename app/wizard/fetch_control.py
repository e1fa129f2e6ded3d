"""What is shown and can be done while recordings are fetched from the sensors' memories: on any step that begins it."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction, BarState
from app.widgets.sensors_progress import LineState, ProgressShown, SensorLine
from app.wizard.sensor_sync import time_left
from app.wording.translation import tr, tr_n

if TYPE_CHECKING:
    from app.wizard.memory_fetches import FetchView
    from app.wizard.recordings import SessionRecordings
    from app.wizard.worn_sensors import WornSensors


class FetchControl(QObject):
    """Fetching what the sensors stored: whether it runs, is put off, or is offered."""

    changed = Signal()  # something else is shown, or can be done

    def __init__(self, recordings: "SessionRecordings", sensors: "WornSensors", parent: QObject) -> None:
        super().__init__(parent)
        self._recordings, self._sensors = recordings, sensors
        self._is_put_off = False  # by the user
        recordings.fetches.changed.connect(self.changed)

    @property
    def is_fetching(self) -> bool:
        """Whether somebody speaks with the sensors about what they hold, or a recording's end waits for that."""
        recordings = self._recordings
        is_waited_for = recordings.is_stopping and recordings.is_in_memory
        return is_waited_for or not recordings.fetches.is_idle

    @property
    def has_failed(self) -> bool:
        """Whether it stopped by itself, and is to be tried again or put off."""
        return bool(self._recordings.fetches.failure[0]) and not self._is_put_off

    @property
    def cannot_leave(self) -> str:
        """Why the step cannot be left now; empty where it can."""
        return (
            tr("A walk is being fetched from the sensors. Wait, or fetch this walk later.") if self.is_fetching else ""
        )

    @property
    def shown(self) -> ProgressShown | None:
        """What is shown of it; None: nothing is fetched."""
        if self.has_failed:
            what, then = self._recordings.fetches.failure
            return ProgressShown(tr("The walk is still in the sensors"), what=what, then=then, is_running=False)
        return self._progress if self.is_fetching else None

    def bar(self) -> BarState | None:
        """What can be done about it; None: nothing has to be."""
        if self.has_failed:
            again = BarAction(tr("Fetch again"), self.go_on, tr("Enter"), Icon.REPEAT)
            return BarState(primary=again, others=(BarAction(tr("Fetch later"), self.put_off, is_requested=False),))
        return BarState(note=tr("The walk is being fetched.")) if self.is_fetching else None

    @property
    def later(self) -> BarAction | None:
        """The way to what was put off, while nothing else is done with the sensors."""
        count = len(self._recordings.in_sensors)
        if not count or not self._is_put_off or self.is_fetching:
            return None
        return BarAction(tr_n("Fetch {count} walk", "Fetch {count} walks", count).format(count=count), self.go_on)

    def go_on(self) -> None:
        """Fetch what failed, or was put off."""
        self._is_put_off = False
        self._recordings.fetches.start()

    def put_off(self) -> None:
        self._is_put_off = True
        self._recordings.fetch_later()
        self.changed.emit()

    def begun(self) -> None:
        """A recording begins: what was put off is fetched with it, once it has ended, if that is in the sensors too."""
        self._is_put_off = self._is_put_off and not self._sensors.are_in_memory

    @property
    def _progress(self) -> ProgressShown:
        fetches = self._recordings.fetches
        names = self._sensors.acquisition.sensors if self._sensors.acquisition is not None else ()
        view = fetches.view(len(names))
        if not fetches.waiting:
            return ProgressShown(tr("The walk is being loaded"))
        if not fetches.is_running:
            return ProgressShown(tr("The sensors are being released"), tr("This takes a few seconds."))
        title = tr("The walk is being fetched from the sensors")
        if view.waiting > 1:
            title = tr("{count} walks are being fetched from the sensors").format(count=view.waiting)
        lines = tuple(SensorLine(name, _state(name, view)) for name in names)
        return ProgressShown(title, _sentence(view), _share(view, len(names)), lines, stop=tr("Fetch later"))


def _state(name: str, view: "FetchView") -> LineState:
    if name in view.fetched:
        return LineState.DONE
    return LineState.NOW if name == view.sensor else LineState.TO_DO


def _sentence(view: "FetchView") -> str:
    if not view.sensor:
        return tr("Stopping the sensors and checking what they recorded.")
    stated = tr("{sensor}: {done} of about {of} samples.").format(sensor=view.sensor, done=view.done, of=view.of)
    return " ".join(filter(None, [stated, time_left(view.left_s)]))


def _share(view: "FetchView", sensors: int) -> float | None:
    if not view.sensor:
        return None
    now = min(view.done / view.of, 1.0) if view.of else 0.0
    return (len(view.fetched) + now) / max(sensors, len(view.fetched) + 1)

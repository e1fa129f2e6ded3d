"""What was recorded in the sensors' memories on its way into its journals: one recording after the other, with a stop.

The oldest comes first. Stopped, it is gone on with where it was; where sensors are out of reach, it is tried again.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.acquisition.recorder import Recorder
from app.system.progress import Report
from app.wording.translation import tr
from app.workers.background import Background
from app.workers.refusals import refusal_of
from devices.live import SourceRefusedError

if TYPE_CHECKING:
    from devices.live import SourceLostError

SURE_S = 2.0  # of fetching, before it is shown how long the rest will take


@dataclass(frozen=True, slots=True)
class FetchView:
    """How far the recording is that is being fetched."""

    sensor: str = ""  # which is sending now; empty while they are still asked to end
    done: int = 0  # samples of that sensor so far
    of: int = 0  # about how many it has
    left_s: float | None = None  # until all sensors of this recording are fetched, about; None: not known yet
    fetched: tuple[str, ...] = ()  # sensors that are done
    waiting: int = 0  # how many recordings there are in the sensors, this one among them


@dataclass(slots=True)
class _Running:
    """One recording that is being fetched; its numbers are written by the links' thread, and read by the screen's."""

    recorder: Recorder
    began_s: float = 0.0
    before: int = 0
    done: dict[str, int] = field(default_factory=dict)
    about: dict[str, int] = field(default_factory=dict)

    def fetch(self, report: Report) -> "Mapping[str, SourceLostError | SourceRefusedError]":
        self.began_s, self.before = time.monotonic(), sum(self.done.values())
        return self.recorder.finish(self._progress, lambda: report(0.0, ""))

    def _progress(self, sensor: str, done: int, of: int) -> None:
        self.about[sensor] = of
        self.done[sensor] = done

    def view(self, sensors: int, waiting: int) -> FetchView:
        done = dict(self.done)
        if not done:
            return FetchView(waiting=waiting)
        *fetched, now = done
        expected = sum(self.about.values()) / len(self.about) * max(sensors, len(done))
        passed_s, came = time.monotonic() - self.began_s, sum(done.values()) - self.before
        left_s = None
        if passed_s > SURE_S and came > 0:
            left_s = max(expected - sum(done.values()), 0.0) * passed_s / came
        return FetchView(now, done[now], self.about[now], left_s, tuple(fetched), waiting)


class MemoryFetches(QObject):
    """Fetches what sensors stored, one recording after the other, beside what goes on."""

    changed = Signal()  # something else is shown
    fetched = Signal(object)  # a Recorder whose journal holds what the sensors did

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._waiting: list[_Running] = []  # oldest first
        self._failed: Mapping[str, SourceLostError | SourceRefusedError] = {}
        self._is_broken = self._must_start = False
        self._background = Background(self)
        self._background.progressed.connect(self._on_progressed)
        self._background.done.connect(self._on_done)
        self._background.failed.connect(self._on_broken)
        self._background.idle.connect(self._on_idle)

    @property
    def waiting(self) -> tuple[Recorder, ...]:
        """Those that are in the sensors still, oldest first."""
        return tuple(one.recorder for one in self._waiting)

    @property
    def is_running(self) -> bool:
        return self._background.is_busy or self._must_start

    @property
    def is_idle(self) -> bool:
        """Whether nobody speaks with the sensors."""
        return self._background.is_idle

    def view(self, sensors: int) -> FetchView:
        """How far it is; of so many sensors."""
        return self._waiting[0].view(sensors, len(self._waiting)) if self._waiting else FetchView()

    @property
    def failure(self) -> tuple[str, str]:
        """Why it stopped, and what to do; empty where it did not."""
        if self.is_running:
            return "", ""
        if self._is_broken:
            return tr("Fetching the recording stopped early."), tr(
                "Fetch the recording again. See the log for details."
            )
        for sensor, problem in self._failed.items():
            if isinstance(problem, SourceRefusedError):
                return refusal_of(problem)
            what = tr("{sensor} is out of range.").format(sensor=sensor)
            then = tr("The recording is still in the sensor. Bring {sensor} closer, then fetch the recording again.")
            return what, then.format(sensor=sensor)
        return "", ""

    def add(self, recorder: Recorder) -> None:
        """Fetch this one, too, as soon as those before it are."""
        self._waiting.append(_Running(recorder))
        self.start()

    def start(self) -> None:
        """Go on, or try again; not where nothing waits."""
        if not self._waiting or self._background.is_busy:
            return
        self._failed, self._is_broken = {}, False
        self._must_start = not self._background.is_idle  # what was stopped lets go of the sensors first
        if not self._must_start:
            self._background.start(self._waiting[0].fetch)
        self.changed.emit()

    def stop(self) -> None:
        """Leave it in the sensors for now."""
        self._must_start = False
        self._background.stop()
        self.changed.emit()

    def give_up(self) -> tuple[Recorder, ...]:
        """Fetch nothing more; those that are left in the sensors."""
        self.stop()
        left, self._waiting = self.waiting, []
        return left

    def finish(self) -> None:
        """Wait for the thread, at the end of the program."""
        self._background.finish()

    def _on_idle(self) -> None:
        if self._must_start:
            self.start()
        self.changed.emit()

    def _on_progressed(self, _share: float, _what: str) -> None:
        self.changed.emit()

    def _on_done(self, failed: "Mapping[str, SourceLostError | SourceRefusedError]") -> None:
        self._failed = failed
        if not failed:
            self.fetched.emit(self._waiting.pop(0).recorder)
            self.start()
        self.changed.emit()

    def _on_broken(self, _error: Exception) -> None:
        self._is_broken = True
        self.changed.emit()

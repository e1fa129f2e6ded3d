"""Cost of the whole window while a patient walks.

Also the age of what it paints, and whether its thread is ever held up.

    python -m tests.benchmarks.live_window [--rate 100] [--size 1280 800] [--seconds 60] [--curves 18] [--analyses]
        [--camera]

The application itself on a display of its own (Xvfb) leads a whole session with the simulated patient, from home to
the results, and records a walk of so many seconds; readers, journal, estimator and frames are all in its process.
Reported are: CPU of the walk as a share of one core, by thread; frames a second and how far apart; age: from an angle's
stamp until the frame that shows it was sent to the display, the estimator's wait for the samples around it included;
what held the screen's thread up for more than 100 ms in the whole session, and where. Of the longest time between two
frames: how long each of our threads was at work in it, and how long it was ready and other processes were on the
processor; and how long a process beside that does nothing but beat was silent. A machine that is still is no
fault of the window. With `--curves 18` frames are those of a page that draws the rates of six sensors about three
axes, instead of the walking page, for as long. One analysis runs beside the walk, as ever, to find the ankles' axes;
with `--analyses` one after the other all the time. With `--camera` FFmpeg's test picture of 1280 x 720 pixels is
recorded beside the walk, 30 times a second; the process that takes it makes it as well, which a camera does itself.
"""

import argparse
import gc
import json
import subprocess
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from tests.app.watchdog import Watchdog, open_schedstat, schedstat_s
from tests.benchmarks.own_display import own_display, own_environment
from tests.driver import HIDDEN, options

if TYPE_CHECKING:
    from app.main_window import MainWindow
    from app.wizard.wizard import Wizard
    from app.wizard.worn_sensors import SourceChoice

STRIDE_S = 1.1
POLL_MS = 50
PATIENCE_S = 180.0
PAUSE_S = 0.7  # at each stop, for what is drawn after it
DUE_S = 1 / 30
BEAT_S = 0.02
WATCH_MS = 20  # four times as far apart as in tests, where a watchdog may cost what it likes
KEPT = "at_work_and_kept_ms"


def lead(required: argparse.Namespace) -> dict[str, Any]:
    """Open the window, lead the session, and give what was measured. Runs in a process of its own."""
    from PySide6.QtCore import QTimer

    from app import main_window
    from app.wizard.sensors import sources

    sources.choices = lambda: (_source(required.rate, required.seconds),)  # before the wizard takes it from there
    measured: dict[str, Any] = {}
    init = main_window.MainWindow.__init__
    timer = QTimer()

    def begun(window: "MainWindow", *arguments: Any, **named: Any) -> None:
        init(window, *arguments, **named)
        dog = Watchdog(beat_ms=WATCH_MS)
        script = _session(window, required, measured)
        state: dict[str, Any] = {"until": lambda: True, "since_s": time.monotonic()}

        def poll() -> None:
            try:
                if state["until"]():
                    state["until"], state["since_s"] = next(script), time.monotonic()
                elif time.monotonic() - state["since_s"] > PATIENCE_S + required.seconds:
                    raise TimeoutError("the session does not go on")
            except StopIteration:
                timer.stop()  # the window may take several polls to close
                dog.stop()
                measured["late"] = [str(late) for late in dog.late]
                window.close()
            except Exception:
                window.close()
                raise

        timer.timeout.connect(poll)
        timer.start(POLL_MS)
        dog.start()
        gc.unfreeze()  # the application is measured as it is

    main_window.MainWindow.__init__ = begun  # type: ignore[assignment,method-assign]  # only to measure
    collected = _collections()
    main_window.open_window([])
    measured["collections_ms"] = collected
    return measured


def _source(rate_hz: float, seconds: float) -> "SourceChoice":
    from app.acquisition.acquisition import Acquisition
    from app.wizard.sensors.sources import DEMONSTRATION
    from app.wizard.worn_sensors import SourceChoice
    from devices.simulation.demonstration_patient import DemonstrationPatient
    from devices.simulation.replay import DEMONSTRATION_SESSION
    from devices.simulation.walker import Walk

    walk = Walk(strides=round((seconds + 10.0) / STRIDE_S), standing_before_s=2.0)
    recordings = (*(one for one in DEMONSTRATION_SESSION.recordings if not isinstance(one, Walk)), walk)
    settings = replace(DEMONSTRATION_SESSION, rate_hz=rate_hz, recordings=recordings)
    return SourceChoice(
        DEMONSTRATION, "Simulated patient", lambda: Acquisition([DemonstrationPatient(settings)]), is_simulated=True
    )


def _session(
    window: "MainWindow", required: argparse.Namespace, measured: dict[str, Any]
) -> Iterator[Callable[[], bool]]:
    """The session: each stop is reached when what it yields is true."""
    window.resize(*required.size)
    window.move(20, 20)
    yield _after(PAUSE_S)
    window.open_demonstration()
    yield lambda: window.home is not None and window.home.isVisible()
    yield _after(2 * PAUSE_S)
    yield lambda: window.preparing.is_idle  # who types a passphrase takes longer
    yield lambda: window.home is not None and not window.home.filling.is_busy  # nor what fills the demonstration
    from app.wizard.free_motion.step import FreeMotionStep
    from app.wizard.results.step import ResultsStep
    from app.wizard.sensors.page import Way
    from app.wizard.step import StepId

    assert window.home is not None
    window.home.session_requested.emit(window.home.patients.patient)
    wizard = window.wizard
    assert wizard is not None
    yield _after(PAUSE_S)
    yield lambda: wizard.visit is not None and wizard.visit.patient.stored is not None
    wizard.go_to(StepId.SENSORS)
    yield _after(PAUSE_S)
    visit = wizard.visit
    assert visit is not None
    visit.sensors.search(visit.choices[0])
    yield lambda: visit.sensors.acquisition is not None
    yield _after(4.0)
    _Watch.listen()
    wizard.steps[StepId.SENSORS].page.way_chosen.emit(Way.MOTION)  # type: ignore[attr-defined]  # it is the sensors page
    yield _after(PAUSE_S)
    wizard.go_to(StepId.STAND_STILL)
    yield _after(PAUSE_S)
    wizard.press_primary()
    yield lambda: wizard.step_id is StepId.FREE_MOTION
    free = wizard.steps[StepId.FREE_MOTION]
    assert isinstance(free, FreeMotionStep)
    yield lambda: wizard.step_id is StepId.WALKING or free.question.asked is not None
    if wizard.step_id is StepId.FREE_MOTION:
        yield _after(PAUSE_S)
        free.page.question.answered.emit(0)
    yield lambda: wizard.step_id is StepId.WALKING
    yield lambda: not visit.evaluation.is_busy
    yield _after(PAUSE_S)
    feed = None
    if required.camera:
        walking = wizard.steps[StepId.WALKING]
        yield from _camera_on(walking)
        (feed,) = walking.camera.feeds  # type: ignore[attr-defined]  # it is the walking step
    wizard.press_primary()
    yield lambda: wizard.is_recording
    yield _after(8.0)  # until every joint has its angle
    bench = _bench_page(window, wizard) if required.curves else None
    done: list[int] = []
    visit.evaluation.done.connect(lambda: done.append(1))
    watch = _Watch(wizard)
    wait = _after(required.seconds)
    yield _asking_again(wizard.steps[StepId.WALKING], wait) if required.analyses else wait
    measured |= watch.end() | {"analyses": len(done)}
    if feed is not None:
        measured["camera"] = f"{feed.taken} frames, {feed.mode}"
    if bench is not None:
        window.screens.setCurrentWidget(wizard)
        yield _after(PAUSE_S)
    wizard.press_primary()
    yield lambda: not visit.recordings.is_recording and not visit.recordings.is_stopping
    yield _after(PAUSE_S)
    visit.recordings.keep(visit.recordings.walks[-1], True)
    wizard.go_to(StepId.RESULTS)
    results = wizard.steps[StepId.RESULTS]
    assert isinstance(results, ResultsStep)
    yield lambda: results._shown is not None and not visit.evaluation.is_busy
    yield _after(2 * PAUSE_S)
    wizard.go_to(StepId.REPORT)
    yield _after(PAUSE_S)
    wizard.leave()
    yield _after(2 * PAUSE_S)


def _camera_on(walking: Any) -> Iterator[Callable[[], bool]]:
    from app.wizard.walking import camera_control
    from devices.cameras.camera import TEST_PICTURE, CameraInfo

    camera = CameraInfo("Test picture", "testsrc2=size=1280x720:rate=30", TEST_PICTURE)
    setattr(camera_control, "find_cameras", lambda: (camera,))  # noqa: B010  as if it were connected
    walking.camera.look()
    yield lambda: walking.camera.shown is not None
    walking.camera.turn(True)
    walking.camera.agree()
    yield lambda: bool(walking.camera.feeds) and walking.camera.feeds[0].latest is not None


def _after(seconds: float) -> Callable[[], bool]:
    until_s = time.monotonic() + seconds
    return lambda: time.monotonic() >= until_s


def _asking_again(walking: Any, until: Callable[[], bool]) -> Callable[[], bool]:
    """Let the walking step ask for the ankles again as soon as it has its answer."""

    def is_over() -> bool:
        walking._preview._is_ankle_asked = False
        return until()

    return is_over


class _Watch:
    """What is measured while the patient walks."""

    current: "_Watch | None" = None

    @classmethod
    def listen(cls) -> None:
        """Hear of every curve that is painted from now on; before any is, since Qt asks Python only once."""
        from PySide6.QtCore import QTimer

        from app.wizard.walking.live_strip import _History

        paint = _History.paintEvent

        def received(item: Any, *arguments: Any) -> None:
            paint(item, *arguments)
            if cls.current is not None:
                QTimer.singleShot(0, partial(cls.current.on_sent, item))  # once the frame is on the display

        _History.paintEvent = received  # type: ignore[assignment,method-assign]  # only to measure

    def __init__(self, wizard: "Wizard") -> None:
        visit = wizard.visit
        assert visit is not None
        assert visit.sensors.acquisition is not None
        self._acquisition = visit.sensors.acquisition
        self._painted_s: list[float] = []
        self._spent: list[dict[str, Spent]] = []  # at each of these
        self._threads_spent = _Spent()
        self._age_s: list[float] = []
        self._shown_to_s: dict[int, float] = {}
        self._first: Any = None
        self._cpu, self._threads = time.process_time(), _by_thread()
        self._begin_s = time.perf_counter()
        _Watch.current = self

    def on_sent(self, item: Any) -> None:
        if _Watch.current is not self:
            return
        now_s = self._acquisition.now_s
        if self._first is None:
            self._first = item
        if item is self._first:
            self._painted_s.append(time.perf_counter())
            self._spent.append(self._threads_spent.read())
        for trace in item._traces.values():
            shown_to_s = self._shown_to_s.get(id(trace), trace.last_s)
            first = int(trace.time_s.searchsorted(shown_to_s, side="right"))
            new = trace.time_s[first:][np.isfinite(trace.angle_deg[first:])]
            self._age_s += (now_s - new).tolist()
            self._shown_to_s[id(trace)] = trace.last_s

    def end(self) -> dict[str, Any]:
        _Watch.current = None
        self._threads_spent.close()
        elapsed_s = time.perf_counter() - self._begin_s
        cpu_s = time.process_time() - self._cpu
        threads = {
            name: 100 * (spent_s - self._threads.get(name, 0.0)) / elapsed_s for name, spent_s in _by_thread().items()
        }
        between_s = np.diff(self._painted_s)
        return {
            "cpu": 100 * cpu_s / elapsed_s,
            "threads": {name: share for name, share in threads.items() if share >= 0.2},
            "frames": len(self._painted_s) / elapsed_s,
            "between_ms": _quantiles(between_s, (0.5, 0.95, 0.99, 1.0)),
            "longest": longest_gap(self._painted_s, self._spent),
            "age_ms": _quantiles(np.array(self._age_s), (0.5, 0.95, 1.0)),
            "behind": self._acquisition.dropped_from_preview,
            "lost": sum(status.counts.lost for status in self._acquisition.status().values()),
        }


def _bench_page(window: "MainWindow", wizard: "Wizard") -> Any:
    """Eighteen curves: what every sensor's rates about its three axes are, two curves in each of nine strips."""
    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QVBoxLayout, QWidget

    from app.wizard.walking.live_strip import LiveStrip
    from app.wizard.walking.readout import LiveTrace
    from core.body import Side

    acquisition = wizard.visit.sensors.acquisition if wizard.visit is not None else None
    assert acquisition is not None
    page = QWidget()
    column = QVBoxLayout(page)
    strips = [LiveStrip((-400.0, 400.0), 400) for _ in range(9)]
    for strip in strips:
        column.addWidget(strip, 1)

    def show() -> None:
        curves = []
        for sensor in acquisition.sensors:
            block = acquisition.latest(sensor, 0.5)
            curves += [LiveTrace(block.time_s, block.gyr_rad_s[:, axis]) for axis in range(3)]
        for k, strip in enumerate(strips):
            left, right = curves[2 * k : 2 * k + 2]
            if len(left.time_s):  # nothing is there before the first sample
                strip.show_traces(float(left.time_s[-1]), {Side.LEFT: left, Side.RIGHT: right})

    timer = QTimer(page)
    timer.timeout.connect(show)
    timer.start(round(1000 * DUE_S))
    window.screens.addWidget(page)
    window.screens.setCurrentWidget(page)
    return page


Spent = tuple[float, float]
"""How long a thread was at work so far, and how long it was ready and others were on the processor, both s."""


def longest_gap(painted_s: Sequence[float], spent: Sequence[Mapping[str, Spent]]) -> dict[str, Any]:
    """Of the longest time between two of these instants (n,): how long, since when, and what each thread did, ms."""
    if len(painted_s) < 2:
        return {}
    k = int(np.argmax(np.diff(painted_s)))
    threads = {
        name: [round(1000 * (after - before)) for before, after in zip(spent[k][name], now, strict=True)]
        for name, now in spent[k + 1].items()
        if name in spent[k]
    }
    gap_ms = round(1000 * (painted_s[k + 1] - painted_s[k]), 1)
    return {"ms": gap_ms, "since_s": round(painted_s[k], 3), KEPT: threads}


class _Spent:
    """What each of our threads has spent. Their files stay open: opening them in every frame cost more than a point."""

    def __init__(self) -> None:
        self._files: dict[int, BinaryIO] = {}

    def read(self) -> dict[str, Spent]:
        reported = {}
        for thread in threading.enumerate():
            if (native_id := thread.native_id) is None:
                continue
            with suppress(OSError):  # it has just ended
                if native_id not in self._files:
                    self._files[native_id] = open_schedstat(native_id)
                reported[thread.name] = schedstat_s(self._files[native_id])
        return reported

    def close(self) -> None:
        for file in self._files.values():
            file.close()


class _Beside(threading.Thread):
    """Beats in another process than the window's: when it was silent for how long."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self._is_over = threading.Event()
        self.beats_s: list[float] = []

    def run(self) -> None:
        while not self._is_over.wait(BEAT_S):
            self.beats_s.append(time.perf_counter())

    def end(self) -> dict[str, float]:
        self._is_over.set()
        self.join()
        return {
            key: reported
            for key, reported in longest_gap(self.beats_s, [{}] * len(self.beats_s)).items()
            if key != KEPT
        }


def _by_thread() -> dict[str, float]:
    """Processor time of each thread so far, s, by its name; of the display's and Qt's own, all together."""
    names = {thread.native_id: thread.name for thread in threading.enumerate()}
    spent: defaultdict[str, float] = defaultdict(float)
    for folder in Path("/proc/self/task").iterdir():
        name = names.get(int(folder.name), "others")
        spent[name] += int((folder / "schedstat").read_text().split()[0]) / 1e9
    return spent


def _collections() -> list[float]:
    """How long each full garbage collection takes, ms, from now on."""
    took_ms: list[float] = []
    begun: list[float] = []

    def note(phase: str, reported: dict[str, int]) -> None:
        if reported["generation"] == 2:
            if phase == "start":
                begun.append(time.perf_counter())
            elif begun:
                took_ms.append(round(1000 * (time.perf_counter() - begun.pop()), 1))

    gc.callbacks.append(note)
    return took_ms


def _quantiles(values_s: "np.ndarray[Any, Any]", which: tuple[float, ...]) -> list[float]:
    return [round(1000 * value, 1) for value in np.quantile(values_s, which)] if len(values_s) else []


def main() -> None:
    required = options(
        __doc__,
        rate=(100.0, "of each sensor, Hz"),
        size={"type": int, "nargs": 2, "default": (1280, 800), "metavar": ("WIDTH", "HEIGHT")},
        seconds=(60.0, "of the walk"),
        curves={"type": int, "choices": [0, 18], "default": 0},
        analyses=False,
        camera=False,
        inside=(False, HIDDEN),
    )
    if required.inside:
        print(json.dumps(lead(required)))
        return
    with own_display() as display, own_environment(display) as environment:
        command = [sys.executable, "-m", "tests.benchmarks.live_window", "--inside", *sys.argv[1:]]
        beside = _Beside()
        beside.start()
        reported = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True).stdout
    measured = json.loads(reported.splitlines()[-1]) | {"beside": beside.end()}
    for late in measured.pop("late", []):
        print(late)
    print(json.dumps(measured, indent=1))


if __name__ == "__main__":
    main()

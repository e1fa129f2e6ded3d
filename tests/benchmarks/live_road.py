"""Cost of the whole live road, and age of what the screen can read.

    python -m tests.benchmarks.live_road [--seconds 30]

The demonstration's patient with six sensors at 200 Hz, played in real time through the acquisition: reader, sealed
journal, ring buffers and the estimator of each step. CPU of the whole process but the frames, as a share of one core;
"reading and recording" is what every row holds besides. Age: from a sample's stamp until the state that has it can be
read; of walking that of the angles, which wait for the samples around them. A frame is a millisecond of
Python on a thread of its own, due 30 times a second as the screen's are: when it is done.
"""

import tempfile
import threading
import time
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from app.acquisition.acquisition import Acquisition, LiveEstimator
from app.acquisition.live_sensors import live_sensors
from app.storage.journal.writer import JournalWriter
from app.wizard.free_motion.estimator import FreeMotionEstimator, UnplacedFreeMotionEstimator
from app.wizard.sensors.estimator import PlacingEstimator
from app.wizard.standing.estimator import StandingEstimator
from app.wizard.walking.estimator import WalkingEstimator
from core.analysis import analyse
from core.body import LEG_SITES, Side
from core.live.sensors import LiveSensor
from core.samples import FloatArray, ImuBlock
from core.session import RecordingKind
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from tests.driver import options
from tests.safety.journal_material import KEY, NO_ROOM_ASKED

RATE_HZ = 200.0
STRIDE_S = 1.1
FRAME_S = 1 / 30
FRAME_LOOPS = 20_000  # about a millisecond


@dataclass(slots=True)
class Timed:
    """Does an estimator's updates, and notes how long each took and how old what it shows is."""

    estimator: LiveEstimator
    newest_shown_s: Callable[[], float] | None
    now_s: Callable[[], float]
    took_s: list[float] = field(default_factory=list)
    age_s: list[float] = field(default_factory=list)
    _shown_to_s: float = -np.inf

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        begin_s = time.thread_time()
        self.estimator.update(blocks)
        self.took_s.append(time.thread_time() - begin_s)
        now_s = self.now_s()
        time_s = np.concatenate([block.time_s for block in blocks.values()])
        if self.newest_shown_s is not None:
            shown_to_s = self.newest_shown_s()
            time_s = np.arange(max(self._shown_to_s, shown_to_s - 1.0) + 1 / RATE_HZ, shown_to_s + 1e-6, 1 / RATE_HZ)
            self._shown_to_s = max(self._shown_to_s, shown_to_s)
        self.age_s += (now_s - time_s).tolist()


class Nothing:
    """What is read and recorded when nobody works on it."""

    def update(self, blocks: Mapping[str, ImuBlock]) -> None:
        pass


class Screen(threading.Thread):
    """Draws a frame of Python whenever one is due; how late each was done, and what all of them cost."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.late_s: list[float] = []
        self.cpu_s = 0.0
        self._is_over = threading.Event()

    def run(self) -> None:
        due_s = time.perf_counter()
        while not self._is_over.is_set():
            due_s += FRAME_S
            time.sleep(max(0.0, due_s - time.perf_counter()))
            total = 0
            for k in range(FRAME_LOOPS):
                total += k
            self.late_s.append(time.perf_counter() - due_s)
        self.cpu_s = time.thread_time()

    def end(self) -> None:
        self._is_over.set()
        self.join()


def measure(
    acquisition: Acquisition,
    name: str,
    estimator: LiveEstimator,
    kind: RecordingKind,
    seconds: float,
    newest_shown_s: Callable[[], float] | None = None,
) -> str:
    """One stage of the visit, recorded: a row of the table."""
    timed, screen = Timed(estimator, newest_shown_s, lambda: acquisition.now_s), Screen()
    acquisition.ask(kind)
    with tempfile.TemporaryDirectory() as folder:
        acquisition.record(JournalWriter.create(Path(folder), uuid.uuid4(), KEY, room=NO_ROOM_ASKED))
        acquisition.set_estimator(timed)
        screen.start()
        begin_s, cpu_s = time.perf_counter(), time.process_time()
        time.sleep(seconds)
        elapsed_s, cpu_s = time.perf_counter() - begin_s, time.process_time() - cpu_s
        screen.end()
        acquisition.set_estimator(None)
        summary = acquisition.stop_recording()
    lost = sum(status.counts.lost for status in acquisition.status().values())
    share = 100 * (cpu_s - screen.cpu_s) / elapsed_s
    took, late = _quantiles(timed.took_s, (0.5, 0.99, 1.0), 1), _quantiles(screen.late_s, (0.5, 0.99, 1.0), 1)
    age = _quantiles(timed.age_s, (0.5, 0.95, 1.0), 0)
    dropped = f"{lost}, {summary.dropped_records}, {acquisition.dropped_from_preview}"
    return f"| {name} | {share:.1f} | {took} | {age} | {late} | {dropped} |"


def _quantiles(values_s: list[float], which: tuple[float, ...], digits: int) -> str:
    return ", ".join(f"{1000 * value:.{digits}f}" for value in np.quantile(values_s, which))


def stood(acquisition: Acquisition) -> StandingEstimator:
    """Let the patient stand until every sensor has shown its rest."""
    estimator = StandingEstimator(acquisition.sensors)
    acquisition.set_estimator(estimator)
    until_s = time.monotonic() + 10.0
    while not estimator.state.standing.is_done and time.monotonic() < until_s:
        time.sleep(0.1)
    acquisition.set_estimator(None)
    return estimator


def run(seconds: float) -> None:
    required = (Standing(duration_s=10.0), FreeMotion(duration_s=seconds), Walk(strides=round(seconds / STRIDE_S)))
    session = simulate(replace(DEMONSTRATION, rate_hz=RATE_HZ, recordings=required)).session
    calibration = analyse(session).calibrations[-1].joints
    site_of = {session.recordings[0].imu[site].sensor: site for site in LEG_SITES}
    acquisition = Acquisition([ReplaySource(session)])
    acquisition.start()
    try:
        rests = stood(acquisition).state.standing.rest
        sensors = live_sensors(site_of, rests, acquisition.status())
        standing = {name: rest.acc_m_s2 for name, rest in rests.items()}
        walking = WalkingEstimator(site_of, sensors, calibration)
        free, walk = RecordingKind.FREE_MOTION, RecordingKind.WALKING

        def newest_angle_s() -> float:
            curves = walking.state.joints.values()
            return min((float(c.time_s[-1]) for c in curves if len(c.time_s)), default=-np.inf)

        print("| estimator | of one core, % | update 50 %, 99 %, worst, ms | age 50 %, 95 %, worst, ms |", end="")
        print(" frame done 50 %, 99 %, worst, ms | lost: sensors, journal, preview |\n|---|---|---|---|---|---|")
        for name, estimator, kind in (
            ("reading and recording", Nothing(), walk),
            ("placing", PlacingEstimator(site_of, standing), free),
            ("standing", StandingEstimator(site_of), RecordingKind.STANDING),
            ("free motion", FreeMotionEstimator(site_of, sensors, standing=standing), free),
            ("free motion, sites unknown", unplaced(sensors, standing), free),
        ):
            print(measure(acquisition, name, estimator, kind, seconds), flush=True)
        print(measure(acquisition, "walking", walking, walk, seconds, newest_angle_s), flush=True)
    finally:
        acquisition.close()


def unplaced(sensors: Mapping[str, LiveSensor], standing: Mapping[str, FloatArray]) -> UnplacedFreeMotionEstimator:
    """Both legs begin together, so that somebody has to say which is which."""
    estimator = UnplacedFreeMotionEstimator(sensors, None, standing=standing)
    estimator.name_leg((next(iter(sensors)), Side.LEFT))
    return estimator


def main() -> None:
    run(options(__doc__, seconds=(30.0, "of each estimator")).seconds)


if __name__ == "__main__":
    main()

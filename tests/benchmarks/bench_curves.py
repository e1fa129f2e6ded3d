"""Time from Stop until the curves of the bench are on the screen.

    python -m tests.benchmarks.bench_curves [--walks 6] [--speed 4]

A simulated user of an above-knee prosthesis walks alignment after alignment, 14 strides each, all of them kept; the
library is an encrypted one on the disk, the window Qt's offscreen one. Of each walk, from pressing Stop: until it has
been read back, until it is analysed, until the bench with its curves is painted, seconds of the clock, and processor
time of this process. Time before Stop runs `--speed` times as fast.
"""

import os
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter, process_time, sleep

from app.theme.current import load_fonts

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QApplication

from app.acquisition.acquisition import Acquisition
from app.plots.compared_chart import ComparedChart
from app.wizard.keys import Intent, KeyAction
from app.wizard.visit import Visit
from app.wizard.walking.step import WalkingStep
from app.wizard.worn_sensors import SourceChoice
from app.workers.library_controller import LibraryController
from core.body import LEG_SITES, Side
from core.session import Patient, RecordingKind
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import FreeMotion, ProsthesisSetting, Standing, Tissue, Walk, WalkerSettings, simulate
from tests.driver import options
from tests.quick_library import quick_library

PASSPHRASE = "four short words here"
PATIENCE_S = 60.0
RUN, KEEP = Intent(KeyAction.RUN), Intent(KeyAction.KEEP)


class Painted(QObject):
    """When curves of the bench were painted last."""

    def __init__(self) -> None:
        super().__init__()
        self.at_s = 0.0

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() is QEvent.Type.Paint and isinstance(watched, ComparedChart):
            self.at_s = perf_counter()
        return False


def wait(until: Callable[[], bool]) -> float:
    """Let the application live until something is so; the clock then."""
    end_s = perf_counter() + PATIENCE_S
    while not until():
        if perf_counter() > end_s:
            raise TimeoutError("this took too long")
        QApplication.processEvents()
        sleep(0.002)  # the analysis needs the processor
    return perf_counter()


def rest(seconds: float) -> None:
    end_s = perf_counter() + seconds
    wait(lambda: perf_counter() >= end_s)


def patient(walks: int, speed: float) -> ReplaySource:
    played = [Walk(f"walk {k}", strides=14, prosthesis=ProsthesisSetting(swing_flexion_deg=k)) for k in range(walks)]
    settings = WalkerSettings(
        seed=1,
        tissue=Tissue.SOFT,
        prosthetic_side=Side.LEFT,
        recordings=(Standing(duration_s=10.0), FreeMotion(duration_s=12.0), *played),
    )
    return ReplaySource(simulate(settings).session, speed=speed)


def dressed(controller: LibraryController, source: ReplaySource) -> Visit:
    choice = SourceChoice("fast", "Fast patient", lambda: Acquisition([source], source.now_ns), is_simulated=True)
    visit = Visit(controller, [choice])
    visit.patient.edit(Patient(code="DEMO-7", birth_year=1970, prosthetic_side="left"))
    visit.patient.commit()
    wait(lambda: visit.patient.stored is not None)
    visit.record.begin()
    wait(lambda: visit.session is not None)
    visit.sensors.search(visit.choices[0])
    worn = {f"DEMO-{site}": site for site in LEG_SITES}
    wait(lambda: visit.sensors.acquisition is not None and set(visit.sensors.status) == set(worn))
    visit.sensors.assign_all(worn)
    visit.place_sensors()
    rest(0.5)
    return visit


def _has_more(visit: Visit, count: int) -> bool:
    return len(visit.recordings.every) > count


def calibrate(visit: Visit, speed: float) -> None:
    acquisition = visit.sensors.acquisition
    assert acquisition is not None
    for kind, seconds in ((RecordingKind.STANDING, 4.0), (RecordingKind.FREE_MOTION, 13.0)):
        acquisition.ask(kind)
        count = len(visit.recordings.every)
        visit.recordings.begin(acquisition, kind)
        wait(lambda: visit.recordings.is_recording)
        rest(seconds / speed)
        visit.recordings.stop()
        wait(partial(_has_more, visit, count))
    wait(lambda: visit.evaluation.calibration != {} and not visit.evaluation.is_busy)


def walked(step: WalkingStep, visit: Visit, painted: Painted, speed: float) -> tuple[float, float, float, float]:
    """One walk: seconds from Stop to read back, analysed, painted; processor time."""
    for _ in range(4):
        step.page.bench.alignments.fields.steppers["turns"].stepped.emit(1)
    count = len(visit.recordings.walks)
    step.on_intent(RUN)
    wait(lambda: visit.recordings.is_recording)
    end_s = perf_counter() + 19.0 / speed
    while perf_counter() < end_s:
        step.tick()
        rest(0.03)
    wait(lambda: not visit.evaluation.is_busy)
    begin_s, begin_cpu_s = perf_counter(), process_time()
    step.on_intent(RUN)
    read_s = wait(lambda: len(visit.recordings.walks) > count)
    name = visit.recordings.walks[-1].details.name
    analysed_s = wait(lambda: bool(visit.evaluation.strides(name)) and not visit.evaluation.is_busy)
    wait(lambda: step.page.bench.isVisible() and painted.at_s > analysed_s)
    cpu_s = process_time() - begin_cpu_s
    return read_s - begin_s, analysed_s - begin_s, painted.at_s - begin_s, cpu_s


def main() -> None:
    required = options(__doc__, walks=6, speed=4.0)
    application = QApplication([])
    load_fonts()
    with tempfile.TemporaryDirectory() as folder:
        quick_library(Path(folder), PASSPHRASE).library.close()
        controller = LibraryController()
        controller.open(lambda holder: holder.open(Path(folder), PASSPHRASE))
        wait(lambda: controller.state is not None)
        visit = dressed(controller, patient(required.walks, required.speed))
        calibrate(visit, required.speed)
        step = WalkingStep(visit)
        step.page.resize(1064, 672)
        step.page.show()
        step.enter()
        painted = Painted()
        application.installEventFilter(painted)
        print("walk | read back s | analysed s | painted s | processor s")
        for number in range(1, required.walks + 1):
            found = walked(step, visit, painted, required.speed)
            print(" | ".join([str(number), *(f"{value:.2f}" for value in found)]), flush=True)
            step.on_intent(KEEP)
            rest(0.3)
        step.leave()
        visit.close()
        visit.finish()
        controller.finish()
    application.quit()


if __name__ == "__main__":
    main()

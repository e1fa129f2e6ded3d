"""T7: what a walk of hours loses under the whole window, and whether anything grows.

    python -m tests.safety.window_hours [--hours 2] [--speed 1]

The whole window without a display leads a visit of the simulated patient with six sensors at 200 Hz to the walking
page, and records one walk of so many hours, drawn 30 times a second. After the first minutes and before the stop are
reported: memory, threads, open files, objects, references to None. Then the walk is stopped, decoded and analysed, as
ever. It ends with 1 if a sample is missing, or anything grew by more than it may. At a higher speed the clock of
sensors and recording runs faster; frames, disk and processor do not, and the estimator may leave samples out of the
preview.
"""

import resource
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtWidgets import QApplication

from app.acquisition.acquisition import Acquisition
from app.main_window import MainWindow
from app.wizard.step import StepId
from core.samples import ImuBlock
from core.session import RecordingKind
from devices.simulation.replay import DEMONSTRATION_SESSION, ReplaySource
from devices.simulation.walker import simulate
from tests.driver import options
from tests.safety.window_material import PATIENCE_S, begun_visit, grown, held, linger, opened_window, put_on, wait

if TYPE_CHECKING:
    from app.wizard.visit import Visit
    from app.wizard.wizard import Wizard

RATE_HZ = 200.0
ASKS_EVERY_S = 2.0  # shorter than any of the patient's walks: they follow each other
SETTLED_S = 180.0  # until the buffers of the last seconds are full, and each page's parts are made
SHOWS_EVERY_S = 300.0
ANALYSED_WITHIN_S = 3600.0


def lead(application: QApplication, window: MainWindow) -> "tuple[Wizard, Visit]":
    """Go from home to a walk that is being recorded."""
    wizard, visit = begun_visit(application, window)
    linger(application, 4.0)
    put_on(visit)
    wizard.go_to(StepId.STAND_STILL)
    linger(application, 0.5)
    wizard.press_primary()
    wait(application, lambda: wizard.step_id is StepId.FREE_MOTION)
    wait(application, lambda: wizard.step_id is StepId.WALKING, 3 * PATIENCE_S)
    wait(application, lambda: not visit.evaluation.is_busy)
    wizard.press_primary()
    wait(application, lambda: wizard.is_recording)
    return wizard, visit


def walk_on(
    application: QApplication, acquisition: Acquisition, until_s: float, show_message: Callable[[], None]
) -> None:
    """Let the patient walk until so much of the acquisition's time has passed."""
    reported_s = time.monotonic()
    while acquisition.now_s < until_s:
        acquisition.ask(RecordingKind.WALKING)
        linger(application, ASKS_EVERY_S)
        if time.monotonic() - reported_s >= SHOWS_EVERY_S:
            reported_s = time.monotonic()
            show_message()


def faults_of(block: ImuBlock, seconds: float) -> list[str]:
    """What is missing in a sensor's samples, which come at an even rate."""
    faults = []
    missing = np.round(np.diff(block.time_s) * RATE_HZ).astype(int) - 1
    if missing.any():
        faults.append(f"{block.sensor}: {missing[missing > 0].tolist()} are missing")
    if len(block) < (seconds - 1.0) * RATE_HZ:
        faults.append(f"{block.sensor} has {len(block)} samples")
    return faults


def main() -> int:
    required = options(__doc__, hours=2.0, speed=1.0)
    seconds = 3600.0 * required.hours
    session = simulate(replace(DEMONSTRATION_SESSION, rate_hz=RATE_HZ)).session
    source = ReplaySource(session, finishes=True, speed=required.speed)
    with opened_window(lambda: Acquisition([source], now_ns=source.now_ns)) as (application, window):
        wizard, visit = lead(application, window)
        acquisition = visit.sensors.acquisition
        assert acquisition is not None
        began_s = acquisition.now_s

        def show_message() -> None:
            print(f"{(acquisition.now_s - began_s) / 3600:.2f} h: {held(window)}", flush=True)

        walk_on(application, acquisition, began_s + min(SETTLED_S * required.speed, seconds / 4), show_message)
        show_message()
        before = held(window)
        walk_on(application, acquisition, began_s + seconds, show_message)
        after = held(window)
        print(f"after {required.hours:g} h: {after}", flush=True)
        faults = [
            f"{name} lost {one.counts.lost} live" for name, one in acquisition.status().items() if one.counts.lost
        ]
        behind = acquisition.dropped_from_preview
        stopped_s = time.monotonic()
        wizard.press_primary()
        # "is_stopping" ends after a few seconds, so that the next may begin; hours take longer to be read back
        wait(application, lambda: visit.recordings.is_idle, ANALYSED_WITHIN_S)
        read_s = time.monotonic() - stopped_s
        wait(application, lambda: not visit.evaluation.is_busy, ANALYSED_WITHIN_S)
        analysed_s = time.monotonic() - stopped_s - read_s
        walk = visit.recordings.walks[-1]
        assert walk.read_back is not None
        faults += [fault for block in walk.read_back.imu.values() for fault in faults_of(block, seconds)]
        samples = sum(len(block) for block in walk.read_back.imu.values())
        strides = visit.evaluation.strides(walk.details.name)
    faults += [f"{name} grew" for name in grown(before, after)]
    most_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{samples} samples, {behind} left out of the preview; strides: {', '.join(map(str, strides.values()))}")
    print(f"read back in {read_s:.1f} s, analysed in {analysed_s:.1f} s, holding {most_mib:.0f} MiB at most")
    print("\n".join(faults) if faults else "nothing is missing, nothing grew")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

"""How long after a stride's event does the patient see its bar and hear its tone?

    python -m tests.benchmarks.feedback_latency [--seconds 25]

The demonstration's patient with six sensors at 200 Hz, played in real time through the acquisition: reader, sealed
journal, ring buffers, the walking estimator, and the patient's screen beside the operator's page, which is drawn thirty
times a second meanwhile. One measure after the other, on the leg without a prosthesis, each with a target that every
stride reaches.

"From the event": from the instant of the knee's peak, of the contact or of the toe-off to when the bar has been
painted, and to when the tone is handed to the player. "From its end": from the sample that tells it, with which a knee
has fallen from its peak and a contact is found. How long the player takes from there to the loudspeaker is not in it.
"""

import argparse
import sys
import tempfile
import threading
import time
import uuid
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QObject, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app import sounds
from app.acquisition.acquisition import Acquisition
from app.acquisition.live_sensors import live_sensors
from app.main_window import SWITCH_S
from app.sounds import Sound
from app.storage.journal.writer import JournalWriter
from app.theme import ThemeNotifier, load_fonts
from app.wizard.walking.estimator import WalkingEstimator
from app.wizard.walking.page import WalkingPage
from app.wizard.walking.patient_feedback import PatientFeedback
from app.wizard.walking.walk_list import WalkRow, WalkState
from app.workers.garbage import GarbageCollector
from core.analysis import analyse
from core.body import Side, Site
from core.live.stride_values import StrideValue
from core.samples import RecordingKind
from core.targets import Target, TargetMeasure
from devices.replay import ReplaySource
from devices.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from tests.benchmarks.live_road import stood
from tests.safety.journal_material import KEY, NO_ROOM_ASKED

RATE_HZ = 200.0
STRIDE_S = 1.1
TICK_MS = 33
BEAT_S = 0.01
ALWAYS_REACHED = -99


class _Beat(threading.Thread):
    """Sleeps for BEAT_S again and again: how late it wakes is what the machine adds by itself, busy as it is."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.late_s: list[float] = []
        self._is_over = threading.Event()

    def run(self) -> None:
        while not self._is_over.is_set():
            begin_s = time.perf_counter()
            time.sleep(BEAT_S)
            self.late_s.append(time.perf_counter() - begin_s - BEAT_S)

    def end(self) -> None:
        self._is_over.set()
        self.join()


class _Watch(QObject):
    """Notes when each value was handed to the player, and when the window had painted it."""

    def __init__(self, acquisition: Acquisition, estimator: WalkingEstimator) -> None:
        super().__init__()
        self._acquisition, self._estimator = acquisition, estimator
        self.target: Target | None = None
        self.heard: list[tuple[StrideValue, float]] = []
        self.painted: list[tuple[StrideValue, float]] = []
        self.known: list[tuple[StrideValue, float]] = []
        self.on_value, estimator.on_value = estimator.on_value, self.on_known
        self._pending: list[StrideValue] = []
        self._last_known: StrideValue | None = None

    def on_known(self) -> None:
        """Called by the estimator's thread: the first that anybody can know of a value."""
        value, now_s = self._newest(), self._acquisition.now_s
        if value is not None and value is not self._last_known:
            self.known.append((value, now_s))
            self._last_known = value
        if self.on_value is not None:
            self.on_value()

    def _newest(self) -> StrideValue | None:
        """The newest value of what is aimed at."""
        target = self.target
        of_it = (
            one
            for one in reversed(self._estimator.state.stride_values)
            if target is not None and one.measure is target.measure and target.side in (None, one.side)
        )
        return next(of_it, None)

    def on_sound(self, sound: Sound) -> None:
        value, now_s = self._newest(), self._acquisition.now_s
        if sound is not Sound.REACHED or value is None:
            return
        self.heard.append((value, now_s))
        self._pending.append(value)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() is QEvent.Type.Paint and self._pending:
            QTimer.singleShot(0, self.on_painted)  # once all of it is done
        return False

    def on_painted(self) -> None:
        now_s = self._acquisition.now_s
        self.painted += [(value, now_s) for value in self._pending]
        self._pending.clear()


def run(seconds: float) -> None:
    sys.setswitchinterval(SWITCH_S)  # as the window does
    app = QApplication([])
    collector = GarbageCollector(app, lambda: False)  # as in the application: only between frames
    load_fonts()
    look = ThemeNotifier()
    strides = round(seconds / STRIDE_S)
    wanted = (Standing(duration_s=10.0), FreeMotion(duration_s=25.0), Walk(strides=strides, standing_before_s=2.0))
    session = simulate(replace(DEMONSTRATION, rate_hz=RATE_HZ, recordings=wanted)).session
    calibration = analyse(session).calibrations[-1].joints
    site_of = {session.recordings[0].imu[site].sensor: site for site in Site}
    acquisition = Acquisition([ReplaySource(session)])
    acquisition.start()
    played = sounds.play
    try:
        sensors = live_sensors(site_of, stood(acquisition).state.standing.rest, acquisition.status())
        estimator = WalkingEstimator(site_of, sensors, calibration)
        page = WalkingPage(look)
        page.resize(1064, 600)
        page.show_walks((WalkRow("1", "A", "Barefoot", WalkState.RECORDING),))
        page.show()
        feedback = PatientFeedback(look, _visit(site_of, calibration), page.patient_controls, page)
        feedback.toggle()
        assert feedback.window is not None
        feedback.watch(estimator)
        watch = _Watch(acquisition, estimator)
        sounds.play = watch.on_sound  # the tone itself is not measured, and nobody is to hear it
        feedback.window.installEventFilter(watch)
        tick = QTimer()
        tick.timeout.connect(lambda: page.show_view(estimator.state))
        tick.start(TICK_MS)
        print("All in ms: 50 %, 95 %, worst.\n")
        print("| measure | strides | from the event: known | bar | tone | from its end: bar | tone |")
        print("|---|---|---|---|---|---|---|")
        beat = _Beat()
        beat.start()
        with tempfile.TemporaryDirectory() as folder:
            acquisition.record(JournalWriter.create(Path(folder), uuid.uuid4(), KEY, room=NO_ROOM_ASKED))
            acquisition.set_estimator(estimator)
            every: tuple[list[Any], list[Any], list[Any]] = [], [], []
            for measure in TargetMeasure:
                watch.target = Target(measure, Side.RIGHT if measure.has_side else None, ALWAYS_REACHED)
                page.patient_controls.target_set.emit(watch.target)
                acquisition.ask(RecordingKind.WALKING)
                QTest.qWait(round(1000 * seconds))
                noted = watch.known, watch.painted, watch.heard
                print(_row(str(measure), *noted), flush=True)
                for whole, part in zip(every, noted, strict=True):
                    whole.extend(part)
                    part.clear()
            print(_row("all", *every))
            beat.end()
            tick.stop()
            acquisition.set_estimator(None)
            acquisition.stop_recording()
        feedback.close()
        page.close()
        app.processEvents()
        collector.deleteLater()
        dropped, trouble = acquisition.dropped_from_preview, acquisition.trouble
        print(f"\nA thread that does nothing woke so late meanwhile: {_quantiles(beat.late_s)}.")
        print(f"Samples that the estimator never saw: {dropped}; it failed with: {trouble}.")
    finally:
        sounds.play = played
        acquisition.close()


def _visit(site_of: dict[str, Site], calibration: Any) -> Any:
    """What the screen asks of a visit."""
    sensors = SimpleNamespace(sensor_at={site: name for name, site in site_of.items()}, site_of=site_of)
    return SimpleNamespace(
        sensors=sensors,
        evaluation=SimpleNamespace(calibration=calibration),
        prosthetic_sides=frozenset(),
        rests=site_of,
    )


Noted = list[tuple[StrideValue, float]]


def _row(name: str, known: Noted, painted: Noted, heard: Noted) -> str:
    cells = [_quantiles([at_s - one.event_s for one, at_s in noted]) for noted in (known, painted, heard)]
    cells += [_quantiles([at_s - one.told_s for one, at_s in noted]) for noted in (painted, heard)]
    return f"| {name} | {len(painted)} | " + " | ".join(cells) + " |"


def _quantiles(values_s: list[float]) -> str:
    if not values_s:
        return "-"
    return ", ".join(f"{1000 * value:.0f}" for value in np.quantile(values_s, (0.5, 0.95, 1.0)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=25.0, help="of each measure")
    run(parser.parse_args().seconds)


if __name__ == "__main__":
    main()

"""From six emulated DOTs to results: found, set up and synchronised in the window, each float compared.

    python -m tests.safety.dots_to_results [--walks 1] [--memory] [--bumble] [--shots FOLDER]

As `ports_to_results`, in real time, but in one process: behind the interface that the Bluetooth library has for
backends, or with `--bumble` through Bumble's virtual radio. Walks are sent live at 60 Hz, or with `--memory` recorded
in the sensors at 120 Hz and fetched, with three broken links of each sensor and samples that it cannot read at first.
The patient's motion, the sensors' clocks and what each took are the oracle.
"""

import os
import sys
import tempfile
import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from unittest.mock import patch

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication

from app.theme.current import load_fonts
from app.wizard.sensors.dot_form import DotChoice
from app.wizard.sensors.sources import SEARCH
from app.wizard.sensors.step import SensorsStep
from app.wizard.step import StepId
from core.body import LEG_JOINTS, LEG_SITES, Site
from core.samples import FloatArray
from core.session import RecordingKind
from devices.clocks.host_clock import host_time_ns
from devices.emulators.dot import EmulatedDot
from devices.emulators.dot_patient import worn_air
from devices.emulators.patient import FINE_HZ, EmulatedPatient
from devices.transport.bluetooth import Radio
from tests.devices.bumble_air import BumbleAir, BumbleRadio
from tests.driver import options
from tests.safety.ports_to_results import Outcome, WindowSession, lead, look, outcome_of

KIND = "movella-dot"
BREAKS = [300, 400, 500]  # samples of a file since it was connected, after which the link is lost
UNREAD = 0.002  # of the samples of a file
APART_MS = 2.0
FETCHED_S = 600.0  # at most


class DotWindowSession(WindowSession):
    """The sensors are known by their names, which count."""

    def __init__(
        self, application: QApplication, folder: Path, shots: Path | None, dots: list[EmulatedDot], *, in_memory: bool
    ) -> None:
        super().__init__(application, folder, shots)
        self.dots, self.in_memory = dots, in_memory
        self.synchronised_s: list[float] = []
        self.fetched_s: list[float] = []
        self.breaks = self.unread = 0

    def to_sensors(self, code: str, kind: str) -> None:
        for letter in code:
            self.press(Qt.Key(ord(letter)))
        self.press(Qt.Key.Key_Return)
        self.wait(
            lambda: self.wizard.step_id is StepId.SENSORS and self.visit.session is not None,
            "sensors' step",
        )
        sensors, step = self.visit.sensors, self.wizard.steps[StepId.SENSORS]
        assert isinstance(step, SensorsStep)
        sensors.search(next(source for source in self.visit.choices if source.key == SEARCH))
        self.wait(lambda: step.setup.is_on, "the sensors that were heard")
        assert not any(source.is_simulated for source in self.visit.choices), "they would not be kept of this patient"
        self.wait(lambda: all(dot.sensor.info is not None for dot in step.setup.dots), "what they are")
        if not self.in_memory:
            step.page.dots.show_choice(DotChoice(record_hz=0))
        look(self, self.shots, f"{kind}-set-up")
        begin_s = time.monotonic()
        self.press(Qt.Key.Key_Return)
        self.wait(lambda: sensors.sync.is_running, "synchronising")
        self.linger(8.0)
        look(self, self.shots, f"{kind}-synchronising")
        self.wait(lambda: sensors.acquisition is not None, f"sensors {sensors.sync.failure}")
        self.synchronised_s.append(time.monotonic() - begin_s)

    def before_walks(self) -> None:
        if not self.in_memory:
            return
        begin_s = time.monotonic()
        look(self, self.shots, f"{KIND}-before-walks")
        self.press(Qt.Key.Key_Return)
        sensors = self.visit.sensors
        self.wait(lambda: sensors.are_ready_for_walks and sensors.sync.is_idle, "sensors that are ready")
        self.synchronised_s.append(time.monotonic() - begin_s)
        for dot in self.dots:
            dot.faults.damaged = UNREAD

    def after_walk(self, number: int) -> None:
        if not self.in_memory:
            return
        for dot in self.dots:
            dot.faults.drops_export_after = list(BREAKS)
        recordings, begin_s = self.visit.recordings, time.monotonic()
        self.wait(lambda: bool(recordings.fetches.view(6).fetched), "the first sensor's file", FETCHED_S)
        look(self, self.shots, f"{KIND}-fetching-{number}")
        while len(recordings.walks) < number:
            self.wait(lambda: len(recordings.walks) == number or bool(recordings.fetches.failure[0]), "it", FETCHED_S)
            if recordings.fetches.failure[0]:
                print(*recordings.fetches.failure, flush=True)
                self.press(Qt.Key.Key_Return)  # Fetch again
                self.wait(lambda: not recordings.fetches.failure[0], "another try")
        self.fetched_s.append(time.monotonic() - begin_s)
        self.breaks += sum(len(BREAKS) - len(dot.faults.drops_export_after) for dot in self.dots)

    def place(self) -> None:
        acquisition = self.visit.sensors.acquisition
        assert acquisition is not None
        for name in acquisition.sensors:
            self.visit.sensors.assign(name, list(LEG_SITES)[int(name[-4:], 16) - 1])


def run(
    application: QApplication, walks: int, shots: Path | None, *, in_memory: bool, by_bumble: bool
) -> tuple[Outcome, DotWindowSession]:
    """Lead one session."""
    patient = EmulatedPatient()
    air, dots = worn_air(patient, 6, states_so=False)
    radio = Radio(air.backend, air.announced)
    if by_bumble:
        virtual = BumbleAir(dots)
        radio = BumbleRadio(virtual)
        radio.run(virtual.start())

    def ask(kind: RecordingKind) -> float:
        return (patient.ask(kind).end_ns - host_time_ns()) / 1e9

    with ExitStack() as stack:
        stack.enter_context(patch("app.wizard.sensors.sources.own_radio", lambda: radio))
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="gaitwright-dots-")))
        session = DotWindowSession(application, folder, shots, dots, in_memory=in_memory)
        stack.callback(session.close)
        analysis = lead(session, KIND, ask, walks)
        assert all(dot.is_synchronised for dot in dots)
        when_ns = np.arange(patient.clips[0].start_ns, host_time_ns(), 1e9 / FINE_HZ)
        reported: dict[str, FloatArray] = {"when_s": when_ns / 1e9}
        reported |= {
            f"truth {joint}": np.array([patient.angle_rad(joint, at) for at in when_ns]) for joint in LEG_JOINTS
        }
        for dot, site in zip(dots, LEG_SITES, strict=True):
            reported |= _taken(dot, site)
        found: Mapping[str, FloatArray] = reported
        return outcome_of(KIND, session.visit, analysis, found, folder / "library"), session


def _taken(dot: EmulatedDot, site: Site) -> Mapping[str, FloatArray]:
    """What it sent live, then what it recorded."""
    values = [one[1] for one in dot.sent] + [row for file in dot.memory.files for row in file.values]
    at_s = [one[2] / 1e9 for one in dot.sent] + [at for file in dot.memory.files for at in file.taken_s]
    every = np.array(values)
    return {
        f"sent {site}": np.hstack([np.pi / 180 * every[:, 7:], every[:, 4:7]]),
        f"sent_s {site}": np.array(at_s),
    }


def main() -> int:
    required = options(
        __doc__,
        walks=1,
        memory=(False, "record walks in the sensors"),
        bumble=(False, "through Bumble's virtual radio"),
        shots={"type": Path, "metavar": "FOLDER", "help": "write pictures of the window there"},
    )
    application = QApplication([])
    application.setStyle("Fusion")
    load_fonts()
    outcome, session = run(
        application, required.walks, required.shots, in_memory=required.memory, by_bumble=required.bumble
    )
    print(outcome, flush=True)
    print(f"synchronised in {', '.join(f'{one:.0f}' for one in session.synchronised_s)} s", flush=True)
    if required.memory:
        fetched = ", ".join(f"{one:.0f}" for one in session.fetched_s)
        print(f"fetched in {fetched} s over {session.breaks} broken links", flush=True)
    apart_ms = max(float(np.ptp(late)) for late in outcome.late_ms.values())
    return 0 if apart_ms < APART_MS and not outcome.lost and not outcome.wrong else 1


if __name__ == "__main__":
    sys.exit(main())

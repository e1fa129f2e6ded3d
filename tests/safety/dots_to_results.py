"""From six emulated DOTs to results: found, synchronised, streamed at 60 Hz through the wizard, each float compared.

    python -m tests.safety.dots_to_results [--walks 1] [--shots FOLDER]

As `ports_to_results`, in real time, but in one process: behind the interface that the Bluetooth library has for
backends. The patient's motion, the sensors' clocks and what each took are the oracle.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from unittest.mock import patch

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
from PySide6.QtWidgets import QApplication

from app.theme import load_fonts
from core.body import Joint, Site
from core.samples import FloatArray, RecordingKind
from devices.bluetooth import Radio
from devices.emulators.dot_patient import worn_air
from devices.emulators.patient import FINE_HZ, EmulatedPatient
from devices.host_clock import host_time_ns
from tests.safety.ports_to_results import Outcome, WindowSession, lead, outcome_of

KIND = "movella-dot"


class DotWindowSession(WindowSession):
    """The sensors are known by their names, which count."""

    def place(self) -> None:
        acquisition = self.visit.sensors.acquisition
        assert acquisition is not None
        for name in acquisition.sensors:
            self.visit.sensors.assign(name, list(Site)[int(name[-4:], 16) - 1])


def run(application: QApplication, walks: int, shots: Path | None) -> tuple[Outcome, bool]:
    """Lead one session; whether all sensors were on one clock, too."""
    patient = EmulatedPatient()
    air, dots = worn_air(patient, 6, says_so=False)
    radio = Radio(air.backend, air.announced)

    def ask(kind: RecordingKind) -> float:
        return (patient.ask(kind).end_ns - host_time_ns()) / 1e9

    with ExitStack() as stack:
        stack.enter_context(patch("app.wizard.sensors.sources.own_radio", lambda: radio))
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="gaitwright-dots-")))
        session = DotWindowSession(application, folder, shots)
        stack.callback(session.close)
        analysis = lead(session, KIND, ask, walks)
        is_one_clock = all(dot.is_synchronised for dot in dots)
        when_ns = np.arange(patient.clips[0].start_ns, host_time_ns(), 1e9 / FINE_HZ)
        told: dict[str, FloatArray] = {"when_s": when_ns / 1e9}
        told |= {f"truth {joint}": np.array([patient.angle_rad(joint, at) for at in when_ns]) for joint in Joint}
        for dot, site in zip(dots, Site, strict=False):
            values = np.array([one[1] for one in dot.sent])
            told[f"sent {site}"] = np.hstack([np.pi / 180 * values[:, 7:], values[:, 4:7]])
            told[f"sent_s {site}"] = np.array([one[2] for one in dot.sent]) / 1e9
        found: Mapping[str, FloatArray] = told
        return outcome_of(KIND, session.visit, analysis, found, folder / "library"), is_one_clock


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--walks", type=int, default=1)
    parser.add_argument("--shots", type=Path, metavar="FOLDER", help="write pictures of the window there")
    wanted = parser.parse_args()
    application = QApplication([])
    application.setStyle("Fusion")
    load_fonts()
    outcome, is_one_clock = run(application, wanted.walks, wanted.shots)
    print(outcome, flush=True)
    return 0 if is_one_clock and not outcome.lost and not outcome.wrong else 1


if __name__ == "__main__":
    sys.exit(main())

"""From six ports to results. Measure what is lost on the way, and how far the angles are from the patient's truth.

    python -m tests.safety.ports_to_results [--kinds ximu3 witmotion csv xsens-mti shimmer3] [--rate 100] [--walks 3]

Six emulated sensors, in a process of their own, speak one maker's protocol at six pseudo-terminals and are worn by a
simulated patient. They do not say that they are emulated. The wizard is led through a whole session in a library of its
own, on whatever display Qt has (none is needed): a patient whose code is no demonstration's, sensors found by the
search and placed, standing, free motion, walks, results. Then what was recorded is compared, sample by sample, with
what the sensors measured, and the angles of the results with the patient's, which are zero while standing.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from app.theme.current import load_fonts

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np
from PySide6.QtCore import QEvent, QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.editing.session_recording import SessionRecording
from app.storage.journal.header import JournalHeader
from app.system.settings import Settings
from app.wizard.sensors.sources import COLUMNS, SEARCH
from app.wizard.sensors.step import SensorsStep
from app.wizard.step import StepId
from app.wizard.visit import Visit
from app.wizard.wizard import Wizard
from app.workers.library_controller import LibraryController
from core.body import LEG_JOINTS, LEG_SITES, Joint, Site
from core.results import Analysis, RecordingAnalysis
from core.samples import FloatArray, ImuBlock, IntArray
from core.session import RecordingKind
from devices.clocks.host_clock import host_time_ns
from devices.emulators.csv_lines import COLUMNS as EMULATED_COLUMNS
from devices.emulators.patient import FINE_HZ, KINDS, EmulatedPatient, EmulatedSensor
from devices.emulators.transports import Emulation, PseudoTerminal
from devices.transport.ports import MORE_PORTS
from tests.driver import HIDDEN, options

SITES = len(LEG_SITES)
PATIENCE_S = 90.0
# what a number is rounded to on its way: rate in rad/s, force in m/s2
STEPS = {
    "ximu3": (1e-5, 1e-5),
    "witmotion": (np.deg2rad(2000 / 32768), 16 * 9.80665 / 32768),
    "csv": (np.deg2rad(1e-3), 9.80665e-4),
    "xsens-mti": (1e-5, 1e-5),
    "shimmer3": (np.deg2rad(1 / 16.38), 1 / 417),
    "movella-dot": (1e-9, 1e-9),  # as it is sent, in single precision
}
LOOKED_AT = 30  # samples
DELAYS_S = np.arange(-0.005, 0.03, 0.0005).tolist()
MOST_KNEE_DEG, MOST_ANKLE_DEG = 0.13, 0.45  # nine in ten sessions of a patient who moves so, without a way in between


class Played:
    """The sensors in their own process: `ask` lets the patient move, `end` gives what was measured and what is true."""

    def __init__(self, kind: str, rate_hz: int, folder: Path) -> None:
        self._folder = folder
        command = [sys.executable, "-m", "tests.safety.ports_to_results", "--play", str(folder)]
        command += ["--kinds", kind, "--rate", str(rate_hz)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.places: list[str] = json.loads(self._stated())

    def ask(self, kind: RecordingKind) -> float:
        """Let the patient move; for how many seconds from now."""
        self._show_message(kind.value)
        return float(self._stated())

    def end(self) -> Mapping[str, FloatArray]:
        self._show_message("end")
        self._process.wait()
        return dict(np.load(self._folder / "measured.npz"))

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()  # which closes the pipes

    def _show_message(self, line: str) -> None:
        assert self._process.stdin is not None
        print(line, file=self._process.stdin, flush=True)

    def _stated(self) -> str:
        assert self._process.stdout is not None
        return self._process.stdout.readline()


def play(kind: str, rate_hz: int, folder: Path) -> None:
    """Be the sensors' process."""
    patient = EmulatedPatient()
    sensors = [EmulatedSensor(patient, kind, number, rate_hz, states_so=False) for number in range(SITES)]
    emulations = [Emulation(one.voice, partial(PseudoTerminal, folder / f"{kind}-{one.site}")) for one in sensors]
    print(json.dumps([emulation.place for emulation in emulations]), flush=True)
    for line in sys.stdin:
        if line.strip() == "end":
            break
        clip = patient.ask(RecordingKind(line.strip()))
        print((clip.end_ns - host_time_ns()) / 1e9, flush=True)
    for emulation in emulations:
        emulation.close()
    when_ns = np.arange(patient.clips[0].start_ns, host_time_ns(), 1e9 / FINE_HZ)
    reported = {
        f"truth {joint}": np.array([patient.angle_rad(joint, at_ns) for at_ns in when_ns]) for joint in LEG_JOINTS
    }
    reported |= {f"sent {one.site}": np.array(one.sent) for one in sensors}
    reported |= {f"sent_s {one.site}": np.array(one.sent_ns) / 1e9 for one in sensors}
    np.savez(folder / "measured.npz", allow_pickle=False, when_s=when_ns / 1e9, **reported)


@dataclass(slots=True)
class Outcome:
    """Of all recordings. `rms_deg` by joint, one of each walk; `late_ms` by recording, of each sensor's stamps."""

    kind: str
    rate_hz: float = 0.0
    sent: int = 0
    received: int = 0
    lost: int = 0
    wrong: int = 0
    moved_s: float = 0.0
    rms_deg: dict[Joint, list[float]] = field(default_factory=dict)
    delay_ms: list[float] = field(default_factory=list)
    late_ms: dict[str, list[float]] = field(default_factory=dict)

    def __str__(self) -> str:
        knee, ankle = self.worst(is_knee=True), self.worst(is_knee=False)
        return (
            f"{self.kind}, {self.rate_hz:g} Hz: {self.sent} samples sent while recording, {self.received} received, "
            f"{self.lost} lost, {self.wrong} changed; {len(self.delay_ms)} walks after {self.moved_s:.0f} s of free "
            f"motion, RMS error of the worst knee {knee:.2f}, of the worst ankle {ankle:.2f} deg; stamps "
            f"{np.mean(list(self.late_ms.values())):.1f} ms late, those of two sensors at most "
            f"{max(np.ptp(late) for late in self.late_ms.values()):.1f} ms apart"
        )

    @property
    def is_right(self) -> bool:
        is_near = self.worst(is_knee=True) <= MOST_KNEE_DEG and self.worst(is_knee=False) <= MOST_ANKLE_DEG
        return not self.lost and not self.wrong and is_near

    def worst(self, is_knee: bool) -> float:
        return max(max(values) for joint, values in self.rms_deg.items() if joint.is_knee is is_knee)


class WindowSession:
    """The wizard and whoever works it."""

    def __init__(self, application: QApplication, folder: Path, shots: Path | None) -> None:
        self._application, self.shots = application, shots
        os.environ["XDG_CONFIG_HOME"] = str(folder)
        self.controller = LibraryController()
        self.controller.open(
            lambda holder: holder.create(folder / "library", "PT", "Port Tester", "seven quiet herons cross")
        )
        self.wait(lambda: self.controller.state is not None, "library")
        settings = Settings(QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat))
        self.wizard = Wizard(self.controller, settings)
        self.wizard.resize(1280, 800)
        self.wizard.show()
        self.wizard.activateWindow()
        QTest.qWaitForWindowActive(self.wizard)
        self.wizard.begin(None)
        assert self.wizard.visit is not None
        self.visit: Visit = self.wizard.visit
        self.refusals: list[str] = []
        self.visit.refused.connect(lambda what, then: self.refusals.append(f"{what} {then}"))

    def wait(self, until: Callable[[], bool], what: str, most_s: float = PATIENCE_S) -> None:
        end_s = time.monotonic() + most_s
        while not until():
            if time.monotonic() > end_s:
                raise TimeoutError(f"waited in vain for: {what}; {getattr(self, 'refusals', [])}")
            self._application.processEvents()
            self._application.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
            time.sleep(0.003)

    def linger(self, seconds: float) -> None:
        end_s = time.monotonic() + seconds
        self.wait(lambda: time.monotonic() >= end_s, "time", seconds + PATIENCE_S)

    def press(self, key: Qt.Key) -> None:
        QTest.keyClick(self._application.focusWidget() or self.wizard, key)

    def to_sensors(self, code: str, kind: str) -> None:
        """Type the patient's code, go on, and search."""
        for letter in code:
            self.press(Qt.Key(ord(letter)))
        self.press(Qt.Key.Key_Return)
        self.wait(
            lambda: self.wizard.step_id is StepId.SENSORS and self.visit.session is not None,
            "sensors' step",
        )
        sources = self.visit.choices
        assert not any(source.is_simulated for source in sources), "they would not be kept of this patient"
        if kind == "csv":
            self.show_columns()
        else:
            self.visit.sensors.search(next(source for source in sources if source.key == SEARCH))
        self.wait(lambda: self.visit.sensors.acquisition is not None, "sensors")
        acquisition = self.visit.sensors.acquisition
        assert acquisition is not None
        assert len(acquisition.sensors) == SITES, acquisition.sensors
        assert {reader.source.info.driver for reader in acquisition._readers} == {kind}

    def show_columns(self) -> None:
        """Say what the columns of lines of numbers mean, as the page guesses it."""
        step = self.wizard.steps[StepId.SENSORS]
        assert isinstance(step, SensorsStep)
        self.wait(lambda: any(source.key == COLUMNS for source in self.visit.choices), "text lines (CSV)")
        step.page.source_chosen.emit(COLUMNS)
        self.wait(lambda: step.telling.columns is not None, "columns")
        self.linger(1.0)
        assert step.telling.columns == EMULATED_COLUMNS
        look(self, self.shots, "csv-columns")
        self.wizard.press_primary()

    def before_walks(self) -> None:
        """Do what these sensors need before they record walks."""

    def after_walk(self, number: int) -> None:
        """Do what these sensors need once a walk was stopped; the first one has number 1."""

    def place(self) -> None:
        """Wear each sensor at the site that its port is named for."""
        acquisition = self.visit.sensors.acquisition
        assert acquisition is not None
        for reader in acquisition._readers:
            place = reader.source._channel.place  # type: ignore[attr-defined]  # every driver here reads a port
            site = next(site for site in LEG_SITES if place.endswith(f"-{site}"))
            self.visit.sensors.assign(reader.source.info.sensors[0], site)

    def close(self) -> None:
        self.wizard.close()
        self.wizard.finish()
        self.controller.finish()
        self.wizard.deleteLater()
        self._application.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


def run(application: QApplication, kind: str, rate_hz: int, walks: int, shots: Path | None = None) -> Outcome:
    """Lead one session of one kind of sensor from its ports to its results."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="gaitwright-ports-")))
        played = Played(kind, rate_hz, folder)
        stack.callback(played.close)
        os.environ[MORE_PORTS] = os.pathsep.join(played.places)
        session = WindowSession(application, folder, shots)
        stack.callback(session.close)
        analysis = lead(session, kind, played.ask, walks)
        return outcome_of(kind, session.visit, analysis, played.end(), folder / "library")


def lead(session: WindowSession, kind: str, ask: Callable[[RecordingKind], float], walks: int) -> Analysis:
    """Lead a session from its sensors to its results; `ask` lets the patient move, and states for how long."""
    visit, wizard, shots = session.visit, session.wizard, session.shots
    session.to_sensors("P-8", kind)
    session.place()
    session.linger(2.0)
    look(session, shots, f"{kind}-sensors")
    wizard.press_primary()
    session.wait(lambda: wizard.step_id is StepId.STAND_STILL, "standing step")
    session.press(Qt.Key.Key_Space)
    session.wait(
        lambda: visit.recordings.standing is not None and wizard.step_id is StepId.FREE_MOTION, "free motion step"
    )
    session.wait(lambda: visit.recordings.is_recording, "free motion")
    while wizard.step_id is StepId.FREE_MOTION:
        ends_s = time.monotonic() + ask(RecordingKind.FREE_MOTION)
        session.wait(
            lambda: wizard.step_id is not StepId.FREE_MOTION or time.monotonic() > ends_s - 0.5,  # noqa: B023  # it waits at once
            "walking step",
        )
    session.wait(lambda: time.monotonic() > ends_s, "standing still")
    session.before_walks()
    for number in range(walks):
        session.press(Qt.Key.Key_1)
        session.press(Qt.Key.Key_Space)
        session.wait(lambda: visit.recordings.is_recording and visit.recordings.has_begun, "walk")
        left_s = ask(RecordingKind.WALKING)
        session.linger(left_s + 0.3)
        look(session, shots, f"{kind}-walk-{number + 1}")
        session.press(Qt.Key.Key_Space)
        session.after_walk(number + 1)
        session.wait(lambda number=number: len(visit.recordings.walks) == number + 1, "walk's end")  # type: ignore[misc]  # the default binds the loop's value
        session.press(Qt.Key.Key_K)
        session.linger(0.5)
    session.press(Qt.Key.Key_Return)
    session.wait(lambda: wizard.step_id is StepId.RESULTS, "results")
    session.wait(lambda: has_evaluated(visit, walks), "results' figures")
    look(session, shots, f"{kind}-results")
    analysis = visit.evaluation.analysis
    assert analysis is not None
    return analysis


def has_evaluated(visit: Visit, walks: int) -> bool:
    analysis = visit.evaluation.analysis
    found = analysis.recordings if analysis is not None else ()
    is_whole = sum(recording.kind is RecordingKind.WALKING for recording in found) == walks
    return is_whole and not visit.evaluation.is_busy


def outcome_of(
    kind: str, visit: Visit, analysis: Analysis, reported: Mapping[str, FloatArray], library: Path
) -> Outcome:
    """Compare what was recorded with what was measured, and the angles with the truth."""
    outcome, zero = Outcome(kind), true_zero(visit, reported, library)
    for recording in visit.recordings.every:
        assert recording.read_back is not None
        for site, block in recording.read_back.imu.items():
            rows = compare_samples(outcome, block, reported[f"sent {site}"], STEPS[kind])
            late_s = (
                block.time_s[rows >= 0] + opened_s(recording, library) - reported[f"sent_s {site}"][rows[rows >= 0]]
            )
            outcome.late_ms.setdefault(recording.details.name, []).append(1000 * float(late_s.mean()))
            if recording.details.kind is RecordingKind.FREE_MOTION:
                outcome.moved_s = float(np.ptp(block.time_s))
            outcome.rate_hz = round(1 / float(np.median(np.diff(block.time_s))), 1)
        found = next((one for one in analysis.recordings if one.name == recording.details.name), None)
        if recording.details.kind is RecordingKind.WALKING and found is not None:
            about_s = float(np.mean(outcome.late_ms[found.name])) / 1000
            begin_s = opened_s(recording, library) - (about_s if about_s > DELAYS_S[-1] else 0.0)
            compare_angles(outcome, found, reported, zero, begin_s)
    return outcome


def true_zero(visit: Visit, reported: Mapping[str, FloatArray], library: Path) -> dict[Joint, float]:
    """How far each joint was bent, on average, while the standing was recorded that the angles are zero at."""
    recording = visit.recordings.standing
    assert recording is not None
    assert recording.read_back is not None
    (site, *_) = Site
    first_s, last_s = opened_s(recording, library) + recording.read_back.imu[site].time_s[[0, -1]]
    is_then = (reported["when_s"] >= first_s) & (reported["when_s"] <= last_s)
    return {joint: float(reported[f"truth {joint}"][is_then].mean()) for joint in LEG_JOINTS}


def opened_s(recording: SessionRecording, library: Path) -> float:
    """When a recording's journal was opened, by the host's clock: its time 0."""
    (journal,) = recording.stored.journals
    content = (library / "recordings" / journal.file).read_bytes()
    return JournalHeader.parsed(content, journal.file).opened_ns / 1e9


def compare_samples(outcome: Outcome, block: ImuBlock, sent: FloatArray, steps: tuple[float, float]) -> IntArray:
    """Find each sample that was received among those that were sent, in their order; where (n,), -1: nowhere."""
    within = np.repeat(steps, 3)
    received = np.hstack([block.gyr_rad_s, block.acc_m_s2])
    first = np.flatnonzero(
        (
            np.abs(np.lib.stride_tricks.sliding_window_view(sent, (LOOKED_AT, 6))[:, 0] - received[:LOOKED_AT])
            <= within
        ).all(axis=(1, 2))
    )
    assert len(first) == 1, f"{block.sensor}: what was received first was sent {len(first)} times"
    at = begin = int(first[0])
    rows = np.full(len(received), -1)
    for number, row in enumerate(received):
        for ahead in (LOOKED_AT, len(sent)):
            same = (np.abs(sent[at : at + ahead] - row) <= within).all(axis=1)
            if same.any():
                rows[number] = at + int(np.argmax(same))
                at = int(rows[number]) + 1
                break
        else:
            outcome.wrong += 1
    outcome.sent += at - begin
    outcome.received += len(received)
    outcome.lost += at - begin - int(np.count_nonzero(rows >= 0))
    return rows


def compare_angles(
    outcome: Outcome,
    found: RecordingAnalysis,
    reported: Mapping[str, FloatArray],
    zero: Mapping[Joint, float],
    begin_s: float,
) -> None:
    """Find the delay that all sensors share, and the angles' errors without it."""
    at_s = found.time_s + begin_s
    errors = {delay_s: errors_deg(found, reported, zero, at_s - delay_s) for delay_s in DELAYS_S}
    delay_s = min(errors, key=lambda one: sum(value * value for value in errors[one].values()))
    outcome.delay_ms.append(1000 * delay_s)
    for joint, value in errors[delay_s].items():
        outcome.rms_deg.setdefault(joint, []).append(value)


def errors_deg(
    found: RecordingAnalysis, reported: Mapping[str, FloatArray], zero: Mapping[Joint, float], at_s: FloatArray
) -> dict[Joint, float]:
    """RMS error of each joint, its angles having been measured at `at_s` (n,) by the host's clock."""
    errors = {}
    for joint in LEG_JOINTS:
        true_rad = np.interp(at_s, reported["when_s"], reported[f"truth {joint}"]) - zero[joint]
        error = found.joints[joint].angle_rad - true_rad
        errors[joint] = float(np.degrees(np.sqrt(np.nanmean(error**2))))
    return errors


def look(session: WindowSession, shots: Path | None, name: str) -> None:
    """Take a picture of the window."""
    if shots is not None:
        session.linger(0.3)
        shots.mkdir(parents=True, exist_ok=True)
        session.wizard.grab().save(str(shots / f"{name}.png"))


def main() -> int:
    required = options(
        __doc__,
        kinds={"nargs": "+", "choices": KINDS, "default": KINDS},
        rate=(100, "as their owner set them: 100 or 200 (100)"),
        walks=3,
        shots={"type": Path, "metavar": "FOLDER", "help": "write pictures of the window there"},
        play={"type": Path, "help": HIDDEN},
    )
    if required.play is not None:
        play(required.kinds[0], required.rate, required.play)
        return 0
    application = QApplication([])
    application.setStyle("Fusion")
    load_fonts()
    is_right = True
    for kind in required.kinds:
        outcome = run(application, kind, required.rate, required.walks, required.shots)
        print(outcome, flush=True)
        is_right &= outcome.is_right
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main())

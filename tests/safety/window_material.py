"""The whole window without a display, led by a script, and what its process holds."""

import gc
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
os.environ["OPENBLAS_NUM_THREADS"] = "1"

from PySide6.QtCore import QEvent, QObject, QSettings
from PySide6.QtWidgets import QApplication

from app.acquisition.acquisition import Acquisition
from app.main_window import SWITCH_S, MainWindow
from app.system.settings import Settings
from app.theme.current import load_fonts
from app.wizard.sensors import sources
from app.wizard.step import StepId
from app.wizard.worn_sensors import SourceChoice
from app.workers.garbage import GarbageCollector
from core.body import LEG_SITES, Site
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate

if TYPE_CHECKING:
    from app.wizard.visit import Visit
    from app.wizard.wizard import Wizard

PATIENCE_S = 60.0
FILLED_S = 300.0  # on a busy machine


@dataclass(frozen=True, slots=True)
class Held:
    memory_mib: float
    threads: int
    files: int
    qt_objects: int
    python_objects: int
    none_references: int

    def __str__(self) -> str:
        return (
            f"{self.memory_mib:.1f} MiB, {self.threads} threads, {self.files} files, {self.qt_objects} Qt objects, "
            f"{self.python_objects} Python objects, {self.none_references} references to None"
        )


MAY_GROW = Held(20.0, 0, 0, 20, 2000, sys.maxsize)  # Qt: one visit more that is being closed
MAY_SHRINK = 2000  # references to None: what is given away too often ends the program


def held(window: MainWindow) -> Held:
    gc.collect()
    resident = int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return Held(
        memory_mib=resident / 2**20,
        threads=threading.active_count(),
        files=len(list(Path("/proc/self/fd").iterdir())),
        qt_objects=len(window.findChildren(QObject)),
        python_objects=len(gc.get_objects()),
        none_references=sys.getrefcount(None),
    )


def grown(before: Held, after: Held) -> list[str]:
    """What is more than it may be."""
    names = [name for name in Held.__slots__ if getattr(after, name) - getattr(before, name) > getattr(MAY_GROW, name)]
    if after.none_references < before.none_references - MAY_SHRINK:
        names.append("calls that give None away")
    return names


def wait(
    application: QApplication, until: Callable[[], bool], patience_s: float = PATIENCE_S, every_s: float = 0.005
) -> None:
    end_s = time.monotonic() + patience_s
    while not until():
        if time.monotonic() > end_s:
            raise TimeoutError("the visit does not go on")
        application.processEvents()
        application.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)  # as `exec` does of itself
        time.sleep(every_s)


def linger(application: QApplication, seconds: float) -> None:
    end_s = time.monotonic() + seconds
    wait(application, lambda: time.monotonic() >= end_s, seconds + PATIENCE_S)


def application() -> QApplication:
    """Made as the program makes its own."""
    sys.setswitchinterval(SWITCH_S)
    made = QApplication([])
    made.setApplicationName("Gaitwright")
    made.setStyle("Fusion")
    load_fonts()
    return made


def window_in(made: QApplication, library: Path) -> MainWindow:
    """The window of a user whose library is there, and whose settings lie beside it."""
    settings = Settings(QSettings(str(library.parent / "settings.ini"), QSettings.Format.IniFormat))
    window = MainWindow(settings, library)
    garbage = GarbageCollector(window, lambda: window.preparing.is_busy)
    window.preparing.done.connect(garbage.pass_over_imported)
    window.show()
    return window


def offer(name: str, open_sensors: Callable[[], Acquisition]) -> None:
    """Let these sensors be the only ones that can be chosen; before the wizard takes its choices."""
    patient = SourceChoice(name, name.capitalize(), open_sensors, is_simulated=True)
    sources.choices = lambda: (patient,)


def fast_patient(sites: tuple[Site, ...] = LEG_SITES, speed: float = 20.0) -> Callable[[], Acquisition]:
    """A patient of two walks whose time runs faster than ours."""
    played = (Standing(duration_s=10.0), FreeMotion(duration_s=30.0), Walk(strides=14), Walk("walk 2", strides=14))
    session = simulate(replace(DEMONSTRATION, sites=sites, recordings=played)).session

    def make() -> Acquisition:
        source = ReplaySource(session, speed=speed)
        return Acquisition([source], source.now_ns)

    return make


@contextmanager
def opened_window(open_sensors: Callable[[], Acquisition]) -> Iterator[tuple[QApplication, MainWindow]]:
    """The window at home in the demonstration's library, where such sensors can be chosen."""
    offer("patient", open_sensors)
    made = application()
    with tempfile.TemporaryDirectory() as folder:
        window = window_in(made, Path(folder) / "library")
        window.open_demonstration()
        wait(made, lambda: window.home is not None and window.home.isVisible())
        wait(made, lambda: window.preparing.is_idle)
        wait(made, lambda: window.home is not None and window.home.patients.patient is not None)
        # what fills the demonstration beside the screen is not what is looked at
        wait(made, lambda: window.home is not None and not window.home.filling.is_busy, FILLED_S)
        yield made, window
        window.close()
        window.finish()


def begun_visit(made: QApplication, window: MainWindow) -> "tuple[Wizard, Visit]":
    """From home to a session of the chosen patient, whose sensors are being looked for."""
    assert window.home is not None
    window.home.session_requested.emit(window.home.patients.patient)
    wizard = window.wizard
    assert wizard is not None
    visit = wizard.visit
    assert visit is not None
    wait(made, lambda: visit.patient.stored is not None)
    wizard.go_to(StepId.SENSORS)
    wait(made, lambda: visit.session is not None)
    visit.sensors.search(visit.choices[0])
    wait(made, lambda: visit.sensors.acquisition is not None)
    return wizard, visit


def put_on(visit: "Visit", sites: Sequence[Site] = LEG_SITES) -> Acquisition:
    """The sensors at their sites, in their order."""
    acquisition = visit.sensors.acquisition
    assert acquisition is not None
    visit.sensors.assign_all(dict(zip(acquisition.sensors, sites, strict=True)))
    return acquisition

"""The whole window without a display, led by a script, and what its process holds."""

import gc
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from app.theme.current import load_fonts

os.environ["QT_QPA_PLATFORM"] = "offscreen"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

from PySide6.QtCore import QEvent, QObject, QSettings
from PySide6.QtWidgets import QApplication

from app.acquisition.acquisition import Acquisition
from app.main_window import SWITCH_S, MainWindow
from app.system.settings import Settings
from app.wizard.sensors import sources
from app.wizard.worn_sensors import SourceChoice
from app.workers.garbage import GarbageCollector

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


def wait(application: QApplication, until: Callable[[], bool], patience_s: float = PATIENCE_S) -> None:
    end_s = time.monotonic() + patience_s
    while not until():
        if time.monotonic() > end_s:
            raise TimeoutError("the visit does not go on")
        application.processEvents()
        application.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)  # as `exec` does of itself
        time.sleep(0.005)


def linger(application: QApplication, seconds: float) -> None:
    end_s = time.monotonic() + seconds
    wait(application, lambda: time.monotonic() >= end_s, seconds + PATIENCE_S)


@contextmanager
def opened_window(open_sensors: Callable[[], Acquisition]) -> Iterator[tuple[QApplication, MainWindow]]:
    """The window at home in the demonstration's library, where such sensors can be chosen."""
    patient = SourceChoice("patient", "Patient", open_sensors, is_simulated=True)
    sources.choices = lambda: (patient,)  # before the wizard takes it from there
    sys.setswitchinterval(SWITCH_S)
    application = QApplication([])
    application.setStyle("Fusion")
    load_fonts()
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(QSettings(f"{folder}/settings.ini", QSettings.Format.IniFormat))
        window = MainWindow(settings, Path(folder) / "library")
        garbage = GarbageCollector(window, lambda: window.preparing.is_busy)
        window.preparing.done.connect(garbage.pass_over_imported)
        window.show()
        window.open_demonstration()
        wait(application, lambda: window.home is not None and window.home.isVisible())
        wait(application, lambda: window.preparing.is_idle)
        wait(application, lambda: window.home is not None and window.home.patients.patient is not None)
        # what fills the demonstration beside the screen is not what is looked at
        wait(application, lambda: window.home is not None and not window.home.filling.is_busy, FILLED_S)
        yield application, window
        window.close()
        window.finish()

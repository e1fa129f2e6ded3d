"""Does the window stay as it is, however many visits it has seen?

    python -m tests.safety.window_visits [--visits 30]

The whole window without a display: a session is begun, sensors are opened, placed and listened to, every page that can
be entered is shown, and the session is left; again and again. After the first five visits and after the last are told:
memory, threads, open files, objects of Qt below the window and of Python in all, and references to None, which a fault
in a binding would use up. It ends with 1 if anything grew by more than it may.
"""

import argparse
import gc
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

os.environ["QT_QPA_PLATFORM"] = "offscreen"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

from PySide6.QtCore import QEvent, QObject, QSettings
from PySide6.QtWidgets import QApplication

from app.acquisition.acquisition import Acquisition
from app.main_window import MainWindow
from app.settings import Settings
from app.theme import Look, load_fonts
from app.wizard import sources
from app.wizard.worn_sensors import SourceChoice
from app.workers.garbage import GarbageCollector
from core.body import Site
from devices.replay import ReplaySource
from devices.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate

if TYPE_CHECKING:
    from app.wizard.visit import Visit

SETTLED_AFTER = 5
PATIENCE_S = 60.0
LISTENS_S = 0.5


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


def wait(application: QApplication, until: Callable[[], bool]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not until():
        if time.monotonic() > end_s:
            raise TimeoutError("the visit does not go on")
        application.processEvents()
        application.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)  # as `exec` does of itself
        time.sleep(0.005)


def linger(application: QApplication, seconds: float) -> None:
    end_s = time.monotonic() + seconds
    wait(application, lambda: time.monotonic() >= end_s)


def make_visit(application: QApplication, window: MainWindow) -> None:
    """Begin a session, put six sensors on, look at every page that may be entered, and leave."""
    assert window.home is not None
    window._on_session_wished(window.home._patient)
    wizard = window._wizard
    assert wizard is not None
    visit: Visit | None = wizard.visit
    assert visit is not None
    wait(application, lambda: visit.patient.stored is not None)
    wizard.go_to(1)
    wait(application, lambda: visit.session is not None)
    visit.sensors.search(visit.choices[0])
    wait(application, lambda: visit.sensors.acquisition is not None)
    assert visit.sensors.acquisition is not None
    visit.sensors.assign_all(dict(zip(visit.sensors.acquisition.sensors, Site, strict=True)))
    linger(application, LISTENS_S)
    for step in (2, 4, 5, 6):
        wizard.go_to(step)
        linger(application, LISTENS_S / 2)
    wizard.leave()
    wait(application, lambda: all(thread.name != "closing sensors" for thread in threading.enumerate()))
    linger(application, LISTENS_S / 2)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--visits", type=int, default=30)
    visits = parser.parse_args().visits
    played = (Standing(duration_s=5.0), FreeMotion(duration_s=5.0), Walk(strides=6))
    session = simulate(replace(DEMONSTRATION, recordings=played)).session
    patient = SourceChoice("patient", "Patient", lambda: Acquisition([ReplaySource(session)]), is_simulated=True)
    sources.choices = lambda: (patient,)  # before the wizard takes it from there
    application = QApplication([])
    application.setStyle("Fusion")
    load_fonts()
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(QSettings(f"{folder}/settings.ini", QSettings.Format.IniFormat))
        window = MainWindow(Look(application), settings, Path(folder) / "library")
        garbage = GarbageCollector(window)
        window.preparing.done.connect(garbage.pass_over_imported)
        window.show()
        window.open_demonstration()
        wait(application, lambda: window.home is not None and window.home.isVisible())
        wait(application, lambda: window.preparing.is_idle)
        wait(application, lambda: window.home is not None and window.home._patient is not None)
        for _ in range(SETTLED_AFTER):
            make_visit(application, window)
        before = held(window)
        print(f"after {SETTLED_AFTER} visits: {before}", flush=True)
        for _ in range(visits - SETTLED_AFTER):
            make_visit(application, window)
        after = held(window)
        print(f"after {visits} visits: {after}", flush=True)
        grown = [
            name for name in Held.__slots__ if getattr(after, name) - getattr(before, name) > getattr(MAY_GROW, name)
        ]
        if after.none_references < before.none_references - MAY_SHRINK:
            grown.append("calls that give None away")
        window.close()
        window.finish()
    print(f"grew: {', '.join(grown)}" if grown else "nothing grew")
    return 1 if grown else 0


if __name__ == "__main__":
    sys.exit(main())

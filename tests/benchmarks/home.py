"""Time until home shows a library of many patients, and until a search in it is answered.

    python -m tests.benchmarks.home [--patients 2000] [--times 5]

A library in a folder, each patient with a session, the latest 40 with two visits whose courses are kept, on a window
without a display (Qt's offscreen). "Opened": from asking home to show the library until its patients are painted.
"Chosen": until the first patient's visits are. "Searched": five letters typed one after another, each painted. "At
work": the processor time of the screen's thread meanwhile. To compare two versions run this file in turn with either on
PYTHONPATH.
"""

import os
import statistics
import tempfile
from functools import partial
from pathlib import Path
from time import perf_counter, thread_time

from app.theme.current import load_fonts

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QSettings
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.home.home import Home
from app.storage.layout import KEYS
from app.system.settings import Settings
from app.workers.library_controller import LibraryController
from core.session import Patient, Session
from tests.app.home.course_library import PASSPHRASE, add_visit, course_of_visit
from tests.driver import options
from tests.quick_library import quick_library
from tests.safety.window_material import wait

SEARCHED = "P-012"
WITH_COURSES = 40
wait_until = partial(wait, patience_s=300.0, every_s=0.0005)  # what is measured takes milliseconds


def make_library(folder: Path, patients: int) -> None:
    courses = [course_of_visit(number) for number in (3, 4)]
    with quick_library(folder, PASSPHRASE) as opened:
        library = opened.library
        for number in range(patients):
            one = Patient(code=f"P-{number:04d}", birth_year=1940 + number % 60, affected_side="left")
            patient = library.patients.create(one)
            if number >= patients - WITH_COURSES:
                for at, course in zip((3, 4), courses, strict=True):
                    add_visit(library, patient.id, at, course)
            else:
                library.sessions.create(patient.id, Session((), started=f"2026-01-{1 + number % 28:02d}T09:00:00"))


def main() -> None:
    asked = options(
        __doc__, patients=2000, times=5, library={"type": Path, "help": "made there if it is empty, and kept"}
    )
    application = QApplication([])
    application.setStyle("Fusion")
    load_fonts()
    with tempfile.TemporaryDirectory() as temporary:
        folder = asked.library or Path(temporary) / "library"
        folder.mkdir(exist_ok=True)
        if not (folder / KEYS).exists():
            make_library(folder, asked.patients)
        controller = LibraryController()
        controller.open(lambda holder: holder.open(folder, PASSPHRASE))
        wait_until(application, lambda: controller.state is not None)
        state = controller.state
        assert state is not None
        home = Home(
            controller,
            Settings(QSettings(f"{temporary}/settings.ini", QSettings.Format.IniFormat)),
        )
        home.resize(1280, 800)
        home.show()
        page, rows = home.page, []
        for _ in range(asked.times + 1):  # the first one fills caches
            began_s, worked_s = perf_counter(), thread_time()
            home.show_library(state)
            wait_until(application, lambda: bool(page.patients.lines))
            home.repaint()
            opened_s, at_work_s = perf_counter() - began_s, thread_time() - worked_s
            wait_until(application, lambda: bool(page.sessions.lines))
            home.repaint()
            chosen_s = perf_counter() - began_s
            began_s, worked_s = perf_counter(), thread_time()
            for letter in SEARCHED:
                QTest.keyClicks(page.search, letter)
                application.processEvents()
            home.repaint()
            searched_s, searching_s = perf_counter() - began_s, thread_time() - worked_s
            rows.append((opened_s, at_work_s, chosen_s, searched_s, searching_s))
            page.search.clear()
            wait_until(application, lambda: bool(page.sessions.lines))
            home.clear()
        middle = [statistics.median(figures) for figures in zip(*rows[1:], strict=True)]
        print("| opened, s | at work, s | chosen, s | searched, s | at work, s |\n|---|---|---|---|---|")
        print("| " + " | ".join(f"{figure:.3f}" for figure in middle) + " |", flush=True)
        home.close()
        controller.finish()


if __name__ == "__main__":
    main()

"""Time until the demonstration's home is there, and until each of its patients is complete.

    python -m tests.benchmarks.demonstration [--times 3]

From the click on "Open demonstration" in a window on a display of its own (Xvfb): pressed at once, as the window is
there, and once what is imported beside the screen has been. "Home" is when its patients are listed and can be chosen,
then each patient when the last visit is analysed and in the course. "At work" is the program's own processor time until
then, without the processes that record and analyse. "Held up" is how often, and for how long at most, the screen's
thread was.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import monotonic, process_time

from app.theme.current import load_fonts
from tests.benchmarks.own_display import own_display, own_environment
from tests.driver import options

CODES = ("DEMO-KNEE", "DEMO-STROKE", "DEMO-AK", "DEMO-BK")
INSIDE = "from tests.benchmarks.demonstration import measure; measure(is_prepared={})"
POLL_S = 0.01
PATIENCE_S = 600.0


def measure(*, is_prepared: bool) -> None:
    """Open the demonstration in a window, and print the seconds until home and until each patient is complete."""
    from PySide6.QtCore import QSettings
    from PySide6.QtTest import QTest
    from PySide6.QtWidgets import QApplication

    from app.main_window import MainWindow
    from app.system.settings import Settings
    from tests.app.watchdog import Watchdog

    application = QApplication([])
    application.setStyle("Fusion")
    load_fonts()
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(QSettings(f"{folder}/settings.ini", QSettings.Format.IniFormat))
        window = MainWindow(settings, Path(folder) / "library")
        window.show()
        QTest.qWaitForWindowExposed(window)
        if is_prepared:
            window.prepare()
            QTest.qWait(100)
            while not window.preparing.is_idle or window.wizard is None:
                QTest.qWait(50)
        dog = Watchdog()
        dog.start()
        began_s, before_s = monotonic(), process_time()
        window.open_demonstration()
        reached: dict[str, float] = {}
        while len(reached) < 1 + len(CODES):
            if monotonic() - began_s > PATIENCE_S:
                raise TimeoutError(f"after {PATIENCE_S} s only {reached} were there")
            QTest.qWait(round(1000 * POLL_S))
            now_s = monotonic() - began_s
            home = window.home
            if home is None or home.page.patients.line is None:
                continue
            reached.setdefault("home", now_s)
            done, _ = home.filling.strip.done
            for code, visits in zip(CODES, (4, 6, 7), strict=True):
                if done >= visits or (code == CODES[-1] and not home.filling.is_busy):
                    reached.setdefault(code, now_s)
        dog.stop()
        work_s = process_time() - before_s
        held_s = [late.busy_s + late.waited_s for late in dog.late]
        window.close()
        window.finish()
    print(*(f"{reached[name]:.2f}" for name in ("home", *CODES)), f"{work_s:.2f}", len(held_s), max(held_s, default=0))


def main() -> None:
    times = options(__doc__, times=3).times
    print(f"load {os.getloadavg()[0]:.0f} on {os.cpu_count()} processors; medians, s")
    print("| pressed | home | " + " | ".join(CODES) + " | at work | held up |\n|" + "---|" * (4 + len(CODES)))
    with own_display() as display, own_environment(display) as environment:
        for is_prepared, words in ((False, "at once"), (True, "after the imports")):
            command = [sys.executable, "-c", INSIDE.format(is_prepared)]
            runs = []
            for _ in range(times):
                done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
                runs.append([float(one) for one in done.stdout.split()])
            *middle, _, _ = (statistics.median(figures) for figures in zip(*runs, strict=True))
            cells = " | ".join(f"{figure:.1f}" for figure in middle)
            held, longest_s = sum(run[-2] for run in runs), max(run[-1] for run in runs)
            print(f"| {words} | {cells} | {held:.0f} times in {times}, longest {longest_s:.2f} s |", flush=True)


if __name__ == "__main__":
    main()

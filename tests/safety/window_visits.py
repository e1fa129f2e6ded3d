"""Check that the window stays as it is, however many visits it has seen.

    python -m tests.safety.window_visits [--visits 30]

The whole window without a display: a session is begun, sensors are opened, placed and listened to, every page that can
be entered is shown, and the session is left; again and again. After the first five visits and after the last are
reported: memory, threads, open files, objects of Qt below the window and of Python in all, and references to None,
which a fault in a binding would use up. It ends with 1 if anything grew by more than it may.
"""

import sys
import threading
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QApplication

from app.acquisition.acquisition import Acquisition
from app.main_window import MainWindow
from app.wizard.step import StepId
from devices.simulation.replay import ReplaySource
from devices.simulation.walker import DEMONSTRATION, FreeMotion, Standing, Walk, simulate
from tests.driver import options
from tests.safety.window_material import begun_visit, grown, held, linger, opened_window, put_on, wait

if TYPE_CHECKING:
    pass

SETTLED_AFTER = 5
LISTENS_S = 0.5


def make_visit(application: QApplication, window: MainWindow) -> None:
    """Begin a session, put six sensors on, look at every page that may be entered, and leave."""
    wizard, visit = begun_visit(application, window)
    put_on(visit)
    linger(application, LISTENS_S)
    for step in (StepId.STAND_STILL, StepId.WALKING, StepId.RESULTS, StepId.REPORT):
        wizard.go_to(step)
        linger(application, LISTENS_S / 2)
    wizard.leave()
    wait(application, lambda: all(thread.name != "closing sensors" for thread in threading.enumerate()))
    linger(application, LISTENS_S / 2)


def main() -> int:
    visits = options(__doc__, visits=30).visits
    played = (Standing(duration_s=5.0), FreeMotion(duration_s=5.0), Walk(strides=6))
    session = simulate(replace(DEMONSTRATION, recordings=played)).session
    with opened_window(lambda: Acquisition([ReplaySource(session)])) as (application, window):
        for _ in range(SETTLED_AFTER):
            make_visit(application, window)
        before = held(window)
        print(f"after {SETTLED_AFTER} visits: {before}", flush=True)
        for _ in range(visits - SETTLED_AFTER):
            make_visit(application, window)
        after = held(window)
        print(f"after {visits} visits: {after}", flush=True)
    names = grown(before, after)
    print(f"grew: {', '.join(names)}" if names else "nothing grew")
    return 1 if names else 0


if __name__ == "__main__":
    sys.exit(main())

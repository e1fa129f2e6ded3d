"""Time from the start of the program until its window is there.

    python -m tests.benchmarks.window_start [--times 9]

From just before the process is begun until the first frame of the window is on a display of its own (Xvfb), with all
files in the disk's cache and all modules compiled, as from the second start on: for a new user, who is shown the first
start, and for one who has a library, who logs in. "At work" is the processor time of the process until then: other
programs make the time longer, but hardly this.
"""

import statistics
import subprocess
import sys
from collections.abc import Mapping
from time import monotonic, process_time

from tests.benchmarks.own_display import own_display, own_environment
from tests.driver import options

INSIDE = "from tests.benchmarks.window_start import start; start()"


def start() -> None:
    """Start as `gaitwright` does, print when the window was there and the processor time until then, and end."""
    from PySide6.QtCore import QEvent, QObject, QTimer
    from PySide6.QtWidgets import QWidget

    from app import main_window
    from app.cli import main as cli

    class FirstFrame(QObject):
        def eventFilter(self, watched: QObject, event: QEvent) -> bool:
            if event.type() is QEvent.Type.Paint:
                watched.removeEventFilter(self)
                QTimer.singleShot(0, self, lambda: self.show_message(watched))
            return False

        def show_message(self, window: QObject) -> None:
            print(monotonic(), process_time(), flush=True)
            assert isinstance(window, QWidget)
            window.close()

    first = FirstFrame()
    init = main_window.MainWindow.__init__

    def watched_init(window: main_window.MainWindow, *arguments: object, **named: object) -> None:
        init(window, *arguments, **named)  # type: ignore[arg-type]  # as they were given
        window.installEventFilter(first)

    main_window.MainWindow.__init__ = watched_init  # type: ignore[assignment,method-assign]  # only to measure
    sys.argv = ["gaitwright"]
    sys.exit(cli.main())


def started(environment: Mapping[str, str]) -> tuple[float, float]:
    """Start once: seconds until the window is there, and how many of them the process was at work."""
    begin_s = monotonic()
    reported = subprocess.run(
        [sys.executable, "-c", INSIDE], env=environment, capture_output=True, text=True, check=True
    ).stdout.split()
    return float(reported[-2]) - begin_s, float(reported[-1])


def make_library(environment: Mapping[str, str]) -> None:
    code = (
        "from pathlib import Path; from app.storage.layout import default_folder; "
        "from app.storage.opened import create_library; from app.storage.stored import Operator, Role; "
        "someone = Operator('AB', 'A. B.', Role.ADMINISTRATOR); "
        "create_library(default_folder(), someone, 'long enough a phrase')[0].library.close()"
    )
    subprocess.run([sys.executable, "-c", code], env=environment, check=True)


def main() -> None:
    times = options(__doc__, times=9).times
    print("| who | shown after, s: least, median, most | at work, s: least, median, most |\n|---|---|---|")
    with own_display() as display, own_environment(display) as environment:
        for who in ("a new user", "a user with a library"):
            if who != "a new user":
                make_library(environment)
            started(environment)  # fills caches
            runs = [started(environment) for _ in range(times)]
            wall, work = (
                f"{min(all_s):.2f}, {statistics.median(all_s):.2f}, {max(all_s):.2f}"
                for all_s in zip(*runs, strict=True)
            )
            print(f"| {who} | {wall} | {work} |", flush=True)


if __name__ == "__main__":
    main()

"""Time until the results of a stored session are on the screen.

    python -m tests.benchmarks.opening [--times 10]

The demonstration patient with three walks, in an encrypted library on the disk. From the moment a session is opened
from the list until its results are painted, on a window without a display (Qt's offscreen): the first opening of the
program's life, and the median and the longest of those after; once with nothing kept, so that the analysis is computed,
and once from the analysis that is kept. Each with the processor time that it took.
"""

import os
import statistics
import sys
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import NamedTuple
from uuid import UUID

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QEvent, QObject, QSettings
from PySide6.QtWidgets import QApplication, QStackedWidget, QWidget

from app.storage.exchange import import_session
from app.storage.opened import OpenedLibrary
from app.storage.stored import Role
from app.system.settings import Settings
from app.theme.current import load_fonts, set_theme
from app.theme.theme import Theme
from app.wizard.wizard import Wizard
from app.workers.library_controller import LibraryController
from core.session import Session
from devices.simulation.walker import DEMONSTRATION, simulate
from tests.driver import options
from tests.quick_library import quick_library
from tests.safety.window_material import wait

PASSPHRASE = "four short words here"
WALKS = 3
wait_until = partial(wait, patience_s=60.0, every_s=0.0005)  # what is measured takes milliseconds


class Opening(NamedTuple):
    """Seconds until the results were painted, and of the processor."""

    shown_s: float
    work_s: float


class Painted(QObject):
    """Whether a widget was painted since it was last asked."""

    def __init__(self) -> None:
        super().__init__()
        self.was = False

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        self.was = self.was or event.type() is QEvent.Type.Paint
        return False


def three_walks() -> Session:
    walk = DEMONSTRATION.recordings[-1]
    more = tuple(replace(walk, name=f"walk {k}") for k in range(2, WALKS + 1))
    return simulate(replace(DEMONSTRATION, recordings=DEMONSTRATION.recordings + more)).session


def library_with(session: Session, folder: Path) -> UUID:
    """Make an encrypted library that holds the session."""
    with quick_library(folder, PASSPHRASE) as opened:
        return import_session(opened, session, lambda _share, _what: None, "DEMO-1").session_id


def opened_once(application: QApplication, wizard: Wizard, session_id: UUID) -> Opening:
    """Open a session as from the list, and leave it again once it is painted."""
    began_s, worked_s = perf_counter(), process_time()
    wizard.show_session(session_id)
    wait_until(application, lambda: _results(wizard) is not None)
    results, painted = _results(wizard), Painted()
    assert results is not None
    results.installEventFilter(painted)
    results.update()
    wait_until(application, lambda: painted.was)
    took = Opening(perf_counter() - began_s, process_time() - worked_s)
    idle_until_s = perf_counter() + 0.5  # what came of it is kept meanwhile
    wait_until(application, lambda: perf_counter() > idle_until_s)
    wizard.close_visit()
    return took


def forget(opened: OpenedLibrary, session_id: UUID) -> None:
    """Remove what is kept, as if the algorithm were another one."""
    from sqlalchemy import delete

    from app.storage.database.models import ResultRow

    with opened.library._unit.writing(Role.CLINICIAN) as session:  # only a measurement wants this
        session.execute(delete(ResultRow).where(ResultRow.session_id == session_id))


def row(name: str, openings: list[Opening]) -> str:
    first, *later = openings
    shown, work = [one.shown_s for one in later], [one.work_s for one in later]
    return (
        f"| {name} | {first.shown_s:.2f} | {statistics.median(shown):.2f} | {max(shown):.2f} "
        f"| {statistics.median(work):.2f} |"
    )


def _results(wizard: Wizard) -> QWidget | None:
    """The page of results, once it is in sight."""
    frame = wizard.shell.page
    page = frame.currentWidget() if isinstance(frame, QStackedWidget) else None
    return page if type(page).__name__ == "ResultPage" else None


def main() -> None:
    times = options(__doc__, times=10).times
    application = QApplication(sys.argv[:1])
    load_fonts()
    set_theme(Theme())
    controller = LibraryController()
    with tempfile.TemporaryDirectory(prefix="gaitwright-") as folder:
        session_id = library_with(three_walks(), Path(folder))
        controller.open(lambda holder: holder.open(Path(folder), PASSPHRASE))
        wait_until(application, lambda: controller.state is not None)
        settings = Settings(QSettings(str(Path(folder) / "settings.ini"), QSettings.Format.IniFormat))
        wizard = Wizard(controller, settings)
        wizard.resize(1280, 800)
        wizard.show()
        print("| analysis | first, s | median, s | longest, s | processor, s |\n|---|---|---|---|---|", flush=True)
        for name in ("computed", "kept"):
            openings = []
            for _ in range(times + 1):
                if name == "computed":
                    controller.run(partial(forget, session_id=session_id), None, None, wizard)
                openings.append(opened_once(application, wizard, session_id))
            print(row(name, openings), flush=True)
        wizard.close()
        wizard.finish()
        controller.finish()


if __name__ == "__main__":
    main()

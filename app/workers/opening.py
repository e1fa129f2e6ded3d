"""From a folder or the demonstration to an analysis: what the background does when a session is opened.

Whatever takes long to import is imported inside the work: numpy alone would hold up the screen for a third of a second.
"""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from app.system.progress import Report
from app.wording.translation import tr
from app.workers.background import Work

if TYPE_CHECKING:
    from core.results import Analysis
    from core.session import Session

READING_SHARE = 0.1  # of the progress; the analysis takes the rest


@dataclass(frozen=True, slots=True)
class Opened:
    """A session as it was read, with what came of it."""

    session: "Session"
    analysis: "Analysis"


def opening_folder(folder: Path) -> Work:
    """Give the work that reads and analyses a session folder. It raises `FileRefusedError` as the reader does."""

    def work(report: Report) -> Opened:
        what = tr("reading {folder}").format(folder=folder.name)
        report(0.0, what)
        from app.importing.untrusted_files import read_foreign_session

        return _analysed(read_foreign_session(folder, lambda: report(0.0, what)), report)

    return work


def opening_demonstration() -> Work:
    """Give the work that lets the simulated patient walk and analyses it."""

    def work(report: Report) -> Opened:
        report(0.0, tr("simulating a patient"))
        from devices.simulation.walker import DEMONSTRATION, simulate

        return _analysed(simulate(DEMONSTRATION).session, report)

    return work


def _analysed(session: "Session", report: Report) -> Opened:
    from core.analysis import analyse

    report(READING_SHARE / 2, tr("preparing the curves"))
    import_module("app.results.result_page")  # the page itself is made later, on the thread of the screen
    report(READING_SHARE, tr("checking the samples"))
    analysis = analyse(session, progress=lambda share, what: report(READING_SHARE + (1 - READING_SHARE) * share, what))
    report(1.0, "")
    return Opened(session, analysis)

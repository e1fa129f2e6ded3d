"""From a folder or the demonstration to an analysis: what the background does when a session is opened.

Whatever takes long to import is imported inside the work: numpy alone would hold up the screen for a third of a second.
"""

from importlib import import_module
from pathlib import Path

from app.system.progress import Report
from app.wording.translation import tr
from app.workers.background import Work

READING_SHARE = 0.1  # of the progress; the analysis takes the rest


def opening_folder(folder: Path) -> Work:
    """Give the work that reads and analyses a session folder. It raises `FileRefusedError` as the reader does."""
    return _opening(folder, tr("reading {folder}").format(folder=folder.name))


def opening_demonstration() -> Work:
    """Give the work that lets the simulated patient walk and analyses it."""
    return _opening(None, tr("simulating a patient"))


def _opening(folder: Path | None, what: str) -> Work:
    def work(report: Report) -> object:
        report(0.0, what)
        from app.workers.opened_session import read_or_simulated, visit_of  # numpy, scipy

        session = read_or_simulated(folder, lambda: report(0.0, what))
        report(READING_SHARE / 2, tr("preparing the curves"))
        import_module("app.results.result_page")  # the page itself is made later, on the thread of the screen
        report(READING_SHARE, tr("checking the samples"))
        visit = visit_of(session, lambda share, now: report(READING_SHARE + (1 - READING_SHARE) * share, now))
        report(1.0, "")
        return visit

    return work

"""A session of a folder or of the demonstration, and its analysis: what `opening` needs of the modules that compute."""

from collections.abc import Callable
from pathlib import Path

from app.importing.untrusted_files import read_foreign_session
from app.summary.request import AnalysedVisit
from app.system.progress import Report
from core.analysis import analyse
from core.session import Session
from devices.simulation.walker import DEMONSTRATION, simulate


def read_or_simulated(folder: Path | None, waiting: Callable[[], None]) -> Session:
    """The session in a folder; without one, of the simulated patient."""
    return simulate(DEMONSTRATION).session if folder is None else read_foreign_session(folder, waiting)


def visit_of(session: Session, report: Report) -> AnalysedVisit:
    """The session, analysed."""
    return AnalysedVisit(session, analyse(session, progress=report))
